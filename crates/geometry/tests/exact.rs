//! The exact kernel and the predicates against the oracle, on numbers of every size and on cases that cancel.

use std::cmp::Ordering;

use proptest::prelude::*;
use tahko_geometry::glam::{DVec3, Vec3};
use tahko_geometry::oracle::{Oracle, RBig};
use tahko_geometry::predicate::{self, Sign};
use tahko_geometry::test_support::{grid_point, point, soup};
use tahko_geometry::{BruteForce, Hit, Precision, Ray, RayQuery, Triangle, TriangleMesh};

/// A finite f32 of any exponent, denormals and zeros of both signs among them.
fn any_finite() -> impl Strategy<Value = f32> {
    any::<u32>()
        .prop_map(f32::from_bits)
        .prop_filter("finite", |value| value.is_finite())
}

fn wild_point() -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(any_finite()).prop_map(Vec3::from)
}

/// Points among which coincidences are common: on a grid, in a small box, anywhere, or on a grid of some power of two.
fn any_point() -> impl Strategy<Value = Vec3> {
    #[expect(clippy::cast_possible_truncation, reason = "rounds to the nearest f32")]
    let scaled = (grid_point(), -140i32..120).prop_map(|(point, power)| {
        point
            .as_dvec3()
            .to_array()
            .map(|value| (value * 2f64.powi(power)) as f32)
            .into()
    });
    prop_oneof![3 => grid_point(), 2 => point(2.0), 1 => wild_point(), 1 => scaled]
}

fn triangle() -> impl Strategy<Value = Triangle> {
    prop::array::uniform3(any_point()).prop_map(|[a, b, c]| Triangle::new(a, b, c))
}

/// A ray through a point, or a point near it, of one of the triangles: where decisions are hard.
fn ray_at(triangles: &[Triangle]) -> BoxedStrategy<Ray> {
    let targets: Vec<Vec3> = triangles
        .iter()
        .flat_map(|Triangle { a, b, c }| {
            [
                *a,
                *b,
                *c,
                a.midpoint(*b),
                b.midpoint(*c),
                (*a + *b + *c) / 3.0,
                *a * 0.75 + *b * 0.25,
            ]
        })
        .filter(|target| target.is_finite())
        .collect();
    let target = prop_oneof![4 => prop::sample::select(targets), 1 => any_point()];
    let interval = prop_oneof![
        4 => Just((0.0, f32::INFINITY)),
        1 => Just((f32::NEG_INFINITY, f32::INFINITY)),
        1 => Just((0.0, 1.0)),
        1 => Just((1.0, 1.0)),
        1 => (-2.0f32..2.0, 0.0f32..2.0).prop_map(|(start, length)| (start, start + length)),
    ];
    let nudge = prop_oneof![3 => Just([0i8; 3]), 1 => prop::array::uniform3(-1i8..=1)];
    (any_point(), target, nudge, interval, any::<bool>())
        .prop_map(|(origin, target, nudge, (t_min, t_max), is_along_axis)| {
            let mut direction = target - origin;
            for axis in 0..3 {
                direction[axis] = match nudge[axis] {
                    1 => direction[axis].next_up(),
                    -1 => direction[axis].next_down(),
                    _ => direction[axis],
                };
            }
            if is_along_axis {
                let axis = usize::from(nudge[0].unsigned_abs());
                direction = Vec3::ZERO;
                direction[axis] = if nudge[1] < 0 { -1.0 } else { 1.0 };
                let mut start = target;
                start[axis] = origin[axis];
                return Ray::with_interval(start, direction, t_min, t_max);
            }
            Ray::with_interval(origin, direction, t_min, t_max)
        })
        .boxed()
}

/// Separate triangles, or triangles that share edges and vertices.
fn triangles() -> impl Strategy<Value = Vec<Triangle>> {
    let connected = (
        prop::array::uniform5(any_point()),
        prop::collection::vec(prop::array::uniform3(0usize..5), 1..6),
    )
        .prop_map(|(points, indices)| {
            let corners = indices
                .iter()
                .map(|indices| indices.map(|index| points[index]));
            corners.map(|[a, b, c]| Triangle::new(a, b, c)).collect()
        });
    prop_oneof![prop::collection::vec(triangle(), 1..6), connected]
}

fn triangles_and_ray() -> impl Strategy<Value = (Vec<Triangle>, Ray)> {
    triangles().prop_flat_map(|triangles| {
        let ray = ray_at(&triangles);
        (Just(triangles), ray)
    })
}

fn mesh_of(triangles: &[Triangle]) -> TriangleMesh {
    soup(triangles.iter().map(Triangle::vertices).collect())
}

/// What a structure has to answer: the primitive, and `t` correctly rounded.
fn of_hit(hit: Hit) -> (u32, u32) {
    assert!(hit.u >= 0.0 && hit.v >= 0.0, "{hit:?}");
    assert!(f64::from(hit.u) + f64::from(hit.v) <= 1.0, "{hit:?}");
    (hit.primitive, hit.t.to_bits())
}

fn sign_of(value: &RBig) -> Sign {
    match value.cmp(&RBig::ZERO) {
        Ordering::Less => Sign::Negative,
        Ordering::Equal => Sign::Zero,
        Ordering::Greater => Sign::Positive,
    }
}

type ExactVector = [RBig; 3];

fn minus(a: Vec3, b: Vec3) -> ExactVector {
    let exact = |value: f32| RBig::try_from(value).expect("finite");
    [0, 1, 2].map(|axis| exact(a[axis]) - exact(b[axis]))
}

fn triple_product(a: &ExactVector, b: &ExactVector, c: &ExactVector) -> RBig {
    let cross = [(1, 2), (2, 0), (0, 1)].map(|(i, j)| &b[i] * &c[j] - &b[j] * &c[i]);
    &a[0] * &cross[0] + &a[1] * &cross[1] + &a[2] * &cross[2]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(
        std::env::var("PROPTEST_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(2000)
    ))]

    #[test]
    fn closest_hits_are_those_of_the_oracle((triangles, ray) in triangles_and_ray()) {
        let mesh = mesh_of(&triangles);
        let oracle = Oracle::new(&mesh);
        let structure = BruteForce::new(&mesh, Precision::Exact);
        let expected = oracle.closest_hit(&ray);
        let found = structure.closest_hit(&ray);
        prop_assert_eq!(
            found.map(of_hit),
            expected.as_ref().map(|hit| (hit.triangle, hit.rounded_t().to_bits())),
            "{:?}", ray
        );
        prop_assert_eq!(structure.any_hit(&ray), expected.is_some());
        if let (Some(found), Some(expected)) = (found, expected) {
            for (weight, exact) in [(found.u, &expected.u), (found.v, &expected.v)] {
                let error = f64::from(weight) - exact.to_f64().value();
                prop_assert!(error.abs() < 1.2e-7, "{} is not {}", weight, exact);
            }
            let expected = oracle.closest_hit_ignoring(&ray, found.primitive);
            let found = structure.closest_hit_ignoring(&ray, found.primitive);
            prop_assert_eq!(
                found.map(of_hit),
                expected.map(|hit| (hit.triangle, hit.rounded_t().to_bits()))
            );
        }
    }

    #[test]
    fn crossings_are_those_of_the_oracle((triangles, ray) in triangles_and_ray()) {
        let mesh = mesh_of(&triangles);
        let structure = BruteForce::new(&mesh, Precision::Fast);
        let mut found = Vec::new();
        structure.all_hits(&ray, &mut |hit| {
            found.push(of_hit(hit));
            std::ops::ControlFlow::Continue(())
        });
        let expected = Oracle::new(&mesh).crossings(&ray);
        let expected: Vec<_> = expected.iter().map(|hit| (hit.triangle, hit.rounded_t().to_bits())).collect();
        prop_assert_eq!(&found, &expected);
        prop_assert_eq!(structure.crossings(&ray), expected.len());
    }

    #[test]
    fn signs_are_exact([a, b, c, origin] in prop::array::uniform4(any_point()), direction in any_point()) {
        let triangle = Triangle::new(a, b, c);
        let ray = Ray::new(origin, direction);
        let (edge1, edge2) = (minus(b, a), minus(c, a));
        let exact_direction = minus(direction, Vec3::ZERO);
        let edge = triple_product(&exact_direction, &minus(a, origin), &minus(b, origin));
        prop_assert_eq!(predicate::edge_side(&ray, a, b), sign_of(&edge));
        let determinant = triple_product(&exact_direction, &edge1, &edge2);
        prop_assert_eq!(predicate::direction_side(direction, &triangle), sign_of(&determinant));
        let height = triple_product(&minus(origin, a), &edge1, &edge2);
        prop_assert_eq!(predicate::point_side(origin, &triangle), sign_of(&height));
        let axes = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| triple_product(&minus(axis, Vec3::ZERO), &edge1, &edge2));
        prop_assert_eq!(triangle.is_degenerate(), axes.iter().all(|part| *part == RBig::ZERO));
        prop_assert_eq!(triangle.scaled_normal() == DVec3::ZERO, triangle.is_degenerate());
    }

    #[test]
    fn orders_along_a_ray_are_exact((triangles, ray) in triangles_and_ray(), t in any_finite()) {
        let exact_t = |triangle: &Triangle| {
            let (edge1, edge2) = (minus(triangle.b, triangle.a), minus(triangle.c, triangle.a));
            let determinant = triple_product(&minus(ray.direction, Vec3::ZERO), &edge1, &edge2);
            (determinant != RBig::ZERO)
                .then(|| triple_product(&minus(triangle.a, ray.origin), &edge1, &edge2) / determinant)
        };
        prop_assume!(ray.is_valid());
        let first = exact_t(&triangles[0]);
        for second in &triangles {
            let expected = first.as_ref().zip(exact_t(second)).map(|(first, second)| first.cmp(&second));
            prop_assert_eq!(predicate::compare_hits(&ray, &triangles[0], second), expected);
        }
        for t in [t, 0.0, 1.0, -1.0, 0.5] {
            let expected = first.as_ref().map(|first| first.cmp(&RBig::try_from(t).expect("finite")));
            prop_assert_eq!(predicate::compare_t(&ray, &triangles[0], t), expected);
        }
    }
}

#[test]
fn a_hit_at_the_very_end_of_the_interval_is_decided_by_the_exact_t() {
    // t = 1/3, whose nearest f32 is above it.
    let mesh = soup(vec![[Vec3::ZERO, Vec3::X, Vec3::Y]]);
    let structure = BruteForce::new(&mesh, Precision::Exact);
    let third = 1.0f32 / 3.0;
    let at = |t_min, t_max| {
        let ray = Ray::with_interval(Vec3::new(0.25, 0.25, 1.0), Vec3::NEG_Z * 3.0, t_min, t_max);
        structure.closest_hit(&ray).map(|hit| hit.t)
    };
    assert_eq!(at(0.0, third), Some(third), "1/3 is below its f32");
    assert_eq!(at(0.0, third.next_down()), None);
    assert_eq!(at(third, 1.0), None);
    assert_eq!(at(third.next_down(), 1.0), Some(third));
}

#[test]
fn a_t_beyond_the_largest_number_is_a_hit_at_the_largest_number() {
    let mesh = soup(vec![
        [Vec3::ZERO, Vec3::X, Vec3::Y],
        [
            Vec3::Z * 2.0,
            Vec3::X + Vec3::Z * 2.0,
            Vec3::Y + Vec3::Z * 2.0,
        ],
    ]);
    let structure = BruteForce::new(&mesh, Precision::Exact);
    let tiny = f32::from_bits(1);
    let ray = Ray::new(Vec3::new(0.25, 0.25, 3.0), Vec3::NEG_Z * tiny);
    let hit = structure
        .closest_hit(&ray)
        .expect("both are ahead, at 2^149 and more");
    assert_eq!((hit.t, hit.primitive), (f32::MAX, 1));
    let until_largest = Ray {
        t_max: f32::MAX,
        ..ray
    };
    assert_eq!(
        structure.closest_hit(&until_largest),
        None,
        "its t is larger"
    );
}
