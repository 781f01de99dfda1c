//! kd-trees for ray casting.
//!
//! A kd-tree divides space by planes perpendicular to the axes. Its cells do not overlap, so a ray meets them in their
//! order along the ray and stops at the first hit that no later cell can beat. A triangle is listed in every
//! cell that it touches. Take a kd-tree where rays are many and the scene is deep, so that stopping early saves
//! most; take the BVH where the build has to be short or memory known before, the BSP tree where splitting planes
//! should follow polygons that are not parallel to the axes.
//!
//! ```
//! use tahko_geometry::{Ray, RayQuery, TriangleMesh, glam::Vec3};
//! use tahko_kdtree::{KdTree, KdTreeOptions};
//!
//! // Two triangles, one above the other.
//! let vertices = [0.0, 1.0].map(|z| [Vec3::Z * z, Vec3::X + Vec3::Z * z, Vec3::Y + Vec3::Z * z]);
//! let mesh = TriangleMesh::new(vertices.concat(), vec![[0, 1, 2], [3, 4, 5]])?;
//! let tree = KdTree::build(&mesh, &KdTreeOptions::default())?;
//!
//! let down = Ray::new(Vec3::new(0.25, 0.25, 3.0), Vec3::NEG_Z);
//! let hit = tree.closest_hit(&down).expect("the upper triangle is below the origin");
//! assert_eq!((hit.primitive, hit.t), (1, 2.0));
//! assert!(!tree.any_hit(&Ray::new(Vec3::splat(2.0), Vec3::NEG_Z)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Guarantees
//! - Queries answer as [`BruteForce`](tahko_geometry::BruteForce) does at the same
//!   [`Precision`](tahko_geometry::Precision), bit for bit. Cells list every triangle that touches them, by a bound
//!   on the rounding of the clipping, and planes are crossed with a margin that no accepted hit exceeds.
//! - Any valid mesh builds: empty, flat, all triangles equal, coordinates from the smallest f32 to the largest. Depth
//!   and the number of list entries have limits, so time and memory have.
//! - The same input gives the same tree for every number of threads.
//!
//! # Options
//! [`KdTreeOptions::balanced`], the default, builds with the surface area heuristic in `O(n log n)` (Wald and Havran
//! 2006): events are sorted once, triangles are clipped to their cells, and cutting off empty space is rewarded.
//! [`KdTreeOptions::fast`] splits in the middle. [`SplitPolicy`] has the others; [`KdTree::statistics`] tells
//! what came out.
//!
//! # Features
//! - `parallel` (default): build on the threads of the current rayon pool.
#![forbid(unsafe_code)]

mod build;
mod node;
mod options;
mod statistics;
mod traverse;
mod tree;
mod validate;

pub use options::{AxisChoice, BuildError, KdTreeOptions, SplitPolicy};
pub use tree::KdTree;
pub use validate::ValidationError;
