//! What falls into bins of centroids, and the cheapest split between them.
//!
//! The loops here take most of a build. They are compiled for every level of instructions, and find the same at each. An array's `map` with vector
//! operations in its closure would not be compiled into them, but called.

use tahko_geometry::glam::{BVec4A, Mat4, Vec4};
use tahko_geometry::simd::{Portable, Simd};

use super::binned::BinMap;
use super::paired::PairedBounds;
use super::reference::{Bounds, CentroidScale, Reference};

/// The cheapest split.
pub(super) struct BinSplit {
    /// The sum over both sides of their half area in scaled units times their number.
    pub(super) cost: f32,
    pub(super) axis: usize,
    /// The bin before which it splits.
    pub(super) bin: usize,
    /// The boxes around the bins before it and around the others.
    pub(super) bounds: [Bounds; 2],
}

/// What is in the bins of each axis.
pub(super) struct Bins<const N: usize> {
    bounds: [[PairedBounds; N]; 3],
    /// By bin, then by axis; whole numbers that are turned to f32 when they are used.
    counts: [[i32; 4]; N],
}

impl<const N: usize> Bins<N> {
    #[inline(always)]
    pub(super) fn empty<S: Simd>(simd: S) -> Self {
        Self {
            bounds: [[PairedBounds::empty(simd); N]; 3],
            counts: [[0; 4]; N],
        }
    }

    /// References of the first and of the second half take turns: neighbours in the list often fall into the same bin, and what has just
    /// been written to it would have to be waited for.
    #[inline(always)]
    pub(super) fn fill<S: Simd>(&mut self, simd: S, references: &[Reference], map: &BinMap) {
        let (first, second) = references.split_at(references.len() / 2);
        let (second, last) = second.split_at(first.len());
        for (first, second) in first.iter().zip(second) {
            self.add(simd, first, map);
            self.add(simd, second, map);
        }
        for reference in last {
            self.add(simd, reference, map);
        }
    }

    #[inline(always)]
    fn add<S: Simd>(&mut self, simd: S, reference: &Reference, map: &BinMap) {
        let bounds = simd.load(reference.lanes());
        let bins = map.bins::<N>(map.scale.centroid_of(simd, bounds));
        for (axis, bin) in bins.into_iter().enumerate() {
            let filled = &mut self.bounds[axis][bin];
            *filled = filled.with(simd, bounds);
            self.counts[bin][axis] += 1;
        }
    }

    pub(super) fn merged(mut self, Self { bounds, counts }: Self) -> Self {
        let own = self.bounds.iter_mut().flatten();
        for (own, other) in own.zip(bounds.iter().flatten()) {
            *own = own.with(Portable, other.lanes(Portable));
        }
        let own = self.counts.iter_mut().flatten();
        for (own, other) in own.zip(counts.iter().flatten()) {
            *own += other;
        }
        self
    }

    /// The cheapest split; `None` if each axis has all references in one bin. The lanes of the vectors are the axes.
    ///
    /// A split with nothing on one side has a cost of zero times infinity, which is not less than any other.
    #[inline(always)]
    pub(super) fn cheapest<S: Simd>(
        &self,
        simd: S,
        bins: usize,
        scale: CentroidScale,
    ) -> Option<BinSplit> {
        let mut costs = [Vec4::ZERO; N];
        let mut behind = Sides::empty(simd);
        for bin in (1..bins).rev() {
            behind.add(simd, self, bin);
            costs[bin] = behind.costs(simd, scale);
        }
        let mut before = Sides::empty(simd);
        let mut best = Vec4::INFINITY;
        let mut best_bins = Vec4::ZERO;
        let mut number = 0.0;
        for (bin, behind) in costs[1..bins].iter().enumerate() {
            before.add(simd, self, bin);
            number += 1.0;
            let cost = before.costs(simd, scale) + *behind;
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
        if best[axis] < f32::INFINITY {
            Some(BinSplit {
                cost: best[axis],
                axis,
                bin,
                bounds: self.sides(simd, bins, axis, bin),
            })
        } else {
            None
        }
    }

    /// At least what a split of the references above a limit of area, in scaled units, from all others costs; infinite if there are none.
    ///
    /// A reference above it makes the box of its bin as large on each axis. Bins whose boxes are smaller have only others, and so all others have a box of at least
    /// the size of that around these bins.
    #[inline(always)]
    pub(super) fn least_cost_by_size<S: Simd>(
        &self,
        simd: S,
        bins: usize,
        scale: CentroidScale,
        limit: f32,
    ) -> f32 {
        let limit = Vec4::splat(limit);
        let (mut all, mut small) = (Sides::empty(simd), Sides::empty(simd));
        let mut exceeding = 0;
        for bin in 0..bins {
            let mut one = Sides::empty(simd);
            one.add(simd, self, bin);
            let exceeds = one.areas(simd, scale).cmpgt(limit) & one.is_used();
            exceeding |= exceeds.bitmask();
            all.add(simd, self, bin);
            small.add_unless(simd, self, bin, exceeds.bitmask());
        }
        if exceeding & 0b111 != 0b111 {
            return f32::INFINITY;
        }
        let small_area = Vec4::select(small.is_used(), small.areas(simd, scale), Vec4::ZERO);
        let others = all.counts() - small.counts();
        let least = small.counts() * small_area + others * small_area.min(limit);
        least.x.max(least.y).max(least.z)
    }

    /// The boxes around the bins before a bin and around the others.
    #[inline(always)]
    fn sides<S: Simd>(&self, simd: S, bins: usize, axis: usize, bin: usize) -> [Bounds; 2] {
        let (first, second) = self.bounds[axis][..bins].split_at(bin);
        let first = PairedBounds::around(simd, first);
        [first, PairedBounds::around(simd, second)].map(PairedBounds::to_bounds)
    }
}

/// The references on one side of a split on each axis.
struct Sides<S: Simd> {
    bounds: [S::F32s; 3],
    counts: [i32; 4],
}

impl<S: Simd> Sides<S> {
    #[inline(always)]
    fn empty(simd: S) -> Self {
        Self {
            bounds: [simd.splat(f32::INFINITY); 3],
            counts: [0; 4],
        }
    }

    #[inline(always)]
    fn add<const N: usize>(&mut self, simd: S, bins: &Bins<N>, bin: usize) {
        for (bounds, bins) in self.bounds.iter_mut().zip(&bins.bounds) {
            *bounds = simd.min(*bounds, bins[bin].lanes(simd));
        }
        for (count, other) in self.counts.iter_mut().zip(bins.counts[bin]) {
            *count += other;
        }
    }

    /// Adds a bin on those axes that a mask does not have.
    #[inline(always)]
    fn add_unless<const N: usize>(&mut self, simd: S, bins: &Bins<N>, bin: usize, mask: u32) {
        for axis in 0..3 {
            if mask >> axis & 1 == 0 {
                let lanes = bins.bounds[axis][bin].lanes(simd);
                self.bounds[axis] = simd.min(self.bounds[axis], lanes);
                self.counts[axis] += bins.counts[bin][axis];
            }
        }
    }

    #[inline(always)]
    fn costs(&self, simd: S, scale: CentroidScale) -> Vec4 {
        self.areas(simd, scale) * self.counts()
    }

    #[inline(always)]
    fn counts(&self) -> Vec4 {
        Vec4::from_array(self.counts.map(|count| count as f32))
    }

    /// On which axes there are any; the others have an infinite area.
    #[inline(always)]
    fn is_used(&self) -> BVec4A {
        self.counts().cmpgt(Vec4::ZERO)
    }

    /// Half of the surface areas of the boxes, in scaled units.
    #[inline(always)]
    fn areas(&self, simd: S, scale: CentroidScale) -> Vec4 {
        // The extents are negative, and products of two of them positive.
        let [x, y, z] = self.bounds;
        let [x, y, z] = [
            scale.negative_extent(simd, x),
            scale.negative_extent(simd, y),
            scale.negative_extent(simd, z),
        ];
        let extents = Mat4::from_cols(x, y, z, Vec4::ZERO).transpose();
        let [x, y, z] = [extents.x_axis, extents.y_axis, extents.z_axis];
        x * y + y * z + z * x
    }
}
