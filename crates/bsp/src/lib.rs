//! BSP trees for ray casting.
//!
//! A binary space partitioning tree cuts space by planes in any direction, most of them planes of the scene's own
//! polygons. Cells become convex polytopes that fit the scene more closely than boxes can, and a ray tests fewer triangles.
//! The price is paid in the build, which is longer than that of a kd-tree or a BVH. Take it for scenes of
//! large flat polygons that are not aligned to the axes and for the exact partition of space; take the BVH where the
//! build counts.
//!
//! ```
//! use tahko_bsp::{BspOptions, BspTree};
//! use tahko_geometry::{Ray, RayQuery, TriangleMesh, glam::Vec3};
//!
//! // Two triangles, one above the other.
//! let vertices = [0.0, 1.0].map(|z| [Vec3::Z * z, Vec3::X + Vec3::Z * z, Vec3::Y + Vec3::Z * z]);
//! let mesh = TriangleMesh::new(vertices.concat(), vec![[0, 1, 2], [3, 4, 5]])?;
//! let tree = BspTree::build(&mesh, &BspOptions::default())?;
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
//!   [`Precision`](tahko_geometry::Precision), bit for bit: polygons are cut only to decide which cells list a triangle, hits
//!   are tested on the triangle itself, and planes are crossed with a margin that no accepted hit exceeds.
//! - Any valid mesh builds: empty, flat, all triangles equal, coordinates from the smallest f32 to the largest.
//! - The lists of triangles stay below [`max_growth`](BspOptions::max_growth) times the number of triangles, also where
//!   BSP trees grow quadratically.
//! - The same input gives the same tree for every number of threads.
//!
//! # Options
//! [`Splitter`] chooses among the planes that [`SplittingPlanes`] and [`Candidates`] offer, [`Straddlers`] says what
//! becomes of polygons on both sides. [`BspOptions::fast`], [`BspOptions::balanced`] (the default) and
//! [`BspOptions::high_quality`] are good combinations; [`BspTree::statistics`] and [`BspTree::bsp_statistics`]
//! tell what came out.
//!
//! # Features
//! - `parallel` (default): build on the threads of the current rayon pool.
#![forbid(unsafe_code)]

mod build;
mod cell;
mod crossing;
mod divider;
mod node;
mod options;
mod parallel;
mod piece;
mod policy;
mod stack;
mod statistics;
mod traverse;
mod tree;
mod validate;

pub use options::{BspOptions, BuildError};
pub use policy::{Candidates, Splitter, SplittingPlanes, Straddlers};
pub use statistics::BspStatistics;
pub use tree::BspTree;
pub use validate::{Place, ValidationError};
