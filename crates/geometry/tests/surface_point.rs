//! Positions against the oracle, and rays that leave a triangle.

use proptest::prelude::*;
use tahko_geometry::glam::{DVec3, Vec3};
use tahko_geometry::oracle::{Oracle, RBig};
use tahko_geometry::predicate::{Sign, direction_side, point_side};
use tahko_geometry::test_support::{point, soup};
use tahko_geometry::{
    Axis, BruteForce, Hit, Precision, Ray, RayQuery, SurfacePoint, Triangle, TriangleMesh,
};

const HALF_ULP: f64 = 1.0 / (1u64 << 24) as f64;

fn scaled(point: Vec3, power: i32) -> Vec3 {
    (point.as_dvec3() * 2f64.powi(power)).as_vec3()
}

/// A triangle of ordinary shape, or a needle up to `2^30` times as long as wide, or one with axis-parallel sides; of any size, and up to
/// `2^30` times its size away from the origin.
fn triangle() -> impl Strategy<Value = Triangle> {
    let corners = || prop::array::uniform3(point(1.0));
    let needle = (corners(), 0i32..30).prop_map(|([a, along, across], thinness)| {
        [a, a + along, a + 0.3 * along + scaled(across, -thinness)]
    });
    let flat = (corners(), 0usize..3).prop_map(|(mut corners, axis)| {
        let height = corners[0][axis];
        for corner in &mut corners {
            corner[axis] = height;
        }
        corners
    });
    let shape = prop_oneof![2 => corners(), 1 => needle, 1 => flat];
    let place = prop_oneof![1 => Just(None), 1 => (point(1.0), 0i32..30).prop_map(Some)];
    let size = prop_oneof![2 => -4i32..4, 1 => -148i32..127];
    (shape, place, size).prop_map(|(corners, place, size)| {
        let offset = place.map_or(DVec3::ZERO, |(place, distance)| {
            place.as_dvec3() * 2f64.powi(distance)
        });
        let [a, b, c] = corners.map(|corner| {
            let exact = (corner.as_dvec3() + offset) * 2f64.powi(size);
            let largest = f64::from(f32::MAX) / 4.0;
            exact
                .clamp(DVec3::splat(-largest), DVec3::splat(largest))
                .as_vec3()
        });
        Triangle::new(a, b, c)
    })
}

/// Weights of the inside, of edges and of vertices.
fn weights() -> impl Strategy<Value = (f32, f32)> {
    let inside = (0.0f32..1.0, 0.0f32..1.0).prop_map(|(u, v)| (u, v * (1.0 - u)));
    let edges = (0.0f32..1.0)
        .prop_flat_map(|u| prop::sample::select(vec![(u, 0.0), (0.0, u), (u, 1.0 - u)]));
    let vertices = prop::sample::select(vec![(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)]);
    prop_oneof![4 => inside, 1 => edges, 1 => vertices]
}

/// A direction that may lie in a plane of the triangle's edges, nearly or exactly, of any length.
fn direction(triangle: &Triangle) -> BoxedStrategy<Vec3> {
    let Triangle { a, b, c } = *triangle;
    let unit = |vector: DVec3| vector.normalize_or(DVec3::X).as_vec3();
    let [e1, e2] = [b, c].map(|vertex| unit(vertex.as_dvec3() - a.as_dvec3()));
    let normal = unit(triangle.scaled_normal() / triangle.scaled_normal().abs().max_element());
    let special = vec![
        e1,
        e2,
        -e1,
        e1 + e2,
        normal,
        -normal,
        b - a,
        c - b,
        Vec3::X,
        Vec3::NEG_Z,
    ];
    let grazing = (point(1.0), -40i32..0, any::<bool>()).prop_map(move |(weights, rise, up)| {
        let rise = if up {
            2f32.powi(rise)
        } else {
            -(2f32.powi(rise))
        };
        e1 * weights.x + e2 * weights.y + normal * rise
    });
    let any = prop_oneof![2 => point(1.0), 1 => prop::sample::select(special), 2 => grazing];
    let length = prop_oneof![3 => Just(0i32), 1 => -140i32..127];
    (any, length)
        .prop_map(|(direction, length)| scaled(direction, length))
        .boxed()
}

fn case() -> impl Strategy<Value = (Triangle, (f32, f32), Vec3)> {
    (triangle(), weights())
        .prop_flat_map(|(triangle, weights)| (Just(triangle), Just(weights), direction(&triangle)))
}

fn mesh_of(triangle: &Triangle) -> TriangleMesh {
    soup(vec![triangle.vertices()])
}

fn hit_at((u, v): (f32, f32)) -> Hit {
    Hit {
        t: 1.0,
        u,
        v,
        primitive: 0,
    }
}

fn exact(value: f32) -> RBig {
    RBig::try_from(value).expect("finite")
}

fn distance(a: &RBig, b: &RBig) -> RBig {
    if a < b { b - a } else { a - b }
}

/// The extent of a triangle, and the distance between neighbouring numbers at its largest coordinate.
fn sizes(triangle: &Triangle) -> (f64, f64) {
    let bounds = triangle.aabb();
    let extent = (bounds.max.as_dvec3() - bounds.min.as_dvec3()).max_element();
    let largest = bounds.max.abs().max(bounds.min.abs()).max_element();
    (extent, f64::from(largest.next_up()) - f64::from(largest))
}

fn config() -> ProptestConfig {
    let cases = std::env::var("PROPTEST_CASES").ok();
    let cases = cases.and_then(|cases| cases.parse().ok()).unwrap_or(2000);
    ProptestConfig {
        max_global_rejects: cases,
        ..ProptestConfig::with_cases(cases)
    }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn the_exact_hit_is_within_the_error((triangle, (u, v), direction) in case(), back in -30i32..30) {
        let from_a = |vertex: Vec3| vertex.as_dvec3() - triangle.a.as_dvec3();
        let target = triangle.a.as_dvec3() + from_a(triangle.b) * f64::from(u) + from_a(triangle.c) * f64::from(v);
        let (extent, _) = sizes(&triangle);
        let unit = direction.as_dvec3().normalize_or_zero();
        let origin = (target - unit * extent * 2f64.powi(back)).as_vec3();
        let ray = Ray::with_interval(origin, direction, f32::NEG_INFINITY, f32::INFINITY);
        let mesh = mesh_of(&triangle);
        let Some(hit) = BruteForce::new(&mesh, Precision::Exact).closest_hit(&ray) else { return Ok(()) };
        let point = SurfacePoint::new(&hit, &triangle, Precision::Exact);
        let t = Oracle::new(&mesh).closest_hit(&ray).expect("hit").t;
        for axis in 0..3 {
            let expected = exact(ray.origin[axis]) + &t * exact(ray.direction[axis]);
            let error = distance(&exact(point.position()[axis]), &expected);
            prop_assert!(error <= exact(point.error()[axis]), "{ray:?} {point:?}");
        }
    }

    #[test]
    fn positions_of_all_precisions_are_within_the_error_of_the_triangle((triangle, (u, v), _) in case()) {
        let point = SurfacePoint::new(&hit_at((u, v)), &triangle, Precision::Fast);
        for axis in 0..3 {
            let [a, b, c] = triangle.vertices().map(|vertex| exact(vertex[axis]));
            let on_triangle = &a + exact(u) * (b - &a) + exact(v) * (c - &a);
            let error = distance(&exact(point.position()[axis]), &on_triangle);
            prop_assert!(error <= exact(point.error()[axis]), "{point:?}");
        }
        prop_assert!(triangle.aabb().contains(point.position()));
    }

    #[test]
    fn a_ray_does_not_meet_the_triangle_that_it_leaves((triangle, weights, direction) in case()) {
        let mesh = mesh_of(&triangle);
        for precision in Precision::ALL {
            let point = SurfacePoint::new(&hit_at(weights), &triangle, precision);
            let ray = point.spawn_ray(direction);
            prop_assert!(!BruteForce::new(&mesh, precision).any_hit(&ray), "{precision:?} {triangle:?} {ray:?}");
            prop_assert_eq!(Oracle::new(&mesh).closest_hit(&ray), None);
            if triangle.is_degenerate() || !direction.is_finite() {
                continue;
            }
            let side = match direction_side(direction, &triangle) {
                Sign::Zero => Sign::Positive,
                side => side,
            };
            prop_assert_eq!(point_side(ray.origin, &triangle), side);
        }
    }

    #[test]
    fn a_ray_to_a_point_ends_beside_it_by_the_lift((triangle, weights, target) in case()) {
        let mesh = mesh_of(&triangle);
        for precision in Precision::ALL {
            let point = SurfacePoint::new(&hit_at(weights), &triangle, precision);
            let ray = point.spawn_ray_to(target);
            prop_assert!(!BruteForce::new(&mesh, precision).any_hit(&ray), "{precision:?} {triangle:?} {ray:?}");
            let direction = target - point.position();
            if direction.is_finite() {
                prop_assert_eq!((ray.direction, ray.t_min, ray.t_max), (direction, 0.0, 1.0));
            }
        }
    }

    #[test]
    fn the_origin_is_as_near_as_the_documentation_says((triangle, weights, direction) in case()) {
        let (extent, ulp) = sizes(&triangle);
        for precision in Precision::ALL {
            let point = SurfacePoint::new(&hit_at(weights), &triangle, precision);
            let lift = (point.spawn_ray(direction).origin.as_dvec3() - point.position().as_dvec3()).abs();
            // Rounding moves the position by at most half a unit in the last place.
            let exact = 6.0 * 0.5 * ulp + 2.0 * ulp + extent * 2f64.powi(-36);
            let reach = if precision == Precision::Exact { 0.0 } else { 54.0 * (HALF_ULP * extent + f64::from(f32::from_bits(1))) };
            prop_assert!(lift.max_element() <= exact + reach, "{precision:?} {point:?}: {lift}");
            prop_assert!(lift.to_array().iter().filter(|part| **part > 0.0).count() <= 1, "along one axis");
        }
    }

    /// Two triangles at a valley: a ray from one of them that leads away from both planes meets neither.
    #[test]
    fn a_ray_from_a_gentle_valley_meets_neither_side(
        [a, along, across, third] in prop::array::uniform4(point(1.0)),
        angle in 0.01f64..13.0,
        place in (point(1.0), 0i32..16),
        (u, nearness) in (0.0f32..1.0, 0i32..24),
        direction in point(1.0),
    ) {
        let (e, w) = (along.as_dvec3(), across.as_dvec3());
        let normal = e.cross(w).normalize_or_zero();
        prop_assume!(e.length() > 0.1 && e.cross(w).length() > 0.1);
        let to_neighbour = e.cross(normal).normalize();
        let (sin, cos) = angle.to_radians().sin_cos();
        let rising = to_neighbour * cos + normal * sin;
        let offset = place.0.as_dvec3() * 2f64.powi(place.1) + a.as_dvec3();
        let [p, q, inner, outer] = [
            DVec3::ZERO,
            e,
            w,
            e * f64::from(third.x) + rising * (0.1 + f64::from(third.y).abs()),
        ]
        .map(|corner| (corner + offset).as_vec3());
        let first = Triangle::new(p, q, inner);
        let second = Triangle::new(q, p, outer);
        prop_assume!(!first.is_degenerate() && !second.is_degenerate());
        // As rounded, the neighbour is still a valley and still gentle.
        let [n1, n2] = [first, second].map(|triangle| triangle.scaled_normal().normalize());
        prop_assume!(n1.dot(n2) > 14f64.to_radians().cos() && point_side(outer, &first) == Sign::Positive);
        let direction = if direction_side(direction, &first) == Sign::Negative { -direction } else { direction };
        prop_assume!([first, second].iter().all(|triangle| direction_side(direction, triangle) == Sign::Positive));
        let v = 2f32.powi(-nearness);
        let point = SurfacePoint::new(&hit_at((u * (1.0 - v), v)), &first, Precision::Exact);
        let structure = BruteForce::new(&soup(vec![first.vertices(), second.vertices()]), Precision::Exact);
        let ray = point.spawn_ray(direction);
        prop_assert_eq!(structure.closest_hit(&ray), None, "{:?} {:?}", point, ray);
        prop_assert!(!structure.any_hit_ignoring(&ray, 1));
    }
}

/// Rays that start on a triangle exactly: `t = 0` is a hit, and a spawned ray sees nothing (hard case 27).
#[test]
fn a_ray_that_starts_on_a_triangle_hits_it_unless_it_was_spawned_there() {
    let triangle = Triangle::new(Vec3::ZERO, Vec3::X, Vec3::Y);
    let mesh = mesh_of(&triangle);
    let start = Vec3::new(0.25, 0.25, 0.0);
    for precision in Precision::ALL {
        let structure = BruteForce::new(&mesh, precision);
        for direction in [Vec3::Z, Vec3::NEG_Z, Vec3::new(1.0, -2.0, 0.5)] {
            let hit = structure
                .closest_hit(&Ray::new(start, direction))
                .expect("t = 0 counts");
            assert_eq!(hit.t, 0.0);
            let point = SurfacePoint::new(&hit, &triangle, precision);
            assert_eq!((point.position(), point.error().z), (start, 0.0));
            let ray = point.spawn_ray(direction);
            assert!(!structure.any_hit(&ray), "{precision:?} {ray:?}");
            assert!(
                ray.origin.z * direction.z > 0.0,
                "on the side that it leads to"
            );
        }
    }
}

/// Origins as near to the plane as f32 allows see the triangle on their other side only (hard case 28).
#[test]
fn the_side_of_an_origin_next_to_the_plane_is_exact() {
    for size in [1e-30f32, 1e-8, 1.0, 1e8, 1e30] {
        let slanted = Triangle::new(
            Vec3::new(-0.7, -0.6, -0.2) * size,
            Vec3::new(0.9, -0.4, 0.3) * size,
            Vec3::new(0.1, 0.8, 0.6) * size,
        );
        let structure = BruteForce::new(&mesh_of(&slanted), Precision::Exact);
        let normal = slanted.scaled_normal().normalize().as_vec3();
        for step in 1..100u8 {
            let v = f32::from(step) / 128.0;
            let point = SurfacePoint::new(&hit_at((0.2, v)), &slanted, Precision::Exact);
            for outward in [normal, -normal] {
                let ray = point.spawn_ray(outward);
                let lift = (ray.origin - point.position()).abs().max_element();
                assert!(lift <= 4e-7 * size, "{lift} at size {size}");
                assert!(!structure.any_hit(&ray), "{ray:?}");
                let back = Ray {
                    direction: -outward,
                    ..ray
                };
                assert!(structure.any_hit(&back), "{back:?}");
            }
        }
    }
}

/// The size of a floor does not matter for where exact rays start.
#[test]
fn exact_rays_start_near_the_surface_of_a_large_triangle() {
    let corner = |x: f32, z: f32| Vec3::new(x, 0.5 * x, z) * 1e5;
    let floor = Triangle::new(corner(-1.0, -1.0), corner(1.0, -1.0), corner(0.0, 1.0));
    let mesh = mesh_of(&floor);
    let ray = Ray::new(Vec3::new(0.01, 5.0, 0.02), Vec3::NEG_Y);
    let lift = Precision::ALL.map(|precision| {
        let hit = BruteForce::new(&mesh, precision)
            .closest_hit(&ray)
            .expect("the floor is below");
        let point = SurfacePoint::new(&hit, &floor, precision);
        (point.spawn_ray(Vec3::Y).origin - point.position()).length()
    });
    assert!(lift[0] > 0.1 && lift[1] > 0.1, "{lift:?}");
    assert!(lift[2] < 1e-8, "{lift:?}");
}

/// An octahedron, its faces cut in four `levels` times, with the vertices on a sphere.
fn sphere(radius: f64, levels: u32) -> Vec<[Vec3; 3]> {
    let mut faces = vec![];
    for (x, y, z) in [(1, 1, 1), (-1, 1, 1), (1, -1, 1), (1, 1, -1)] {
        let [x, y, z] = [x, y, z].map(f64::from);
        let face = [DVec3::X * x, DVec3::Y * y, DVec3::Z * z];
        faces.extend([face, face.map(|corner| -corner)]);
    }
    for _ in 0..levels {
        let cut = |[a, b, c]: [DVec3; 3]| {
            let [ab, bc, ca] = [a + b, b + c, c + a].map(DVec3::normalize);
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        faces = faces.into_iter().flat_map(cut).collect();
    }
    faces
        .into_iter()
        .map(|face| face.map(|corner| (corner * radius).as_vec3()))
        .collect()
}

/// Concentric spheres 4e-5 apart: a ray through them sees both shells, twice (hard case 45).
#[test]
fn a_ray_through_thin_shells_sees_every_surface() {
    const OUTER: f64 = 7.8;
    let shells = [sphere(OUTER, 3), sphere(OUTER - 4e-5, 3)].concat();
    for place in [Vec3::ZERO, Vec3::new(100.0, -20.0, 3.0)] {
        let moved = shells
            .iter()
            .map(|face| face.map(|corner| corner + place))
            .collect();
        let mesh = soup(moved);
        let count = mesh.len() / 2;
        for precision in Precision::ALL {
            let structure = BruteForce::new(&mesh, precision);
            for face in (0..count).step_by(7) {
                let triangle = mesh.triangle(face);
                let target = triangle.a * 0.5 + triangle.b * 0.3 + triangle.c * 0.2;
                let origin = place + (target - place) * 3.0 + Axis::ALL[face % 3].unit_vector();
                let seen = surfaces_along(
                    &structure,
                    &mesh,
                    precision,
                    Ray::new(origin, target - origin),
                );
                let shell = |index: usize| seen[index] as usize / count;
                assert_eq!(seen.len(), 4, "{precision:?} {face}: {seen:?}");
                assert_eq!(
                    [0, 1, 2, 3].map(shell),
                    [0, 1, 1, 0],
                    "{precision:?} {face}"
                );
            }
        }
    }
}

/// The triangles that a ray passes through, going on from each by a spawned ray.
fn surfaces_along(
    structure: &BruteForce,
    mesh: &TriangleMesh,
    precision: Precision,
    mut ray: Ray,
) -> Vec<u32> {
    let mut seen = vec![];
    while let Some(hit) = structure.closest_hit(&ray) {
        assert!(seen.len() < 100, "{precision:?} stays at {:?}", ray.origin);
        seen.push(hit.primitive);
        let triangle = mesh.triangle(hit.primitive as usize);
        ray = SurfacePoint::new(&hit, &triangle, precision).spawn_ray(ray.direction);
    }
    seen
}

#[test]
fn what_cannot_be_spawned_is_a_ray_that_hits_nothing() {
    let triangle = Triangle::new(Vec3::ZERO, Vec3::X, Vec3::Y);
    let point = SurfacePoint::new(&hit_at((0.25, 0.25)), &triangle, Precision::Exact);
    for direction in [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY] {
        assert!(!point.spawn_ray(direction).is_valid(), "{direction}");
    }
    assert!(
        !point.spawn_ray_to(point.position()).is_valid(),
        "no direction"
    );
    let top = Vec3::splat(f32::MAX);
    let at_the_end = Triangle::new(top, top.with_x(0.0), top.with_y(0.0));
    let point = SurfacePoint::new(&hit_at((0.25, 0.25)), &at_the_end, Precision::Exact);
    assert!(
        !point.spawn_ray(Vec3::Z).is_valid(),
        "no number beyond the largest"
    );
    assert!(
        point.spawn_ray(Vec3::NEG_Z).is_valid(),
        "but many before it"
    );
}
