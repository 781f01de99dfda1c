//! The traversal, nearest child first.
//!
//! **Why no hit is lost.** The box of a child contains, of each triangle listed below it, at least the part that it is responsible for, and these parts cover the
//! triangle. Boxes are exact or rounded outward. A child is culled only by a test that [`FusedRay`] proves to keep every hit in the box, up to the reach
//! of the kernel, whatever the signs of zeros, the place of the origin and the sizes of numbers. A child is skipped later only if it begins beyond
//! the best hit, rounded: at the same rounded `t` it may still hold a triangle that is nearer before rounding, or one with a smaller
//! number. So the answer is that of testing every triangle, at every level of instructions.

use std::marker::PhantomData;
use std::mem::MaybeUninit;
use std::ops::ControlFlow;

use tahko_geometry::glam::Vec4;
use tahko_geometry::kernel::BlockFilter;
use tahko_geometry::simd::{LANES, Simd, WithSimd};
use tahko_geometry::{
    FusedRay, FusedSlabs, HitCollector, Precision, Ray, TraversalCounter, Traverse, TriangleBlock,
    TriangleKernel, test_block,
};

use super::stack::{Entry, LOCAL, Room, Stack};
use super::{Child, Kind, WideBvh, WideNode};
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
        self.simd().dispatch(Traversal::<K, H, C> {
            bvh: self.layout(),
            ray,
            kernel: PhantomData,
            collector,
            counter,
        });
    }

    #[inline]
    fn answer<K: TriangleKernel, H: HitCollector, C: TraversalCounter>(
        &self,
        ray: &Ray,
        collector: &mut H,
        counter: &mut C,
    ) -> H::Answer {
        self.simd().dispatch(Search::<K, H, C> {
            bvh: self.layout(),
            ray,
            kernel: PhantomData,
            collector,
            counter,
        })
    }
}

/// A traversal and the answer, both with the instructions of the level.
struct Search<'a, K, H, C> {
    bvh: &'a WideBvh,
    ray: &'a Ray,
    kernel: PhantomData<K>,
    collector: &'a mut H,
    counter: &'a mut C,
}

impl<K: TriangleKernel, H: HitCollector, C: TraversalCounter> WithSimd for Search<'_, K, H, C> {
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

struct Traversal<'a, K, H, C> {
    bvh: &'a WideBvh,
    ray: &'a Ray,
    kernel: PhantomData<K>,
    collector: &'a mut H,
    counter: &'a mut C,
}

/// What the boxes of nodes are tested with.
struct Slabs<S: Simd> {
    simd: S,
    near: Planes<S>,
    far: Planes<S>,
    negative: [bool; 3],
    t_min: S::F32s,
}

/// What near planes, or far planes, are tested with.
struct Planes<S: Simd> {
    reciprocal: [S::F32s; 3],
    offset: [S::F32s; 3],
}

impl<S: Simd> Planes<S> {
    #[inline(always)]
    fn new(simd: S, slabs: &FusedSlabs) -> Self {
        Self {
            reciprocal: splat(simd, slabs.reciprocal),
            offset: splat(simd, slabs.offset),
        }
    }
}

impl<S: Simd> Slabs<S> {
    #[inline(always)]
    fn new(simd: S, ray: &FusedRay, t_min: f32) -> Self {
        Self {
            simd,
            near: Planes::new(simd, &ray.near),
            far: Planes::new(simd, &ray.far),
            negative: [1, 2, 4].map(|bit| ray.negative & bit != 0),
            // Entries are ordered as integers: no negative zero.
            t_min: simd.splat(t_min + 0.0),
        }
    }

    /// Where the ray enters the boxes, and a bit for each that it does not miss.
    #[inline(always)]
    fn clip(&self, node: &WideNode, t_max: S::F32s) -> (S::F32s, u32) {
        let simd = self.simd;
        let (near_x, far_x) = self.planes(node, 0);
        let (near_y, far_y) = self.planes(node, 1);
        let (near_z, far_z) = self.planes(node, 2);
        // What is NaN is dropped, or drops what it is compared with: the limits come last, and are numbers.
        let start = simd.max(simd.max(near_x, near_y), simd.max(near_z, self.t_min));
        let end = simd.min(simd.min(far_x, far_y), simd.min(far_z, t_max));
        (start, simd.bits(simd.le(start, end)))
    }

    /// Where the ray meets the planes across an axis: those that it meets first, and the others.
    #[inline(always)]
    fn planes(&self, node: &WideNode, axis: usize) -> (S::F32s, S::F32s) {
        let is_negative = self.negative[axis];
        let near = self.simd.load(&node.bounds[axis][usize::from(is_negative)]);
        let far = self
            .simd
            .load(&node.bounds[axis][usize::from(!is_negative)]);
        let t = |planes: &Planes<S>, places: S::F32s| {
            self.simd
                .mul_add(places, planes.reciprocal[axis], planes.offset[axis])
        };
        (t(&self.near, near), t(&self.far, far))
    }
}

#[inline(always)]
fn splat<S: Simd>(simd: S, vector: Vec4) -> [S::F32s; 3] {
    [
        simd.splat(vector.x),
        simd.splat(vector.y),
        simd.splat(vector.z),
    ]
}

impl<K: TriangleKernel, H: HitCollector, C: TraversalCounter> WithSimd for Traversal<'_, K, H, C> {
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
        let slabs = Slabs::new(simd, &fused, ray.t_min);
        let mut local: Room = [MaybeUninit::uninit(); LOCAL];
        let mut more = Vec::new();
        let mut stack = Stack::new(if bvh.stack_size <= LOCAL {
            &mut local
        } else {
            more.resize(bvh.stack_size, MaybeUninit::uninit());
            &mut more
        });
        let mut t_max = collector.t_max();
        let mut current = bvh.root;
        loop {
            // Nodes have a loop of their own, without calls: what they are tested with stays in registers.
            let limit = simd.splat(t_max);
            let first_block = loop {
                counter.node_visit();
                let index = match current.kind() {
                    Kind::Inner(index) => index,
                    Kind::Leaf(first_block) => break first_block,
                };
                let node = &bvh.nodes[index];
                counter.bound_tests(LANES as u64);
                let (start, hits) = slabs.clip(node, limit);
                let nearest = if hits == 0 {
                    stack.pop_before::<H>(t_max)
                } else {
                    Some(nearest_child::<S, H>(simd, node, start, hits, &mut stack))
                };
                match nearest {
                    Some(child) => current = child,
                    None => return,
                }
            };
            let leaf = Leaf::<K, H, C> {
                blocks: &bvh.blocks[first_block..],
                ray,
                filter: &filter,
                collector: &mut *collector,
                counter: &mut *counter,
            };
            if simd.outline(leaf).is_break() {
                return;
            }
            t_max = collector.t_max();
            match stack.pop_before::<H>(t_max) {
                Some(child) => current = child,
                None => return,
            }
        }
    }
}

/// The test of a leaf, which the first of the blocks begins.
struct Leaf<'a, K: TriangleKernel, H, C> {
    blocks: &'a [TriangleBlock],
    ray: &'a Ray,
    filter: &'a K::Block,
    collector: &'a mut H,
    counter: &'a mut C,
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

/// Of at least one child that the ray hits, the one that it enters first; the others are pushed, the farthest one first.
#[inline(always)]
fn nearest_child<S: Simd, H: HitCollector>(
    simd: S,
    node: &WideNode,
    start: S::F32s,
    hits: u32,
    stack: &mut Stack<'_>,
) -> Child {
    let lane = |bits: u32| bits.trailing_zeros() as usize % LANES;
    let first = lane(hits);
    let rest = hits & (hits - 1);
    if rest == 0 {
        return node.children[first];
    }
    if !H::ORDERED {
        let mut rest = rest;
        while rest != 0 {
            stack.push(Entry::new(node.children[lane(rest)], 0.0));
            rest &= rest - 1;
        }
        return node.children[first];
    }
    let starts = simd.store(start).0;
    let entry = |lane: usize| Entry::new(node.children[lane], starts[lane]);
    let a = entry(first);
    let b = entry(lane(rest));
    let rest = rest & (rest - 1);
    if rest == 0 {
        let [near, far] = sorted(a, b);
        stack.push(far);
        return near.child();
    }
    let c = entry(lane(rest));
    let rest = rest & (rest - 1);
    if rest == 0 {
        let [a, b] = sorted(a, b);
        let [b, c] = sorted(b, c);
        let [a, b] = sorted(a, b);
        stack.push(c);
        stack.push(b);
        return a.child();
    }
    let d = entry(lane(rest));
    let rest = rest & (rest - 1);
    if rest == 0 {
        let ([a, b], [c, d]) = (sorted(a, b), sorted(c, d));
        let ([a, c], [b, d]) = (sorted(a, c), sorted(b, d));
        let [b, c] = sorted(b, c);
        stack.push(d);
        stack.push(c);
        stack.push(b);
        return a.child();
    }
    for entry in [a, b, c, d] {
        stack.push(entry);
    }
    let mut count = 4;
    let mut rest = rest;
    while rest != 0 {
        stack.push(entry(lane(rest)));
        rest &= rest - 1;
        count += 1;
    }
    stack.sort_last(count);
    stack.pop().map_or(Child::NOTHING, Entry::child)
}

/// Two entries in order, without a branch.
#[inline(always)]
fn sorted(a: Entry, b: Entry) -> [Entry; 2] {
    if b < a { [b, a] } else { [a, b] }
}
