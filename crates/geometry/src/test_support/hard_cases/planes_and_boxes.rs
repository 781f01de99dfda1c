//! Rays and triangles in splitting planes and in faces of boxes, and the smallest scenes: cases 1 to 7, 33 and 34.

use glam::{Vec3, vec3};

use super::shapes::{cube, cuboid, height_field};
use super::{HardCase, exact, ratio};
use crate::test_support::soup;
use crate::{Axis, Ray, TriangleMesh};

/// Both zeros.
const ZEROS: [f32; 2] = [0.0, -0.0];

/// 1: The ray runs in the plane x = 0, which triangles on both sides touch.
pub(super) fn ray_in_a_splitting_plane() -> Vec<HardCase> {
    let left = |z: f32| [vec3(-1.0, -1.0, z), vec3(0.0, -1.0, z), vec3(0.0, 1.0, z)];
    let right = |z: f32| [vec3(0.0, -1.0, z), vec3(1.0, -1.0, z), vec3(0.0, 1.0, z)];
    let mesh = soup(vec![
        left(0.0),
        left(2.0),
        left(4.0),
        right(1.0),
        right(3.0),
        right(5.0),
    ]);
    let mut case = HardCase::new(1, "ray in a splitting plane", mesh);
    for zero in ZEROS {
        for y in [-1.0, 0.0, 1.0] {
            let up = vec3(zero, zero, 1.0);
            case = case
                .hits(Ray::new(vec3(0.0, y, -5.0), up), 0, ratio(5, 1))
                .hits(Ray::new(vec3(0.0, y, 0.5), up), 3, ratio(1, 2))
                .hits(Ray::new(vec3(0.0, y, 10.0), -up), 5, ratio(5, 1))
                .hits(Ray::new(vec3(zero, y, 4.5), -2.0 * up), 2, ratio(1, 4))
                .misses(Ray::new(vec3(0.0, y, 5.5), up));
        }
        // In the plane and across it.
        case = case
            .hits(
                Ray::new(vec3(0.0, -2.0, -1.0), vec3(zero, 1.0, 1.0)),
                0,
                ratio(1, 1),
            )
            .hits(
                Ray::new(vec3(0.0, 3.0, 3.0), vec3(zero, -2.0, -2.0)),
                3,
                ratio(1, 1),
            );
    }
    vec![case]
}

/// 2: A triangle lies in the splitting plane, and the ray crosses it at right angles.
pub(super) fn triangle_in_a_splitting_plane() -> Vec<HardCase> {
    let planar = [
        vec3(0.0, -1.0, -1.0),
        vec3(0.0, 1.0, -1.0),
        vec3(0.0, 0.0, 2.0),
    ];
    let sides = [1.0f32, 2.0, 3.0, 4.0, -1.0, -2.0, -3.0, -4.0]
        .map(|x| [vec3(0.0, 5.0, 0.0), vec3(x, 5.0, 0.0), vec3(x, 6.0, 1.0)]);
    let mesh = soup([vec![planar], sides.to_vec()].concat());
    let at = |t_min, t_max| Ray::with_interval(vec3(-5.0, 0.0, 0.0), Vec3::X, t_min, t_max);
    let (below, above) = (5.0f32.next_down(), 5.0f32.next_up());
    let mut case = HardCase::new(2, "triangle in a splitting plane", mesh)
        .hits(at(0.0, f32::INFINITY), 0, ratio(5, 1))
        .hits(at(5.0, 5.0), 0, ratio(5, 1))
        .misses(at(0.0, below))
        .misses(at(above, f32::INFINITY))
        .hits(
            Ray::new(vec3(5.0, 0.0, 0.0), vec3(-2.0, -0.0, 0.0)),
            0,
            ratio(5, 2),
        )
        .hits(Ray::new(vec3(-5.0, 0.0, 2.0), Vec3::X), 0, ratio(5, 1))
        .hits(Ray::new(vec3(-5.0, 0.0, -1.0), Vec3::X), 0, ratio(5, 1))
        .misses(Ray::new(vec3(-5.0, 0.0, 2.0f32.next_up()), Vec3::X));
    for direction in [Vec3::X, Vec3::NEG_X, vec3(1.0, 2.0, 3.0)] {
        case = case.hits(Ray::new(Vec3::ZERO, direction), 0, ratio(0, 1));
    }
    vec![case]
}

/// 3: The origin is on the splitting plane, and the ray leaves it to either side, or not.
pub(super) fn origin_on_a_splitting_plane() -> Vec<HardCase> {
    let wall = |x: f32| [vec3(x, -3.0, -3.0), vec3(x, 3.0, -3.0), vec3(x, 0.0, 6.0)];
    let ceiling = [
        vec3(-1.0, -1.0, 2.0),
        vec3(1.0, -1.0, 2.0),
        vec3(0.0, 3.0, 2.0),
    ];
    let touching = [0.5f32, -0.5].map(|x| {
        [
            vec3(0.0, -2.0, -2.0),
            vec3(x, -2.0, -2.0),
            vec3(0.0, -3.0, -2.0),
        ]
    });
    let mesh = soup([vec![wall(-1.0), wall(1.0), ceiling], touching.to_vec()].concat());
    let mut case = HardCase::new(3, "origin on a splitting plane", mesh);
    for zero in ZEROS {
        for origin in [vec3(zero, zero, 0.0), vec3(zero, 0.25, 0.0)] {
            case = case
                .hits(Ray::new(origin, vec3(1.0, zero, zero)), 1, ratio(1, 1))
                .hits(Ray::new(origin, vec3(-1.0, zero, zero)), 0, ratio(1, 1))
                .hits(Ray::new(origin, vec3(zero, zero, 1.0)), 2, ratio(2, 1))
                .hits(Ray::new(origin, vec3(1e-20, zero, 1.0)), 2, ratio(2, 1))
                .hits(Ray::new(origin, vec3(-1e-20, zero, 1.0)), 2, ratio(2, 1))
                .hits(Ray::new(origin, vec3(1.0, zero, 1.0)), 1, ratio(1, 1))
                .hits(Ray::new(origin, vec3(-4.0, zero, 1.0)), 0, ratio(1, 4))
                .misses(Ray::new(origin, vec3(zero, 1.0, zero)));
        }
    }
    vec![case]
}

/// 4: The ray runs in a face of a box, and along its edges.
pub(super) fn ray_in_a_box_face() -> Vec<HardCase> {
    let mut case = HardCase::new(4, "ray in a face of a box", cube()).closed();
    for zero in ZEROS {
        let up = |x: f32, y: f32| Ray::new(vec3(x, y, -1.0), vec3(zero, zero, 1.0));
        case = case
            .hits(up(0.0, 0.5), 8, ratio(1, 1))
            .hits(up(1.0, 0.5), 9, ratio(1, 1))
            .hits(up(0.5, 0.0), 9, ratio(1, 1))
            .hits(up(0.5, 1.0), 8, ratio(1, 1))
            .hits(up(0.0, 0.0), 8, ratio(1, 1))
            .hits(up(1.0, 1.0), 8, ratio(1, 1))
            .hits(up(1.0, 0.0), 9, ratio(1, 1))
            .hits(up(0.0, 1.0), 8, ratio(1, 1))
            .misses(up(1.0f32.next_up(), 0.5))
            .misses(up(-f32::MIN_POSITIVE, 0.5));
    }
    vec![case]
}

/// 5: Directions with zeros of either sign, along all axes, through the insides, edges and corners of faces.
pub(super) fn negative_zeros() -> Vec<HardCase> {
    let mut case = HardCase::new(5, "negative zeros in the direction", cube()).closed();
    let places = [0.0, 0.5, 1.0].map(|first| [0.0, 0.5, 1.0].map(|second| (first, second)));
    for axis in Axis::ALL {
        for (first, second) in places.into_iter().flatten() {
            for zeros in [[0.0, 0.0], [0.0, -0.0], [-0.0, 0.0], [-0.0, -0.0]] {
                for sign in [1.0, -1.0] {
                    let start = if sign > 0.0 { -1.0 } else { 2.0 };
                    let along = |a: f32, b: f32, c: f32| {
                        let mut vector = Vec3::ZERO;
                        vector[axis as usize] = a;
                        vector[axis.next() as usize] = b;
                        vector[axis.next().next() as usize] = c;
                        vector
                    };
                    let direction = along(sign, zeros[0], zeros[1]);
                    let ray = Ray::new(along(start, first, second), direction);
                    case = case.hits_at(ray, ratio(1, 1)).starting_outside();
                }
            }
        }
    }
    vec![case]
}

/// 6: Components of the direction, or all of it, are denormal. Rust keeps denormals (flushing them to zero is
/// not legal for a Rust program), so the answers are those for the numbers as they are.
pub(super) fn denormal_directions() -> Vec<HardCase> {
    let tiny = 1e-40;
    let ray = |x: f32, y: f32, z: f32, direction: Vec3| Ray::new(vec3(x, y, z), direction);
    let up_to_max = Ray {
        t_max: f32::MAX,
        ..ray(0.5, 0.25, -1.0, vec3(0.0, 0.0, tiny))
    };
    let case = HardCase::new(6, "denormal directions", cube())
        .closed()
        .hits(ray(0.0, 0.5, -1.0, vec3(tiny, 0.0, 1.0)), 8, ratio(1, 1))
        .hits(ray(0.0, 0.5, -1.0, vec3(1e-45, 0.0, 1.0)), 8, ratio(1, 1))
        .misses(ray(0.0, 0.5, -1.0, vec3(-tiny, 0.0, 1.0)))
        .misses(ray(0.0, 0.5, -1.0, vec3(-1e-45, 0.0, 1.0)))
        .misses(ray(1.0, 0.5, -1.0, vec3(tiny, 0.0, 1.0)))
        .hits(ray(0.0, 0.25, -1.0, vec3(tiny, tiny, 1.0)), 8, ratio(1, 1))
        // t is beyond the largest f32: it is the closest hit all the same, unless the interval ends before it.
        .hits(
            ray(0.5, 0.25, -1.0, vec3(0.0, 0.0, tiny)),
            9,
            ratio(1, 1) / exact(tiny),
        )
        .misses(up_to_max)
        .hits(
            ray(-1.0, -1.0, -1.0, Vec3::splat(tiny)),
            0,
            ratio(1, 1) / exact(tiny),
        )
        .hits(
            ray(0.5, 0.25, -1e-5, vec3(0.0, 0.0, tiny)),
            9,
            exact(1e-5) / exact(tiny),
        )
        .hits(ray(0.5, 0.25, -1e-40, vec3(0.0, 0.0, tiny)), 9, ratio(1, 1));
    vec![case]
}

/// 7: Rays along an axis on faces whose coordinates are no short binary fractions.
pub(super) fn axis_ray_on_a_rounded_face() -> Vec<HardCase> {
    let small = cuboid(vec3(0.1, 0.2, 0.3), vec3(0.7, 0.9, 1.3));
    let far = cuboid(vec3(1e5 + 0.1, 0.2, 123.3), vec3(2e5 + 0.7, 0.9, 123.4));
    [("small", small), ("long and far", far)]
        .into_iter()
        .map(|(name, mesh)| {
            let bounds = mesh.aabb();
            let (min, max, center) = (bounds.min, bounds.max, bounds.center());
            let t = exact(min.x) - exact(-5.0);
            let mut case = HardCase::new(7, name, mesh).closed();
            for zero in ZEROS {
                let ray = |y: f32, z: f32| Ray::new(vec3(-5.0, y, z), vec3(1.0, zero, zero));
                case = case
                    .hits(ray(min.y, center.z), 0, t.clone())
                    .hits(ray(max.y, center.z), 1, t.clone())
                    .hits(ray(center.y, min.z), 1, t.clone())
                    .hits(ray(center.y, max.z), 0, t.clone())
                    .hits(ray(min.y, min.z), 0, t.clone())
                    .misses(ray(min.y.next_down(), center.z))
                    .misses(ray(center.y, max.z.next_up()));
            }
            case
        })
        .collect()
}

/// 33: No triangles, and one to four of them.
pub(super) fn few_triangles() -> Vec<HardCase> {
    let at = |z: u8| {
        [
            vec3(0.0, 0.0, f32::from(z)),
            vec3(1.0, 0.0, f32::from(z)),
            vec3(0.0, 1.0, f32::from(z)),
        ]
    };
    let down = Ray::new(vec3(0.25, 0.25, 8.0), Vec3::NEG_Z);
    let names = [
        "one triangle",
        "two triangles",
        "three triangles",
        "four triangles",
    ];
    let stacks = (1u8..).zip(names).map(|(count, name)| {
        HardCase::new(33, name, soup((0..count).map(at).collect()))
            .hits(down, u32::from(count) - 1, ratio(9 - i64::from(count), 1))
            .hits(Ray::new(vec3(0.25, 0.25, -1.0), Vec3::Z), 0, ratio(1, 1))
            .misses(Ray::new(vec3(0.75, 0.75, 8.0), Vec3::NEG_Z))
    });
    let empty = HardCase::new(33, "no triangles", TriangleMesh::default())
        .misses(down)
        .misses(Ray::new(Vec3::ZERO, Vec3::X));
    stacks.chain([empty]).collect()
}

/// 34: All triangles lie in one plane; rays perpendicular to it, grazing and in it.
pub(super) fn flat_scene() -> Vec<HardCase> {
    let mut case = HardCase::new(
        34,
        "all triangles in one plane",
        height_field(6, |_, _| 0.0),
    );
    for x in 0..=6u8 {
        for y in [0u8, 3, 6] {
            let down = Ray::new(vec3(f32::from(x), f32::from(y), 1.0), Vec3::NEG_Z);
            case = case.hits_at(down, ratio(1, 1));
        }
        let y = f32::from(x);
        case = case
            .misses(Ray::new(vec3(-1.0, y, 0.0), Vec3::X))
            .misses(Ray::new(vec3(y, y, 0.0), vec3(1.0, 1.0, -0.0)))
            .asks(Ray::new(vec3(-1.0, y, 1e-7), vec3(1.0, 0.01, -1e-7)))
            .asks(Ray::new(vec3(-1.0, 3.3, 4e-7), vec3(1.0, 0.01, -1e-7)));
    }
    vec![case]
}
