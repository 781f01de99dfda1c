//! The traversal, nearest child first.
//!
//! **Why no hit is lost.** The box of a child contains, of each triangle listed below it, at least the part that it is responsible for, and these parts cover the
//! triangle. Boxes are exact or rounded outward. A child is culled only by a test that [`FusedRay`] proves to keep every hit in the box, up to the reach
//! of the kernel, whatever the signs of zeros, the place of the origin and the sizes of numbers. A child is skipped later only if it begins beyond
//! the best hit, rounded: at the same rounded `t` it may still hold a triangle that is nearer before rounding, or one with a smaller
//! number. So the answer is that of testing every triangle, at every level of instructions.

use std::marker::PhantomData;
use std::ops::ControlFlow;

use tahko_geometry::kernel::BlockFilter;
use tahko_geometry::simd::{LANES, Simd, WithSimd};
use tahko_geometry::{
    FusedRay, HitCollector, Precision, Ray, TraversalCounter, Traverse, TriangleKernel,
};

use super::access::{View, with_view};
use super::batch::Batch;
use super::leaf::Leaf;
use super::node::Node;
use super::order::nearest_child;
use super::slabs::{SlabConstants, Slabs};
use super::stack::Stack;
use super::{Child, Kind};
use crate::Bvh;

impl Traverse for Bvh {
    fn precision(&self) -> Precision {
        self.options().precision
    }

    fn traverse<K: TriangleKernel, H: HitCollector, C: TraversalCounter>(
        &self,
        ray: &Ray,
        collector: &mut H,
        counter: &mut C,
    ) {
        with_view!(self.layout(), bvh => self.simd().dispatch(Traversal::<K, H, C, _> {
            bvh,
            ray,
            kernel: PhantomData,
            collector,
            counter,
        }));
    }

    #[inline]
    fn answer<K: TriangleKernel, H: HitCollector, C: TraversalCounter>(
        &self,
        ray: &Ray,
        collector: &mut H,
        counter: &mut C,
    ) -> H::Answer {
        with_view!(self.layout(), bvh => self.simd().dispatch(Search::<K, H, C, _> {
            bvh,
            ray,
            kernel: PhantomData,
            collector,
            counter,
        }))
    }

    fn answers<K: TriangleKernel, H: HitCollector>(&self, rays: &[Ray], answers: &mut [H::Answer]) {
        with_view!(self.layout(), bvh => self.simd().dispatch(Batch::<K, H, _> {
            bvh,
            rays,
            answers,
            kernel: PhantomData,
        }));
    }
}

/// A traversal and the answer, both with the instructions of the level.
pub(super) struct Search<'a, K, H, C, N> {
    pub(super) bvh: View<'a, N>,
    pub(super) ray: &'a Ray,
    pub(super) kernel: PhantomData<K>,
    pub(super) collector: &'a mut H,
    pub(super) counter: &'a mut C,
}

impl<K: TriangleKernel, H: HitCollector, C: TraversalCounter, N: Node> WithSimd
    for Search<'_, K, H, C, N>
{
    type Output = H::Answer;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> H::Answer {
        let traversal = Traversal {
            bvh: self.bvh,
            ray: self.ray,
            kernel: self.kernel,
            collector: &mut *self.collector,
            counter: &mut *self.counter,
        };
        traversal.with_simd(simd);
        self.collector.finish::<K, C>(self.ray, self.counter)
    }
}

struct Traversal<'a, K, H, C, N> {
    bvh: View<'a, N>,
    ray: &'a Ray,
    kernel: PhantomData<K>,
    collector: &'a mut H,
    counter: &'a mut C,
}

impl<K: TriangleKernel, H: HitCollector, C: TraversalCounter, N: Node> WithSimd
    for Traversal<'_, K, H, C, N>
{
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self {
            bvh,
            ray,
            collector,
            counter,
            ..
        } = self;
        if bvh.root == Child::NOTHING {
            return;
        }
        let fused = FusedRay::new(ray, bvh.size, K::REACH);
        let filter = K::Block::new(ray, &fused);
        let way = Way::<K, H, C, N> {
            bvh,
            ray,
            slabs: &SlabConstants::new(&fused, ray.t_min),
            filter: &filter,
            collector,
            counter,
        };
        let (ControlFlow::Break(()) | ControlFlow::Continue(())) = way.search(simd, bvh.root);
    }
}

/// A ray's way through a subtree.
pub(super) struct Way<'a, K: TriangleKernel, H, C, N> {
    pub(super) bvh: View<'a, N>,
    pub(super) ray: &'a Ray,
    pub(super) slabs: &'a SlabConstants,
    pub(super) filter: &'a K::Block,
    pub(super) collector: &'a mut H,
    pub(super) counter: &'a mut C,
}

impl<K: TriangleKernel, H: HitCollector, C: TraversalCounter, N: Node> Way<'_, K, H, C, N> {
    /// Searches what is below a child. `Break` if the search is over.
    #[inline(always)]
    pub(super) fn search<S: Simd>(self, simd: S, below: Child) -> ControlFlow<()> {
        let Self {
            bvh,
            ray,
            slabs,
            filter,
            collector,
            counter,
        } = self;
        let slabs = Slabs::new(simd, slabs);
        let mut room = Stack::room();
        let mut stack = Stack::new(&mut room);
        let mut t_max = collector.t_max();
        let mut current = below;
        loop {
            // Nodes have a loop of their own, without calls: what they are tested with stays in registers.
            let limit = simd.splat(t_max);
            let first_block = loop {
                counter.node_visit();
                let index = match current.kind() {
                    Kind::Inner(index) => index,
                    Kind::Leaf(first_block) => break first_block,
                };
                let node = bvh.node(index);
                counter.bound_tests(LANES as u64);
                let (start, hits) = slabs.clip(node, limit);
                let hits = simd.bits(hits);
                let nearest = if hits == 0 {
                    stack.pop_before::<H>(t_max)
                } else {
                    Some(nearest_child::<S, H, N>(
                        bvh, simd, node, start, hits, &mut stack,
                    ))
                };
                match nearest {
                    Some(child) => current = child,
                    None => return ControlFlow::Continue(()),
                }
            };
            let leaf = Leaf::<K, H, C> {
                blocks: bvh.blocks_from(first_block),
                ray,
                filter,
                collector: &mut *collector,
                counter: &mut *counter,
            };
            simd.outline(leaf)?;
            t_max = collector.t_max();
            match stack.pop_before::<H>(t_max) {
                Some(child) => current = child,
                None => return ControlFlow::Continue(()),
            }
        }
    }
}
