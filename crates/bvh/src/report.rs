//! What a build took and what came of it.

use std::time::Instant;

use crate::Bvh;

/// What a build took and what came of it, from [`Bvh::build_with`].
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct BuildReport {
    /// The phases in their order, with the seconds that each took.
    pub phases: Vec<(BuildPhase, f64)>,
    /// The tree's expected cost for a random ray, as in [`Bvh::statistics`]. What it leaves out, [`Bvh::end_point_overlap`], is not computed unasked: that takes
    /// three to eight times as long as a build on the meshes that were measured.
    pub sah_cost: f64,
    /// How often a triangle is listed, on average; 0 for none.
    pub references_per_triangle: f64,
    /// Bytes of the finished tree per triangle; 0 for none.
    pub bytes_per_triangle: f64,
    /// The most bytes that the build was [estimated](crate::BvhOptions::build_memory) to hold at a time, with the [pieces](crate::BvhOptions::presplit_budget) that it made.
    pub estimated_memory: u64,
}

/// A phase of a build.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum BuildPhase {
    /// The boxes of the triangles; for [`Clusters`](crate::BuildMethod::Clusters) also their order along the curve.
    References,
    /// The binary tree.
    Tree,
    /// Moving subtrees of it to cheaper places.
    Reinsertion,
    /// The nodes and triangles as queries read them.
    Layout,
}

impl BuildReport {
    /// The seconds of all phases.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.phases.iter().map(|(_, seconds)| seconds).sum()
    }

    pub(crate) fn new(bvh: &Bvh, stopwatch: Stopwatch, estimated_memory: u64) -> Self {
        let statistics = bvh.statistics();
        let per_triangle = |count: usize| count as f64 / statistics.primitives.max(1) as f64;
        Self {
            phases: stopwatch.phases,
            sah_cost: statistics.sah_cost,
            references_per_triangle: per_triangle(statistics.references),
            bytes_per_triangle: per_triangle(statistics.bytes),
            estimated_memory,
        }
    }
}

/// Takes the times of phases that follow each other.
pub(crate) struct Stopwatch {
    begin: Instant,
    phases: Vec<(BuildPhase, f64)>,
}

impl Stopwatch {
    pub(crate) fn start() -> Self {
        Self {
            begin: Instant::now(),
            phases: Vec::new(),
        }
    }

    /// Ends a phase and begins the next one.
    pub(crate) fn end(&mut self, phase: BuildPhase) {
        let end = Instant::now();
        let seconds = (end - self.begin).as_secs_f64();
        self.phases.push((phase, seconds));
        self.begin = end;
    }
}
