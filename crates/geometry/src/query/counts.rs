//! Counting what queries do.

use crate::predicate::Rung;

/// What queries did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct QueryCounts {
    /// Nodes visited, leaves included.
    pub node_visits: u64,
    /// Tests of the ray against a box or a splitting plane. Where a node has a vector of boxes, all its lanes count, used or not.
    pub bound_tests: u64,
    /// Tests of the ray against a triangle.
    pub triangle_tests: u64,
    /// Triangle tests at [`Precision::Exact`](crate::Precision::Exact) by the rung that settled them.
    pub rungs: RungCounts,
    /// Comparisons of hits whose rounded `t` are equal, at [`Precision::Exact`](crate::Precision::Exact), by the rung that settled
    /// them; without those of triangles that have the same vertices.
    pub orders: RungCounts,
}

/// How many decisions each rung of the ladder of [`Exact`](crate::kernel::Exact) made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RungCounts {
    /// Those that f32 made certain.
    pub f32: u64,
    /// Those that f64 made certain.
    pub f64: u64,
    /// Those that took exact arithmetic.
    pub exact: u64,
}

impl RungCounts {
    fn add(&mut self, rung: Rung, count: u64) {
        *match rung {
            Rung::F32 => &mut self.f32,
            Rung::F64 => &mut self.f64,
            Rung::Exact => &mut self.exact,
        } += count;
    }
}

impl std::ops::AddAssign for RungCounts {
    fn add_assign(&mut self, other: Self) {
        self.f32 += other.f32;
        self.f64 += other.f64;
        self.exact += other.exact;
    }
}

impl std::ops::AddAssign for QueryCounts {
    fn add_assign(&mut self, other: Self) {
        self.node_visits += other.node_visits;
        self.bound_tests += other.bound_tests;
        self.triangle_tests += other.triangle_tests;
        self.rungs += other.rungs;
        self.orders += other.orders;
    }
}

/// Receives the events of a traversal. The unit type ignores them at no cost.
pub trait TraversalCounter {
    /// A node was visited.
    fn node_visit(&mut self);
    /// The ray was tested against `count` boxes or planes.
    fn bound_tests(&mut self, count: u64);
    /// The ray was tested against `count` triangles.
    fn triangle_tests(&mut self, count: u64);
    /// `count` triangle tests were settled on a rung of the ladder.
    fn decisions(&mut self, rung: Rung, count: u64);
    /// The order of two hits with equal rounded `t` was settled on a rung of the ladder.
    fn order(&mut self, rung: Rung);
}

impl TraversalCounter for () {
    #[inline]
    fn node_visit(&mut self) {}
    #[inline]
    fn bound_tests(&mut self, _count: u64) {}
    #[inline]
    fn triangle_tests(&mut self, _count: u64) {}
    #[inline]
    fn decisions(&mut self, _rung: Rung, _count: u64) {}
    #[inline]
    fn order(&mut self, _rung: Rung) {}
}

impl TraversalCounter for QueryCounts {
    #[inline]
    fn node_visit(&mut self) {
        self.node_visits += 1;
    }
    #[inline]
    fn bound_tests(&mut self, count: u64) {
        self.bound_tests += count;
    }
    #[inline]
    fn triangle_tests(&mut self, count: u64) {
        self.triangle_tests += count;
    }
    #[inline]
    fn decisions(&mut self, rung: Rung, count: u64) {
        self.rungs.add(rung, count);
    }
    #[inline]
    fn order(&mut self, rung: Rung) {
        self.orders.add(rung, 1);
    }
}
