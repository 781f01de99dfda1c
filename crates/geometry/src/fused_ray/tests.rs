use glam::Vec3;
use proptest::prelude::*;

use super::*;
use crate::oracle::RBig;
use crate::simd::{Lanes, Simd, SimdLevel, WithSimd};
use crate::test_support::grid_point;

/// The box test of the nodes of a tree, for one box.
struct Clip<'a> {
    fused: &'a FusedRay,
    bounds: &'a Aabb,
}

impl WithSimd for Clip<'_> {
    /// Where the ray enters and leaves each of eight boxes.
    type Output = (f32, f32);

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> (f32, f32) {
        let Self { fused, bounds } = self;
        let t = |slabs: &FusedSlabs, corners: [Vec3; 2], axis: usize| {
            let corner = corners[(fused.negative >> axis & 1) as usize];
            let [place, reciprocal, offset] =
                [corner[axis], slabs.reciprocal[axis], slabs.offset[axis]]
                    .map(|value| simd.load(&Lanes::splat(value)));
            simd.mul_add(place, reciprocal, offset)
        };
        let [near_x, near_y, near_z] =
            [0, 1, 2].map(|axis| t(&fused.near, [bounds.min, bounds.max], axis));
        let [far_x, far_y, far_z] =
            [0, 1, 2].map(|axis| t(&fused.far, [bounds.max, bounds.min], axis));
        let (least, most) = (simd.splat(f32::NEG_INFINITY), simd.splat(f32::INFINITY));
        let start = simd.max(simd.max(near_x, near_y), simd.max(near_z, least));
        let end = simd.min(simd.min(far_x, far_y), simd.min(far_z, most));
        (simd.store(start).0[0], simd.store(end).0[0])
    }
}

/// The part of a ray in a box at every level.
fn clip(ray: &Ray, bounds: &Aabb, size: f32, reach: f32) -> Vec<(SimdLevel, f32, f32)> {
    let fused = FusedRay::new(ray, size, reach);
    let levels = SimdLevel::ALL.into_iter().filter_map(SimdLevel::available);
    let clipped = levels.map(|level| {
        let fused = &fused;
        let (start, end) = level.dispatch(Clip { fused, bounds });
        (level.level(), start.max(ray.t_min), end.min(ray.t_max))
    });
    clipped.collect()
}

fn exact(value: f32) -> RBig {
    RBig::try_from(value).expect("finite")
}

/// The f32 numbers around an exact one; `None` beyond the largest.
fn around(value: &RBig) -> Option<[f32; 2]> {
    let nearest = value.to_f32().value();
    if !nearest.is_finite() {
        return None;
    }
    let below = if exact(nearest) > *value {
        nearest.next_down()
    } else {
        nearest
    };
    let above = if exact(below) < *value {
        below.next_up()
    } else {
        below
    };
    (below.is_finite() && above.is_finite()).then_some([below, above])
}

/// The smallest box around the point of a ray at `t`, moved in each coordinate by up to `reach` times the distance from the origin.
pub(super) fn box_around(ray: &Ray, t: f32, reach: f32, signs: [i8; 3]) -> Option<Aabb> {
    let point = [0, 1, 2].map(|axis| {
        let way = exact(t) * exact(ray.direction[axis]);
        (exact(ray.origin[axis]) + way.clone(), way)
    });
    let ways = point.iter().map(|(_, way)| way.to_f64().value().abs());
    let moved = crate::kernel::reach(reach, ways.fold(0.0, f64::max));
    let mut bounds = Aabb::EMPTY;
    for axis in 0..3 {
        let moved = RBig::try_from(f64::from(signs[axis]) * moved).ok()?;
        let [below, above] = around(&(point[axis].0.clone() + moved))?;
        (bounds.min[axis], bounds.max[axis]) = (below, above);
    }
    Some(bounds)
}

/// Numbers of sizes around a power of two; zeros of both signs, very small ones and coincidences among them.
fn number(power: std::ops::Range<i32>) -> impl Strategy<Value = f32> {
    let sign = any::<bool>().prop_map(|negative| if negative { -1.0 } else { 1.0 });
    let of_size = (sign, 1.0f32..2.0, power).prop_map(|(sign, digits, power)| {
        #[expect(clippy::cast_possible_truncation, reason = "rounds to the nearest f32")]
        let value = (sign * f64::from(digits) * 2f64.powi(power)) as f32;
        value
    });
    let any = any::<u32>().prop_map(f32::from_bits);
    let any = any.prop_filter("finite", |value| value.is_finite());
    let special = prop::sample::select(vec![0.0, -0.0, 1.0, -1.0, f32::from_bits(1), -1e-40]);
    prop_oneof![16 => of_size, 3 => special, 1 => any]
}

fn vector(power: std::ops::Range<i32>) -> impl Strategy<Value = Vec3> {
    let number = || number(power.clone());
    (number(), number(), number()).prop_map(Vec3::from)
}

/// An origin, a direction and a `t`: of ordinary sizes, on a grid, and of any size.
pub(super) fn point_of_ray() -> impl Strategy<Value = (Vec3, Vec3, f32)> {
    let positive_or_not = |powers| number(powers).boxed();
    let ordinary = (vector(-8..8), vector(-20..2), positive_or_not(-6..10));
    let grid = (
        grid_point(),
        grid_point(),
        prop::sample::select(vec![0.5, 1.0, 2.0, -1.0, 0.0]),
    );
    let wild = (vector(-70..70), vector(-64..64), positive_or_not(-100..120));
    let large = (vector(20..64), vector(-64..4), positive_or_not(20..120));
    prop_oneof![2 => ordinary, 1 => grid, 2 => wild, 2 => large]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20_000))]

    /// The promise: what a kernel accepts is not culled, be the box as tight as it may and the structure as large.
    #[test]
    fn no_point_of_a_ray_is_culled_at_any_level(
        (origin, direction, t) in point_of_ray(),
        starts_before in any::<bool>(),
        reach in prop::sample::select(vec![0.0, 0.0, 8.0, 64.0]),
        signs in prop::array::uniform3(-1i8..=1),
        larger in prop::sample::select(vec![1.0, 1.0, 1e3, 1e10]),
    ) {
        prop_assume!(t.is_finite());
        let t_min = if starts_before && t >= 0.0 { 0.0 } else { t };
        let ray = Ray::with_interval(origin, direction, t_min, t);
        prop_assume!(ray.is_valid());
        let Some(bounds) = box_around(&ray, t, reach, signs) else {
            return Ok(());
        };
        let size = size_of_bounds(&bounds) * larger;
        for (level, start, end) in clip(&ray, &bounds, size, reach) {
            prop_assert!(start <= t && t <= end, "{level:?}: [{start}, {end}] without {t}");
        }
    }
}

/// An ordinary ray in front of a box that it passes at some distance, in a structure of some size.
fn is_culled(ray: &Ray, bounds: &Aabb, size: f32) -> bool {
    let mut clipped = clip(ray, bounds, size, 0.0).into_iter();
    clipped.all(|(_, start, end)| start > end)
}

#[test]
fn boxes_that_a_ray_passes_are_culled_in_structures_of_every_size() {
    let place = Vec3::new(0.3, 0.2, 0.1);
    let bounds = Aabb::new(place, place + 0.01);
    for target in [place + 0.005, place + Vec3::new(0.005, 0.0, 0.01)] {
        for origin in [Vec3::new(0.35, 0.25, 0.4), Vec3::new(-3.0, 7.0, 5.0)] {
            let direction = target - origin;
            let away = direction.any_orthonormal_vector() * 0.02;
            for size in [1.0, 1e3, 1e5] {
                let hit = Ray::new(origin, direction);
                let miss = Ray::new(origin + away, direction);
                assert!(!is_culled(&hit, &bounds, size), "{hit:?}, {size}");
                assert!(is_culled(&miss, &bounds, size), "{miss:?}, {size}");
                let behind = Ray::new(origin, -direction);
                assert!(is_culled(&behind, &bounds, size), "{behind:?}, {size}");
            }
        }
    }
}

#[test]
fn parallel_rays_are_culled_beside_a_box_and_not_in_its_faces() {
    let unit = Aabb::new(Vec3::ZERO, Vec3::ONE);
    for zero in [0.0, -0.0] {
        for (x, culled) in [
            (-0.01, true),
            (0.0, false),
            (0.5, false),
            (1.0, false),
            (1.01, true),
        ] {
            let ray = Ray::new(Vec3::new(x, 0.5, -1.0), Vec3::new(zero, zero, 1.0));
            assert_eq!(is_culled(&ray, &unit, 1.0), culled, "x = {x}, {zero:?}");
            assert_eq!(is_culled(&ray, &unit, 1e5), culled, "x = {x}, {zero:?}");
        }
    }
}

/// Around the limits, and far from them: nearly all rays are seen to be inside without a look at each limit.
#[test]
fn filters_decide_in_their_range_and_nowhere_else() {
    let lengths = (-36i8..=24).map(|power| 2f32.powi(power.into()));
    let places = [0.0, 1.0]
        .into_iter()
        .chain((26u8..=32).map(|power| 2f32.powi(power.into())));
    for (length, place) in
        lengths.flat_map(|length| places.clone().map(move |place| (length, place)))
    {
        for size in [1e-25, 1e-6, 1.0, 3e8, 1.4e9] {
            for t_min in [0.0, -1.0] {
                let origin = Vec3::new(-1.0, place, 0.5);
                let direction = Vec3::new(0.5, -0.25, -1.0) * length;
                let ray = Ray::with_interval(origin, direction, t_min, 5.0);
                let distance = f64::from(size) + f64::from(place.max(1.0));
                let is_near = distance <= f64::from(sheared::FARTHEST) * (1.0 - 1e-6);
                let expected = is_near && sheared::DIRECTIONS.contains(&length);
                let found = FusedRay::new(&ray, size, 0.0).filters_decide;
                assert_eq!(found, expected, "{ray:?}, {size}");
            }
        }
    }
}

#[test]
fn the_axis_is_the_dominant_one() {
    for place in 0..5u16.pow(3) {
        let component = |digit: u32| f32::from(place / 5u16.pow(digit) % 5) - 2.0;
        let direction = Vec3::new(component(0), component(1), component(2));
        if direction != Vec3::ZERO {
            let fused = FusedRay::new(&Ray::new(Vec3::ONE, direction), 1.0, 0.0);
            assert_eq!(fused.axis, Axis::dominant(direction), "{direction}");
            assert_eq!(fused.largest, direction.abs().max_element(), "{direction}");
        }
    }
}

#[test]
fn extremes_cull_nothing() {
    let unit = Aabb::new(Vec3::ZERO, Vec3::ONE);
    let far = Aabb::new(Vec3::splat(-3.0e38), Vec3::splat(3.0e38));
    for direction in [Vec3::X * 1e-40, Vec3::X * 1e38, Vec3::new(1e-45, 0.0, -0.0)] {
        let ray = Ray::new(Vec3::new(0.5, 7.0, 0.0), direction);
        for (bounds, size) in [(unit, 1.0), (unit, 3.0e38), (far, 3.0e38)] {
            assert!(!is_culled(&ray, &bounds, size), "{direction}, {size}");
        }
    }
}

/// An offset that overflows while the product does not, or is not rounded, is infinite on the wrong side.
#[test]
fn large_coordinates_do_not_lose_the_face_that_a_ray_runs_in() {
    for power in 20u8..64 {
        let place = Vec3::splat(2f32.powi(i32::from(power)));
        let bounds = Aabb::new(place, place * 1.5);
        for direction in [
            Vec3::Z,
            Vec3::new(-0.0, 0.0, 1e-9),
            Vec3::new(1e-30, -0.0, 1.0),
        ] {
            let origin = place.with_z(0.0);
            let ray = Ray::new(origin, direction);
            assert!(
                !is_culled(&ray, &bounds, bounds.max.x),
                "2^{power}, {direction:?}"
            );
        }
    }
}
