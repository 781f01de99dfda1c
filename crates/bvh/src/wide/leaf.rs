//! The test of a ray against the triangles of a leaf.

use std::ops::ControlFlow;

use tahko_geometry::simd::{Simd, WithSimd};
use tahko_geometry::{
    HitCollector, Ray, TraversalCounter, TriangleBlock, TriangleKernel, test_block,
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
