//! Cells of trees: triangles across many of them, rays along their planes, and cells that are slivers and wedges: cases 35 to 41.

use std::f32::consts::TAU;

use glam::{Vec3, vec3};

use super::aimed::aimed_at_features;
use super::shapes::{count, height_field, joined, mesh, wedge};
use super::{HardCase, exact, ratio};
use crate::test_support::soup;
use crate::{Ray, TriangleMesh};

/// 35: Rays at an angle of 1e-7 along a floor of many triangles, flat or uneven by as little.
pub(super) fn grazing_a_floor() -> Vec<HardCase> {
    let flat = height_field(10, |_, _| 0.0);
    let uneven = height_field(10, |x, y| (x * 7.0 + y * 3.0) % 5.0 * 1e-7);
    [
        ("grazing a flat floor", flat),
        ("grazing an uneven floor", uneven),
    ]
    .into_iter()
    .map(|(name, floor)| {
        let mut case = HardCase::new(35, name, floor);
        for step in 0..10u8 {
            let y = f32::from(step);
            let height = 1e-7 * (y + 1.5);
            case = case
                .asks(Ray::new(vec3(-1.0, y, height), vec3(1.0, 0.0, -1e-7)))
                .asks(Ray::new(
                    vec3(-1.0, y + 0.3, height),
                    vec3(1.0, 0.05, -1e-7),
                ))
                .asks(Ray::new(
                    vec3(11.0, 5.0, height),
                    vec3(-1.0, 0.5 - 0.1 * y, -1e-7),
                ))
                .asks(Ray::new(vec3(-1.0, -1.0, height), vec3(1.0, 1.0, -1e-7)));
        }
        case
    })
    .collect()
}

/// 36: A long triangle is found in the first of many cells, its hit lies in a late one, and a nearer triangle between.
pub(super) fn long_triangle() -> Vec<HardCase> {
    // The plane z = x / 10 - 9: the x axis is met at x = 90.
    let long = [
        vec3(0.0, -1.0, -9.0),
        vec3(100.0, -1.0, 1.0),
        vec3(100.0, 3.0, 1.0),
    ];
    let beside = (1..99u8)
        .map(|x| [1.0, 2.0].map(|y| vec3(f32::from(x), y, 0.25)))
        .map(|[a, b]| [a, b, b + 0.5 * Vec3::X]);
    let wall = |x: f32| [vec3(x, -1.0, -1.0), vec3(x, 1.0, -1.0), vec3(x, 0.0, 1.0)];
    let shape = soup(
        [long]
            .into_iter()
            .chain(beside)
            .chain([wall(95.0), wall(80.0)])
            .collect(),
    );
    let [behind, before] = [99, 100];
    let along =
        |t_min: f32| Ray::with_interval(vec3(-5.0, 0.0, 0.0), Vec3::X, t_min, f32::INFINITY);
    let case = HardCase::new(36, "long triangle across many cells", shape)
        .hits(along(0.0), before, ratio(85, 1))
        .ignoring_it_hits(0, ratio(95, 1))
        .crosses(3)
        .hits(along(85.5), 0, ratio(95, 1))
        .ignoring_it_hits(behind, ratio(100, 1))
        .hits(along(95.5), behind, ratio(100, 1))
        .hits(
            Ray::new(vec3(200.0, 0.0, 0.0), vec3(-2.0, -0.0, 0.0)),
            behind,
            ratio(105, 2),
        )
        .misses(along(101.0));
    vec![case]
}

/// A tilted floor, uneven by roundings, with walls across its end.
fn tilted_floor() -> TriangleMesh {
    let floor = height_field(8, |x, y| 0.3 * x + 0.7 * y);
    let wall = [
        vec3(8.0, 0.0, -10.0),
        vec3(8.0, 8.0, -10.0),
        vec3(8.0, 4.0, 30.0),
    ];
    let across = [
        vec3(0.0, 4.0, -10.0),
        vec3(8.0, 4.0, -10.0),
        vec3(4.0, 4.0, 30.0),
    ];
    joined(&floor, &soup(vec![wall, across]))
}

/// 37: Rays nearly in planes that are not parallel to an axis, with origins within rounding of them.
pub(super) fn ray_along_a_general_plane() -> Vec<HardCase> {
    let mut case = HardCase::new(37, "along a tilted plane", tilted_floor());
    for step in 0..12u8 {
        let (x, y) = (0.61 * f32::from(step), 7.7 - 0.59 * f32::from(step));
        let origin = vec3(x, y, 0.3 * x + 0.7 * y);
        for direction in [
            vec3(1.0, 0.0, 0.3),
            vec3(0.5, -0.25, -0.025),
            vec3(-1.0, 1.0, 0.4),
        ] {
            for nudge in [-1e-7, 0.0, 1e-7] {
                case = case
                    .asks(Ray::new(origin, direction + nudge * Vec3::Z))
                    .asks(Ray::new(
                        origin - 2.0 * direction,
                        direction + nudge * Vec3::Z,
                    ));
            }
        }
    }
    vec![case]
}

/// 38: Two planes at an angle of 1e-6, rays through the wedge between them and small triangles inside it.
pub(super) fn acute_wedge() -> Vec<HardCase> {
    let slope = 1e-6;
    let inside = (1..8u8).map(|step| {
        let x = f32::from(step);
        let z = 0.5 * slope * x;
        [
            vec3(x, x - 4.0, z),
            vec3(x + 0.5, x - 4.0, z),
            vec3(x, x - 3.0, 1.1 * z),
        ]
    });
    let shape = joined(&wedge(10.0, slope), &soup(inside.collect()));
    let mut case = HardCase::new(38, "wedge of 1e-6", shape);
    for step in 0..16u8 {
        let y = f32::from(step) - 8.0;
        let z = slope * (f32::from(step) - 5.0);
        case = case
            .asks(Ray::new(vec3(20.0, y, z), vec3(-1.0, 0.0, 0.0)))
            .asks(Ray::new(vec3(20.0, y, z), vec3(-1.0, 0.03, -0.5 * slope)))
            .asks(Ray::new(
                vec3(-20.0, 0.25 * y, z),
                vec3(1.0, 0.1, 0.75 * slope),
            ))
            .asks(Ray::new(vec3(1.0 + 0.5 * y, y - 3.5, 1.0), Vec3::NEG_Z))
            .hits_something(Ray::new(vec3(0.0, y, -1.0), Vec3::Z));
    }
    vec![case]
}

/// 39: Triangles in planes a ten-millionth apart, parallel and around one axis: cells between them are slivers.
pub(super) fn sliver_cells() -> Vec<HardCase> {
    let thin = |step: u8| f32::from(step) * 1e-7;
    let fan = (0..24).map(|step| {
        [
            Vec3::ZERO,
            vec3(1.0, 0.0, thin(step)),
            vec3(1.0, 1.0, thin(step)),
        ]
    });
    let sheets = (0..24).map(|step| {
        [
            vec3(2.0, 0.0, thin(step)),
            vec3(3.0, 0.0, thin(step)),
            vec3(2.0, 1.0, thin(step)),
        ]
    });
    let mut case = HardCase::new(39, "planes 1e-7 apart", soup(fan.chain(sheets).collect()));
    let top = exact(thin(23));
    for step in 0..24u8 {
        let height = thin(step);
        case = case
            .hits(
                Ray::new(vec3(2.25, 0.25, height), Vec3::Z),
                24 + u32::from(step),
                ratio(0, 1),
            )
            .hits(
                Ray::new(vec3(2.25, 0.25, height.next_up()), Vec3::NEG_Z),
                24 + u32::from(step),
                exact(height.next_up()) - exact(height),
            )
            .asks(Ray::new(
                vec3(-1.0, 0.1 + height, 0.5 * height),
                vec3(1.0, 0.1, 0.4e-7),
            ))
            .asks(Ray::new(vec3(4.0, 0.3, height), vec3(-1.0, 0.0, -1e-8)));
    }
    let down = Ray::new(vec3(2.25, 0.25, 1.0), Vec3::NEG_Z);
    let apex = Ray::new(Vec3::Z, Vec3::NEG_Z);
    vec![
        case.hits(down, 47, ratio(1, 1) - top)
            .crosses(24)
            .hits(apex, 0, ratio(1, 1)),
    ]
}

/// 40: A prism with seven sides, turned so that no plane is exact: planes through its edges at right angles to its faces leave
/// neighbours on both sides by rounding.
pub(super) fn turned_prism() -> Vec<HardCase> {
    let sides = 7u8;
    let turn = glam::Quat::from_rotation_x(0.7) * glam::Quat::from_rotation_z(0.3);
    let ring = |z: f32| {
        (0..sides).map(move |side| {
            let angle = TAU * f32::from(side) / f32::from(sides);
            turn * vec3(angle.cos(), angle.sin(), z)
        })
    };
    let vertices: Vec<Vec3> = ring(-1.0).chain(ring(1.0)).collect();
    let n = u32::from(sides);
    let walls = (0..n).flat_map(|i| {
        let j = (i + 1) % n;
        [[i, j, n + j], [i, n + j, n + i]]
    });
    let caps = (1..n - 1).flat_map(|i| [[0, i + 1, i], [n, n + i, n + i + 1]]);
    let prism = mesh(vertices, walls.chain(caps).collect());
    let aimed = aimed_at_features(
        &prism,
        &[vec3(4.0, -3.0, 2.0), vec3(-0.5, 9.0, 0.0)],
        &[Vec3::ZERO],
    );
    vec![
        HardCase::new(40, "turned prism", prism)
            .closed()
            .asks_all(aimed),
    ]
}

/// 41: A dome so flat that three neighbouring planes hardly meet in a point.
pub(super) fn nearly_coplanar_planes() -> Vec<HardCase> {
    let dome = height_field(8, |x, y| {
        -1e-6 * ((x - 4.0) * (x - 4.0) + (y - 4.0) * (y - 4.0))
    });
    let mut case = HardCase::new(41, "nearly coplanar planes", dome.clone());
    let size = count(dome.vertices().len());
    for (index, vertex) in (0..size).zip(dome.vertices()).step_by(2) {
        let above = *vertex + Vec3::Z;
        case = case.hits_something(Ray::new(above, Vec3::NEG_Z));
        if index % 3 == 0 {
            let origin = vec3(-9.0, 1.0, 1e-5);
            case = case
                .asks(Ray::new(origin, *vertex - origin))
                .asks(Ray::new(*vertex - 3.0 * Vec3::X, vec3(1.0, 0.01, 1e-7)));
        }
    }
    vec![case]
}
