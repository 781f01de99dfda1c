//! The traversal, nearest child first.
//!
//! **Why no hit is lost.** The box of a child contains, of each triangle listed below it, at least the part that it is responsible for, and these parts cover the
//! triangle. Boxes are exact or rounded outward. A child is culled only by a test that [`FusedRay`] proves to keep every hit in the box, up to the reach
//! of the kernel, whatever the signs of zeros, the place of the origin and the sizes of numbers. A child is skipped later only if it begins beyond
//! the best hit, rounded: at the same rounded `t` it may still hold a triangle that is nearer before rounding, or one with a smaller
//! number. So the answer is that of testing every triangle, at every level of instructions.

use std::hint::black_box;
use std::marker::PhantomData;
use std::ops::ControlFlow;

use tahko_geometry::kernel::BlockFilter;
use tahko_geometry::simd::{LANES, Simd, WithSimd};
use tahko_geometry::{
    FusedRay, HitCollector, Precision, Ray, TraversalCounter, Traverse, TriangleKernel,
};

use super::access::{Source, View, with_source};
use super::batch::Batch;
use super::leaf::Leaf;
use super::node::Node;
use super::order::nearest_child;
use super::plane_order::PlaneOrder;
use super::slabs::Slabs;
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
        with_source!(self.layout(), source => self.simd().dispatch(Traversal::<K, H, C, _> {
            source,
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
        with_source!(self.layout(), source => self.simd().dispatch(Search(Traversal::<K, H, C, _> {
            source,
            ray,
            kernel: PhantomData,
            collector,
            counter,
        })))
    }

    fn answers<K: TriangleKernel, H: HitCollector>(&self, rays: &[Ray], answers: &mut [H::Answer]) {
        with_source!(self.layout(), source => {
            let batch = Batch::<K, H, _> {
                bvh: source.view(),
                rays,
                answers,
                kernel: PhantomData,
            };
            batch.run(self.simd());
        });
    }
}

/// A traversal of a layout.
struct Traversal<'a, K, H, C, N> {
    source: Source<'a, N>,
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
        let view = self.source.view();
        search::<S, K, H, C, N>(simd, view, self.ray, self.collector, self.counter);
    }
}

/// A traversal and the answer, both with the instructions of the level.
struct Search<'a, K, H, C, N>(Traversal<'a, K, H, C, N>);

impl<K: TriangleKernel, H: HitCollector, C: TraversalCounter, N: Node> WithSimd
    for Search<'_, K, H, C, N>
{
    type Output = H::Answer;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> H::Answer {
        let Self(Traversal {
            source,
            ray,
            collector,
            counter,
            ..
        }) = self;
        search::<S, K, H, C, N>(simd, source.view(), ray, collector, counter);
        collector.finish::<S, K, C>(simd, ray, counter)
    }
}

/// Offers the triangles that a valid ray may hit to a collector.
#[inline(always)]
pub(super) fn search<S: Simd, K: TriangleKernel, H: HitCollector, C: TraversalCounter, N: Node>(
    simd: S,
    bvh: View<'_, N>,
    ray: &Ray,
    collector: &mut H,
    counter: &mut C,
) {
    if bvh.root == Child::NOTHING {
        return;
    }
    let fused = FusedRay::new(ray, bvh.size, K::REACH);
    let filter = K::Block::new(ray, &fused);
    let way = Way::<K, H, C, N> {
        bvh,
        ray,
        fused: &fused,
        filter: &filter,
        collector,
        counter,
    };
    let (ControlFlow::Break(()) | ControlFlow::Continue(())) = way.search(simd, bvh.root);
}

/// A ray's way through a subtree.
pub(super) struct Way<'a, K: TriangleKernel, H, C, N> {
    pub(super) bvh: View<'a, N>,
    pub(super) ray: &'a Ray,
    pub(super) fused: &'a FusedRay,
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
            fused,
            filter,
            collector,
            counter,
        } = self;
        let mut room = Stack::room();
        let mut stack = Stack::new(&mut room);
        let mut t_max = collector.t_max();
        let mut current = below;
        loop {
            // Nodes have a loop of their own, without calls: what they are tested with stays in registers. It is read anew after a leaf. Without the box
            // the compiler would know the registers' contents from before and save them around the call, which is as much to read, and as much again to write.
            let limit = simd.splat(t_max);
            let fused = black_box(fused);
            let order = PlaneOrder::new(fused.negative);
            let slabs = Slabs::new(simd, fused, &order);
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
                    Some(nearest_child::<S, H, N, _>(
                        bvh,
                        simd,
                        node,
                        || simd.store(start),
                        hits,
                        &mut stack,
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
            leaf.search(simd)?;
            t_max = collector.t_max();
            match stack.pop_before::<H>(t_max) {
                Some(child) => current = child,
                None => return ControlFlow::Continue(()),
            }
        }
    }
}
