use std::ops::Range;

use glam::{Vec3, Vec3Swizzles};
use proptest::prelude::*;

use super::*;
use crate::kernel::behind::tests::at_surface;
use crate::kernel::exact_block::tests::{check_lane, levels, scene};
use crate::kernel::{BlockFilter, ExactBlockFilter, MollerTrumbore, ReachBlockFilter, Woop};
use crate::simd::{LANES, WithSimd};
use crate::test_support::point;
use crate::{Aabb, Ray, Triangle, TriangleKernel, size_of_bounds};

/// What a filter says of the rays and triangles of a scene; `None` if it says nothing.
struct Test<'a, F>(&'a [Ray], &'a [Triangle], &'a [f32], F);

/// For each triangle: together with all rays, and for each ray alone with all triangles.
struct Verdicts {
    of_rays: Vec<Option<BlockVerdict>>,
    of_blocks: Vec<Option<BlockVerdict>>,
    /// The second of these in two steps.
    in_steps: Vec<Option<BlockVerdict>>,
}

impl<F: RaysFilter> WithSimd for Test<'_, F> {
    type Output = Option<Verdicts>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Option<Verdicts> {
        let Self(rays, triangles, limits, mut filter) = self;
        let block = TriangleBlock::new((0..).zip(triangles.iter().copied()));
        let bounds = triangles.iter().map(Triangle::aabb);
        let bounds = bounds.fold(Aabb::EMPTY, Aabb::union);
        let mut lanes = RayLanes::splat(&rays[0]);
        for (lane, ray) in rays.iter().enumerate() {
            lanes.set(lane, ray);
        }
        let axis = Axis::dominant(rays[0].direction);
        if !filter.prepare(simd, &lanes, axis, size_of_bounds(&bounds)) {
            return None;
        }
        let of_blocks = (0..rays.len()).map(|lane| {
            let alone = filter.of_lane(&lanes, lane);
            alone.test(simd, &block, limits[lane])
        });
        let of_blocks = of_blocks.collect();
        let in_steps = (0..rays.len()).map(|lane| {
            let (alone, t_max) = (filter.of_lane(&lanes, lane), limits[lane]);
            let possible = alone.possible(simd, &block, t_max);
            let judged = || alone.judge(simd, &block, t_max, possible);
            (possible != 0).then(judged).flatten()
        });
        let in_steps = in_steps.collect();
        lanes.t_max.0[..limits.len()].copy_from_slice(limits);
        let all = (0..triangles.len()).map(|triangle| filter.test(simd, &lanes, &block, triangle));
        Some(Verdicts {
            of_rays: all.collect(),
            of_blocks,
            in_steps,
        })
    }
}

/// Eight rays near the one of a scene, more or less; none begins behind its origin.
fn rays_and_triangles(sizes: Range<i32>) -> impl Strategy<Value = (Vec<Ray>, Vec<Triangle>)> {
    let moves = prop::collection::vec((point(1.0), point(1.0)), LANES - 1);
    let spread = prop::sample::select(vec![0.0, 1e-6, 1e-2, 0.3, 1.0]);
    let scene = prop_oneof![scene(sizes.clone()), at_surface(sizes)];
    let scene = scene.prop_filter("what a packet takes", |(triangles, ray)| {
        let mut vertices = triangles.iter().flat_map(Triangle::vertices);
        ray.is_valid() && ray.t_max >= 0.0 && vertices.all(Vec3::is_finite)
    });
    (scene, moves, spread).prop_map(|((triangles, ray), moves, spread)| {
        let ray = Ray {
            t_min: ray.t_min.max(0.0),
            ..ray
        };
        let [way, length] = [triangles[0].a - ray.origin, ray.direction]
            .map(|vector| vector.abs().max_element() * spread);
        let moved = moves.into_iter().map(|(origin, direction)| Ray {
            origin: ray.origin + way * origin,
            direction: ray.direction + length * direction,
            ..ray
        });
        let moved = moved.map(|other| if other.is_valid() { other } else { ray });
        (std::iter::once(ray).chain(moved).collect(), triangles)
    })
}

/// Checks what filters say, together and alone, up to the present `t_max` of each ray.
fn check(rays: &[Ray], triangles: &[Triangle], limits: &[f32]) -> Result<(), String> {
    for level in levels() {
        let filter = <ExactBlockFilter as BlockFilter>::Rays::EMPTY;
        if let Some(verdicts) = level.dispatch(Test(rays, triangles, limits, filter)) {
            for (place, triangle) in triangles.iter().enumerate() {
                for (lane, (ray, t_max)) in rays.iter().zip(limits).enumerate() {
                    let name = level.level();
                    let of_rays = (verdicts.of_rays[place], lane);
                    let of_block = (verdicts.of_blocks[lane], place);
                    let in_steps = (verdicts.in_steps[lane], place);
                    for verdict in [of_rays, of_block, in_steps] {
                        check_lane(ray, triangle, *t_max, verdict)
                            .map_err(|error| format!("{name:?}, {ray:?}, {verdict:?}: {error}"))?;
                    }
                }
            }
        }
        let filter = <ReachBlockFilter as BlockFilter>::Rays::EMPTY;
        if let Some(verdicts) = level.dispatch(Test(rays, triangles, limits, filter)) {
            for (place, triangle) in triangles.iter().enumerate() {
                for (lane, (ray, t_max)) in rays.iter().zip(limits).enumerate() {
                    let hits = [
                        MollerTrumbore::new(ray).intersect(triangle, *t_max, &mut ()),
                        Woop::new(ray).intersect(triangle, *t_max, &mut ()),
                    ];
                    let is_possible = |verdict: Option<BlockVerdict>, lane: usize| {
                        verdict.is_some_and(|verdict| verdict.possible >> lane & 1 == 1)
                    };
                    let is_possible = is_possible(verdicts.of_rays[place], lane)
                        && is_possible(verdicts.of_blocks[lane], place)
                        && is_possible(verdicts.in_steps[lane], place);
                    if !is_possible && hits != [None; 2] {
                        return Err(format!("{ray:?}, {triangle:?}: {hits:?} thrown out"));
                    }
                }
            }
        }
    }
    Ok(())
}

fn assert_true_of_kernels(rays: &[Ray], triangles: &[Triangle]) {
    let limits: Vec<f32> = rays.iter().map(|ray| ray.t_max).collect();
    assert_eq!(check(rays, triangles, &limits), Ok(()));
    // The best hit so far: that of a triangle, for every second ray, and its neighbours; or the search is over.
    let nearest = rays.iter().enumerate().map(|(lane, ray)| {
        let kernel = crate::Exact::new(ray);
        let triangle = &triangles[lane % triangles.len()];
        let hit = kernel.intersect(triangle, f32::INFINITY, &mut ());
        match (hit, lane % 4) {
            (Some(hit), 0) => hit.t,
            (Some(hit), 1) => hit.t.next_down(),
            (Some(hit), 2) => hit.t.next_up().min(ray.t_max),
            (None, 3) => f32::NEG_INFINITY,
            _ => ray.t_max,
        }
    });
    let nearest: Vec<f32> = nearest.collect();
    assert_eq!(check(rays, triangles, &nearest), Ok(()));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3_000))]

    /// The promise: what is thrown out is no hit, and what is certain is a hit inside of the interval that is given.
    #[test]
    fn the_filter_is_right_about_rays_and_triangles_of_ordinary_sizes((rays, triangles) in rays_and_triangles(-12..12)) {
        assert_true_of_kernels(&rays, &triangles);
    }

    #[test]
    fn the_filter_is_right_about_rays_and_triangles_of_any_size((rays, triangles) in rays_and_triangles(-148..120)) {
        assert_true_of_kernels(&rays, &triangles);
    }

    #[test]
    fn the_filter_is_right_at_the_ends_of_its_range((rays, triangles) in rays_and_triangles(20..40)) {
        assert_true_of_kernels(&rays, &triangles);
    }
}

/// Whether the exact filter decides about rays from near zero in some directions, the first of which chooses the axis.
fn decides(directions: &[Vec3]) -> bool {
    let rays: Vec<Ray> = directions
        .iter()
        .map(|direction| Ray::new(Vec3::ZERO, *direction))
        .collect();
    let triangle = Triangle::new(Vec3::X, Vec3::Y, Vec3::Z);
    let limits = vec![f32::INFINITY; rays.len()];
    let decided = levels().map(|level| {
        let filter = <ExactBlockFilter as BlockFilter>::Rays::EMPTY;
        let verdicts = level.dispatch(Test(&rays, &[triangle], &limits, filter));
        verdicts.is_some()
    });
    let decided: Vec<bool> = decided.collect();
    assert!(
        decided.iter().all(|one| *one == decided[0]),
        "the same at every level: {decided:?}"
    );
    decided[0]
}

#[test]
fn rays_decide_together_where_all_have_half_of_their_direction_along_the_axis() {
    for axis in Vec3::AXES {
        let across = axis.yzx();
        let first = axis + 0.9 * across;
        assert!(decides(&[first, axis + 2.0 * across]), "half of it");
        assert!(decides(&[first, -axis - 2.0 * across]), "on the other way");
        assert!(!decides(&[first, axis + 2.001 * across]), "less");
        let [small, large] = [2f32.powi(-30), 2f32.powi(20)];
        assert!(decides(&[first, large * axis, small * axis]), "the range");
        assert!(!decides(&[first, 1.01 * large * axis]), "above");
        assert!(!decides(&[first, 0.99 * small * axis]), "below");
    }
}

#[test]
fn rays_from_far_away_decide_nothing() {
    let triangle = Triangle::new(Vec3::X, Vec3::Y, Vec3::Z);
    for (distance, expected) in [(2f32.powi(29), true), (2f32.powi(30), false)] {
        let near = Ray::new(Vec3::ZERO, Vec3::ONE);
        let far = Ray::new(-distance * Vec3::ONE, Vec3::ONE);
        for level in levels() {
            let filter = <ExactBlockFilter as BlockFilter>::Rays::EMPTY;
            let limits = [f32::INFINITY; 2];
            let verdicts = level.dispatch(Test(&[near, far], &[triangle], &limits, filter));
            assert_eq!(verdicts.is_some(), expected, "{distance}");
        }
    }
}

#[test]
fn nearly_all_ordinary_rays_are_decided() {
    let triangle = Triangle::new(
        Vec3::new(-1.0, -1.1, 5.0),
        Vec3::new(1.2, -0.9, 5.2),
        Vec3::new(0.1, 1.3, 4.9),
    );
    let rays: Vec<Ray> = (0u8..8)
        .map(|lane| {
            Ray::new(
                Vec3::ZERO,
                Vec3::new(f32::from(lane) * 0.1 - 0.15, 0.0, 1.0),
            )
        })
        .collect();
    for level in levels() {
        let filter = <ExactBlockFilter as BlockFilter>::Rays::EMPTY;
        let limits = [f32::INFINITY; LANES];
        let verdicts = level.dispatch(Test(&rays, &[triangle], &limits, filter));
        let verdict = verdicts.and_then(|verdicts| verdicts.of_rays[0]);
        let verdict = verdict.expect("some are hits");
        let hits = rays.iter().enumerate().filter(|(_, ray)| {
            let kernel = crate::Exact::new(ray);
            kernel
                .intersect(&triangle, f32::INFINITY, &mut ())
                .is_some()
        });
        let hits = hits.fold(0, |hits, (lane, _)| hits | 1 << lane);
        assert!((1..0xff).contains(&hits), "{hits:b}");
        assert_eq!(
            [verdict.possible, verdict.certain],
            [hits; 2],
            "all are certain"
        );
    }
}
