//! Needles, slivers, tiny triangles, and rays in or close to the plane of a triangle: cases 13 to 16, 25 and 28.

use glam::{DVec3, Vec3, vec3};

use super::{HardCase, ratio};
use crate::test_support::soup;
use crate::{Ray, Triangle};

/// 13: A needle a million long and a thousandth wide.
pub(super) fn needle() -> Vec<HardCase> {
    let mesh = soup(vec![[
        Vec3::ZERO,
        vec3(1e6, 0.0, 0.0),
        vec3(0.5e6, 1e-3, 0.0),
    ]]);
    let down = |x: f32, y: f32| Ray::new(vec3(x, y, 1.0), Vec3::NEG_Z);
    let mut case = HardCase::new(13, "needle", mesh)
        .hits(down(0.5e6, 5e-4), 0, ratio(1, 1))
        .hits(down(0.5e6, 1e-3), 0, ratio(1, 1))
        .misses(down(0.5e6, 1e-3f32.next_up()))
        .misses(down(0.5e6f32.next_up(), 1e-3))
        .hits(down(0.5e6, 0.0), 0, ratio(1, 1))
        .hits(down(1e6, 0.0), 0, ratio(1, 1))
        .hits(down(0.0, 0.0), 0, ratio(1, 1))
        .misses(down(1e6f32.next_up(), 0.0))
        .misses(down(0.5e6, -1e-45));
    for step in 0..16u8 {
        let x = 0.625e5 * f32::from(step);
        // About the long edges, from above and from a slant.
        for y in [x * 2e-9, (x * 2e-9).next_up(), (x * 2e-9).next_down(), 1e-9] {
            let target = vec3(x, y, 0.0);
            let origin = vec3(3e5, -7.0, 11.0);
            case = case
                .asks(down(x, y))
                .asks(Ray::new(origin, target - origin));
        }
    }
    vec![case]
}

/// 14: A skinny triangle of sides near 11.2, 9.7 and 1.6, seen at half a degree from 590 away: rays that pass it miss, and `t` never leaves the
/// triangle's own range. Proportions after an issue of Embree, which reported a hit at t = 12 291.
pub(super) fn grazed_sliver() -> Vec<HardCase> {
    let mesh = soup(vec![[
        vec3(0.0, 0.0, 0.0),
        vec3(11.2, 0.0, 0.0),
        vec3(9.7, 0.5, 0.0),
    ]]);
    let slope = 0.5f32.to_radians().tan();
    // Aimed at (x, y) in the plane, from 590 before it.
    let graze =
        |x: f32, y: f32| Ray::new(vec3(x - 590.0, y, 590.0 * slope), vec3(1.0, 0.0, -slope));
    let mut case = HardCase::new(14, "grazed sliver", mesh);
    for step in 0..12u8 {
        let x = f32::from(step);
        for y in [0.0, 0.01, 0.05 * x, 0.25] {
            case = case.asks(graze(x, y));
        }
        case = case
            .misses(graze(x, 0.75))
            .misses(graze(x, -1e-6))
            .misses(graze(13.0 + x, 0.25))
            .misses(graze(-1.0 - 100.0 * x, 0.0));
    }
    vec![case]
}

/// 15: Distant edges that the ray passes within roundings, nearly in the planes of both triangles. All widths of vectors are to
/// agree; there is one kernel per precision so far.
pub(super) fn distant_coplanar_edges() -> Vec<HardCase> {
    let (a, b) = (vec3(1e5, -10.0, 0.1), vec3(1e5 + 20.0, 10.0, 0.3));
    let (c, d) = (vec3(1e5 + 5.0, 3.0, 1e-3), vec3(1e5 + 13.0, -2.0, 0.37));
    let mut case = HardCase::new(
        15,
        "distant edges, nearly coplanar",
        soup(vec![[a, b, c], [b, a, d]]),
    );
    let nudges: [fn(f32) -> f32; 3] = [f32::next_down, |value| value, f32::next_up];
    for step in 0..=8u8 {
        let target = a.lerp(b, 0.125 * f32::from(step));
        for nudge_y in nudges {
            for nudge_z in nudges {
                let direction = vec3(target.x, nudge_y(target.y), nudge_z(target.z));
                case = case.asks(Ray::new(Vec3::ZERO, direction));
            }
        }
    }
    vec![case]
}

/// 16: Rays in the plane of a triangle: no hit, wherever they run.
pub(super) fn ray_in_the_plane() -> Vec<HardCase> {
    let tilted = soup(vec![[Vec3::X, Vec3::Y, Vec3::Z]]);
    let mut tilted = HardCase::new(16, "in the plane x + y + z = 1", tilted);
    for origin in [
        vec3(1.0, 1.0, -1.0),
        vec3(2.0, -1.0, 0.0),
        vec3(0.25, 0.25, 0.5),
        Vec3::X,
    ] {
        for direction in [
            vec3(-1.0, 0.0, 1.0),
            vec3(-1.0, 1.0, 0.0),
            vec3(-2.0, 3.0, -1.0),
            vec3(0.0, -1e-10, 1e-10),
        ] {
            let whole = Ray::with_interval(origin, direction, f32::NEG_INFINITY, f32::INFINITY);
            tilted = tilted.misses(Ray::new(origin, direction)).misses(whole);
        }
    }
    let flat = soup(vec![
        [Vec3::ZERO, Vec3::X, Vec3::Y],
        [Vec3::Z, Vec3::X + Vec3::Z, Vec3::Y + Vec3::Z],
    ]);
    let flat = HardCase::new(16, "in an axis plane", flat)
        .misses(Ray::new(vec3(-1.0, 0.25, 0.0), Vec3::X))
        .misses(Ray::new(vec3(-1.0, 0.0, 0.0), vec3(1.0, -0.0, -0.0)))
        .misses(Ray::new(vec3(-1.0, 2.0, 0.0), vec3(1.0, -1.0, 0.0)))
        // One step out of the plane the ray meets the other triangle.
        .hits(
            Ray::new(vec3(0.25, 0.25, 0.0f32.next_up()), Vec3::Z),
            1,
            ratio(1, 1) - super::exact(0.0f32.next_up()),
        )
        .hits(Ray::new(vec3(0.25, 0.25, 0.0), Vec3::Z), 0, ratio(0, 1));
    vec![tilted, flat]
}

/// 25: Triangles with edges of about 2e-4, 1e-10, 1e-20 and of the smallest numbers.
pub(super) fn tiny_triangles() -> Vec<HardCase> {
    [
        ("edges 2^-12", -12),
        ("edges 2^-34", -34),
        ("edges 2^-66", -66),
        ("edges 2^-120", -120),
        ("edges 2^-140", -140),
    ]
    .into_iter()
    .map(|(name, exponent)| {
        // In two steps: powi has the reciprocal of a number that may overflow.
        let size = 2.0f32.powi(exponent / 2) * 2.0f32.powi(exponent / 2);
        let mesh = soup(vec![[Vec3::ZERO, Vec3::X * size, Vec3::Y * size]]);
        let down = |x: f32, y: f32, z: f32| Ray::new(vec3(x * size, y * size, z), Vec3::NEG_Z);
        let near = Ray::new(vec3(0.25, 0.5, 1.0) * size, Vec3::NEG_Z * size);
        HardCase::new(25, name, mesh)
            .hits(down(0.25, 0.25, 1.0), 0, ratio(1, 1))
            .hits(down(0.5, 0.5, 1.0), 0, ratio(1, 1))
            .hits(down(0.0, 1.0, 1024.0), 0, ratio(1024, 1))
            .misses(down(0.625, 0.5, 1.0))
            .misses(down(-0.25, 0.5, 1.0))
            .hits(near, 0, ratio(1, 1))
    })
    .collect()
}

/// 28: The origin is above or below a triangle by 1e-8 of its size, rounded to f32, and the ray leaves along the normal: the side is that of the
/// origin as given.
pub(super) fn origin_close_to_the_surface() -> Vec<HardCase> {
    let corners = [
        vec3(0.1, 0.2, 0.3),
        vec3(1.1, 0.35, 0.25),
        vec3(0.4, 1.3, 0.9),
    ];
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    let normal = Triangle::new(corners[0], corners[1], corners[2])
        .scaled_normal()
        .normalize();
    let mut case = HardCase::new(
        28,
        "origin within rounding of the surface",
        soup(vec![corners]),
    );
    for step in 1..24u8 {
        let u = f64::from(step) / 25.0;
        let v = (f64::from(step) * 0.618).fract() * (1.0 - u);
        let point: DVec3 = a + u * (b - a) + v * (c - a);
        for distance in [1e-8, -1e-8, 1e-6] {
            let origin = (point + distance * normal).as_vec3();
            let outward = normal.as_vec3();
            case = case
                .asks(Ray::new(origin, outward))
                .asks(Ray::new(origin, -outward));
        }
    }
    vec![case]
}
