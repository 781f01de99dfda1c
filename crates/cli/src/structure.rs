//! Builds a structure and reports what it looks like.

use std::path::Path;

use anyhow::{Result, anyhow};
use serde::Serialize;
use tahko_tracer::accelerator::{Accelerator, StructureKind};
use tahko_tracer::geometry::{ExpectedVisits, Precision, TriangleMesh};

use crate::progress::Progress;

/// Builds a structure over the triangles of a file.
pub(crate) fn build(
    kind: StructureKind,
    precision: Precision,
    mesh: &TriangleMesh,
    path: &Path,
    progress: &Progress,
) -> Result<Accelerator> {
    let name = kind.name();
    progress.phase(&format!("building {name} over {} triangles", mesh.len()));
    Accelerator::build(kind, precision, mesh)
        .map_err(|source| anyhow!("{}: {source}", path.display()))
}

/// A structure, as it appears in JSON.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct StructureReport {
    /// `brute`, `bsp`, `kdtree` or `bvh`.
    pub(crate) name: &'static str,
    /// Triangles that it was built from.
    pub(crate) triangles: usize,
    /// Time of the build.
    pub(crate) build_seconds: f64,
    /// All nodes, leaves included.
    pub(crate) nodes: usize,
    /// Nodes without children.
    pub(crate) leaves: usize,
    /// Leaves without triangles.
    pub(crate) empty_leaves: usize,
    /// Nodes on the longest way from the root to a leaf.
    pub(crate) depth: usize,
    /// Entries in the lists of triangles.
    pub(crate) references: usize,
    /// How often a triangle is listed on average.
    pub(crate) references_per_triangle: f64,
    /// Memory in bytes.
    pub(crate) bytes: usize,
    /// Memory per triangle in bytes.
    pub(crate) bytes_per_triangle: f64,
    /// What a random line through the bounds is expected to visit.
    pub(crate) expected_visits: VisitReport,
    /// The cost of these visits, in units of one triangle test; null where it is not finite.
    pub(crate) sah_cost: f64,
}

/// Expected visits, as they appear in JSON.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct VisitReport {
    pub(crate) inner_nodes: f64,
    pub(crate) leaves: f64,
    /// Triangle tests, were each triangle tested in every leaf that lists it.
    pub(crate) triangle_tests: f64,
}

impl VisitReport {
    const fn new(visits: ExpectedVisits) -> Self {
        Self {
            inner_nodes: visits.inner_nodes,
            leaves: visits.leaves,
            triangle_tests: visits.triangle_tests,
        }
    }
}

impl StructureReport {
    pub(crate) fn new(structure: StructureKind, accelerator: &Accelerator) -> Self {
        let statistics = accelerator.statistics();
        Self {
            name: structure.name(),
            triangles: statistics.primitives,
            build_seconds: accelerator.build_time().as_secs_f64(),
            nodes: statistics.nodes,
            leaves: statistics.leaves,
            empty_leaves: statistics.empty_leaves,
            depth: statistics.depth,
            references: statistics.references,
            references_per_triangle: statistics.references_per_primitive(),
            bytes: statistics.bytes,
            bytes_per_triangle: statistics.bytes_per_primitive(),
            expected_visits: VisitReport::new(statistics.expected_visits),
            sah_cost: statistics.sah_cost,
        }
    }
}
