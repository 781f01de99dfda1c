//! The core of the suite: closed meshes and rays aimed at every vertex and every edge, which leak first.

use glam::{Vec3, vec3};

use super::HardCase;
use super::aimed::aimed_at_features;
use super::shapes::{self, mapped, snapped};
use crate::TriangleMesh;

/// A closed mesh with rays from outside its bounds, from inside, along the axes and along its edges.
fn aimed(name: &'static str, mesh: TriangleMesh, outside: &[Vec3], inside: &[Vec3]) -> HardCase {
    let questions = aimed_at_features(&mesh, outside, inside);
    HardCase::new(8, name, mesh).closed().asks_all(questions)
}

/// Points of the grid of snapped meshes: rays from them pass exactly through vertices.
const OUTSIDE: [Vec3; 2] = [vec3(3.5, 2.25, -5.0), vec3(-4.0, 0.125, 0.5)];
const INSIDE: [Vec3; 1] = [vec3(0.125, -0.0625, 0.1875)];

fn tetrahedron() -> HardCase {
    aimed("tetrahedron", shapes::tetrahedron(), &OUTSIDE, &INSIDE)
}

fn cube() -> HardCase {
    let centered = mapped(&shapes::cube(), |corner| 2.0 * corner - Vec3::ONE);
    aimed("cube", centered, &OUTSIDE, &INSIDE)
}

fn octahedron() -> HardCase {
    aimed(
        "octahedron",
        shapes::octahedron(Vec3::splat(1.5)),
        &OUTSIDE,
        &INSIDE,
    )
}

fn sphere() -> HardCase {
    aimed(
        "sphere",
        snapped(&shapes::sphere(2)),
        &OUTSIDE[..1],
        &INSIDE,
    )
}

fn torus() -> HardCase {
    aimed(
        "torus",
        snapped(&shapes::torus(11, 6)),
        &OUTSIDE,
        &[vec3(2.0, 0.0625, 0.125)],
    )
}

/// Bumps on a sphere, rounded to integers.
fn blob_of_integers() -> HardCase {
    let blob = mapped(&shapes::sphere(1), |vertex| {
        let bumps = 1.0 + 0.2 * (vertex.x * 4.0 + vertex.z).sin();
        (vertex * bumps * 9.0).round()
    });
    aimed(
        "blob of integers",
        blob,
        &[vec3(31.0, -17.0, 23.0)],
        &[vec3(1.0, 0.0, -1.0)],
    )
}

/// No two edges alike, coordinates rounded by their distance from zero.
fn far_mesh() -> HardCase {
    let center = vec3(1e5, -2e5, 3e4);
    let far = mapped(&shapes::sphere(1), |vertex| {
        let bumps = 1.0 + 0.3 * (vertex.x * 7.0 + vertex.y * 3.0 - vertex.z * 5.0).sin();
        vertex * bumps * 37.7 + center
    });
    aimed(
        "irregular mesh far from zero",
        far,
        &[center + vec3(111.0, 57.0, -83.0), vec3(1.0, 2.0, 3.0)],
        &[center],
    )
}

/// Two million long, 2e-3 wide, 2 high.
fn needles() -> HardCase {
    let needles = shapes::octahedron(vec3(1e6, 1e-3, 1.0));
    aimed(
        "needles",
        needles,
        &[vec3(3.0, 5.0, -7.0), vec3(2e6, 1e-3, 0.25)],
        &[vec3(1.0, 1e-5, 0.125)],
    )
}

pub(super) fn all() -> Vec<HardCase> {
    vec![
        tetrahedron(),
        cube(),
        octahedron(),
        sphere(),
        torus(),
        blob_of_integers(),
        far_mesh(),
        needles(),
    ]
}
