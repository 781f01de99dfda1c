use std::ops::Range;

use glam::Vec3;
use proptest::prelude::*;

use super::super::exact_block::tests::{levels, scene};
use super::super::terms::{certain_hit, is_certainly_behind};
use super::*;
use crate::simd::{LANES, WithSimd};
use crate::{Ray, Triangle};

/// What the rung says of eight rays and triangles.
struct OfLanes<'a>(&'a RayLanes, &'a VertexLanes, u32);

impl WithSimd for OfLanes<'_> {
    type Output = (HitLanes, u32);

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> (HitLanes, u32) {
        let Self(rays, vertices, lanes) = self;
        let load = |[x, y, z]: &[Lanes; 3]| [simd.load(x), simd.load(y), simd.load(z)];
        let [a, b, c] = vertices;
        let vectors = [&rays.origin, &rays.direction, a, b, c].map(load);
        (
            certain_hits(simd, rays, vertices),
            certainly_behind(simd, vectors, lanes),
        )
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

/// Checks that each lane has what a ray alone has, to the last bit; gives how many hits are known, and how many planes are behind.
fn check(scenes: &[(Ray, Triangle)]) -> [u32; 2] {
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
    let mut counts = [0; 2];
    for level in levels() {
        let (hits, behind) = level.dispatch(OfLanes(&rays, &vertices, 0xff));
        for lanes in [0, 0x01, 0x0f, 0x28, 0x90] {
            let (_, found) = level.dispatch(OfLanes(&rays, &vertices, lanes));
            assert_eq!(found, behind & lanes, "of {lanes:b}");
        }
        for (lane, (ray, triangle)) in scenes.iter().enumerate() {
            let name = level.level();
            let found = (hits.known >> lane & 1 != 0).then(|| hits.hit(lane));
            let bits = |hit: TriangleHit| [hit.t, hit.u, hit.v].map(f32::to_bits);
            let expected = certain_hit(ray, triangle);
            assert_eq!(
                found.map(bits),
                expected.map(bits),
                "{name:?}, {ray:?}, {triangle:?}"
            );
            let [origin, direction] = [ray.origin, ray.direction].map(Vec3::into);
            let expected =
                is_certainly_behind(origin, direction, triangle.vertices().map(Vec3::into));
            assert_eq!(
                behind >> lane & 1 != 0,
                expected,
                "{name:?}, {ray:?}, {triangle:?}"
            );
        }
        counts = [hits.known.count_ones(), behind.count_ones()];
    }
    counts
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
    assert_eq!(check(&scenes), [4, 2]);
}
