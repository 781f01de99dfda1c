use glam::Vec3;
use proptest::prelude::*;

use super::super::tests::{box_around, point_of_ray};
use super::*;
use crate::simd::{LANES, SimdLevel, WithSimd};
use crate::{Aabb, FusedRay, Ray, size_of_bounds};

/// Eight rays prepared, and what bounds them.
struct Prepare<'a> {
    rays: &'a RayLanes,
    negative: u32,
    size_and_reach: (f32, f32),
}

impl WithSimd for Prepare<'_> {
    type Output = (FusedPacket, PacketBounds);

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let mut packet = FusedPacket::EMPTY;
        let mut bounds = GatheredBounds::new(self.negative);
        packet.prepare(
            simd,
            self.rays,
            self.negative,
            self.size_and_reach,
            &mut bounds,
        );
        (packet, bounds.all_lanes(simd, self.negative))
    }
}

fn prepare(
    rays: &[Ray],
    size_and_reach: (f32, f32),
) -> impl Iterator<Item = (SimdLevel, FusedPacket, PacketBounds)> {
    let mut lanes = RayLanes::splat(&rays[0]);
    for (lane, ray) in rays.iter().enumerate() {
        lanes.set(lane, ray);
    }
    let negative = rays[0].direction.is_negative_bitmask() & 7;
    let levels = SimdLevel::ALL.into_iter().filter_map(SimdLevel::available);
    levels.map(move |level| {
        let (packet, bounds) = level.dispatch(Prepare {
            rays: &lanes,
            negative,
            size_and_reach,
        });
        (level.level(), packet, bounds)
    })
}

/// Where a packet enters a box and leaves it, at zero or later, in the arithmetic of traversals: a difference and a product for each plane.
fn clip(bounds: &PacketBounds, negative: u32, of: &Aabb) -> (f32, f32) {
    let (mut start, mut end) = (0f32, f32::INFINITY);
    let corners = [of.min, of.max];
    for axis in 0..3 {
        let places = |side: usize| {
            let plane = corners[side ^ (negative >> axis & 1) as usize][axis];
            let distance = plane - bounds.origins[axis][side];
            bounds.reciprocals[axis][side].map(|reciprocal| distance * reciprocal)
        };
        let ([a, b], [c, d]) = (places(0), places(1));
        start = start.max(a.min(b));
        end = end.min(c.max(d));
    }
    (start, end)
}

/// Rays into the octant of the first one.
fn into_one_octant(rays: &mut [Ray]) {
    let first = rays[0].direction;
    for ray in rays {
        ray.direction = ray.direction.copysign(first);
    }
}

fn rays() -> impl Strategy<Value = (Vec<Ray>, Vec<f32>)> {
    let member = point_of_ray().prop_filter_map("begins at zero", |(origin, direction, t)| {
        let ray = Ray::new(origin, direction);
        (t >= 0.0 && t.is_finite() && ray.is_valid()).then_some((ray, t))
    });
    let member = member.boxed();
    // Those of a packet are often near each other.
    let near = (
        member.clone(),
        prop::collection::vec(-1e-3f32..1e-3, LANES - 1),
    );
    let near = near.prop_map(|((ray, t), moves)| {
        let moved = moves.into_iter().map(|by| Ray {
            origin: ray.origin * (1.0 + by),
            direction: ray.direction + ray.direction.length() * by * Vec3::new(0.3, 0.1, 1.0),
            ..ray
        });
        let moved = moved.filter(Ray::is_valid);
        std::iter::once(ray)
            .chain(moved)
            .map(|ray| (ray, t))
            .collect()
    });
    let any = prop::collection::vec(member, 1..=LANES);
    prop_oneof![near, any].prop_map(|members: Vec<(Ray, f32)>| {
        let (mut rays, places): (Vec<Ray>, Vec<f32>) = members.into_iter().unzip();
        into_one_octant(&mut rays);
        (rays, places)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(5_000))]

    #[test]
    fn each_ray_of_a_packet_is_prepared_as_it_is_alone(
        (rays, _) in rays(),
        reach in prop::sample::select(vec![0.0, 8.0, 64.0]),
        size in prop::sample::select(vec![0.0, 1e-25, 1e-3, 1.0, 7.5, 1e4, 1e20, f32::MAX]),
    ) {
        for (level, packet, _) in prepare(&rays, (size, reach)) {
            for (lane, ray) in rays.iter().enumerate() {
                let alone = FusedRay::new(ray, size, reach);
                for axis in 0..3 {
                    let found = [packet.near[axis], packet.far[axis]].map(|pair| pair.map(|lanes| lanes.0[lane]));
                    let expected = [alone.near, alone.far].map(|slabs| [slabs.reciprocal[axis], slabs.offset[axis]]);
                    prop_assert_eq!(found, expected, "{:?}, {:?}", level, ray);
                }
            }
        }
    }

    /// The promise: no box that holds a point of any of the rays is culled, be it as tight as it may, and none is said to begin later than there.
    #[test]
    fn no_point_of_any_ray_of_a_packet_is_culled(
        (rays, places) in rays(),
        reach in prop::sample::select(vec![0.0, 0.0, 8.0, 64.0]),
        signs in prop::array::uniform3(-1i8..=1),
        larger in prop::sample::select(vec![1.0, 1.0, 1e3, 1e10]),
    ) {
        let negative = rays[0].direction.is_negative_bitmask() & 7;
        for (ray, t) in rays.iter().zip(places) {
            let Some(of) = box_around(ray, t, reach, signs) else {
                continue;
            };
            let size = size_of_bounds(&of) * larger;
            for (level, _, bounds) in prepare(&rays, (size, reach)) {
                let (start, end) = clip(&bounds, negative, &of);
                prop_assert!(start <= t && t <= end, "{level:?}: [{start}, {end}] without {t}");
            }
        }
    }
}

#[test]
fn boxes_beside_a_packet_are_culled() {
    let rays: Vec<Ray> = (0..8u8)
        .map(|i| {
            let side = f32::from(i) * 0.01;
            Ray::new(Vec3::new(side, 0.0, -2.0), Vec3::new(0.1 + side, 0.02, 1.0))
        })
        .collect();
    let cube = |corner: Vec3| Aabb::new(corner, corner + 0.1);
    for (level, _, bounds) in prepare(&rays, (2.0, 0.0)) {
        let is_culled = |corner: Vec3| {
            let (start, end) = clip(&bounds, 0, &cube(corner));
            start > end
        };
        assert!(
            !is_culled(Vec3::new(0.3, 0.0, 0.0)),
            "{level:?}: in the way"
        );
        assert!(is_culled(Vec3::new(0.3, 0.2, 0.0)), "{level:?}: above");
        assert!(
            is_culled(Vec3::new(0.0, 0.0, 0.0)),
            "{level:?}: on the left"
        );
        assert!(is_culled(Vec3::new(0.3, 0.0, -5.0)), "{level:?}: behind");
    }
}
