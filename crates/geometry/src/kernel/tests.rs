use proptest::prelude::*;

use super::*;
use crate::{glam::Vec3, test_support};

fn hit<K: TriangleKernel>(ray: &Ray, triangle: &Triangle) -> Option<TriangleHit> {
    K::new(ray).intersect(triangle, ray.t_max, &mut ())
}

/// A hit is found again after it has become the closest one.
fn assert_is_found_again<K: TriangleKernel>(ray: &Ray, triangle: &Triangle, found: TriangleHit) {
    let again = K::new(ray).intersect(triangle, found.t, &mut ());
    assert_eq!(again, Some(found), "{ray:?} {triangle:?}");
}

fn unit_triangle() -> Triangle {
    Triangle::new(Vec3::ZERO, Vec3::X, Vec3::Y)
}

/// Runs a check with every kernel.
fn for_all(check: impl Fn(fn(&Ray, &Triangle) -> Option<TriangleHit>)) {
    check(hit::<MollerTrumbore>);
    check(hit::<Woop>);
    check(hit::<Exact>);
}

#[test]
fn degenerate_triangles_and_coordinates_that_overflow_give_no_nan_and_no_panic() {
    for (name, mesh) in test_support::degenerate_meshes() {
        let rays = test_support::rays_at_features(&mesh);
        for ray in rays.iter().filter(|ray| ray.is_valid()) {
            for triangle in mesh.triangles() {
                for_all(|hit| {
                    let hit = hit(ray, &triangle);
                    let is_inside = |hit: TriangleHit| hit.u >= 0.0 && hit.u + hit.v <= 1.0;
                    assert!(hit.is_none_or(is_inside), "{name}, {ray:?}: {hit:?}");
                });
            }
        }
    }
}

#[test]
fn t_counts_in_lengths_of_the_direction_and_u_v_weigh_the_vertices() {
    for_all(|hit| {
        for scale in [1e-10, 1.0, 1e10] {
            let ray = Ray::new(Vec3::new(0.25, 0.5, 2.0), Vec3::NEG_Z * scale);
            let hit = hit(&ray, &unit_triangle()).expect("inside");
            assert_eq!((hit.u, hit.v), (0.25, 0.5));
            assert_eq!(hit.t, 2.0 / scale);
        }
    });
}

#[test]
fn both_sides_of_a_triangle_are_hit() {
    for_all(|hit| {
        for direction in [Vec3::Z, Vec3::NEG_Z] {
            let ray = Ray::new(Vec3::new(0.25, 0.25, 0.0) - direction, direction);
            assert_eq!(hit(&ray, &unit_triangle()).map(|hit| hit.t), Some(1.0));
        }
    });
}

#[test]
fn the_interval_is_closed_at_both_ends() {
    for_all(|hit| {
        let at = |t_min, t_max| {
            let origin = Vec3::new(0.25, 0.25, 1.0);
            hit(
                &Ray::with_interval(origin, Vec3::NEG_Z, t_min, t_max),
                &unit_triangle(),
            )
        };
        assert!(at(1.0, 1.0).is_some(), "t_min = t_max = t");
        assert!(at(-5.0, 1.0).is_some(), "t_max = t");
        assert!(at(0.0, 1.0f32.next_down()).is_none(), "t_max just below t");
        assert!(at(1.0f32.next_up(), 2.0).is_none(), "t_min just above t");
    });
}

#[test]
fn rays_in_the_plane_and_flat_triangles_do_not_hit() {
    for_all(|hit| {
        let in_plane = Ray::new(Vec3::new(-1.0, 0.25, 0.0), Vec3::X);
        assert_eq!(hit(&in_plane, &unit_triangle()), None);
        let flat = Triangle::new(Vec3::ZERO, Vec3::X, Vec3::X * 2.0);
        let point = Triangle::new(Vec3::ZERO, Vec3::ZERO, Vec3::ZERO);
        for triangle in [flat, point] {
            assert_eq!(hit(&Ray::new(Vec3::Z, Vec3::NEG_Z), &triangle), None);
            assert_eq!(
                hit(&Ray::new(Vec3::new(1.0, 0.0, 1.0), Vec3::NEG_Z), &triangle),
                None
            );
        }
    });
}

#[test]
fn a_segment_with_area_in_its_rounded_projection_is_not_hit() {
    for_all(|hit| {
        // Three points of a line through a point aimed at, from places that make the projections round.
        for step in 0..2000u16 {
            let origin = Vec3::new(
                f32::from(step) * 0.37 - 300.0,
                7.3,
                f32::from(step) * 0.11 + 3.1,
            );
            let segment = Triangle::new(Vec3::ZERO, Vec3::splat(0.1), Vec3::splat(0.3));
            let ray = Ray::new(origin, Vec3::splat(0.15) - origin);
            assert_eq!(hit(&ray, &segment), None, "{ray:?}");
        }
    });
}

#[test]
fn overflowing_coordinates_are_misses_or_hits_but_never_nan() {
    for_all(|hit| {
        let huge = Triangle::new(Vec3::splat(-3e38), Vec3::X * 3e38, Vec3::Y * 3e38);
        for direction in [Vec3::X, Vec3::ONE, Vec3::splat(1e38), Vec3::splat(1e-45)] {
            if let Some(hit) = hit(&Ray::new(Vec3::splat(-1.0), direction), &huge) {
                assert!(
                    hit.t.is_finite() && hit.u.is_finite() && hit.v.is_finite(),
                    "{hit:?}"
                );
            }
        }
    });
}

#[test]
fn a_needle_is_hit_though_its_t_is_lost_in_f32() {
    // Found by the property below, when the fast kernel looked at t in f32 before it confirmed: t was off by more than 1/1024.
    let a = Vec3::new(-0.609_130_6, 0.0, 0.0);
    let direction = Vec3::new(-0.200_560_73, -0.924_464_7, -0.237_459_96);
    let across = Vec3::new(-0.246_011_02, 0.0, 0.0) * 0.5f32.powi(13);
    let triangle = Triangle::new(a, a + direction, a + 0.5 * direction + across);
    let origin = Vec3::new(0.988_895_95, -0.615_567_9, -0.146_488_03);
    let (u, v) = (0.414_777_04, 0.192_433_85 * (1.0 - 0.414_777_04));
    let ray = Ray::new(
        origin,
        a + u * (triangle.b - a) + v * (triangle.c - a) - origin,
    );
    fn check<K: TriangleKernel>(ray: &Ray, triangle: &Triangle) {
        let found = hit::<K>(ray, triangle).expect("aimed at the inside");
        assert_is_found_again::<K>(ray, triangle, found);
    }
    check::<MollerTrumbore>(&ray, &triangle);
    check::<Woop>(&ray, &triangle);
    check::<Exact>(&ray, &triangle);
}

proptest! {
    /// The theorem of the watertight kernel: of two triangles that share an edge, with their other corners on
    /// either side of it as seen along the ray, at least one is hit.
    #[test]
    fn no_ray_passes_between_neighbours(
        [a, b, c, d] in prop::array::uniform4(test_support::point(1.0)),
        along in 0.0f32..1.0,
        origin in test_support::point(4.0),
    ) {
        let ray = Ray::with_interval(origin, a.lerp(b, along) - origin, f32::NEG_INFINITY, f32::INFINITY);
        // Seen along the ray, the quadrilateral a, c, b, d surrounds the point aimed at.
        let side = |p: Vec3| {
            let [e, w] = [b - a, p - a].map(Vec3::as_dvec3);
            ray.direction.as_dvec3().dot(e.cross(w))
        };
        prop_assume!(ray.is_valid() && side(c) * side(d) < 0.0 && side(c).abs().min(side(d).abs()) > 1e-3);
        prop_assume!((0.01..0.99).contains(&along));
        let hits = [Triangle::new(a, b, c), Triangle::new(b, a, d)]
            .map(|triangle| hit::<Woop>(&ray, &triangle).is_some());
        prop_assert!(hits[0] || hits[1]);
    }

    /// The verdict on a triangle must not depend on what was hit before: a hit is found again with `t_max` at its `t`, also on
    /// needles, where f32 knows little of `t`.
    #[test]
    fn a_hit_is_found_again_with_t_max_at_its_t(
        [a, direction, across] in prop::array::uniform3(test_support::point(1.0)),
        width in 0i32..24,
        weights in (0.0f32..1.0, 0.0f32..1.0),
        origin in test_support::point(3.0),
    ) {
        let triangle = Triangle::new(a, a + direction, a + 0.5 * direction + across * 0.5f32.powi(width));
        let (u, v) = (weights.0, weights.1 * (1.0 - weights.0));
        let target = a + u * (triangle.b - a) + v * (triangle.c - a);
        let ray = Ray::new(origin, target - origin);
        fn check<K: TriangleKernel>(ray: &Ray, triangle: &Triangle) {
            if let Some(found) = hit::<K>(ray, triangle) {
                assert_is_found_again::<K>(ray, triangle, found);
            }
        }
        check::<MollerTrumbore>(&ray, &triangle);
        check::<Woop>(&ray, &triangle);
        check::<Exact>(&ray, &triangle);
    }

    /// Clear hits and misses are the same for all kernels, and t agrees to a few ulp.
    #[test]
    fn kernels_agree_away_from_edges(
        [a, b, c] in prop::array::uniform3(test_support::point(1.0)),
        origin in test_support::point(3.0),
        weights in (-1.0f32..2.0, -1.0f32..2.0),
    ) {
        let (u, v) = weights;
        let margin = [u, v, 1.0 - u - v].map(f32::abs).into_iter().fold(1.0, f32::min);
        let triangle = Triangle::new(a, b, c);
        let target = a + u * (b - a) + v * (c - a);
        let ray = Ray::new(origin, target - origin);
        let slant = triangle.scaled_normal().dot(ray.direction.as_dvec3()).abs();
        prop_assume!(ray.is_valid() && margin > 0.01 && slant > 0.01);
        let expected = u > 0.0 && v > 0.0 && u + v < 1.0;
        for hit in [hit::<MollerTrumbore>, hit::<Woop>, hit::<Exact>] {
            let found = hit(&ray, &triangle);
            prop_assert_eq!(found.is_some(), expected);
            if let Some(found) = found {
                prop_assert!((found.t - 1.0).abs() <= 1e-4, "{}", found.t);
                prop_assert!((found.u - u).abs() < 1e-3 && (found.v - v).abs() < 1e-3);
            }
        }
    }
}
