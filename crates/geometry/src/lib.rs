//! Rays, triangles, planes and polygons: the geometry that tahko's structures share.
#![cfg_attr(not(test), warn(missing_docs))]

mod aabb;
mod axis;
mod brute_force;
mod conservative_ray;
pub mod kernel;
mod mesh;
mod plane;
mod polygon;
pub mod query;
mod ray;
mod statistics;
#[cfg(feature = "test-support")]
pub mod test_support;
mod transform;
mod triangle;

pub use aabb::Aabb;
pub use axis::Axis;
pub use brute_force::BruteForce;
pub use conservative_ray::{ConservativeRay, Interval};
pub use glam;
pub use kernel::{MollerTrumbore, Precision, TriangleHit, TriangleKernel, Woop};
pub use mesh::{DroppedTriangle, MeshError, TriangleMesh};
pub use plane::{Plane, Side};
pub use polygon::{Polygon, PolygonError, Split};
pub use query::{
    AnyHit, ClosestHit, Hit, HitCollector, QueryCounts, RayQuery, TraversalCounter, Traverse,
    test_triangle,
};
pub use ray::Ray;
pub use statistics::TreeStatistics;
pub use transform::Transform;
pub use triangle::Triangle;
