use glam::DVec3;
use proptest::prelude::*;

use super::*;
use crate::test_support;

/// Two equal triangles.
fn twins() -> Oracle {
    let mesh = TriangleMesh::new(
        vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        vec![[0, 1, 2], [0, 1, 2]],
    );
    Oracle::new(&mesh.unwrap())
}

/// The cube from 0 to 1: two triangles per face, winding outwards.
fn cube() -> TriangleMesh {
    let vertex = |corner: u8| Vec3::from([0, 1, 2].map(|axis| f32::from(corner >> axis & 1)));
    let faces = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let indices = faces
        .iter()
        .flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
    TriangleMesh::new((0..8).map(vertex).collect(), indices.collect()).unwrap()
}

fn down(x: f32, y: f32) -> Ray {
    Ray::new(Vec3::new(x, y, 1.0), Vec3::NEG_Z)
}

fn ratio(numerator: i64, denominator: u64) -> RBig {
    RBig::from_parts(numerator.into(), denominator.into())
}

#[test]
fn edges_belong_to_the_triangle_and_one_step_beyond_is_a_miss() {
    let oracle = twins();
    for (x, y, is_hit) in [
        (0.5, 0.5, true),
        (0.5f32.next_up(), 0.5, false),
        (0.0, 0.0, true),
        (-f32::MIN_POSITIVE, 0.0, false),
        (-f32::from_bits(1), 0.5, false),
        (1.0, 0.0, true),
        (1.0, f32::from_bits(1), false),
    ] {
        let ray = down(x, y);
        assert_eq!(oracle.closest_hit(&ray).is_some(), is_hit, "{x} {y}");
        assert_eq!(
            oracle.all_closed_hits(&ray).len(),
            2 * usize::from(is_hit),
            "{x} {y}"
        );
    }
}

#[test]
fn a_hit_is_worked_out_by_hand() {
    let ray = Ray::new(Vec3::new(0.5, 0.125, -7.0), Vec3::new(0.0, 0.25, 3.0));
    // t = 7/3, y = 1/8 + 7/12 = 17/24: beyond x + y = 1.
    assert_eq!(twins().closest_hit(&ray), None);
    let ray = Ray::new(Vec3::new(0.25, 0.125, -7.0), Vec3::new(0.0, 0.25, 3.0));
    let hit = |triangle| ExactHit {
        t: ratio(7, 3),
        u: ratio(1, 4),
        v: ratio(17, 24),
        triangle,
    };
    assert_eq!(twins().all_closed_hits(&ray), [hit(0), hit(1)]);
    assert_eq!(twins().closest_hit(&ray), Some(hit(0)));
    assert_eq!(twins().closest_hit_ignoring(&ray, 0), Some(hit(1)));
    assert_eq!(twins().closest_hit_ignoring(&ray, 7), Some(hit(0)));
    assert_eq!(hit(0).rounded_t(), 7.0 / 3.0);
}

#[test]
fn the_interval_is_closed_and_may_be_infinite_or_have_no_finite_point() {
    let (before, after) = (1.0f32.next_down(), 1.0f32.next_up());
    let (none, infinity) = (f32::NEG_INFINITY, f32::INFINITY);
    for (t_min, t_max, is_hit) in [
        (0.0, 1.0, true),
        (1.0, 1.0, true),
        (1.0, infinity, true),
        (none, infinity, true),
        (none, 1.0, true),
        (none, before, false),
        (after, infinity, false),
        (infinity, infinity, false),
        (none, none, false),
        (after, before, false),
    ] {
        let ray = Ray::with_interval(Vec3::new(0.2, 0.2, 1.0), Vec3::NEG_Z, t_min, t_max);
        assert_eq!(
            twins().closest_hit(&ray).is_some(),
            is_hit,
            "{t_min} {t_max}"
        );
    }
    // From behind: t = -1/3 is between the two f32 numbers around it.
    let ray = |t_min| Ray::with_interval(Vec3::new(0.2, 0.2, 1.0), Vec3::Z * 3.0, t_min, 0.0);
    let third = round_to_f32(&ratio(-1, 3));
    let (below, above) = if f64::from(third) * 3.0 < -1.0 {
        (third, third.next_up())
    } else {
        (third.next_down(), third)
    };
    assert_eq!(twins().all_closed_hits(&ray(below)).len(), 2);
    assert_eq!(twins().all_closed_hits(&ray(above)).len(), 0);
}

#[test]
fn invalid_rays_hit_nothing() {
    for ray in test_support::invalid_rays(down(0.25, 0.25)) {
        assert_eq!(twins().closest_hit(&ray), None, "{ray:?}");
        assert_eq!(twins().all_closed_hits(&ray), [], "{ray:?}");
        assert_eq!(twins().crossings(&ray), [], "{ray:?}");
    }
    let nothing = Oracle::new(&TriangleMesh::default());
    assert_eq!(nothing.closest_hit(&down(0.0, 0.0)), None);
    assert!(!nothing.contains(Vec3::ZERO), "empty");
}

#[test]
fn rays_in_the_plane_and_triangles_without_area_never_hit() {
    let along = Ray::new(Vec3::new(-1.0, 0.25, 0.0), Vec3::X);
    assert_eq!(twins().closest_hit(&along), None);
    let oblique = Ray::new(Vec3::new(-1.0, -0.7, 0.0), Vec3::new(1.3, 1.1, 0.0));
    assert_eq!(twins().closest_hit(&oblique), None);
    let segment = test_support::soup(vec![[Vec3::ZERO, Vec3::X, Vec3::X * 2.0], [Vec3::X; 3]]);
    let through = Ray::new(Vec3::new(1.0, 0.0, 1.0), Vec3::NEG_Z);
    assert_eq!(Oracle::new(&segment).closest_hit(&through), None);
}

#[test]
fn the_largest_and_the_smallest_numbers_are_numbers_like_others() {
    let tiny = f32::from_bits(1);
    // A right triangle with legs of the smallest length, 2^-149, hit at half of it from the largest distance.
    let small = test_support::soup(vec![[Vec3::ZERO, Vec3::X * tiny, Vec3::Y * tiny]]);
    let ray = Ray::new(Vec3::new(tiny, 0.0, f32::MAX), Vec3::NEG_Z);
    let hit = Oracle::new(&small).closest_hit(&ray).unwrap();
    assert_eq!(
        [hit.t, hit.u, hit.v],
        [RBig::try_from(f32::MAX).unwrap(), RBig::ONE, RBig::ZERO]
    );
    let beside = Ray::new(Vec3::new(tiny, tiny, f32::MAX), Vec3::NEG_Z);
    assert_eq!(Oracle::new(&small).closest_hit(&beside), None);

    // t = 2 * MAX / tiny, far beyond f32.
    let max = f32::MAX;
    let corners = [
        Vec3::new(-max, -max, -max),
        Vec3::new(max, -max, -max),
        Vec3::new(-max, max, -max),
    ];
    let large = Oracle::new(&test_support::soup(vec![corners]));
    let slow = Ray::new(Vec3::new(0.0, 0.0, max), Vec3::NEG_Z * tiny);
    let hit = large.closest_hit(&slow).unwrap();
    assert_eq!((hit.u, hit.v), (ratio(1, 2), ratio(1, 2)));
    assert_eq!(
        hit.t,
        RBig::try_from(max).unwrap() * ratio(2, 1) / RBig::try_from(tiny).unwrap()
    );
    assert_eq!(round_to_f32(&hit.t), f32::MAX);
    let slow = Ray {
        origin: Vec3::new(tiny, 0.0, max),
        ..slow
    };
    assert_eq!(large.closest_hit(&slow), None);
}

#[test]
fn rays_through_edges_and_vertices_of_a_closed_mesh_cross_it_twice_or_never() {
    let mesh = cube();
    let oracle = Oracle::new(&mesh);
    let steps = || (-2i8..=6).map(|step| f32::from(step) / 4.0);
    for (x, y) in steps().flat_map(|x| steps().map(move |y| (x, y))) {
        let inside = |value: f32| value > 0.0 && value < 1.0;
        let outside = |value: f32| !(0.0..=1.0).contains(&value);
        for direction in [Vec3::Z, Vec3::new(0.0, 1.0, 1.0), Vec3::new(-1.0, 1.0, 1.0)] {
            let ray = Ray::new(Vec3::new(x, y, 0.5) - direction * 4.0, direction);
            let crossings = oracle.crossings(&ray);
            let distinct = |pair: &[ExactHit]| pair[0].t < pair[1].t;
            assert!(
                crossings.is_empty() || crossings.len() == 2,
                "{x} {y} {direction}: {crossings:?}"
            );
            if inside(x) && inside(y) {
                assert!(
                    crossings.len() == 2 && distinct(&crossings),
                    "{x} {y} {direction}"
                );
            }
            if direction == Vec3::Z && (outside(x) || outside(y)) {
                assert!(crossings.is_empty(), "{x} {y}");
            }
        }
    }
}

#[test]
fn a_point_is_inside_outside_or_on_the_surface() {
    let oracle = Oracle::new(&cube());
    let steps = || (-1i8..=5).map(|step| f32::from(step) / 4.0);
    for x in steps() {
        for (y, z) in steps().flat_map(|y| steps().map(move |z| (y, z))) {
            let expected = [x, y, z].iter().all(|value| (0.0..=1.0).contains(value));
            assert_eq!(oracle.contains(Vec3::new(x, y, z)), expected, "{x} {y} {z}");
        }
    }
    assert!(
        !oracle.contains(Vec3::new(0.5, 0.5, 1.0f32.next_up())),
        "one step outside"
    );
    assert!(
        !oracle.contains(Vec3::new(0.5, 0.5, -f32::from_bits(1))),
        "one step outside"
    );
    assert!(
        !oracle.contains(Vec3::new(0.5, f32::NAN, 0.5)),
        "not finite"
    );
    assert!(
        !oracle.contains(Vec3::new(0.5, f32::INFINITY, 0.5)),
        "not finite"
    );
}

/// The crossings by a step that is small but not infinitesimal.
fn crosses_after_step(ray: &Ray, corners: &[DVec3; 3]) -> bool {
    let step = 2.0f64.powi(-40);
    let shift = DVec3::new(step, step * step, step * step * step);
    // In one go in rationals: the sum does not fit f64.
    ExactRay::new(ray)
        .unwrap()
        .moved_by(&exact_vector(shift))
        .hit(&ExactTriangle::new(corners))
        .is_some()
}

fn scaled(mesh: &TriangleMesh, scale: f32) -> Option<TriangleMesh> {
    let vertices = mesh.vertices().iter().map(|vertex| *vertex * scale);
    TriangleMesh::new(vertices.collect(), mesh.indices().to_vec()).ok()
}

/// All hits without groups and filter.
fn brute_force(mesh: &TriangleMesh, ray: &Ray) -> Vec<ExactHit> {
    let Some(exact) = ExactRay::new(ray) else {
        return Vec::new();
    };
    let hits = (0u32..)
        .zip(mesh.triangles())
        .filter_map(|(triangle, corners)| {
            let corners = corners.vertices().map(Vec3::as_dvec3);
            let [t, u, v] = exact.hit(&ExactTriangle::new(&corners))?;
            Some(ExactHit { t, u, v, triangle })
        });
    let mut hits: Vec<_> = hits.collect();
    hits.sort_by(|a, b| (&a.t, a.triangle).cmp(&(&b.t, b.triangle)));
    hits
}

fn check_against_brute_force(mesh: &TriangleMesh, rays: &[Ray]) {
    let oracle = Oracle::new(mesh);
    for ray in rays {
        let expected = brute_force(mesh, ray);
        let hits = oracle.all_closed_hits(ray);
        assert_eq!(hits, expected, "{ray:?} {mesh:?}");
        assert_eq!(
            oracle.closest_hit(ray).as_ref(),
            hits.first(),
            "{ray:?} {mesh:?}"
        );
        let Some(first) = hits.first() else { continue };
        let second = hits.iter().find(|hit| hit.triangle != first.triangle);
        assert_eq!(
            oracle.closest_hit_ignoring(ray, first.triangle).as_ref(),
            second,
            "{ray:?}"
        );
    }
}

#[test]
fn groups_of_groups_lose_nothing_on_degenerate_meshes() {
    for (_, mesh) in test_support::degenerate_meshes() {
        let rays = test_support::rays_at_features(&mesh).into_iter().step_by(7);
        let axes = test_support::rays_along_axes(&mesh).into_iter().step_by(11);
        check_against_brute_force(&mesh, &rays.chain(axes).collect::<Vec<_>>());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn groups_and_filter_change_no_answer(
        mesh in test_support::mesh(),
        rays in prop::collection::vec(test_support::ray(), 1..8),
        exponent in prop::sample::select(vec![-149, -140, -60, 0, 0, 0, 60, 125]),
    ) {
        #[expect(clippy::cast_possible_truncation, reason = "a power of two that f32 has")]
        let scale = 2.0f64.powi(exponent) as f32;
        let Some(mesh) = scaled(&mesh, scale) else { return Ok(()) };
        let scaled = rays.iter().map(|ray| Ray { origin: ray.origin * scale, ..*ray });
        check_against_brute_force(&mesh, &scaled.collect::<Vec<_>>());
    }

    #[test]
    fn aimed_rays_are_filtered_right(mesh in test_support::mesh(), offset in test_support::point(1e6)) {
        let vertices = mesh.vertices().iter().map(|vertex| *vertex + offset);
        let mesh = TriangleMesh::new(vertices.collect(), mesh.indices().to_vec()).unwrap();
        let rays = test_support::rays_at_features(&mesh).into_iter().step_by(29);
        check_against_brute_force(&mesh, &rays.collect::<Vec<_>>());
    }

    #[test]
    fn rounding_gives_the_nearest_number(
        numerator in any::<i64>(),
        denominator in 1..=u64::MAX,
        exponent in -200i32..200,
    ) {
        let power = |exponent: i32| RBig::try_from(2.0f64.powi(exponent)).unwrap();
        let exact = ratio(numerator, denominator) * power(exponent);
        let rounded = round_to_f32(&exact);
        let error = |t: f32| error_in_ulps(t, &exact);
        prop_assert!(error(rounded) <= 0.5, "{rounded}");
        for other in [rounded.next_up(), rounded.next_down()] {
            prop_assert!(error(rounded) <= error(other), "{rounded} {other}");
        }
    }
}

#[test]
fn rounding_goes_to_even_saturates_and_knows_denormals() {
    let value = |t: f32| RBig::try_from(t).unwrap();
    let (one, tiny) = (1.0f32, f32::from_bits(1));
    let between = |a: f32, b: f32| (value(a) + value(b)) / ratio(2, 1);
    assert_eq!(round_to_f32(&between(one, one.next_up())), one);
    let odd = one.next_up();
    assert_eq!(round_to_f32(&between(odd, odd.next_up())), odd.next_up());
    assert_eq!(round_to_f32(&between(tiny, 2.0 * tiny)), 2.0 * tiny);
    assert_eq!(round_to_f32(&between(2.0 * tiny, 3.0 * tiny)), 2.0 * tiny);
    let negligible = -value(tiny) / ratio(2, 1);
    assert_eq!(round_to_f32(&negligible).to_bits(), 0, "not -0");
    assert_eq!(
        round_to_f32(&(-value(tiny) / ratio(1, 3) * ratio(1, 5))),
        -tiny
    );
    let beyond = value(f32::MAX) * ratio(3, 1);
    assert_eq!(round_to_f32(&beyond), f32::MAX);
    assert_eq!(round_to_f32(&-beyond.clone()), f32::MIN);
    assert_eq!(error_in_ulps(f32::MAX, &beyond), 0.0);
    assert_eq!(error_in_ulps(f32::MAX.next_down(), &beyond), 1.0);
    assert_eq!(error_in_ulps(f32::INFINITY, &beyond), f64::INFINITY);
    assert_eq!(error_in_ulps(f32::NAN, &beyond), f64::INFINITY);
    assert_eq!(error_in_ulps(tiny, &RBig::ZERO), 1.0);
    assert_eq!(error_in_ulps(one.next_up(), &RBig::ONE), 1.0);
    assert_eq!(error_in_ulps(-one, &between(-one, -one.next_up())), 0.5);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4096))]

    #[test]
    fn an_infinitesimal_step_is_the_limit_of_small_steps(
        corners in prop::array::uniform3(test_support::grid_point()),
        origin in test_support::grid_point(),
        target in test_support::grid_point(),
    ) {
        let ray = Ray::with_interval(origin, target - origin, f32::NEG_INFINITY, f32::INFINITY);
        prop_assume!(ray.is_valid());
        let mesh = test_support::soup(vec![corners]);
        let crosses = !Oracle::new(&mesh).crossings(&ray).is_empty();
        prop_assert_eq!(crosses, crosses_after_step(&ray, &corners.map(Vec3::as_dvec3)));
    }
}
