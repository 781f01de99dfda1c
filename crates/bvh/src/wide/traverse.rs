//! The traversal, nearest child first.
//!
//! **Why no hit is lost.** The box of a child contains, of each triangle listed below it, at least the part that it is responsible for, and these parts cover the
//! triangle. Boxes are exact or rounded outward. A child is culled only by a test that [`FusedRay`] proves to keep every hit in the box, up to the reach
//! of the kernel, whatever the signs of zeros, the place of the origin and the sizes of numbers. A child is skipped later only if it begins beyond
//! the best hit, rounded: at the same rounded `t` it may still hold a triangle that is nearer before rounding, or one with a smaller
//! number. So the answer is that of testing every triangle, at every level of instructions.

use std::mem::MaybeUninit;
use std::ops::ControlFlow;

use tahko_geometry::kernel::BlockFilter;
use tahko_geometry::simd::{LANES, Simd, WithSimd};
use tahko_geometry::{
    FusedRay, HitCollector, Precision, Ray, TraversalCounter, Traverse, TriangleKernel, test_block,
};

use super::stack::{Entry, LOCAL, Room, Stack};
use super::{Child, Kind, WideBvh, WideNode};
use crate::Bvh;

impl Traverse for Bvh {
    fn precision(&self) -> Precision {
        self.options().precision
    }

    #[inline]
    fn traverse<K: TriangleKernel, H: HitCollector, C: TraversalCounter>(
        &self,
        ray: &Ray,
        collector: &mut H,
        counter: &mut C,
    ) {
        if self.layout().root == Child::NOTHING {
            return;
        }
        let kernel = K::new(ray);
        self.simd().dispatch(Traversal {
            bvh: self.layout(),
            ray,
            kernel: &kernel,
            collector: &mut *collector,
            counter: &mut *counter,
        });
        collector.finish(&kernel, counter);
    }
}

struct Traversal<'a, K, H, C> {
    bvh: &'a WideBvh,
    ray: &'a Ray,
    kernel: &'a K,
    collector: &'a mut H,
    counter: &'a mut C,
}

/// What the boxes of nodes are tested with.
struct Slabs<S: Simd> {
    simd: S,
    reciprocal: [S::F32s; 3],
    near: [S::F32s; 3],
    far: [S::F32s; 3],
    negative: [bool; 3],
    t_min: S::F32s,
}

impl<S: Simd> Slabs<S> {
    #[inline(always)]
    fn new(simd: S, ray: &FusedRay, t_min: f32) -> Self {
        let splat = |vector: tahko_geometry::glam::Vec3| {
            vector.to_array().map(|component| simd.splat(component))
        };
        Self {
            simd,
            reciprocal: splat(ray.reciprocal),
            near: splat(ray.near),
            far: splat(ray.far),
            negative: ray.negative,
            // Entries are ordered as integers: no negative zero.
            t_min: simd.splat(t_min + 0.0),
        }
    }

    /// Where the ray enters the boxes, and a bit for each that it does not miss.
    #[inline(always)]
    fn clip(&self, node: &WideNode, t_max: S::F32s) -> (S::F32s, u32) {
        let simd = self.simd;
        let [near_x, near_y, near_z] = [0, 1, 2].map(|axis| {
            let plane = simd.load(&node.bounds[axis][usize::from(self.negative[axis])]);
            simd.mul_add(plane, self.reciprocal[axis], self.near[axis])
        });
        let [far_x, far_y, far_z] = [0, 1, 2].map(|axis| {
            let plane = simd.load(&node.bounds[axis][usize::from(!self.negative[axis])]);
            simd.mul_add(plane, self.reciprocal[axis], self.far[axis])
        });
        // What is NaN is dropped, or drops what it is compared with: the limits come last, and are numbers.
        let start = simd.max(simd.max(near_x, near_y), simd.max(near_z, self.t_min));
        let end = simd.min(simd.min(far_x, far_y), simd.min(far_z, t_max));
        (start, simd.bits(simd.le(start, end)))
    }
}

impl<K: TriangleKernel, H: HitCollector, C: TraversalCounter> WithSimd for Traversal<'_, K, H, C> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self {
            bvh,
            ray,
            kernel,
            collector,
            counter,
        } = self;
        let fused = FusedRay::new(ray, &bvh.bounds, K::REACH);
        let filter = K::Block::new(ray, fused.farthest);
        let slabs = Slabs::new(simd, &fused, ray.t_min);
        let mut local: Room = [MaybeUninit::uninit(); LOCAL];
        let mut more = Vec::new();
        let mut stack = Stack::new(if bvh.stack_size <= LOCAL {
            &mut local
        } else {
            more.resize(bvh.stack_size, MaybeUninit::uninit());
            &mut more
        });
        let mut t_max = simd.splat(collector.t_max());
        let mut current = bvh.root;
        loop {
            counter.node_visit();
            match current.kind() {
                Kind::Inner(index) => {
                    let node = &bvh.nodes[index];
                    counter.bound_tests(LANES as u64);
                    let (start, hits) = slabs.clip(node, t_max);
                    if let Some(nearest) =
                        nearest_child::<S, H>(simd, node, start, hits, &mut stack)
                    {
                        current = nearest;
                        continue;
                    }
                }
                Kind::Leaf(first) => {
                    let mut index = first;
                    loop {
                        let block = &bvh.blocks[index];
                        let tested = test_block(
                            simd,
                            (kernel, &filter),
                            block,
                            &mut *collector,
                            &mut *counter,
                        );
                        if let ControlFlow::Break(()) = tested {
                            return;
                        }
                        if !block.continues() {
                            break;
                        }
                        index += 1;
                    }
                    t_max = simd.splat(collector.t_max());
                }
            }
            loop {
                let Some(entry) = stack.pop() else {
                    return;
                };
                // Positive comparison: only what certainly begins beyond the best hit is skipped.
                if H::ORDERED && entry.start() > collector.t_max() {
                    continue;
                }
                current = entry.child();
                break;
            }
        }
    }
}

/// The child that the ray enters first; the others are pushed, the farthest one first.
#[inline(always)]
fn nearest_child<S: Simd, H: HitCollector>(
    simd: S,
    node: &WideNode,
    start: S::F32s,
    hits: u32,
    stack: &mut Stack<'_>,
) -> Option<Child> {
    if hits == 0 {
        return None;
    }
    let lane = |bits: u32| bits.trailing_zeros() as usize % LANES;
    let first = lane(hits);
    let rest = hits & (hits - 1);
    if rest == 0 {
        return Some(node.children[first]);
    }
    if !H::ORDERED {
        let mut rest = rest;
        while rest != 0 {
            stack.push(Entry::new(node.children[lane(rest)], 0.0));
            rest &= rest - 1;
        }
        return Some(node.children[first]);
    }
    let starts = simd.store(start).0;
    let second = lane(rest);
    let rest = rest & (rest - 1);
    let (near, far) = if starts[first] <= starts[second] {
        (first, second)
    } else {
        (second, first)
    };
    stack.push(Entry::new(node.children[far], starts[far]));
    if rest == 0 {
        return Some(node.children[near]);
    }
    stack.push(Entry::new(node.children[near], starts[near]));
    let mut count = 2;
    let mut rest = rest;
    while rest != 0 {
        let lane = lane(rest);
        stack.push(Entry::new(node.children[lane], starts[lane]));
        rest &= rest - 1;
        count += 1;
    }
    stack.sort_last(count);
    stack.pop().map(Entry::child)
}
