//! Bounding volume hierarchies for ray casting.
//!
//! A BVH is a tree of boxes: a node has the boxes of up to eight children, and a ray visits only the children
//! whose boxes it meets. Boxes and triangles are tested eight at a time, with the vector instructions of the processor. It is the
//! structure to start with; the kd-tree makes fewer triangle tests, and the planes of the BSP tree follow the polygons.
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
//!   [`Precision`](tahko_geometry::Precision), bit for bit, with any instructions, one ray at a time or many: boxes are tested with a
//!   margin that no accepted hit exceeds.
//! - Any valid mesh builds: empty, flat, all triangles equal, coordinates from the smallest f32 to the largest. No
//!   way from the root is longer than 64 nodes.
//! - The same input gives the same tree for every number of threads.
//!
//! # Building
//! [`BvhOptions::fast`], [`BvhOptions::balanced`] (the default) and [`BvhOptions::high_quality`] trade build time for
//! the cost of rays; [`Bvh::statistics`] tells what came out. [`Bvh::build_with`] reports its progress to a [`BuildControl`], through which it can
//! be cancelled and its memory limited, and returns a [`BuildReport`].
//!
//! # Memory
//! Meshes that were measured take 67 to 90 bytes per triangle, a copy of the triangles included; those with few triangles per leaf take more. Each triangle is listed
//! once, unless [spatial splits](BvhOptions::spatial_split_budget) are allowed, or [slivers](BvhOptions::presplit_budget) are cut in pieces, as in [`BvhOptions::high_quality`]: long thin triangles along
//! diagonals then take up to eight times the memory, and rays among them a fraction of the time.
//! [`BvhOptions::build_memory`] estimates what a build takes. On Linux, large trees ask for huge pages. An eighth is boxes of nodes;
//! [`NodeFormat::Quantised`] keeps three eighths of that.
//!
//! # Queries
//! - [`RayQuery`](tahko_geometry::RayQuery) has them. For many rays take its batches, `closest_hits` and `any_hits`. Neighbours in the list that go nearly the
//!   same way, as those of a camera do in tiles of its picture, are traced as packets. Of others several are kept in flight, so that some are worked on while others wait
//!   for memory, or for a branch that was foreseen wrongly. `Bvh::closest_hits_parallel` and `Bvh::any_hits_parallel` share a batch among threads.
//! - The instructions are chosen when the program runs: AVX-512 (for vectors of 256 bits) or AVX2 and FMA of x86-64 where the processor has them, otherwise whatever every
//!   processor of the architecture has. [`Bvh::with_simd`] makes another choice; NEON has no code of its own yet.
//! - At every precision a filter looks at eight triangles at a time and leaves few to the kernel. Only that of the exact precision is
//!   also sure of hits.
//!
//! # Features
//! - `parallel` (default): builds on the threads of the current rayon pool, and batches shared among them.

mod build;
mod bvh;
mod control;
mod filling;
mod huge_pages;
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
pub use options::{BuildError, BuildMethod, BvhOptions, NodeFormat};
pub use report::{BuildPhase, BuildReport};
pub use validate::{Content, ValidationError};
