use std::cmp::Ordering;
use std::ops::Range;

use glam::{Vec3, Vec3A};
use proptest::prelude::*;

use super::*;
use crate::kernel::{Exact, ExactCrossing, MollerTrumbore, ReachBlockFilter, Woop};
use crate::predicate::compare_t;
use crate::simd::{AvailableSimd, LANES, Portable, SimdLevel, WithSimd};
use crate::test_support::{grid_point, point};
use crate::{Aabb, Triangle, TriangleKernel, size_of_bounds};

struct Test<'a, F> {
    filter: F,
    block: &'a TriangleBlock,
    t_max: f32,
}

impl<F: BlockFilter> WithSimd for Test<'_, F> {
    type Output = Option<BlockVerdict>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Option<BlockVerdict> {
        self.filter.test(simd, self.block, self.t_max)
    }
}

/// What is left by the step without a branch, and what the next one says of it.
struct InSteps<'a, F>(Test<'a, F>);

impl<F: BlockFilter> WithSimd for InSteps<'_, F> {
    type Output = (Candidates, Option<BlockVerdict>);

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self(Test {
            filter,
            block,
            t_max,
        }) = self;
        let candidates = filter.candidates(simd, block, t_max);
        let possible = filter.possible(simd, block, t_max);
        assert_eq!(candidates.possible, possible, "asked in two ways");
        if possible == 0 {
            return (candidates, None);
        }
        let judged = filter.judge(simd, block, t_max, possible);
        (candidates, judged)
    }
}

pub(in crate::kernel) fn levels() -> impl Iterator<Item = AvailableSimd> {
    SimdLevel::ALL.into_iter().filter_map(SimdLevel::available)
}

/// What the filter says at a level of triangles of a structure that has just these.
pub(in crate::kernel) fn verdict<F: BlockFilter>(
    level: AvailableSimd,
    ray: &Ray,
    triangles: &[Triangle],
    t_max: f32,
) -> Option<BlockVerdict> {
    let block = block(triangles);
    level.dispatch(Test {
        filter: filter::<F>(ray, triangles),
        block: &block,
        t_max,
    })
}

/// What it leaves and says in two steps.
fn in_steps<F: BlockFilter>(
    level: AvailableSimd,
    ray: &Ray,
    triangles: &[Triangle],
    t_max: f32,
) -> (Candidates, Option<BlockVerdict>) {
    let block = block(triangles);
    level.dispatch(InSteps(Test {
        filter: filter::<F>(ray, triangles),
        block: &block,
        t_max,
    }))
}

fn block(triangles: &[Triangle]) -> TriangleBlock {
    TriangleBlock::new((0..).zip(triangles.iter().copied()))
}

/// The filter of a ray in a structure that has just these triangles.
fn filter<F: BlockFilter>(ray: &Ray, triangles: &[Triangle]) -> F {
    let bounds = triangles.iter().map(Triangle::aabb);
    let bounds = bounds.fold(Aabb::EMPTY, Aabb::union);
    F::new(ray, &FusedRay::new(ray, size_of_bounds(&bounds), 0.0))
}

/// Checks what a filter says of a lane against both exact kernels and exact comparisons.
pub(in crate::kernel) fn check_lane(
    ray: &Ray,
    triangle: &Triangle,
    t_max: f32,
    (verdict, lane): (Option<BlockVerdict>, usize),
) -> Result<(), String> {
    let (exact, crossing) = (Exact::new(ray), ExactCrossing::new(ray));
    let is_hit = |t_max: f32| {
        [
            exact.intersect(triangle, t_max, &mut ()).is_some(),
            crossing.intersect(triangle, t_max, &mut ()).is_some(),
        ]
    };
    let bit = |bits: u32| bits >> lane & 1 == 1;
    let Some(verdict) = verdict.filter(|verdict| bit(verdict.possible)) else {
        if is_hit(t_max) != [false; 2] {
            return Err(format!("{triangle:?}: a hit is thrown out"));
        }
        return Ok(());
    };
    if !bit(verdict.certain) {
        return Ok(());
    }
    if is_hit(f32::INFINITY) != [true; 2] {
        return Err(format!("{triangle:?}: certain, and no hit"));
    }
    let (start, end) = (verdict.starts.0[lane], verdict.ends.0[lane]);
    let is_from_start = compare_t(ray, triangle, start).is_some_and(Ordering::is_ge);
    let is_to_end = compare_t(ray, triangle, end).is_some_and(Ordering::is_le);
    if !is_from_start || !is_to_end || start <= ray.t_min || end >= ray.t_max {
        let hit = exact.intersect(triangle, f32::INFINITY, &mut ());
        return Err(format!(
            "{triangle:?}: {hit:?} is not inside [{start}, {end}]"
        ));
    }
    Ok(())
}

/// Checks a triangle that the line of a ray meets for certain, as the filter says: it does, and what follows of that is what the kernels find without it.
fn check_met(ray: &Ray, triangle: &Triangle, t_max: f32) -> Result<(), String> {
    let (
        infinity,
        Ray {
            origin, direction, ..
        },
    ) = (f32::INFINITY, *ray);
    let line = Ray::with_interval(origin, direction, -infinity, infinity);
    let found = [
        Exact::new(&line)
            .intersect(triangle, infinity, &mut ())
            .is_some(),
        ExactCrossing::new(&line)
            .intersect(triangle, infinity, &mut ())
            .is_some(),
    ];
    if found != [true; 2] {
        return Err(format!("{triangle:?}: met, and no hit of the line"));
    }
    let vertices = triangle.vertices().map(Vec3A::from);
    for t_max in [t_max, ray.t_max] {
        let found = [
            Exact::intersect_met(Portable, ray, &vertices, t_max, &mut ()),
            ExactCrossing::intersect_met(Portable, ray, &vertices, t_max, &mut ()),
        ];
        let expected = [
            Exact::new(ray).intersect(triangle, t_max, &mut ()),
            ExactCrossing::new(ray).intersect(triangle, t_max, &mut ()),
        ];
        if found != expected {
            return Err(format!(
                "{triangle:?}: {found:?} where it is met, {expected:?}"
            ));
        }
    }
    Ok(())
}

/// Checks what the filter says of some triangles.
fn check(ray: &Ray, triangles: &[Triangle], t_max: f32) -> Result<(), String> {
    for level in levels() {
        let at_once = verdict::<ExactBlockFilter>(level, ray, triangles, t_max);
        let (candidates, in_steps) = in_steps::<ExactBlockFilter>(level, ray, triangles, t_max);
        let Candidates { possible, met } = candidates;
        let name = level.level();
        for (lane, triangle) in triangles.iter().enumerate() {
            if met >> lane & 1 != 0 {
                check_met(ray, triangle, t_max).map_err(|error| format!("{name:?}, {error}"))?;
            }
        }
        for verdict in [at_once, in_steps] {
            for (lane, triangle) in triangles.iter().enumerate() {
                check_lane(ray, triangle, t_max, (verdict, lane))
                    .map_err(|error| format!("{name:?}, {error}"))?;
            }
        }
        let outside = u32::MAX << triangles.len();
        if possible & outside != 0 {
            return Err(format!("{name:?}: unused lanes of {possible:b}"));
        }
        if met & outside != 0 {
            return Err(format!("{name:?}: unused lanes of {met:b} are met"));
        }
        for verdict in [at_once, in_steps].into_iter().flatten() {
            if verdict.possible == 0
                || verdict.possible & outside != 0
                || verdict.certain & !verdict.possible != 0
            {
                return Err(format!("{name:?}: {verdict:?}"));
            }
        }
    }
    Ok(())
}

/// Checks that the filter of the kernels with a reach throws out nothing that they accept.
fn check_reach(ray: &Ray, triangles: &[Triangle], t_max: f32) -> Result<(), String> {
    let (fast, watertight) = (MollerTrumbore::new(ray), Woop::new(ray));
    for level in levels() {
        let verdict = verdict::<ReachBlockFilter>(level, ray, triangles, t_max);
        let (candidates, in_steps) = in_steps::<ReachBlockFilter>(level, ray, triangles, t_max);
        let left = candidates.possible;
        if candidates.met != 0 {
            return Err(format!("{:?}: {candidates:?}", level.level()));
        }
        let of = |verdict: Option<BlockVerdict>| verdict.map_or(0, |verdict| verdict.possible);
        let possible = of(verdict) & of(in_steps) & left;
        for (lane, triangle) in triangles.iter().enumerate() {
            let hits = [
                fast.intersect(triangle, t_max, &mut ()),
                watertight.intersect(triangle, t_max, &mut ()),
            ];
            if possible >> lane & 1 == 0 && hits != [None; 2] {
                return Err(format!("{:?}, {triangle:?}: {hits:?}", level.level()));
            }
        }
    }
    Ok(())
}

/// A triangle of ordinary or needle-like shape, or on a grid, around zero.
fn shape() -> impl Strategy<Value = [Vec3; 3]> {
    let ordinary = prop::array::uniform3(point(1.0));
    let grid = prop::array::uniform3(grid_point());
    let needle = (prop::array::uniform3(point(1.0)), 0i32..40)
        .prop_map(|([a, b, across], width)| [a, b, a.midpoint(b) + across * 0.5f32.powi(width)]);
    prop_oneof![ordinary, grid, needle]
}

/// What places and sizes a scene of eight triangles and a ray.
#[derive(Clone, Debug)]
struct Scales {
    /// The size of the triangles, as an exponent of two.
    size: i32,
    /// How far they are from zero, relative to their size.
    offset: i32,
    /// How far the ray begins from them.
    distance: i32,
    /// The length of the direction: that of the way to the triangle times this.
    direction: i32,
}

fn scales(sizes: Range<i32>) -> impl Strategy<Value = Scales> {
    (sizes, -4i32..20, -8i32..24, -40i32..40).prop_map(|(size, offset, distance, direction)| {
        Scales {
            size,
            offset,
            distance,
            direction,
        }
    })
}

pub(in crate::kernel) fn scaled(vector: Vec3, power: i32) -> Vec3 {
    (vector.as_dvec3() * 2f64.powi(power)).as_vec3()
}

/// Triangles, and a ray at a place of the first one: a corner, an edge, the inside, or beside it.
pub(in crate::kernel) fn scene(sizes: Range<i32>) -> impl Strategy<Value = (Vec<Triangle>, Ray)> {
    let shapes = prop::collection::vec(shape(), 1..=LANES);
    let weight = || prop_oneof![Just(0.0f32), Just(1.0), Just(0.5), -0.1f32..1.1];
    let interval = prop_oneof![
        3 => Just((0.0, f32::INFINITY)),
        1 => Just((f32::NEG_INFINITY, f32::INFINITY)),
        1 => Just((0.0, 1.0)),
        1 => (-2.0f32..2.0, 0.0f32..2.0).prop_map(|(start, length)| (start, start + length)),
    ];
    let places = (point(1.0), point(1.0), (weight(), weight()), any::<bool>());
    (shapes, scales(sizes), places, interval).prop_map(
        |(shapes, scales, (offset, from, (u, v), is_along_axis), (start, end))| {
            let offset = scaled(offset, scales.size + scales.offset);
            let triangles: Vec<Triangle> = shapes
                .into_iter()
                .map(|shape| shape.map(|corner| scaled(corner, scales.size) + offset))
                .map(|[a, b, c]| Triangle::new(a, b, c))
                .collect();
            let Triangle { a, b, c } = triangles[0];
            let target = a + u * (b - a) + v * (c - a);
            let from = scaled(from, scales.size + scales.distance);
            let from = if is_along_axis { from * Vec3::Z } else { from };
            let origin = target + from;
            let direction = scaled(target - origin, scales.direction);
            // The target is at `2^-direction`.
            let scale = scaled(Vec3::X, -scales.direction).x;
            let ray = Ray::with_interval(origin, direction, start * scale, end * scale);
            (triangles, ray)
        },
    )
}

pub(in crate::kernel) fn assert_true_of_kernels(triangles: &[Triangle], ray: &Ray, t_max: f32) {
    let is_finite = |triangle: &Triangle| triangle.vertices().iter().all(|v| v.is_finite());
    if !ray.is_valid() || !triangles.iter().all(is_finite) {
        return;
    }
    let kernel = Exact::new(ray);
    let hits = triangles
        .iter()
        .filter_map(|triangle| kernel.intersect(triangle, f32::INFINITY, &mut ()));
    // As the best hit so far: those of other triangles, and their neighbours.
    let mut limits = vec![ray.t_max, t_max.min(ray.t_max)];
    limits.extend(hits.flat_map(|hit| [hit.t, hit.t.next_down(), hit.t.next_up()]));
    for t_max in limits {
        let checked = check(ray, triangles, t_max.min(ray.t_max));
        assert_eq!(checked, Ok(()), "{ray:?}, up to {t_max}, {triangles:?}");
        let checked = check_reach(ray, triangles, t_max.min(ray.t_max));
        assert_eq!(checked, Ok(()), "{ray:?}, up to {t_max}, {triangles:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20_000))]

    /// The promise: what is thrown out is no hit, and what is certain is a hit inside of the interval that is given.
    #[test]
    fn the_filter_is_right_about_triangles_of_ordinary_sizes(
        (triangles, ray) in scene(-12..12),
        t_max in 0.0f32..2.0,
    ) {
        assert_true_of_kernels(&triangles, &ray, t_max);
    }

    #[test]
    fn the_filter_is_right_about_triangles_of_any_size(
        (triangles, ray) in scene(-148..120),
        t_max in 0.0f32..2.0,
    ) {
        assert_true_of_kernels(&triangles, &ray, t_max);
    }

    #[test]
    fn the_filter_is_right_where_numbers_underflow(
        (triangles, ray) in scene(-70..-30),
        t_max in 0.0f32..2.0,
    ) {
        assert_true_of_kernels(&triangles, &ray, t_max);
    }

    #[test]
    fn the_filter_is_right_about_large_triangles(
        (triangles, ray) in scene(20..45),
        t_max in 0.0f32..2.0,
    ) {
        assert_true_of_kernels(&triangles, &ray, t_max);
    }
}

fn triangle_around(center: Vec3, size: f32) -> Triangle {
    let corners = [(-1.0, -1.1), (1.2, -0.9), (0.1, 1.3)];
    let [a, b, c] = corners.map(|(x, y)| center + size * Vec3::new(x, y, 0.0));
    Triangle::new(a, b, c)
}

/// Products of weights and `t` that are denormal have few digits.
#[test]
fn a_certain_t_is_right_where_its_terms_underflow() {
    let power = |exponent: i32| 2f32.powi(exponent);
    for distance in -60i32..-36 {
        for direction in [-20i32, -10, 0, 10, 18] {
            let center = Vec3::new(0.0, 0.0, 1.3 * power(distance));
            let triangle = triangle_around(center, power(-56));
            let direction = Vec3::Z * power(direction);
            let ray = Ray::with_interval(Vec3::ZERO, direction, -1.0, f32::INFINITY);
            assert_true_of_kernels(&[triangle], &ray, f32::INFINITY);
        }
    }
}

/// Sums that overflow look like a `t` beyond all others.
#[test]
fn a_hit_is_not_thrown_out_where_its_terms_overflow() {
    for size in 20u8..60 {
        for direction in 0u8..60 {
            let size = 2f32.powi(i32::from(size));
            let triangle = triangle_around(Vec3::new(0.1, 0.2, 1.0) * size, size);
            let direction = Vec3::Z * 2f32.powi(-i32::from(direction));
            let ray = Ray::new(Vec3::ZERO, direction);
            assert_true_of_kernels(&[triangle], &ray, f32::INFINITY);
        }
    }
}

#[test]
fn nearly_all_ordinary_cases_are_decided() {
    let mut state = 1u32;
    let mut random = move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f32::from((state >> 16) as u16) / 65536.0
    };
    let mut vector = move || Vec3::new(random(), random(), random());
    let blocks: Vec<(Vec<Triangle>, Ray)> = (0..4000)
        .map(|_| {
            let center = vector();
            let mut corner = || center + 0.2 * vector();
            let triangles = (0..LANES).map(|_| Triangle::new(corner(), corner(), corner()));
            let triangles: Vec<_> = triangles.collect();
            let origin = 5.0 * vector() - 2.5;
            (triangles, Ray::new(origin, center + 0.1 - origin))
        })
        .collect();
    for level in levels() {
        let [mut undecided, mut certain] = [0; 2];
        for (triangles, ray) in &blocks {
            if let Some(verdict) = verdict::<ExactBlockFilter>(level, ray, triangles, ray.t_max) {
                certain += verdict.certain.count_ones();
                undecided += (verdict.possible & !verdict.certain).count_ones();
            }
        }
        let name = level.level();
        assert!(certain > 1000, "{name:?}: only {certain} hits");
        assert!(
            undecided * 100 < certain,
            "{name:?}: {undecided} undecided, {certain} certain"
        );
    }
}

/// A ray that starts a little above a triangle, and one that is about to hit it.
#[test]
fn the_triangle_behind_a_ray_is_thrown_out_without_a_branch() {
    let triangle = triangle_around(Vec3::ZERO, 1.0);
    let direction = Vec3::new(0.3, -0.2, 0.9);
    for (height, expected) in [(1e-7, 0), (-1e-7, 1)] {
        let ray = Ray::new(height * Vec3::Z, direction);
        for level in levels() {
            let (found, _) = in_steps::<ExactBlockFilter>(level, &ray, &[triangle], f32::INFINITY);
            let expected = Candidates {
                possible: expected,
                met: 1,
            };
            assert_eq!(found, expected, "{:?}, {height}", level.level());
        }
    }
}
