//! Bounding volume hierarchies for ray casting.
//!
//! A BVH is a tree of boxes: each node's box encloses the triangles below it, and a ray visits only the nodes
//! whose boxes it meets. Each triangle is listed once, so the memory is known before the build (70 to 105 bytes
//! per triangle) and the build is short; spatial splits, which [`BvhOptions::high_quality`] allows, list some triangles more often
//! for cheaper rays, within a budget. It is the structure to start with; take the kd-tree where rays are many and the
//! scene is deep, the BSP tree where splitting planes should follow the polygons.
//!
//! ```
//! use tahko_bvh::{Bvh, BvhOptions};
//! use tahko_geometry::{Ray, RayQuery, TriangleMesh, glam::Vec3};
//!
//! // Two triangles, one above the other.
//! let vertices = [0.0, 1.0].map(|z| [Vec3::Z * z, Vec3::X + Vec3::Z * z, Vec3::Y + Vec3::Z * z]);
//! let mesh = TriangleMesh::new(vertices.concat(), vec![[0, 1, 2], [3, 4, 5]])?;
//! let bvh = Bvh::build(&mesh, &BvhOptions::default())?;
//!
//! let down = Ray::new(Vec3::new(0.25, 0.25, 3.0), Vec3::NEG_Z);
//! let hit = bvh.closest_hit(&down).expect("the upper triangle is below the origin");
//! assert_eq!((hit.primitive, hit.t), (1, 2.0));
//! assert!(!bvh.any_hit(&Ray::new(Vec3::splat(2.0), Vec3::NEG_Z)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Guarantees
//! - Queries answer as [`BruteForce`](tahko_geometry::BruteForce) does at the same
//!   [`Precision`](tahko_geometry::Precision), bit for bit: boxes are tested with a margin that no accepted hit exceeds.
//! - Any valid mesh builds: empty, flat, all triangles equal, coordinates from the smallest f32 to the largest. No
//!   way from the root is longer than 64 nodes.
//! - The same input gives the same tree for every number of threads.
//!
//! # Options
//! [`BvhOptions::fast`], [`BvhOptions::balanced`] (the default) and [`BvhOptions::high_quality`] trade build time for
//! the cost of rays; [`Bvh::statistics`] tells what came out.
//!
//! # Features
//! - `parallel` (default): build on the threads of the current rayon pool.

mod build;
mod bvh;
mod control;
mod options;
mod overlap;
mod parallel;
#[cfg(feature = "parallel")]
mod parallel_queries;
mod report;
mod statistics;
mod validate;
mod wide;

pub use bvh::Bvh;
pub use control::BuildControl;
pub use options::{BuildError, BuildMethod, BvhOptions};
pub use report::{BuildPhase, BuildReport};
pub use validate::{Content, ValidationError};
