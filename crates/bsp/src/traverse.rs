//! The traversal, from the ray's start to its end.
//!
//! At each node the ray's interval is divided where it [crosses](crate::crossing) the plane: the side that it comes
//! from, then what lies in the plane, then the other side. The parts overlap by the crossing's width. What begins
//! beyond the best hit is skipped; at the same `t` it may still hold a triangle with a smaller number. A hit that lies
//! outside the cell in which its triangle was found counts, so the order decides the cost alone.

use std::ops::ControlFlow;

use tahko_geometry::{
    ConservativeRay, HitCollector, Interval, Precision, Ray, TraversalCounter, Traverse,
    TriangleKernel, test_triangle,
};

use crate::BspTree;
use crate::crossing::PlaneCrosser;
use crate::node::{Child, IN_PLANE, Link, List};
use crate::stack::Stack;

impl Traverse for BspTree {
    fn precision(&self) -> Precision {
        self.options().precision
    }

    fn traverse<K: TriangleKernel, H: HitCollector, C: TraversalCounter>(
        &self,
        ray: &Ray,
        collector: &mut H,
        counter: &mut C,
    ) {
        let bounds = self.bounds();
        let conservative = ConservativeRay::new(ray, &bounds, K::REACH);
        let interval = Interval {
            start: ray.t_min,
            end: collector.t_max(),
        };
        counter.bound_tests(1);
        let Some(interval) = conservative.clip(&bounds, interval) else {
            return;
        };
        let query = Query {
            tree: self,
            kernel: K::new(ray),
            crosser: PlaneCrosser::new(ray, &conservative, self.depth(), &bounds),
        };
        // Broken off or at its end: the collector has the answer.
        let (ControlFlow::Break(()) | ControlFlow::Continue(())) =
            query.run(interval, collector, counter);
    }
}

struct Query<'a, K> {
    tree: &'a BspTree,
    kernel: K,
    crosser: PlaneCrosser,
}

/// A child that waits while what is nearer is visited, and the ray's interval in it.
#[derive(Clone, Copy, Debug)]
struct Waiting {
    child: Child,
    start: f32,
    end: f32,
}

impl Waiting {
    const NONE: Self = Self {
        child: Child::EMPTY,
        start: 0.0,
        end: 0.0,
    };
}

impl<K: TriangleKernel> Query<'_, K> {
    fn run<H: HitCollector, C: TraversalCounter>(
        &self,
        interval: Interval,
        collector: &mut H,
        counter: &mut C,
    ) -> ControlFlow<()> {
        let mut stack = Stack::new(Waiting::NONE);
        let mut child = self.tree.root;
        let Interval { mut start, mut end } = interval;
        loop {
            match child.link() {
                Link::Inner(index) => {
                    counter.node_visit();
                    counter.bound_tests(1);
                    let node = &self.tree.nodes[index];
                    let crossing = self.crosser.cross(&node.plane);
                    let near = node.children[crossing.near];
                    let far = node.children[1 - crossing.near];
                    if crossing.start > end {
                        child = near;
                        continue;
                    }
                    if crossing.end < start {
                        child = far;
                        continue;
                    }
                    // Minimum and maximum are the other operand where the crossing is NaN.
                    let far_start = start.max(crossing.start);
                    let near_end = end.min(crossing.end);
                    let in_plane = node.children[IN_PLANE];
                    for (child, start, end) in
                        [(far, far_start, end), (in_plane, far_start, near_end)]
                    {
                        if child != Child::EMPTY {
                            stack.push(Waiting { child, start, end });
                        }
                    }
                    child = near;
                    end = near_end;
                    continue;
                }
                Link::Leaf(index) => {
                    counter.node_visit();
                    self.test(self.tree.leaves[index], collector, counter)?;
                }
                Link::Empty => {}
            }
            child = Child::EMPTY;
            while child == Child::EMPTY {
                let Some(waiting) = stack.pop() else {
                    return ControlFlow::Continue(());
                };
                if waiting.start <= collector.t_max() {
                    child = waiting.child;
                    start = waiting.start;
                    end = waiting.end.min(collector.t_max());
                }
            }
        }
    }

    /// Tests the triangles of a list.
    #[inline]
    fn test<H: HitCollector, C: TraversalCounter>(
        &self,
        list: List,
        collector: &mut H,
        counter: &mut C,
    ) -> ControlFlow<()> {
        for reference in &self.tree.references[list.range()] {
            let listed = &self.tree.triangles[*reference as usize];
            test_triangle(
                &self.kernel,
                &listed.triangle,
                listed.number,
                collector,
                counter,
            )?;
        }
        ControlFlow::Continue(())
    }
}
