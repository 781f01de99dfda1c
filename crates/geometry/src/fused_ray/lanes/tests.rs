use glam::Vec3;

use super::*;
use crate::simd::{SimdLevel, WithSimd};

/// The octants of a vector of rays.
struct Octants<'a>(&'a RayLanes);

impl WithSimd for Octants<'_> {
    type Output = OctantLanes;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> OctantLanes {
        self.0.octants(simd)
    }
}

#[test]
fn rays_that_are_valid_and_begin_at_zero_or_later_may_be_in_packets() {
    let good = Ray::with_interval(Vec3::ONE, Vec3::new(1.0, -2.0, -0.0), 0.0, 5.0);
    let tiny = Vec3::Y * f32::from_bits(1);
    let mut rays = Vec::from(crate::test_support::invalid_rays(good));
    rays.extend([
        good,
        Ray {
            t_min: -0.0,
            ..good
        },
        Ray {
            t_min: -1.0,
            ..good
        },
        Ray { t_max: 0.0, ..good },
        Ray {
            direction: -tiny,
            ..good
        },
        Ray {
            direction: Vec3::splat(f32::MIN),
            origin: Vec3::splat(f32::MAX),
            ..good
        },
    ]);
    for level in SimdLevel::ALL.into_iter().filter_map(SimdLevel::available) {
        for ray in &rays {
            for lane in 0..LANES {
                // Beside rays that are in packets.
                let mut lanes = RayLanes::splat(&Ray::new(Vec3::ZERO, Vec3::NEG_ONE));
                lanes.set(lane, ray);
                let found = level.dispatch(Octants(&lanes));
                let is_member = ray.is_valid() && ray.t_min >= 0.0;
                let others = 0xff & !(1 << lane);
                assert_eq!(
                    found.members,
                    others | u32::from(is_member) << lane,
                    "{ray:?}"
                );
                if is_member {
                    let negative = ray.direction.is_negative_bitmask();
                    let expected = [0, 1, 2].map(|axis| others | (negative >> axis & 1) << lane);
                    assert_eq!(found.negative, expected, "{ray:?}");
                }
            }
        }
    }
}

struct AllAtOnce([Ray; LANES]);

impl WithSimd for AllAtOnce {
    type Output = RayLanes;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> RayLanes {
        RayLanes::new(simd, &self.0)
    }
}

#[test]
fn eight_rays_at_once_are_those_put_in_one_by_one() {
    let ray = |lane: usize| {
        let number = lane as f32;
        let origin = Vec3::new(number, 0.5, -number);
        Ray::with_interval(origin, Vec3::new(-1.0, number, 7.0), -0.0, number)
    };
    let rays: [Ray; LANES] = std::array::from_fn(ray);
    let mut expected = RayLanes::splat(&rays[0]);
    for (lane, ray) in rays.iter().enumerate() {
        expected.set(lane, ray);
    }
    let bits = |lanes: &RayLanes| {
        let RayLanes {
            origin: [u, v, w],
            direction: [x, y, z],
            t_min,
            t_max,
        } = lanes;
        [u, v, w, x, y, z, t_min, t_max].map(|lanes| lanes.0.map(f32::to_bits))
    };
    for level in SimdLevel::ALL.into_iter().filter_map(SimdLevel::available) {
        let found = level.dispatch(AllAtOnce(rays));
        assert_eq!(bits(&found), bits(&expected), "{:?}", level.level());
    }
}
