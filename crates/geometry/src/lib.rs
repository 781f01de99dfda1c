//! The geometry that tahko's structures share: rays, triangles, planes, polygons, and one way to ask for hits.
//!
//! Start with [`TriangleMesh`] for the triangles, [`Ray`] for the question and [`RayQuery`] for the answer. [`BruteForce`] answers
//! by testing every triangle; the crates `tahko-bvh`, `tahko-kdtree` and `tahko-bsp` give the same answers faster.
//!
//! ```
//! use tahko_geometry::{BruteForce, Precision, Ray, RayQuery, TriangleMesh, glam::Vec3};
//!
//! // A square of two triangles in the plane z = 0.
//! let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
//! let vertices = corners.map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec();
//! let mesh = TriangleMesh::new(vertices, vec![[0, 1, 2], [0, 2, 3]])?;
//! let square = BruteForce::new(&mesh, Precision::default());
//!
//! // A ray straight down through the second triangle: t counts in lengths of the direction.
//! let hit = square.closest_hit(&Ray::new(Vec3::new(0.25, 0.75, 3.0), Vec3::NEG_Z * 2.0)).expect("the square is below");
//! assert_eq!((hit.primitive, hit.t), (1, 1.5));
//! assert!(!square.any_hit(&Ray::new(Vec3::new(2.0, 0.5, 3.0), Vec3::NEG_Z)));
//! # Ok::<(), tahko_geometry::MeshError>(())
//! ```
//!
//! A hit's [`SurfacePoint`] is its position with a bound of the error, and starts rays that leave the surface: they never meet the same triangle again, and
//! there is no epsilon to choose:
//!
//! ```
//! # use tahko_geometry::{BruteForce, Precision, Ray, RayQuery, TriangleMesh, glam::Vec3};
//! use tahko_geometry::SurfacePoint;
//!
//! # let mesh = TriangleMesh::new(vec![Vec3::ZERO, Vec3::new(4.0, 0.0, 1.0), Vec3::Y * 4.0], vec![[0, 1, 2]])?;
//! # let structure = BruteForce::new(&mesh, Precision::Exact);
//! let hit = structure.closest_hit(&Ray::new(Vec3::new(1.0, 1.0, 9.0), Vec3::NEG_Z)).expect("a triangle is below");
//! let triangle = mesh.triangle(hit.primitive as usize);
//! let point = SurfacePoint::new(&hit, &triangle, Precision::Exact);
//!
//! let light = Vec3::new(3.0, 3.0, 9.0);
//! assert!(!structure.any_hit(&point.spawn_ray_to(light)), "the light is not blocked");
//! assert!(structure.closest_hit(&point.spawn_ray(Vec3::NEG_Z)).is_none(), "nor is the way on");
//! # Ok::<(), tahko_geometry::MeshError>(())
//! ```
//!
//! Polygons are cut by planes in f64; the parts keep the number of the original:
//!
//! ```
//! use tahko_geometry::{Plane, Polygon, Split, glam::DVec3};
//!
//! let triangle = Polygon::new(vec![DVec3::ZERO, DVec3::X * 4.0, DVec3::Y * 4.0], 7)?;
//! let plane = Plane::from_point_normal(DVec3::X, DVec3::X).expect("the normal is not zero");
//! let Split::Spanning { front, back } = triangle.split(&plane) else { panic!("the plane cuts it") };
//! assert_eq!((front.area(), back.area(), front.id()), (4.5, 3.5, 7));
//! # Ok::<(), tahko_geometry::PolygonError>(())
//! ```
//!
//! # Numerical guarantees
//! - A hit has `t` in the closed interval of the ray. The closest hit is the smallest `t`, then the smallest triangle index. A ray in
//!   the plane of a triangle does not hit it, and a triangle without area is never hit.
//! - [`Precision::Exact`], the default: which triangle is hit, or none, is the exact answer for the given numbers, and `t` is the exact value
//!   rounded to the nearest f32. Coordinates may be any finite f32, from denormals to the largest.
//! - [`Precision::Watertight`]: no ray passes between triangles that share an edge or a vertex. [`Precision::Fast`]: a ray that passes
//!   an edge closely may be lost. Where differences of coordinates overflow f32, these two may miss. See [`kernel`].
//! - Whatever a kernel accepts lies in a cell that [`ConservativeRay`] and [`FusedRay`] visit, so every structure gives the answer of brute
//!   force, bit for bit, with whatever vector instructions.
//! - [`SurfacePoint`]: the exact hit is within the error that is given, and a ray that it spawns does not meet the triangle again at the precision of the
//!   structure, for triangles of every size and wherever they are.
//! - [`RayQuery::all_hits`], [`RayQuery::crossings`] and [`RayQuery::contains`] count each crossing of a closed surface once, exactly.
//!
//! # Making a structure
//! - [`Traverse`] is what a structure implements, and then it is a [`RayQuery`]: it offers triangles to a [`HitCollector`] by [`test_triangle`], or by
//!   [`test_block`].
//! - [`ConservativeRay`] tests one box or plane at a time, [`FusedRay`] is for the boxes of nodes whose planes come in vectors.
//! - [`TriangleBlock`] has up to eight triangles as vectors want them, of which a [`BlockFilter`] throws out those that are certainly not hit, and
//!   names those that certainly are. [`RayLanes`] has eight rays, which a [`RaysFilter`] tests with one triangle; [`test_rays`] is the step, and [`RaySearches`] has what
//!   the rays of a packet have found.
//! - [`simd`] has vectors of eight numbers. An algorithm is written once and compiled for every level of instructions; the level is chosen
//!   when the program runs.
//!
//! # Features
//! - `oracle`: exact answers by brute force in rational numbers, to hold structures against.
//! - `test-support` (with `oracle`): random, degenerate and numerically hard meshes and rays, and the comparison with brute force and the
//!   oracle, for the tests of structures.

mod aabb;
mod axis;
mod brute_force;
mod clipped_triangle;
mod conservative_ray;
mod fused_ray;
pub mod kernel;
mod mesh;
#[cfg(feature = "oracle")]
pub mod oracle;
mod plane;
mod polygon;
pub mod predicate;
pub mod query;
mod ray;
pub mod simd;
mod statistics;
mod surface_point;
#[cfg(feature = "test-support")]
pub mod test_support;
mod transform;
mod triangle;
mod triangle_block;

pub use aabb::Aabb;
pub use axis::Axis;
pub use brute_force::BruteForce;
pub use clipped_triangle::{ClippedTriangle, ClippedVertex};
pub use conservative_ray::{ConservativeRay, Interval, Slabs};
pub use fused_ray::{
    FusedPacket, FusedRay, FusedSlabs, GatheredBounds, OctantLanes, PacketBounds, RayLanes,
    size_of_bounds,
};
pub use glam;
pub use kernel::{
    BlockFilter, BlockTest, BlockVerdict, Candidates, Exact, MollerTrumbore, Precision, RaysFilter,
    TriangleHit, TriangleKernel, Woop,
};
pub use mesh::{DroppedTriangle, MeshError, TriangleMesh};
pub use plane::{Plane, Side};
pub use polygon::{Polygon, PolygonError, Split};
pub use query::{
    AnyHit, Candidate, CertainHit, ClosestHit, Hit, HitCollector, KnownHit, QueryCounts, RayQuery,
    RaySearch, RaySearches, RaysFilterOf, RungCounts, TraversalCounter, Traverse, offer_all,
    test_block, test_candidates, test_possible, test_rays, test_triangle,
};
pub use ray::Ray;
pub use statistics::{ExpectedVisits, TreeStatistics};
pub use surface_point::SurfacePoint;
pub use transform::Transform;
pub use triangle::Triangle;
pub use triangle_block::TriangleBlock;
