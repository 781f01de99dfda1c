use std::ops::Range;

use glam::{Vec3, Vec3A};
use proptest::prelude::*;

use super::super::exact_block::tests::{levels, scene};
use super::super::terms::certain_hit;
use super::*;
use crate::simd::{LANES, WithSimd};
use crate::{Ray, Triangle};

/// What the rung says of eight rays and triangles.
struct OfLanes<'a>(&'a RayLanes, &'a VertexLanes);

impl WithSimd for OfLanes<'_> {
    type Output = HitLanes;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> HitLanes {
        let Self(rays, vertices) = self;
        certain_hits(simd, rays, vertices)
    }
}

/// The rung for one of them, a lane for each axis.
struct OfOne<'a>(&'a Ray, &'a Triangle);

impl WithSimd for OfOne<'_> {
    type Output = Option<TriangleHit>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Option<TriangleHit> {
        let Self(ray, triangle) = self;
        certain_hit(simd, ray, &triangle.vertices().map(Vec3A::from))
    }
}

/// Rays with a triangle each, in the order of lanes.
fn scenes(sizes: Range<i32>) -> impl Strategy<Value = Vec<(Ray, Triangle)>> {
    let scene = scene(sizes).prop_filter_map("in range", |(triangles, ray)| {
        let triangle = triangles[0];
        let is_finite = triangle.vertices().iter().all(|vertex| vertex.is_finite());
        (ray.is_valid() && is_finite).then_some((ray, triangle))
    });
    prop::collection::vec(scene, LANES)
}

/// Checks that each lane has what a ray alone has, to the last bit and at every level; gives how many hits are known.
fn check(scenes: &[(Ray, Triangle)]) -> u32 {
    let mut rays = RayLanes::splat(&scenes[0].0);
    let mut vertices = [[Lanes::splat(0.0); 3]; 3];
    for (lane, (ray, triangle)) in scenes.iter().enumerate() {
        rays.set(lane, ray);
        for (lanes, vertex) in vertices.iter_mut().zip(triangle.vertices()) {
            for (lanes, coordinate) in lanes.iter_mut().zip(vertex.to_array()) {
                lanes.0[lane] = coordinate;
            }
        }
    }
    let mut known = 0;
    for level in levels() {
        let hits = level.dispatch(OfLanes(&rays, &vertices));
        for (lane, (ray, triangle)) in scenes.iter().enumerate() {
            let name = level.level();
            let found = (hits.known >> lane & 1 != 0).then(|| hits.hit(lane));
            let bits = |hit: TriangleHit| [hit.t, hit.u, hit.v].map(f32::to_bits);
            for alone in levels() {
                let expected = alone.dispatch(OfOne(ray, triangle));
                assert_eq!(
                    found.map(bits),
                    expected.map(bits),
                    "{name:?}, alone {:?}, {ray:?}, {triangle:?}",
                    alone.level()
                );
            }
        }
        known = hits.known.count_ones();
    }
    known
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn every_lane_has_the_bits_of_a_ray_alone(ordinary in scenes(-12..12), any in scenes(-148..120)) {
        check(&ordinary);
        check(&any);
    }
}

#[test]
fn lanes_differ_in_what_is_known_of_them() {
    let triangle = |z: f32| {
        Triangle::new(
            Vec3::new(-1.0, -1.1, z),
            Vec3::new(1.2, -0.9, z),
            Vec3::new(0.1, 1.3, z),
        )
    };
    // Ahead, behind, at the origin, where `t` is not sure, and without area.
    let ray = Ray::new(Vec3::new(0.1, 0.05, 0.0), Vec3::new(0.01, 0.02, 1.0));
    let flat = Triangle::new(Vec3::X, Vec3::X, Vec3::Y);
    let scenes = [
        (ray, triangle(3.0)),
        (ray, triangle(-3.0)),
        (ray, flat),
        (ray, triangle(0.0)),
        (ray, triangle(1.0)),
        (ray, flat),
        (ray, triangle(-1.0)),
        (ray, flat),
    ];
    assert_eq!(check(&scenes), 4);
}
