//! Random, degenerate and numerically hard input for the tests of structures, and the comparison with brute force and the oracle.

pub mod hard_cases;

use std::fmt::Debug;

use glam::Vec3;
use proptest::prelude::*;

use crate::{Axis, BruteForce, Hit, Precision, QueryCounts, Ray, RayQuery, TriangleMesh};

/// A point with coordinates in `[-size, size]`.
pub fn point(size: f32) -> impl Strategy<Value = Vec3> {
    let coordinate = move || -size..=size;
    (coordinate(), coordinate(), coordinate()).prop_map(Vec3::from)
}

/// A point on a coarse grid, so that coordinates coincide often.
pub fn grid_point() -> impl Strategy<Value = Vec3> {
    let coordinate = || (-3i8..=3).prop_map(f32::from);
    (coordinate(), coordinate(), coordinate()).prop_map(Vec3::from)
}

/// A mesh of 0 to 60 triangles: a soup of large or small triangles, a soup on a grid (flat, repeated and
/// degenerate triangles among them), or a connected mesh over few vertices.
///
/// # Panics
/// Never: the vertices are finite and the indices in range.
pub fn mesh() -> impl Strategy<Value = TriangleMesh> {
    let soup =
        |corners: BoxedStrategy<[Vec3; 3]>| prop::collection::vec(corners, 0..60).prop_map(soup);
    let large = prop::array::uniform3(point(1.0)).boxed();
    let small = (point(1.0), prop::array::uniform3(point(0.05)))
        .prop_map(|(center, offsets)| offsets.map(|offset| center + offset))
        .boxed();
    let grid = prop::array::uniform3(grid_point()).boxed();
    let connected = prop::collection::vec(point(1.0), 3..12).prop_flat_map(|vertices| {
        let count = u32::try_from(vertices.len()).unwrap_or(u32::MAX);
        prop::collection::vec(prop::array::uniform3(0..count), 0..40).prop_map(move |indices| {
            TriangleMesh::new(vertices.clone(), indices).expect("finite vertices, indices in range")
        })
    });
    prop_oneof![soup(large), soup(small), soup(grid), connected]
}

/// A mesh of separate triangles.
///
/// # Panics
/// If a coordinate is not finite.
#[must_use]
pub fn soup(triangles: Vec<[Vec3; 3]>) -> TriangleMesh {
    let indices = (0u32..)
        .step_by(3)
        .take(triangles.len())
        .map(|first| [first, first + 1, first + 2]);
    let indices = indices.collect();
    TriangleMesh::new(triangles.into_flattened(), indices).expect("finite vertices")
}

/// A ray: in a random direction, parallel to an axis (with zeros of both signs), from and towards grid points,
/// or with a short interval that may begin below zero.
pub fn ray() -> impl Strategy<Value = Ray> {
    let random =
        (point(4.0), point(1.0)).prop_map(|(origin, direction)| Ray::new(origin, direction));
    let parallel = (point(1.0), axis(), any::<[bool; 3]>())
        .prop_map(|(origin, axis, signs)| parallel_ray(origin, axis, signs));
    let grid_parallel = (grid_point(), axis(), any::<[bool; 3]>())
        .prop_map(|(origin, axis, signs)| parallel_ray(origin, axis, signs));
    let grid = (grid_point(), grid_point()).prop_map(|(from, to)| Ray::new(from, to - from));
    let short = (point(1.0), point(1.0), -2.0f32..2.0, 0.0f32..2.0).prop_map(
        |(origin, direction, t_min, length)| {
            Ray::with_interval(origin, direction, t_min, t_min + length)
        },
    );
    prop_oneof![random, parallel, grid_parallel, grid, short]
}

fn axis() -> impl Strategy<Value = Axis> {
    prop::sample::select(Axis::ALL.to_vec())
}

/// A ray along an axis, from 8 before the origin's place on it; `signs` picks the direction and the signs of the zeros.
fn parallel_ray(mut origin: Vec3, axis: Axis, signs: [bool; 3]) -> Ray {
    let mut direction = Vec3::from(signs.map(|negative| if negative { -0.0 } else { 0.0 }));
    direction[axis as usize] = if signs[axis as usize] { -1.0 } else { 1.0 };
    origin[axis as usize] = -8.0 * direction[axis as usize];
    Ray::new(origin, direction)
}

/// Rays along each axis, in both directions and with zeros of both signs, through up to 60 vertices of a mesh and the corners of
/// its bounds, from a distance and from the very point: in splitting planes, in faces of boxes, and along edges.
#[must_use]
pub fn rays_along_axes(mesh: &TriangleMesh) -> Vec<Ray> {
    let step = mesh.vertices().len().div_ceil(60).max(1);
    let mut points: Vec<Vec3> = mesh.vertices().iter().copied().step_by(step).collect();
    let bounds = mesh.aabb();
    if !bounds.is_empty() {
        points.extend([bounds.min, bounds.max, bounds.center()]);
    }
    let mut rays = Vec::new();
    for point in points {
        for axis in Axis::ALL {
            for (zero, sign) in [(0.0, 1.0), (-0.0, -1.0), (0.0, -1.0), (-0.0, 1.0)] {
                let mut direction = Vec3::splat(zero);
                direction[axis as usize] = sign;
                let mut start = point;
                start[axis as usize] -= 16.0 * sign;
                rays.extend([start, point].map(|origin| Ray::new(origin, direction)));
            }
        }
    }
    rays
}

/// Variants of a valid ray that are not valid, one for each reason.
#[must_use]
pub fn invalid_rays(good: Ray) -> [Ray; 6] {
    let with =
        |origin, direction, t_min, t_max| Ray::with_interval(origin, direction, t_min, t_max);
    let Ray {
        origin,
        direction,
        t_min,
        t_max,
    } = good;
    [
        with(Vec3::INFINITY, direction, t_min, t_max),
        with(Vec3::NAN, direction, t_min, t_max),
        with(origin, Vec3::ZERO, t_min, t_max),
        with(origin, Vec3::NAN, t_min, t_max),
        with(origin, direction, 2.0, 1.0),
        with(origin, direction, t_min, f32::NAN),
    ]
}

/// Rays that aim at every vertex, edge midpoint and centroid of a mesh, from a few places.
#[must_use]
pub fn rays_at_features(mesh: &TriangleMesh) -> Vec<Ray> {
    let origins = [
        Vec3::new(0.1, 0.2, 5.0),
        Vec3::ZERO,
        Vec3::new(-7.0, 3.0, 1.0),
    ];
    let targets = mesh.triangles().flat_map(|triangle| {
        let [a, b, c] = triangle.vertices();
        [
            a,
            b,
            c,
            a.midpoint(b),
            b.midpoint(c),
            c.midpoint(a),
            (a + b + c) / 3.0,
        ]
    });
    let targets: Vec<Vec3> = targets.collect();
    let rays = origins.into_iter().flat_map(|origin| {
        targets
            .iter()
            .map(move |target| Ray::new(origin, *target - origin))
    });
    rays.collect()
}

/// Meshes on which builders fail when they are careless, each with a name.
#[must_use]
pub fn degenerate_meshes() -> Vec<(&'static str, TriangleMesh)> {
    let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let at = |offset: Vec3| triangle.map(|corner| corner + offset);
    let concentric = |i: u16| {
        let size = f32::from(i + 1);
        [
            Vec3::new(size, 0.0, 0.0),
            Vec3::new(-size, size, 0.0),
            Vec3::new(0.0, -size, 0.0),
        ]
    };
    let nested = |i: i16| triangle.map(|corner| corner * 2.0f32.powi(-i32::from(i)));
    vec![
        ("none", soup(Vec::new())),
        ("one", soup(vec![triangle])),
        ("two equal", soup(vec![triangle; 2])),
        ("hundred equal", soup(vec![triangle; 100])),
        (
            "coplanar",
            soup(
                (0..100u8)
                    .map(|i| at(Vec3::X * f32::from(i) * 0.3))
                    .collect(),
            ),
        ),
        (
            "stacked",
            soup((0..100u8).map(|i| at(Vec3::Z * f32::from(i))).collect()),
        ),
        (
            "coincident centroids",
            soup((0..64).map(concentric).collect()),
        ),
        (
            "nested down to 2^-100",
            soup((0..100).map(nested).collect()),
        ),
        ("a point", soup(vec![[Vec3::ONE; 3]])),
        (
            "points and segments",
            soup(vec![
                [Vec3::ONE; 3],
                [Vec3::ZERO, Vec3::X, Vec3::X * 2.0],
                triangle,
            ]),
        ),
        (
            "only zero area",
            soup(vec![[Vec3::ZERO, Vec3::ONE, Vec3::splat(2.0)]; 40]),
        ),
        ("teapot in a stadium", teapot_in_a_stadium()),
        (
            "largest coordinates",
            soup(vec![
                [Vec3::splat(f32::MIN), Vec3::X * f32::MAX, Vec3::Y],
                triangle,
            ]),
        ),
        (
            "denormal coordinates",
            soup(vec![triangle.map(|corner| corner * 1e-39), triangle]),
        ),
    ]
}

fn teapot_in_a_stadium() -> TriangleMesh {
    let small = (0..200u8).map(|i| {
        let angle = f32::from(i);
        let center = Vec3::new(angle.cos(), (2.0 * angle).sin(), angle.sin()) * 1e-2;
        [center, center + Vec3::X * 1e-3, center + Vec3::Y * 1e-3]
    });
    let floor = [
        Vec3::new(-1e5, -1.0, -1e5),
        Vec3::new(1e5, -1.0, -1e5),
        Vec3::new(0.0, -1.0, 1e5),
    ];
    soup(small.chain([floor]).collect())
}

/// What brute force answers, for holding structures against it.
#[derive(Clone, Debug)]
pub struct BruteForceAnswers<'a> {
    precision: Precision,
    rays: &'a [Ray],
    hits: Vec<Option<Hit>>,
}

impl<'a> BruteForceAnswers<'a> {
    /// The closest hits of some rays.
    #[must_use]
    pub fn new(mesh: &TriangleMesh, precision: Precision, rays: &'a [Ray]) -> Self {
        let mut hits = vec![None; rays.len()];
        BruteForce::new(mesh, precision).closest_hits(rays, &mut hits);
        Self {
            precision,
            rays,
            hits,
        }
    }

    /// Checks that a structure gives the same closest hits (same primitive, same bits) and any hits, in counted and
    /// batch forms.
    ///
    /// # Panics
    /// If an answer differs.
    pub fn assert_equal<S: RayQuery>(&self, name: impl Debug, structure: &S) {
        let precision = self.precision;
        for (ray, expected) in self.rays.iter().zip(&self.hits) {
            let mut counts = QueryCounts::default();
            let closest = [
                structure.closest_hit(ray),
                structure.closest_hit_counted(ray, &mut counts),
            ];
            assert_eq!(
                closest, [*expected; 2],
                "closest hit, {name:?}, {precision:?}, {ray:?}"
            );
            let any = [
                structure.any_hit(ray),
                structure.any_hit_counted(ray, &mut counts),
            ];
            assert_eq!(
                any,
                [expected.is_some(); 2],
                "any hit, {name:?}, {precision:?}, {ray:?}"
            );
        }
        let mut hits = vec![None; self.rays.len()];
        structure.closest_hits(self.rays, &mut hits);
        assert_eq!(hits, self.hits, "batch, {name:?}, {precision:?}");
        let mut any = vec![false; self.rays.len()];
        structure.any_hits(self.rays, &mut any);
        let expected: Vec<bool> = self.hits.iter().map(Option::is_some).collect();
        assert_eq!(any, expected, "batch of any hits, {name:?}, {precision:?}");
    }
}

/// Checks that a structure answers like brute force: [`BruteForceAnswers::assert_equal`].
///
/// # Panics
/// If an answer differs.
pub fn assert_answers_like_brute_force<S: RayQuery>(
    name: impl Debug,
    structure: &S,
    mesh: &TriangleMesh,
    precision: Precision,
    rays: &[Ray],
) {
    BruteForceAnswers::new(mesh, precision, rays).assert_equal(name, structure);
}
