use std::cmp::Ordering;
use std::ops::Range;

use glam::Vec3;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

use super::*;
use crate::kernel::exact_block::tests::{assert_true_of_kernels, levels, scaled, scene, verdict};
use crate::kernel::one_ray::{BeforeRay, RayAlongAxis};
use crate::kernel::{BlockFilter, ExactBlockFilter};
use crate::oracle::Oracle;
use crate::predicate::compare_t;
use crate::simd::WithSimd;
use crate::test_support::{point, soup};
use crate::{
    Aabb, BruteForce, FusedRay, Precision, Ray, RayQuery, SurfacePoint, Triangle, TriangleBlock,
    size_of_bounds,
};

/// The lanes of a block that are said to be behind, whatever the interval of the ray.
struct Behind<'a>(ExactBlockFilter, &'a TriangleBlock);

impl WithSimd for Behind<'_> {
    type Output = u32;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> u32 {
        let Self(filter, block) = self;
        let sight = BeforeRay::new(simd, &filter, block);
        behind(simd, &Seen::new(simd, &sight), &sight)
    }
}

/// Checks what is said to be behind against exact comparisons; gives how many lanes are.
fn check(ray: &Ray, triangles: &[Triangle]) -> u32 {
    let block = TriangleBlock::new((0..).zip(triangles.iter().copied()));
    let bounds = triangles.iter().map(Triangle::aabb);
    let bounds = bounds.fold(Aabb::EMPTY, Aabb::union);
    let filter = ExactBlockFilter::new(ray, &FusedRay::new(ray, size_of_bounds(&bounds), 0.0));
    let mut found = 0;
    if filter.decides() {
        for level in levels() {
            found = level.dispatch(Behind(filter, &block));
            assert_eq!(found & !block.used(), 0, "no unused lane");
            for (lane, triangle) in triangles.iter().enumerate() {
                if found >> lane & 1 == 1 {
                    let order = compare_t(ray, triangle, 0.0);
                    let name = level.level();
                    assert_eq!(order, Some(Ordering::Less), "{name:?} {ray:?} {triangle:?}");
                }
            }
        }
    }
    found.count_ones()
}

/// Some roundings beside a number.
fn nudged(value: f32, steps: i8) -> f32 {
    let step = if steps < 0 {
        f32::next_down
    } else {
        f32::next_up
    };
    (0..steps.unsigned_abs()).fold(value, |value, _| step(value))
}

fn nudged_point(point: Vec3, steps: [i8; 3]) -> Vec3 {
    Vec3::from_array([0, 1, 2].map(|axis| nudged(point[axis], steps[axis])))
}

/// Triangles, the first of which may be moved into a plane along axes, and a ray that starts some roundings beside it: in any direction, along an edge, more or less, or along an axis.
pub(in crate::kernel) fn at_surface(
    sizes: Range<i32>,
) -> impl Strategy<Value = (Vec<Triangle>, Ray)> {
    let steps = || prop::array::uniform3(prop_oneof![3 => Just(0i8), 4 => -2i8..=2]);
    let flat = prop_oneof![Just(None), (0usize..3).prop_map(Some)];
    let weights = (0.0f32..1.0, 0.0f32..1.0);
    let directions = (0u8..4, point(1.0), -20i32..20, steps(), 0usize..3);
    (scene(sizes), flat, weights, steps(), directions).prop_map(
        |((mut triangles, _), flat, (u, v), beside, (kind, direction, power, turn, axis))| {
            let Triangle { a, b, c } = &mut triangles[0];
            if let Some(axis) = flat {
                b[axis] = a[axis];
                c[axis] = a[axis];
            }
            let (along, across) = (*b - *a, *c - *a);
            let (u, v) = if u + v > 1.0 {
                (1.0 - u, 1.0 - v)
            } else {
                (u, v)
            };
            let origin = nudged_point(*a + u * along + v * across, beside);
            let direction = match kind {
                0 => Vec3::AXES[axis] * direction,
                1 => nudged_point(along - u * across, turn),
                _ => scaled(direction, power),
            };
            (triangles, Ray::new(origin, direction))
        },
    )
}

fn is_tested(triangles: &[Triangle], ray: &Ray) -> bool {
    let mut vertices = triangles.iter().flat_map(Triangle::vertices);
    ray.is_valid() && vertices.all(Vec3::is_finite)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(10_000))]

    #[test]
    fn what_is_behind_is_met_before_the_origin(
        ordinary in at_surface(-12..12),
        any in at_surface(-148..120),
        small in at_surface(-40..-20),
        elsewhere in scene(-12..12),
    ) {
        for (triangles, ray) in [ordinary, any, small, elsewhere] {
            if is_tested(&triangles, &ray) {
                check(&ray, &triangles);
            }
        }
    }

    #[test]
    fn the_filter_is_right_about_rays_that_start_on_triangles(
        ordinary in at_surface(-12..12),
        any in at_surface(-148..120),
        t_max in 0.0f32..2.0,
    ) {
        for (triangles, ray) in [ordinary, any] {
            assert_true_of_kernels(&triangles, &ray, t_max);
        }
    }
}

/// How many levels throw out the triangle that a ray hits, for a ray that leaves it; `None` if it is not hit. Nothing is thrown out that the oracle sees hit.
fn thrown_out(
    triangles: &[Triangle],
    ray: &Ray,
    direction: Vec3,
    precision: Precision,
) -> Option<usize> {
    let mesh = soup(triangles.iter().map(Triangle::vertices).collect());
    let hit = BruteForce::new(&mesh, Precision::Exact).closest_hit(ray)?;
    let start = SurfacePoint::new(&hit, &triangles[hit.primitive as usize], precision);
    let ray = start.spawn_ray(direction);
    let hits = Oracle::new(&mesh).all_closed_hits(&ray);
    let possible = levels().map(|level| {
        let verdict = verdict::<ExactBlockFilter>(level, &ray, triangles, ray.t_max);
        verdict.map_or(0, |verdict| verdict.possible)
    });
    let possible: Vec<u32> = possible.collect();
    for hit in hits {
        let is_possible = possible.iter().all(|lanes| lanes >> hit.triangle & 1 == 1);
        assert!(is_possible, "{ray:?} {triangles:?}");
    }
    Some(
        possible
            .iter()
            .filter(|lanes| **lanes >> hit.primitive & 1 == 0)
            .count(),
    )
}

#[test]
fn rays_that_leave_a_surface_lose_no_hit() {
    let mut runner = TestRunner::deterministic();
    let precision = prop::sample::select(vec![Precision::Exact, Precision::Fast]);
    let scenes = (scene(-12..12), point(1.0), precision);
    for _ in 0..1000 {
        let ((triangles, ray), direction, precision) =
            scenes.new_tree(&mut runner).expect("a scene").current();
        thrown_out(&triangles, &ray, direction, precision);
    }
}

/// In places that are many extents of the triangle from zero, as most of a scene is: near zero positions are rounded less than differences.
#[test]
fn the_triangle_that_a_ray_starts_on_is_thrown_out() {
    let [mut rays, mut decided] = [0; 2];
    let mut runner = TestRunner::deterministic();
    let precision = prop::sample::select(vec![Precision::Exact, Precision::Fast]);
    let scenes = (
        prop::array::uniform3(point(1.0)),
        point(32.0),
        point(1.0),
        point(1.0),
        precision,
    );
    for _ in 0..1000 {
        let (shape, place, from, direction, precision) =
            scenes.new_tree(&mut runner).expect("a scene").current();
        let [a, b, c] = shape.map(|corner| corner + place);
        let triangle = Triangle::new(a, b, c);
        let origin = place + 4.0 * from;
        let ray = Ray::new(origin, (a + b + c) / 3.0 - origin);
        if let Some(levels) = thrown_out(&[triangle], &ray, direction, precision) {
            rays += 1;
            decided += usize::from(levels == self::levels().count());
        }
    }
    // Needles are too thin for it.
    assert!(rays > 900 && decided * 10 > rays * 9, "{decided} of {rays}");
}

/// Volumes of small triangles underflow.
#[test]
fn what_is_behind_is_so_where_volumes_underflow() {
    let mut runner = TestRunner::deterministic();
    let scenes = (at_surface(-12..0), -60i32..-20, 0i32..20);
    let mut found = 0;
    for _ in 0..20_000 {
        let ((triangles, ray), power, longer) =
            scenes.new_tree(&mut runner).expect("a scene").current();
        let smaller = |point: Vec3| scaled(point, power);
        let triangles: Vec<Triangle> = triangles
            .iter()
            .map(|triangle| {
                let [a, b, c] = triangle.vertices().map(smaller);
                Triangle::new(a, b, c)
            })
            .collect();
        let ray = Ray::new(smaller(ray.origin), scaled(ray.direction, longer));
        if is_tested(&triangles, &ray) {
            found += check(&ray, &triangles);
        }
    }
    assert!(found > 500, "{found}");
}

/// Depths along a long direction that have few digits as a `t`, or none.
#[test]
fn what_is_behind_is_so_where_depths_underflow() {
    let mut runner = TestRunner::deterministic();
    let depth = (-9i8..=9).prop_map(|depth| scaled(f32::from(depth) * Vec3::Z, -130));
    let corner =
        (point(1.0), depth).prop_map(|(corner, depth)| corner * (Vec3::X + Vec3::Y) + depth);
    let scenes = (prop::array::uniform3(corner), -4i32..12, 1.0f32..1.9);
    let across =
        |point: Vec3, power: i32| scaled(point, power) * (Vec3::X + Vec3::Y) + point * Vec3::Z;
    for _ in 0..20_000 {
        let (corners, power, length) = scenes.new_tree(&mut runner).expect("a scene").current();
        let [a, b, c] = corners.map(|corner| across(corner, power));
        let direction = scaled(length * Vec3::Z, 19);
        for direction in [direction, -direction] {
            check(&Ray::new(Vec3::ZERO, direction), &[Triangle::new(a, b, c)]);
        }
    }
}

#[test]
fn nothing_behind_is_thrown_out_where_the_interval_begins_there() {
    let triangle = Triangle::new(Vec3::NEG_X, Vec3::X, Vec3::new(0.0, 1.0, 0.1));
    let ray = Ray::new(Vec3::new(0.1, 0.2, 1.0), Vec3::new(0.0, 0.01, 0.5));
    for level in levels() {
        for (t_min, possible) in [(0.0, 0), (-1.0, 0), (-3.0, 7)] {
            let ray = Ray { t_min, ..ray };
            let verdict = verdict::<ExactBlockFilter>(level, &ray, &[triangle; 3], ray.t_max);
            assert_eq!(verdict.map_or(0, |verdict| verdict.possible), possible);
        }
    }
}
