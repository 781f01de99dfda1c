//! Counting what queries do.

use crate::predicate::Rung;

/// What queries did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct QueryCounts {
    /// Nodes visited, leaves included.
    pub node_visits: u64,
    /// Tests of the ray against a box or a splitting plane.
    pub bound_tests: u64,
    /// Tests of the ray against a triangle.
    pub triangle_tests: u64,
    /// Triangle tests at [`Precision::Exact`](crate::Precision::Exact) by the rung that settled them.
    pub rungs: RungCounts,
}

/// How many triangle tests each rung of the ladder of [`Exact`](crate::kernel::Exact) settled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RungCounts {
    /// Certain misses in f32.
    pub f32: u64,
    /// Hits and misses that f64 made certain.
    pub f64: u64,
    /// Hits and misses that took expansion arithmetic.
    pub exact: u64,
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
    }
}

/// Receives the events of a traversal. The unit type ignores them at no cost.
pub trait TraversalCounter {
    /// A node was visited.
    fn node_visit(&mut self);
    /// The ray was tested against `count` boxes or planes.
    fn bound_tests(&mut self, count: u64);
    /// The ray was tested against a triangle.
    fn triangle_test(&mut self);
    /// A triangle test was settled on a rung of the ladder.
    fn decision(&mut self, rung: Rung);
}

impl TraversalCounter for () {
    #[inline]
    fn node_visit(&mut self) {}
    #[inline]
    fn bound_tests(&mut self, _count: u64) {}
    #[inline]
    fn triangle_test(&mut self) {}
    #[inline]
    fn decision(&mut self, _rung: Rung) {}
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
    fn triangle_test(&mut self) {
        self.triangle_tests += 1;
    }
    #[inline]
    fn decision(&mut self, rung: Rung) {
        let count = match rung {
            Rung::F32 => &mut self.rungs.f32,
            Rung::F64 => &mut self.rungs.f64,
            Rung::Exact => &mut self.rungs.exact,
        };
        *count += 1;
    }
}
