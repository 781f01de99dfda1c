//! Candidates for spatial splits: planes between bins of equal width, and the boxes of what is on each side.

use tahko_geometry::{
    TriangleMesh,
    glam::{Vec3, Vec4},
    simd::{AvailableSimd, Simd, WithSimd},
};

use super::pieces;
use crate::build::binned::ROUNDING;
use crate::build::reference::{Bounds, Reference};
use crate::parallel::reduce;

/// A plane that cuts a node in two, with what is expected on its sides: references across the plane count on both.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpatialSplit {
    pub(super) axis: usize,
    pub(super) plane: f32,
    /// The sum over both sides of their half area times their number of references.
    pub(super) cost: f64,
    pub(super) sides: [Side; 2],
}

/// Some references, and the box of their parts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    pub(super) bounds: Bounds,
    pub(super) count: u32,
}

impl Side {
    const EMPTY: Self = Self {
        bounds: Bounds::EMPTY,
        count: 0,
    };

    pub(super) fn cost(&self) -> f64 {
        if self.count == 0 {
            return 0.0;
        }
        f64::from(self.count) * self.bounds.half_area()
    }
}

/// The cheapest plane on any axis that makes at most `slack` references more; `None` if all references are on
/// one side of each.
pub(super) fn best(
    references: &[Reference],
    bounds: &Bounds,
    mesh: &TriangleMesh,
    slack: usize,
    simd: AvailableSimd,
) -> Option<SpatialSplit> {
    if references.len() < FEW {
        best_of::<8>(references, bounds, mesh, slack, simd)
    } else {
        best_of::<16>(references, bounds, mesh, slack, simd)
    }
}

/// Nodes of fewer references have 8 bins, others 16: that saves a twentieth of the build time, at no cost.
const FEW: usize = 256;

fn best_of<const N: usize>(
    references: &[Reference],
    bounds: &Bounds,
    mesh: &TriangleMesh,
    slack: usize,
    simd: AvailableSimd,
) -> Option<SpatialSplit> {
    let grid = Grid::<N>::new(bounds);
    let filled = reduce(
        references,
        &|references: &[Reference]| {
            simd.dispatch(Fill::<N> {
                references,
                grid: &grid,
                mesh,
            })
        },
        &Bins::merged,
    );
    let most = references.len() + slack;
    let mut best: Option<SpatialSplit> = None;
    for (axis, bins) in filled.axes.iter().enumerate() {
        for (bin, sides) in bins.splits() {
            let cost = sides[0].cost() + sides[1].cost();
            let count = sides[0].count + sides[1].count;
            let plane = grid.plane(axis, bin);
            if best.is_none_or(|best| cost < best.cost)
                && count as usize <= most
                && bounds.lower()[axis] < plane
                && plane < bounds.upper()[axis]
            {
                best = Some(SpatialSplit {
                    axis,
                    plane,
                    cost,
                    sides,
                });
            }
        }
    }
    best
}

/// Bins of equal width over the box of a node on each axis. Positions are rounded: what is near a plane may be counted on its other side, which
/// steers the build and decides nothing else.
pub(super) struct Grid<const N: usize> {
    origin: Vec4,
    width: Vec4,
    factor: Vec4,
}

impl<const N: usize> Grid<N> {
    fn new(bounds: &Bounds) -> Self {
        #[expect(clippy::cast_precision_loss, reason = "at most 16")]
        let bins = N as f32;
        // Halved before they are subtracted: the difference may be beyond the largest f32.
        let half = 0.5 * bounds.to_aabb().max - 0.5 * bounds.to_aabb().min;
        let factors = (0.5 * bins / half).min(Vec3::splat(f32::MAX));
        Self {
            origin: bounds.lower(),
            width: (half * (2.0 / bins)).extend(0.0),
            factor: factors.extend(0.0),
        }
    }

    /// The plane before a bin.
    #[inline(always)]
    pub(super) fn plane(&self, axis: usize, bin: usize) -> f32 {
        #[expect(clippy::cast_precision_loss, reason = "at most 16")]
        let bin = bin as f32;
        self.origin[axis] + bin * self.width[axis]
    }

    /// The bins of a point.
    #[inline(always)]
    fn bins(&self, point: Vec4) -> [usize; 3] {
        #[expect(clippy::cast_precision_loss, reason = "at most 16")]
        let last = Vec4::splat((N - 1) as f32);
        let position = (point - self.origin) * self.factor - 0.5;
        let [x, y, z, _] = (position.min(last).max(Vec4::ZERO) + ROUNDING).to_array();
        [
            x.to_bits() as usize % N,
            y.to_bits() as usize % N,
            z.to_bits() as usize % N,
        ]
    }
}

/// What fills bins, compiled for each level of instructions. Closures would not be.
struct Fill<'a, const N: usize> {
    references: &'a [Reference],
    grid: &'a Grid<N>,
    mesh: &'a TriangleMesh,
}

impl<const N: usize> WithSimd for Fill<'_, N> {
    type Output = Bins<N>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Bins<N> {
        Bins::filled(self.references, self.grid, self.mesh)
    }
}

struct Bins<const N: usize> {
    axes: [AxisBins<N>; 3],
}

#[derive(Clone, Copy)]
struct AxisBins<const N: usize> {
    /// What is in each bin of the parts of all references.
    bounds: [Bounds; N],
    /// How many references begin in each bin.
    entries: [u32; N],
    /// How many references end in each bin.
    exits: [u32; N],
}

impl<const N: usize> Bins<N> {
    #[inline(always)]
    fn filled(references: &[Reference], grid: &Grid<N>, mesh: &TriangleMesh) -> Self {
        let empty = AxisBins {
            bounds: [Bounds::EMPTY; N],
            entries: [0; N],
            exits: [0; N],
        };
        let mut filled = Self { axes: [empty; 3] };
        // Neighbours in the list often fall into the same bin, and what has just been written to it would have to be waited for.
        let (first, second) = references.split_at(references.len() / 2);
        let (second, last) = second.split_at(first.len());
        for (first, second) in first.iter().zip(second) {
            for reference in [first, second] {
                filled.add(reference, grid, mesh);
            }
        }
        for reference in last {
            filled.add(reference, grid, mesh);
        }
        filled
    }

    #[inline(always)]
    fn add(&mut self, reference: &Reference, grid: &Grid<N>, mesh: &TriangleMesh) {
        let bounds = reference.bounds();
        let first = grid.bins(bounds.lower());
        let last = grid.bins(bounds.upper());
        for (axis, bins) in self.axes.iter_mut().enumerate() {
            bins.entries[first[axis]] += 1;
            bins.exits[last[axis]] += 1;
        }
        // One by one: as lists they would be stored, and loaded as vectors before that is done.
        let differs = (first[0] ^ last[0]) | (first[1] ^ last[1]) | (first[2] ^ last[2]);
        if differs == 0 {
            // Most references of large nodes end here.
            for (axis, bins) in self.axes.iter_mut().enumerate() {
                bins.bounds[first[axis]].add(reference);
            }
            return;
        }
        let [a, b, c] = mesh.triangle(reference.number() as usize).vertices();
        let corners = [a.extend(0.0), b.extend(0.0), c.extend(0.0)];
        for (axis, bins) in self.axes.iter_mut().enumerate() {
            let (first, last) = (first[axis], last[axis]);
            if first == last {
                bins.bounds[first].add(reference);
                continue;
            }
            // The axis as a constant: lanes are chosen by the instruction.
            let (bins, span) = (&mut bins.bounds, first..last + 1);
            match axis {
                0 => pieces::add::<0, N>(bins, &corners, &bounds, grid, span),
                1 => pieces::add::<1, N>(bins, &corners, &bounds, grid, span),
                _ => pieces::add::<2, N>(bins, &corners, &bounds, grid, span),
            }
        }
    }

    fn merged(mut self, Self { axes }: Self) -> Self {
        for (axis, other) in self.axes.iter_mut().zip(axes) {
            for bin in 0..N {
                axis.bounds[bin] = axis.bounds[bin].union(other.bounds[bin]);
                axis.entries[bin] += other.entries[bin];
                axis.exits[bin] += other.exits[bin];
            }
        }
        self
    }
}

impl<const N: usize> AxisBins<N> {
    /// Each bin before which references can be split in two, with what is on both sides.
    fn splits(&self) -> impl Iterator<Item = (usize, [Side; 2])> {
        let mut behind = [Side::EMPTY; N];
        let mut side = Side::EMPTY;
        for bin in (1..N).rev() {
            side.bounds = side.bounds.union(self.bounds[bin]);
            side.count += self.exits[bin];
            behind[bin] = side;
        }
        let mut before = Side::EMPTY;
        (1..N).filter_map(move |bin| {
            before.bounds = before.bounds.union(self.bounds[bin - 1]);
            before.count += self.entries[bin - 1];
            let splits = before.count > 0 && behind[bin].count > 0;
            splits.then_some((bin, [before, behind[bin]]))
        })
    }
}
