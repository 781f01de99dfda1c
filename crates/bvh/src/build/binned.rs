//! Splits by the surface area heuristic over bins of centroids.
//!
//! Source: Wald, "On fast construction of SAH-based bounding volume hierarchies", 2007. Differs in binning
//! all three axes, and in centroids that are scaled so that coordinates of any size can be binned.

use tahko_geometry::glam::{Vec3, Vec4};

use super::reference::{Bounds, CentroidScale, Extent, Reference};
use super::split::{Candidate, Cut};
use crate::parallel::reduce;

/// The map from a reference to its bin on each axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct BinMap {
    scale: CentroidScale,
    origin: Vec4,
    factor: Vec4,
    last: Vec4,
}

impl BinMap {
    /// Bins of equal width over the box of the centroids. On an axis on which all centroids coincide, or are so
    /// close that the factor overflows, all references may fall into one bin.
    fn new(extent: &Extent, scale: CentroidScale, bins: u16) -> Self {
        let factors = (f32::from(bins) / extent.centroids.extent()).min(Vec3::splat(f32::MAX));
        Self {
            scale,
            origin: extent.centroids.lower(),
            factor: factors.extend(0.0),
            last: Vec4::splat(f32::from(bins - 1)),
        }
    }

    #[inline]
    fn bins(&self, reference: &Reference) -> [usize; 3] {
        let position = (self.scale.centroid(reference) - self.origin) * self.factor;
        let [x, y, z, _] = position.min(self.last).to_array();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "from 0 to the last bin; truncation makes bins of equal width"
        )]
        [x, y, z].map(|position| position as i32 as usize)
    }

    /// The bin on one axis: the same arithmetic, hence the same bin.
    #[inline]
    pub(super) fn bin(&self, reference: &Reference, axis: usize) -> usize {
        self.bins(reference)[axis]
    }
}

/// The best split between bins; `None` if each axis has all references in one bin.
pub(super) fn best(
    references: &[Reference],
    extent: &Extent,
    scale: CentroidScale,
    bins: usize,
) -> Option<Candidate> {
    // Room for no more bins than needed: clearing the bins of a small node would cost more than filling them.
    match bins {
        ..=8 => best_of::<8>(references, extent, scale, bins),
        9..=16 => best_of::<16>(references, extent, scale, bins),
        17..=32 => best_of::<32>(references, extent, scale, bins),
        _ => best_of::<64>(references, extent, scale, bins.min(64)),
    }
}

fn best_of<const N: usize>(
    references: &[Reference],
    extent: &Extent,
    scale: CentroidScale,
    bins: usize,
) -> Option<Candidate> {
    #[expect(clippy::cast_possible_truncation, reason = "at most 64")]
    let map = BinMap::new(extent, scale, bins as u16);
    let filled = reduce(
        references,
        &|chunk: &[Reference]| Bins::<N>::filled(chunk, &map),
        &Bins::merged,
    );
    let mut best: Option<Candidate> = None;
    for axis in 0..3 {
        for (bin, cost) in filled.axes[axis].splits(bins) {
            if best.as_ref().is_none_or(|best| cost < best.cost) {
                let cut = Cut::Bin { map, axis, bin };
                best = Some(Candidate { cost, cut });
            }
        }
    }
    best
}

struct Bins<const N: usize> {
    axes: [AxisBins<N>; 3],
}

#[derive(Clone, Copy)]
struct AxisBins<const N: usize> {
    bounds: [Bounds; N],
    counts: [u32; N],
}

impl<const N: usize> Bins<N> {
    fn filled(references: &[Reference], map: &BinMap) -> Self {
        let empty = AxisBins {
            bounds: [Bounds::EMPTY; N],
            counts: [0; N],
        };
        let mut axes = [empty; 3];
        for reference in references {
            for (axis, bin) in axes.iter_mut().zip(map.bins(reference)) {
                axis.bounds[bin].add(reference);
                axis.counts[bin] += 1;
            }
        }
        Self { axes }
    }

    fn merged(mut self, Self { axes }: Self) -> Self {
        for (axis, other) in self.axes.iter_mut().zip(axes) {
            for bin in 0..N {
                axis.bounds[bin] = axis.bounds[bin].union(other.bounds[bin]);
                axis.counts[bin] += other.counts[bin];
            }
        }
        self
    }
}

impl<const N: usize> AxisBins<N> {
    /// Each bin before which references can be split in two, with the cost of doing so: the sum over
    /// both sides of their half area times their number.
    fn splits(&self, bins: usize) -> impl Iterator<Item = (usize, f64)> {
        let mut costs = [0.0; N];
        let mut behind = Side::EMPTY;
        for bin in (1..bins).rev() {
            behind.add(self, bin);
            costs[bin] = behind.cost();
        }
        let total = behind.count + self.counts[0];
        let mut before = Side::EMPTY;
        (1..bins).filter_map(move |bin| {
            before.add(self, bin - 1);
            let splits = before.count > 0 && before.count < total;
            splits.then(|| (bin, before.cost() + costs[bin]))
        })
    }
}

/// The references on one side of a split.
struct Side {
    bounds: Bounds,
    count: u32,
}

impl Side {
    const EMPTY: Self = Self {
        bounds: Bounds::EMPTY,
        count: 0,
    };

    fn add<const N: usize>(&mut self, axis: &AxisBins<N>, bin: usize) {
        self.bounds = self.bounds.union(axis.bounds[bin]);
        self.count += axis.counts[bin];
    }

    fn cost(&self) -> f64 {
        if self.count == 0 {
            return 0.0;
        }
        f64::from(self.count) * self.bounds.half_area()
    }
}
