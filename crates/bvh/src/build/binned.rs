//! Splits by the surface area heuristic over bins of centroids.
//!
//! Source: Wald, "On fast construction of SAH-based bounding volume hierarchies", 2007. Differs in binning
//! all three axes, and in centroids that are scaled so that coordinates of any size can be binned.

use tahko_geometry::glam::{BVec4A, Mat4, Vec3, Vec4};

use super::reference::{Bounds, CentroidScale, Extent, Reference};
use super::split::{Candidate, Cut};
use crate::BvhOptions;
use crate::parallel::reduce;

/// The map from a reference to its bin on each axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct BinMap {
    scale: CentroidScale,
    origin: Vec4,
    factor: Vec4,
    last: Vec4,
}

/// Adding this to a small number rounds it to a whole one, and leaves that in the lower bits. Conversion to integers would
/// take several times as long, as it has to care for numbers of any size.
const ROUNDING: f32 = 12_582_912.0;

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

    /// The bins on the three axes, below `N`, which is a power of two and not below the number of bins.
    #[inline]
    fn bins<const N: usize>(&self, reference: &Reference) -> [usize; 3] {
        let position = (self.scale.centroid(reference) - self.origin) * self.factor - 0.5;
        let [x, y, z, _] = (position.min(self.last) + ROUNDING).to_array();
        [x, y, z].map(|position| position.to_bits() as usize % N)
    }

    /// The bin on one axis: the same arithmetic, hence the same bin.
    #[inline]
    pub(super) fn bin(&self, reference: &Reference, axis: usize) -> usize {
        let centroid = self.scale.centroid_on(reference, axis);
        let position = (centroid - self.origin[axis]) * self.factor[axis] - 0.5;
        let last = self.last[axis];
        let position = if position < last { position } else { last };
        (position + ROUNDING).to_bits() as usize % BvhOptions::MAX_BINS
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
        ..=4 => best_of::<4>(references, extent, scale, bins),
        5..=8 => best_of::<8>(references, extent, scale, bins),
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
    let mut filled = Bins::<N>::EMPTY;
    if references.len() < PARALLEL_SIZE {
        filled.fill(references, &map);
    } else {
        filled = reduce(
            references,
            &|chunk: &[Reference]| {
                let mut filled = Bins::EMPTY;
                filled.fill(chunk, &map);
                filled
            },
            &Bins::merged,
        );
    }
    let (cost, axis, bin) = filled.cheapest(bins, scale)?;
    Some(Candidate {
        cost: f64::from(cost) * scale.area_unit(),
        cut: Cut::Bin {
            map,
            axis,
            bin,
            bounds: filled.sides(axis, bin),
        },
    })
}

/// Nodes with fewer references are binned by one task, in place.
const PARALLEL_SIZE: usize = 1 << 15;

/// What is in the bins of each axis.
struct Bins<const N: usize> {
    bounds: [[Bounds; N]; 3],
    /// By bin, then by axis; whole numbers that are turned to f32 when they are used.
    counts: [[i32; 4]; N],
}

impl<const N: usize> Bins<N> {
    const EMPTY: Self = Self {
        bounds: [[Bounds::EMPTY; N]; 3],
        counts: [[0; 4]; N],
    };

    fn fill(&mut self, references: &[Reference], map: &BinMap) {
        for reference in references {
            for (axis, bin) in map.bins::<N>(reference).into_iter().enumerate() {
                self.bounds[axis][bin].add(reference);
                self.counts[bin][axis] += 1;
            }
        }
    }

    fn merged(mut self, Self { bounds, counts }: Self) -> Self {
        let own = self.bounds.iter_mut().flatten();
        for (own, other) in own.zip(bounds.iter().flatten()) {
            *own = own.union(*other);
        }
        let own = self.counts.iter_mut().flatten();
        for (own, other) in own.zip(counts.iter().flatten()) {
            *own += other;
        }
        self
    }

    /// The boxes around the bins before a bin and around the others.
    fn sides(&self, axis: usize, bin: usize) -> [Bounds; 2] {
        let (first, second) = self.bounds[axis].split_at(bin);
        [first, second].map(|bins| bins.iter().copied().fold(Bounds::EMPTY, Bounds::union))
    }

    /// The cheapest split: its cost, that is the sum over both sides of their half area in scaled units times their number,
    /// its axis, and the bin before which it splits. The lanes of the vectors are the axes.
    ///
    /// A split with nothing on one side has a cost of zero times infinity, which is not less than any other.
    fn cheapest(&self, bins: usize, scale: CentroidScale) -> Option<(f32, usize, usize)> {
        let mut costs = [Vec4::ZERO; N];
        let mut behind = Sides::EMPTY;
        for bin in (1..bins).rev() {
            behind.add(self, bin);
            costs[bin] = behind.costs(scale);
        }
        let mut before = Sides::EMPTY;
        let mut best = Vec4::INFINITY;
        let mut best_bins = Vec4::ZERO;
        let mut number = 0.0;
        for (bin, behind) in costs[1..bins].iter().enumerate() {
            before.add(self, bin);
            number += 1.0;
            let cost = before.costs(scale) + *behind;
            let is_better: BVec4A = cost.cmplt(best);
            best = Vec4::select(is_better, cost, best);
            best_bins = Vec4::select(is_better, Vec4::splat(number), best_bins);
        }
        let mut axis = 0;
        for other in 1..3 {
            if best[other] < best[axis] {
                axis = other;
            }
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a number of at most 64"
        )]
        let bin = best_bins[axis] as usize;
        (best[axis] < f32::INFINITY).then_some((best[axis], axis, bin))
    }
}

/// The references on one side of a split on each axis.
struct Sides {
    bounds: [Bounds; 3],
    counts: [i32; 4],
}

impl Sides {
    const EMPTY: Self = Self {
        bounds: [Bounds::EMPTY; 3],
        counts: [0; 4],
    };

    #[inline]
    fn add<const N: usize>(&mut self, bins: &Bins<N>, bin: usize) {
        for (bounds, bins) in self.bounds.iter_mut().zip(&bins.bounds) {
            *bounds = bounds.union(bins[bin]);
        }
        for (count, other) in self.counts.iter_mut().zip(bins.counts[bin]) {
            *count += other;
        }
    }

    #[inline]
    fn costs(&self, scale: CentroidScale) -> Vec4 {
        let [x, y, z] = self.bounds.map(|bounds| scale.extent(&bounds));
        let extents = Mat4::from_cols(x, y, z, Vec4::ZERO).transpose();
        let [x, y, z] = [extents.x_axis, extents.y_axis, extents.z_axis];
        let areas = x * y + y * z + z * x;
        areas * Vec4::from_array(self.counts.map(|count| count as f32))
    }
}
