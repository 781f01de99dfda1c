//! The traversal, nearer child first.
//!
//! **Why no hit is lost.** A node's box is the union of its triangles' boxes, which are exact: minima and maxima of f32 coordinates. A node is
//! culled by [`ConservativeRay::clip`] only, whose interval contains the `t`, rounded, of every hit that a kernel accepts in the box, whatever
//! the signs of zeros, the place of the origin and the sizes of numbers (its module has the bounds). Boxes without thickness, and rays
//! in their faces, have an interval of their own as others do. A node is skipped later only if it begins beyond the best hit, rounded: at the
//! same rounded `t` it may still hold a triangle that is nearer before rounding, or one with a smaller number. So the
//! answer is that of testing every triangle.

use tahko_geometry::{
    ConservativeRay, HitCollector, Interval, Precision, Ray, TraversalCounter, Traverse,
    TriangleKernel, test_triangle,
};

use crate::Bvh;
use crate::build::MAX_DEPTH;
use crate::layout::Bvh2;
use crate::node::{Node, Siblings};

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
        self.layout().traverse::<K, H, C>(ray, collector, counter);
    }
}

/// A node that waits while its nearer sibling is visited.
#[derive(Clone, Copy)]
struct Waiting<'a> {
    node: &'a Node,
    /// Where the ray enters it, or before.
    start: f32,
}

impl Bvh2 {
    fn traverse<K: TriangleKernel, H: HitCollector, C: TraversalCounter>(
        &self,
        ray: &Ray,
        collector: &mut H,
        counter: &mut C,
    ) {
        let Some(root) = &self.root else {
            return;
        };
        let kernel = K::new(ray);
        let conservative = ConservativeRay::new(ray, &root.bounds(), K::REACH);
        let clip = |node: &Node, t_max: f32| {
            let interval = Interval {
                start: ray.t_min,
                end: t_max,
            };
            let clipped = conservative.clip(&node.bounds(), interval);
            clipped.map(|interval| interval.start)
        };
        counter.bound_tests(1);
        if clip(root, collector.t_max()).is_none() {
            return;
        }
        // Each node on the way down leaves at most one sibling behind, so the stack cannot overflow.
        let mut stack = [Waiting {
            node: root,
            start: 0.0,
        }; MAX_DEPTH];
        let mut waiting = 0;
        let mut node = root;
        loop {
            counter.node_visit();
            if node.is_leaf() {
                let triangles = &self.triangles[node.first()..][..node.count()];
                for leaf in triangles {
                    let (triangle, number) = (&leaf.triangle, leaf.number);
                    if test_triangle(&kernel, triangle, number, collector, counter).is_break() {
                        return;
                    }
                }
            } else {
                let Siblings([first, second]) = &self.siblings[node.first()];
                counter.bound_tests(2);
                let t_max = collector.t_max();
                match (clip(first, t_max), clip(second, t_max)) {
                    (Some(first_start), Some(second_start)) => {
                        let (near, far, start) = if first_start <= second_start {
                            (first, second, second_start)
                        } else {
                            (second, first, first_start)
                        };
                        stack[waiting] = Waiting { node: far, start };
                        waiting += 1;
                        node = near;
                        continue;
                    }
                    (Some(_), None) => {
                        node = first;
                        continue;
                    }
                    (None, Some(_)) => {
                        node = second;
                        continue;
                    }
                    (None, None) => {}
                }
            }
            loop {
                if waiting == 0 {
                    return;
                }
                waiting -= 1;
                let next = stack[waiting];
                // Positive comparison: only what certainly begins beyond the best hit is skipped.
                if next.start > collector.t_max() {
                    continue;
                }
                node = next.node;
                break;
            }
        }
    }
}
