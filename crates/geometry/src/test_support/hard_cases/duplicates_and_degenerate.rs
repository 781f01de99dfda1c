//! Triangles that coincide, nest, have no area or are not finite, and objects of very different sizes: cases 17 to 21, 31 and
//! 32.

use glam::{Vec3, vec3};

use super::shapes::{joined, mapped, mesh, sphere};
use super::{HardCase, exact, ratio};
use crate::test_support::soup;
use crate::{Ray, TriangleMesh};

/// 17: Triangles on top of each other in one plane: of those with the same `t`, the smallest index is hit.
pub(super) fn coplanar_overlap() -> Vec<HardCase> {
    let large = [Vec3::ZERO, vec3(4.0, 0.0, 0.0), vec3(0.0, 4.0, 0.0)];
    let decal = [
        vec3(1.0, 1.0, 0.0),
        vec3(2.0, 1.0, 0.0),
        vec3(1.0, 2.0, 0.0),
    ];
    let [a, b, c] = decal;
    let down = |x: f32, y: f32| Ray::new(vec3(x, y, 1.0), Vec3::NEG_Z);
    let decal_last = HardCase::new(
        17,
        "decal after the wall",
        soup(vec![large, decal, [a, c, b]]),
    )
    .hits(down(1.25, 1.25), 0, ratio(1, 1))
    .crosses(3)
    .hits(down(1.0, 1.0), 0, ratio(1, 1))
    .hits(down(0.5, 0.5), 0, ratio(1, 1))
    .crosses(1);
    let decal_first = HardCase::new(17, "decal before the wall", soup(vec![decal, large]))
        .hits(down(1.25, 1.25), 0, ratio(1, 1))
        .hits(down(1.5, 1.5), 0, ratio(1, 1))
        .hits(down(1.5, 1.5f32.next_up()), 1, ratio(1, 1))
        .hits(down(0.5, 0.5), 1, ratio(1, 1));
    // Both in the plane x + 2y + 3z = 6, with no edge in common.
    let wall = [
        vec3(6.0, 0.0, 0.0),
        vec3(0.0, 3.0, 0.0),
        vec3(0.0, 0.0, 2.0),
    ];
    let decal = [
        vec3(1.0, 1.0, 1.0),
        vec3(3.0, 0.0, 1.0),
        vec3(4.0, 1.0, 0.0),
    ];
    let diagonal = |origin: Vec3| Ray::new(origin, Vec3::NEG_ONE);
    let tilted = [
        ("tilted decal after the wall", [wall, decal]),
        ("tilted decal before the wall", [decal, wall]),
    ]
    .map(|(name, triangles)| {
        let case = HardCase::new(17, name, soup(triangles.to_vec()));
        case.hits(diagonal(vec3(5.0, 5.0, 5.0)), 0, ratio(4, 1))
            .hits_at(diagonal(vec3(5.0, 4.0, 5.0)), ratio(11, 3))
            .hits_at(diagonal(vec3(6.0, 4.0, 4.0)), ratio(10, 3))
    });
    [decal_last, decal_first]
        .into_iter()
        .chain(tilted)
        .collect()
}

/// 18: A triangle twice, as often as leaves are large and once more, and a few hundred times. A hundred thousand are for
/// [`check_many_duplicates`](super::check_many_duplicates).
pub(super) fn duplicates() -> Vec<HardCase> {
    [
        ("2 equal triangles", 2u16),
        ("3 equal triangles", 3),
        ("5 equal triangles", 5),
        ("9 equal triangles", 9),
        ("257 equal triangles", 257),
    ]
    .into_iter()
    .map(|(name, count)| {
        let equal = soup(vec![[Vec3::ZERO, Vec3::X, Vec3::Y]; usize::from(count)]);
        let down = Ray::new(vec3(0.25, 0.25, 1.0), Vec3::NEG_Z);
        HardCase::new(18, name, equal)
            .hits(down, 0, ratio(1, 1))
            .crosses(usize::from(count))
            .ignoring_it_hits(1, ratio(1, 1))
            .hits(Ray::new(vec3(0.5, 0.5, -2.0), Vec3::Z), 0, ratio(2, 1))
            .misses(Ray::new(vec3(0.5, 0.5f32.next_up(), -2.0), Vec3::Z))
    })
    .collect()
}

/// 19: Concentric shells, whose boxes all have the same centre.
pub(super) fn concentric_shells() -> Vec<HardCase> {
    // Tilted, so that the boxes have a thickness and nest in each other.
    let shell = |size: u8| {
        let size = f32::from(size);
        [
            vec3(-size, -size, -size),
            vec3(size, -size, 0.0),
            vec3(0.0, size, size),
        ]
    };
    let nested = soup((1..=64).map(shell).collect());
    let down = |x: f32, y: f32| Ray::new(vec3(x, y, 100.0), Vec3::NEG_Z);
    let mut case = HardCase::new(19, "triangles around one centre", nested);
    for step in 0..16u8 {
        let (x, y) = (f32::from(step) * 0.5 - 4.0, f32::from(step) * 3.0 - 20.0);
        case = case
            .asks(down(x, y))
            .asks(Ray::new(Vec3::ZERO, vec3(x, y, 1.0)));
    }
    let spheres = (2..=8u8).fold(sphere(0), |spheres, size| {
        joined(
            &spheres,
            &mapped(&sphere(0), |vertex| vertex * f32::from(size)),
        )
    });
    let mut closed = HardCase::new(19, "spheres around one centre", spheres).closed();
    for direction in sphere(1).vertices() {
        let outside = vec3(17.0, 19.0, 23.0);
        closed = closed
            .asks(Ray::new(Vec3::ZERO, *direction))
            .crosses(8)
            .asks(Ray::new(outside, 3.0 * *direction - outside))
            .starting_outside();
    }
    vec![case, closed]
}

/// A triangle in itself at half the size, over and over: `count` of them, the smallest one first.
pub(super) fn nested_halves(count: u8) -> TriangleMesh {
    let nested = |index: u8| {
        [Vec3::ZERO, Vec3::X, Vec3::Y]
            .map(|corner| corner * 2.0f32.powi(i32::from(index) + 1 - i32::from(count)))
    };
    soup((0..count).map(nested).collect())
}

/// Triangles apart from each other, at right angles to the x axis, each half as large and half as far from zero as the one before: `count` of
/// them.
pub(super) fn stack_of_halves(count: u8) -> TriangleMesh {
    let upright = |index: u8| {
        [Vec3::X, vec3(1.0, 1.0, 0.0), vec3(1.0, 0.0, 1.0)]
            .map(|corner| corner * 2.0f32.powi(-i32::from(index)))
    };
    soup((0..count).map(upright).collect())
}

/// 20: 120 triangles, each half as large as another, in each other or one behind the other: trees may become more than a hundred deep.
pub(super) fn deep_nesting() -> Vec<HardCase> {
    let mut case = HardCase::new(20, "nested halves", nested_halves(120));
    let mut stack = HardCase::new(20, "stack of halves", stack_of_halves(120));
    for index in (0..120u8).step_by(10) {
        // On the long edge of one triangle, before all larger ones, at a t that f32 mostly cannot tell from theirs.
        let size = 2.0f32.powi(-i32::from(index));
        let along = Ray::new(vec3(-1.0, 0.5 * size, 0.5 * size), Vec3::X);
        stack = stack.hits(along, u32::from(index), ratio(1, 1) + exact(size));
    }
    for exponent in (0..120i32).step_by(12) {
        // On the long edge of one triangle: it is hit, as are all larger ones, and the smallest index is its own.
        let half = 0.5 * 2.0f32.powi(-exponent);
        let primitive = 119 - exponent.unsigned_abs();
        let down = Ray::new(vec3(half, half, 1.0), Vec3::NEG_Z);
        case = case.hits(down, primitive, ratio(1, 1));
    }
    let beside = Ray::new(vec3(0.5, 0.5f32.next_up(), 1.0), Vec3::NEG_Z);
    vec![
        case.misses(beside)
            .hits(Ray::new(Vec3::Z, Vec3::NEG_Z), 0, ratio(1, 1)),
        stack,
    ]
}

/// A sphere of 2^(3 + 2 * level) triangles, 1e-2 in size, and the two triangles of a floor 1e5 wide.
pub(super) fn teapot_in_a_stadium(level: u32) -> TriangleMesh {
    let small = mapped(&sphere(level), |vertex| vertex * 1e-2);
    let floor = [(-1e5, -1e5), (1e5, -1e5), (1e5, 1e5), (-1e5, 1e5)].map(|(x, z)| vec3(x, -1.0, z));
    joined(&small, &mesh(floor.to_vec(), vec![[0, 1, 2], [0, 2, 3]]))
}

/// 21: A small object on a very large floor. What it costs is for [`check_cost_of_a_stadium`](super::check_cost_of_a_stadium).
pub(super) fn small_on_large() -> Vec<HardCase> {
    let mut case = HardCase::new(21, "teapot in a stadium", teapot_in_a_stadium(2));
    let floor = 128;
    for vertex in sphere(2).vertices().iter().step_by(2) {
        let target = *vertex * 1e-2;
        for origin in [
            vec3(0.03, 0.02, 0.05),
            vec3(0.0, 3.0, 1.0),
            vec3(3e4, 2e4, -1e4),
        ] {
            case = case.asks(Ray::new(origin, target - origin));
        }
    }
    for x in [-1e5, -3e4, 0.03, 1.0, 1e5] {
        let down = Ray::new(vec3(x, 1.0, 0.5), Vec3::NEG_Y);
        case = case.hits_at(down, ratio(2, 1));
    }
    // On the diagonal of the floor.
    let down = Ray::new(vec3(7.0, 1.0, 7.0), Vec3::NEG_Y);
    vec![case.hits(down, floor, ratio(2, 1)).crosses(1)]
}

/// 31: Points, segments and triangles that are flat exactly or but for rounding, before a good one.
pub(super) fn degenerate_triangles() -> Vec<HardCase> {
    let p = vec3(0.1, 0.2, 0.3);
    let shape = soup(vec![
        [Vec3::ONE; 3],
        [Vec3::ZERO, Vec3::X, Vec3::X],
        [
            vec3(0.0, 0.0, 1.0),
            vec3(1.0, 1.0, 1.0),
            vec3(0.5, 0.5, 1.0),
        ],
        [p, 2.0 * p, 4.0 * p],
        // On a line but for rounding: they may have an area, and then they can be hit.
        [p, 3.0 * p, 7.0 * p],
        [
            vec3(0.1, 0.1, 0.1),
            vec3(0.2, 0.2, 0.2),
            vec3(0.3, 0.3, 0.3),
        ],
        [Vec3::ZERO, vec3(4.0, 0.0, 0.0), vec3(0.0, 4.0, 0.0)],
        [Vec3::ZERO; 3],
    ]);
    let down = |x: f32, y: f32| Ray::new(vec3(x, y, 2.0), Vec3::NEG_Z);
    let mut case = HardCase::new(31, "degenerate triangles", shape.clone())
        .hits(down(1.0, 1.0), 6, ratio(2, 1))
        .hits(down(0.5, 0.5), 6, ratio(2, 1))
        .hits(down(0.25, 0.25), 6, ratio(2, 1))
        .hits(down(0.0, 0.0), 6, ratio(2, 1))
        .hits(down(0.5, 0.0), 6, ratio(2, 1));
    for triangle in shape.triangles() {
        let [a, b, c] = triangle.vertices();
        for target in [a, b, c, a.midpoint(b), (a + b + c) / 3.0] {
            for origin in [vec3(0.3, 0.1, 2.0), vec3(-3.0, 1.0, -0.5), target + Vec3::Z] {
                case = case.asks(Ray::new(origin, target - origin));
            }
        }
    }
    let only = soup(vec![[p, 2.0 * p, 4.0 * p], [p; 3]]);
    let only = HardCase::new(31, "nothing but degenerate triangles", only)
        .misses(Ray::new(p + Vec3::Z, Vec3::NEG_Z))
        .misses(Ray::new(Vec3::ZERO, p));
    vec![case, only]
}

/// 32: Triangles with vertices that are NaN or infinite are dropped, and the others are hit as if they had never been there.
///
/// # Panics
/// If other triangles are dropped than the two that are not finite.
pub(super) fn dropped_triangles() -> Vec<HardCase> {
    let corner = |index: u16| vec3(f32::from(index % 20), f32::from(index / 20), 0.0);
    let separate = |index: u16| {
        [
            corner(index),
            corner(index) + 0.75 * Vec3::X,
            corner(index) + 0.75 * Vec3::Y,
        ]
    };
    let mut vertices = (0..400).map(separate).collect::<Vec<_>>().into_flattened();
    vertices[3 * 123 + 1].y = f32::NAN;
    vertices[3 * 301].x = f32::NEG_INFINITY;
    let indices = (0..1200)
        .step_by(3)
        .map(|first| [first, first + 1, first + 2])
        .collect();
    let (valid, dropped) =
        TriangleMesh::new_dropping_invalid(vertices, indices).expect("few triangles");
    let dropped: Vec<usize> = dropped.iter().map(|dropped| dropped.triangle).collect();
    assert_eq!(dropped, [123, 301], "the triangles that are not finite");
    let mut case = HardCase::new(32, "two of 400 triangles dropped", valid);
    for index in
        (0..400).filter(|index| index % 7 == 0 || [122, 123, 124, 301, 302].contains(index))
    {
        let down = Ray::new(corner(index) + vec3(0.25, 0.25, 1.0), Vec3::NEG_Z);
        let number = match index {
            123 | 301 => None,
            _ => Some(u32::from(index) - u32::from(index > 123) - u32::from(index > 301)),
        };
        case = match number {
            Some(number) => case.hits(down, number, ratio(1, 1)),
            None => case.misses(down),
        };
    }
    vec![case]
}
