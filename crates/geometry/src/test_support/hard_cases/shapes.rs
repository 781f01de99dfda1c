//! The meshes that hard cases are made of.

use std::collections::{BTreeMap, BTreeSet};
use std::f32::consts::TAU;

use glam::{Vec3, vec3};

use crate::TriangleMesh;

/// Distances of vertices that are [snapped](snapped): differences of coordinates below 2^13 on this grid are exact in f32.
const GRID: f32 = 1.0 / 1024.0;

/// A mesh of known-good parts.
///
/// # Panics
/// If a vertex is not finite or an index is out of range.
pub(super) fn mesh(vertices: Vec<Vec3>, indices: Vec<[u32; 3]>) -> TriangleMesh {
    TriangleMesh::new(vertices, indices).expect("finite vertices, indices in range")
}

/// The same triangles with other vertices.
pub(super) fn mapped(shape: &TriangleMesh, map: impl FnMut(Vec3) -> Vec3) -> TriangleMesh {
    let vertices = shape.vertices().iter().copied().map(map).collect();
    mesh(vertices, shape.indices().to_vec())
}

/// The same triangles with vertices on a grid of step 2^-10: rays between grid points then pass exactly through vertices and midpoints of
/// edges.
pub(super) fn snapped(shape: &TriangleMesh) -> TriangleMesh {
    mapped(shape, |vertex| (vertex / GRID).round() * GRID)
}

/// The triangles of two meshes, those of the first one first.
pub(super) fn joined(first: &TriangleMesh, second: &TriangleMesh) -> TriangleMesh {
    let offset = count(first.vertices().len());
    let moved = second
        .indices()
        .iter()
        .map(|corners| corners.map(|corner| corner + offset));
    let indices = first.indices().iter().copied().chain(moved).collect();
    mesh([first.vertices(), second.vertices()].concat(), indices)
}

/// A number of vertices or triangles.
///
/// # Panics
/// If it does not fit a `u32`: the meshes here are small.
pub(super) fn count(len: usize) -> u32 {
    u32::try_from(len).expect("hard cases are small")
}

/// Every edge once, with the smaller index first.
pub(super) fn edges(shape: &TriangleMesh) -> BTreeSet<(u32, u32)> {
    let of_triangle = |[a, b, c]: [u32; 3]| [(a, b), (b, c), (c, a)];
    let sorted = |(a, b): (u32, u32)| (a.min(b), a.max(b));
    shape
        .indices()
        .iter()
        .copied()
        .flat_map(of_triangle)
        .map(sorted)
        .collect()
}

/// Whether every edge runs equally often in both directions: the surface has no border.
pub(super) fn is_closed(shape: &TriangleMesh) -> bool {
    let mut balance = BTreeMap::<(u32, u32), i32>::new();
    for [a, b, c] in shape.indices() {
        for (start, end) in [(a, b), (b, c), (c, a)] {
            let direction = if start < end { 1 } else { -1 };
            *balance
                .entry((*start.min(end), *start.max(end)))
                .or_default() += direction;
        }
    }
    balance.values().all(|balance| *balance == 0)
}

/// The unit cube: two triangles for each of the faces -x, +x, -y, +y, -z, +z, in this order; outside is front.
///
/// The diagonals: `[000, 011]`, `[100, 111]`, `[000, 101]`, `[010, 111]`, `[000, 110]`, `[001, 111]`.
pub(super) fn cube() -> TriangleMesh {
    let corner = |index: u8| {
        let bit = |place: u8| f32::from(index >> place & 1);
        vec3(bit(0), bit(1), bit(2))
    };
    let faces = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    let indices = faces
        .into_iter()
        .flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]])
        .collect();
    mesh((0..8).map(corner).collect(), indices)
}

/// The box between two corners, with the triangles of [`cube`].
pub(super) fn cuboid(min: Vec3, max: Vec3) -> TriangleMesh {
    mapped(&cube(), |corner| {
        Vec3::select(corner.cmpgt(Vec3::ZERO), max, min)
    })
}

/// Every second corner of a cube.
pub(super) fn tetrahedron() -> TriangleMesh {
    let corners = [
        vec3(1.0, 1.0, 1.0),
        vec3(1.0, -1.0, -1.0),
        vec3(-1.0, 1.0, -1.0),
        vec3(-1.0, -1.0, 1.0),
    ];
    mesh(
        corners.to_vec(),
        vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]],
    )
}

/// Corners at the given distances along the axes: +x, -x, +y, -y, +z, -z.
pub(super) fn octahedron(sizes: Vec3) -> TriangleMesh {
    let [x, y, z] = [
        vec3(sizes.x, 0.0, 0.0),
        vec3(0.0, sizes.y, 0.0),
        vec3(0.0, 0.0, sizes.z),
    ];
    let indices = [
        [0, 2, 4],
        [2, 1, 4],
        [1, 3, 4],
        [3, 0, 4],
        [2, 0, 5],
        [1, 2, 5],
        [3, 1, 5],
        [0, 3, 5],
    ];
    mesh(vec![x, -x, y, -y, z, -z], indices.to_vec())
}

/// A sphere of radius 1 around zero: an octahedron whose triangles are split in four `level` times.
pub(super) fn sphere(level: u32) -> TriangleMesh {
    let mut shape = octahedron(Vec3::ONE);
    for _ in 0..level {
        let mut vertices = shape.vertices().to_vec();
        let midpoints: BTreeMap<(u32, u32), u32> = edges(&shape)
            .into_iter()
            .map(|(a, b)| {
                vertices.push((vertices[a as usize] + vertices[b as usize]).normalize());
                ((a, b), count(vertices.len() - 1))
            })
            .collect();
        let middle = |a: u32, b: u32| midpoints[&(a.min(b), a.max(b))];
        let split = |[a, b, c]: [u32; 3]| {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        let indices = shape.indices().iter().copied().flat_map(split).collect();
        shape = mesh(vertices, indices);
    }
    shape
}

/// A torus around the z axis, radius 2, thickness 2 * 0.75.
pub(super) fn torus(around: u16, across: u16) -> TriangleMesh {
    let vertex = |index: u16| {
        let angle = |step: u16, steps: u16| TAU * f32::from(step) / f32::from(steps);
        let (outer, inner) = (angle(index / across, around), angle(index % across, across));
        let radius = 2.0 + 0.75 * inner.cos();
        vec3(
            radius * outer.cos(),
            radius * outer.sin(),
            0.75 * inner.sin(),
        )
    };
    let cells = (0..around).flat_map(|i| (0..across).map(move |j| (i, j)));
    let indices = cells.flat_map(|(i, j)| {
        let at = |i: u16, j: u16| u32::from(i % around * across + j % across);
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    mesh(
        (0..around * across).map(vertex).collect(),
        indices.collect(),
    )
}

/// Two cones over one ring of `valence` points on the unit circle, with the tips at z = 1 (triangles `0..valence`) and z = -1.
pub(super) fn bipyramid(valence: u16) -> TriangleMesh {
    let ring = (0..valence).map(|step| {
        let angle = TAU * f32::from(step) / f32::from(valence);
        vec3(angle.cos(), angle.sin(), 0.0)
    });
    let vertices: Vec<Vec3> = ring.chain([Vec3::Z, Vec3::NEG_Z]).collect();
    let [top, bottom] = [u32::from(valence), u32::from(valence) + 1];
    let next = |step: u16| u32::from((step + 1) % valence);
    let upper = (0..valence).map(|step| [u32::from(step), next(step), top]);
    let lower = (0..valence).map(|step| [next(step), u32::from(step), bottom]);
    snapped(&mesh(vertices, upper.chain(lower).collect()))
}

/// A field of `size * size` squares over the integers, each of two triangles; `height` gives z. The triangles of the square at `(x, y)`
/// begin at `2 * (y * size + x)`: first the one below its rising diagonal, then the one above it.
pub(super) fn height_field(size: u16, height: impl Fn(f32, f32) -> f32) -> TriangleMesh {
    let points = (0..=size).flat_map(|y| (0..=size).map(move |x| (f32::from(x), f32::from(y))));
    let vertices = points.map(|(x, y)| vec3(x, y, height(x, y))).collect();
    let squares = (0..size).flat_map(|y| (0..size).map(move |x| (x, y)));
    let indices = squares.flat_map(|(x, y)| {
        let at = |x: u16, y: u16| u32::from(y) * (u32::from(size) + 1) + u32::from(x);
        let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
        [[a, b, c], [a, c, d]]
    });
    mesh(vertices, indices.collect())
}

/// Two squares that meet in a line at an angle whose tangent is `slope`: `z = 0` and `z = slope * x`, for x and y up to `size`.
pub(super) fn wedge(size: f32, slope: f32) -> TriangleMesh {
    let corners = [(-size, -size), (size, -size), (size, size), (-size, size)];
    let at = |slope: f32| corners.map(|(x, y)| vec3(x, y, slope * x));
    let square = |corners: [Vec3; 4]| mesh(corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]]);
    joined(&square(at(0.0)), &square(at(slope)))
}
