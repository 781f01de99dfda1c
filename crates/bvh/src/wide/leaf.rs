//! The test of a ray against the triangles of a leaf.

use std::marker::PhantomData;
use std::ops::ControlFlow;

use tahko_geometry::kernel::BlockTest;
use tahko_geometry::predicate::Rung;
use tahko_geometry::simd::{Simd, WithSimd};
use tahko_geometry::{
    Candidates, HitCollector, Ray, TraversalCounter, TriangleBlock, TriangleKernel, test_block,
    test_candidates, test_possible,
};

/// The test of a leaf, which the first of the blocks begins.
pub(super) struct Leaf<'a, K: TriangleKernel, H, C> {
    pub(super) blocks: &'a [TriangleBlock],
    pub(super) ray: &'a Ray,
    pub(super) filter: &'a K::Block,
    pub(super) collector: &'a mut H,
    pub(super) counter: &'a mut C,
}

impl<K: TriangleKernel, H: HitCollector, C: TraversalCounter> WithSimd for Leaf<'_, K, H, C> {
    type Output = ControlFlow<()>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> ControlFlow<()> {
        for block in self.blocks {
            let kernels = (self.ray, self.filter);
            test_block::<S, K, H, C>(
                simd,
                kernels,
                block,
                &mut *self.collector,
                &mut *self.counter,
            )?;
            if !block.continues() {
                break;
            }
        }
        ControlFlow::Continue(())
    }
}

impl<K: TriangleKernel, H: HitCollector, C: TraversalCounter> Leaf<'_, K, H, C> {
    /// The test as a step of a search. Rays that look for any hit mostly start on a surface, so that their first leaf looks like a hit and is none: its blocks are filtered here, without a branch
    /// on that. Others have the whole leaf tested in a function of its own.
    #[inline(always)]
    pub(super) fn search<S: Simd>(self, simd: S) -> ControlFlow<()> {
        if H::ORDERED {
            return simd.outline(self);
        }
        for block in self.blocks {
            let possible = self.filter.possible(simd, block, self.collector.t_max());
            let used = block.used();
            self.counter.triangle_tests(u64::from(used.count_ones()));
            let excluded = (used & !possible).count_ones();
            self.counter.decisions(Rung::F32, u64::from(excluded));
            if possible != 0 {
                simd.outline(Left::<K, H, C> {
                    block,
                    possible,
                    ray: self.ray,
                    filter: self.filter,
                    collector: &mut *self.collector,
                    counter: &mut *self.counter,
                })?;
            }
            if !block.continues() {
                break;
            }
        }
        ControlFlow::Continue(())
    }
}

/// The test of the triangles of a block that may be hit, in search of the closest hit.
pub(super) struct Nearer<'a, K, H, C> {
    pub(super) block: &'a TriangleBlock,
    /// There is at least one.
    pub(super) candidates: Candidates,
    pub(super) ray: &'a Ray,
    pub(super) kernel: PhantomData<K>,
    pub(super) collector: &'a mut H,
    pub(super) counter: &'a mut C,
}

impl<K: TriangleKernel, H: HitCollector, C: TraversalCounter> WithSimd for Nearer<'_, K, H, C> {
    type Output = ControlFlow<()>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> ControlFlow<()> {
        test_candidates::<S, K, H, C>(
            simd,
            self.ray,
            self.block,
            self.candidates,
            self.collector,
            self.counter,
        )
    }
}

/// The test of what the filter leaves of a block.
pub(super) struct Left<'a, K: TriangleKernel, H, C> {
    pub(super) block: &'a TriangleBlock,
    /// A bit for each triangle that is left, of which there is at least one.
    pub(super) possible: u32,
    pub(super) ray: &'a Ray,
    pub(super) filter: &'a K::Block,
    pub(super) collector: &'a mut H,
    pub(super) counter: &'a mut C,
}

impl<K: TriangleKernel, H: HitCollector, C: TraversalCounter> WithSimd for Left<'_, K, H, C> {
    type Output = ControlFlow<()>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> ControlFlow<()> {
        let (kernels, triangles) = ((self.ray, self.filter), (self.block, self.possible));
        test_possible::<S, K, H, C>(simd, kernels, triangles, self.collector, self.counter)
    }
}
