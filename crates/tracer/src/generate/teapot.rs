//! The Utah teapot on a checkerboard.
//!
//! Martin Newell's teapot of 1975 with the bottom that was added later: 32 bicubic Bezier patches. Its symmetry
//! folds their control points into three small tables. Body and lid are four equal quarters around the axis, and
//! handle and spout are two equal halves. In the tables z is up, as in the original; the scene has y up.

use glam::{DVec2, DVec3, Vec3};

use super::generator::Recipe;
use super::mesh_builder::MeshBuilder;
use super::{GeneratedPart, GeneratedScene, SuggestedView};

pub(super) const TEAPOT: Recipe = Recipe {
    name: "teapot",
    description: "the Utah teapot on a checkerboard",
    size_meaning: "cells along a side of each of the 32 Bezier patches",
    sizes: 3..=1249,
    default_size: 12,
    uses_seed: false,
    triangle_count: |size| {
        let cells = u64::from(size);
        // At the knob and at the bottom a side of four patches each is a single point, which leaves triangles
        // instead of quadrilaterals there.
        32 * 2 * cells * cells - 2 * 4 * cells + BOARD_TRIANGLE_COUNT
    },
    generate,
};

const SQUARES: u32 = 8;
const BOARD_TRIANGLE_COUNT: u64 = 2 * SQUARES as u64 * SQUARES as u64;

/// Control points around a quarter circle: radius, length of the inner points' arm, height.
type LatheRow = [f64; 3];
/// Control points around one half of a tube: x and z where it begins, x and z where it ends, both in the plane of
/// symmetry, and how far the two inner points stand out of that plane.
type TubeRow = [f64; 5];

/// From the rim down to the middle of the bottom.
#[rustfmt::skip]
const BODY: [[LatheRow; 4]; 4] = [
    [[1.4, 0.784, 2.4], [1.3375, 0.749, 2.53125], [1.4375, 0.805, 2.53125], [1.5, 0.84, 2.4]],
    [[1.5, 0.84, 2.4], [1.75, 0.98, 1.875], [2.0, 1.12, 1.35], [2.0, 1.12, 0.9]],
    [[2.0, 1.12, 0.9], [2.0, 1.12, 0.45], [1.5, 0.84, 0.225], [1.5, 0.84, 0.15]],
    [[1.5, 0.84, 0.15], [1.5, 0.84, 0.075], [1.425, 0.798, 0.0], [0.0, 0.0, 0.0]],
];

/// From the top of the knob down to the rim.
#[rustfmt::skip]
const LID: [[LatheRow; 4]; 2] = [
    [[0.0, 0.0, 3.15], [0.8, 0.45, 3.15], [0.0, 0.0, 2.85], [0.2, 0.112, 2.7]],
    [[0.2, 0.112, 2.7], [0.4, 0.224, 2.55], [1.3, 0.728, 2.55], [1.3, 0.728, 2.4]],
];

/// From its upper to its lower end.
#[rustfmt::skip]
const HANDLE: [[TubeRow; 4]; 2] = [
    [
        [-1.6, 2.025, -1.5, 2.25, 0.3], [-2.3, 2.025, -2.5, 2.25, 0.3],
        [-2.7, 2.025, -3.0, 2.25, 0.3], [-2.7, 1.8, -3.0, 1.8, 0.3],
    ],
    [
        [-2.7, 1.8, -3.0, 1.8, 0.3], [-2.7, 1.575, -3.0, 1.35, 0.3],
        [-2.5, 1.125, -2.65, 0.9375, 0.3], [-2.0, 0.9, -1.9, 0.6, 0.3],
    ],
];

/// From the body to the opening.
#[rustfmt::skip]
const SPOUT: [[TubeRow; 4]; 2] = [
    [
        [1.7, 1.425, 1.7, 0.6, 0.66], [2.6, 1.425, 3.1, 0.825, 0.66],
        [2.3, 2.1, 2.4, 2.025, 0.25], [2.7, 2.4, 3.3, 2.4, 0.25],
    ],
    [
        [2.7, 2.4, 3.3, 2.4, 0.25], [2.8, 2.475, 3.525, 2.49375, 0.25],
        [2.9, 2.475, 3.45, 2.5125, 0.15], [2.8, 2.4, 3.2, 2.4, 0.15],
    ],
];

fn generate(size: u32, _seed: u64) -> GeneratedScene {
    let mut mesh = MeshBuilder::default();
    lathe(&mut mesh, &BODY, size);
    lathe(&mut mesh, &LID, size);
    tube(&mut mesh, &HANDLE, size);
    tube(&mut mesh, &SPOUT, size);
    let teapot = mesh
        .smooth()
        .into_part("teapot", [0.7, 0.66, 0.6])
        .with_mirror(0.15);
    let mut parts = vec![teapot];
    parts.extend(checkerboard());
    GeneratedScene {
        parts,
        view: SuggestedView::new(Vec3::new(3.2, 4.8, 8.5), Vec3::new(0.1, 1.2, 0.0)),
        lights: vec![Vec3::new(-6.0, 9.0, 6.0), Vec3::new(7.0, 8.0, 5.0)],
    }
}

/// The weights of the control points of a cubic Bezier curve.
fn bernstein(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t]
}

/// The point of a Bezier curve through rows of numbers.
fn blend<const N: usize>(rows: &[[f64; N]; 4], t: f64) -> [f64; N] {
    let weights = bernstein(t);
    std::array::from_fn(|column| (0..4).map(|row| weights[row] * rows[row][column]).sum())
}

/// The rows of a strip of patches at evenly spaced parameters; each patch begins where the one before ends.
fn rows<const N: usize>(patches: &[[[f64; N]; 4]], cells: u32) -> impl Iterator<Item = [f64; N]> {
    let inner = patches.iter().flat_map(move |patch| {
        (0..cells).map(move |cell| blend(patch, f64::from(cell) / f64::from(cells)))
    });
    inner.chain(patches.last().map(|patch| patch[3]))
}

/// From the table's axes, z up, to the scene's, y up.
fn to_scene(point: DVec3) -> Vec3 {
    DVec3::new(point.x, point.z, -point.y).as_vec3()
}

/// Adds a surface of (nearly) revolution. A row of radius zero at an end becomes one vertex.
fn lathe(mesh: &mut MeshBuilder, patches: &[[LatheRow; 4]], cells: u32) {
    let rings: Vec<Vec<u32>> = rows(patches, cells)
        .map(|[radius, arm, height]| {
            if radius == 0.0 {
                return vec![mesh.vertex(to_scene(DVec3::Z * height))];
            }
            let quarter = [[radius, 0.0], [radius, arm], [arm, radius], [0.0, radius]];
            (0..4 * cells)
                .map(|column| {
                    let t = f64::from(column % cells) / f64::from(cells);
                    let point =
                        (0..column / cells).fold(DVec2::from(blend(&quarter, t)), |p, _| p.perp());
                    mesh.vertex(to_scene(point.extend(height)))
                })
                .collect()
        })
        .collect();
    for pair in rings.windows(2) {
        join_rings(mesh, &pair[0], &pair[1]);
    }
}

/// Adds a tube that is mirrored in the plane y = 0.
fn tube(mesh: &mut MeshBuilder, patches: &[[TubeRow; 4]], cells: u32) {
    let rings: Vec<Vec<u32>> = rows(patches, cells)
        .map(|[first_x, first_z, last_x, last_z, width]| {
            let half = [
                [first_x, 0.0, first_z],
                [first_x, width, first_z],
                [last_x, width, last_z],
                [last_x, 0.0, last_z],
            ];
            let point = |cell: u32| DVec3::from(blend(&half, f64::from(cell) / f64::from(cells)));
            let there = (0..cells).map(point);
            let back = (1..=cells)
                .rev()
                .map(|cell| point(cell) * DVec3::new(1.0, -1.0, 1.0));
            there
                .chain(back)
                .map(|position| mesh.vertex(to_scene(position)))
                .collect()
        })
        .collect();
    for pair in rings.windows(2) {
        join_rings(mesh, &pair[0], &pair[1]);
    }
}

/// Adds the band between two closed rows of vertices, of which one may be a single vertex. Its front is to the right of a
/// walk along the first ring, as seen from the second.
fn join_rings(mesh: &mut MeshBuilder, upper: &[u32], lower: &[u32]) {
    let columns = upper.len().max(lower.len());
    for column in 0..columns {
        let next = (column + 1) % columns;
        match (upper, lower) {
            (&[pole], _) => mesh.triangle([pole, lower[column], lower[next]]),
            (_, &[pole]) => mesh.triangle([upper[column], pole, upper[next]]),
            _ => mesh.quad([upper[column], lower[column], lower[next], upper[next]]),
        }
    }
}

/// Two parts: the dark and the light squares.
fn checkerboard() -> [GeneratedPart; 2] {
    let mut meshes: [MeshBuilder; 2] = std::array::from_fn(|_| MeshBuilder::default());
    let coordinate = |line: u32| 1.25 * (line as f32 - 0.5 * SQUARES as f32);
    for j in 0..SQUARES {
        for i in 0..SQUARES {
            let mesh = &mut meshes[((i + j) % 2) as usize];
            let corners = [(i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)]
                .map(|(i, j)| mesh.vertex(Vec3::new(coordinate(i), 0.0, coordinate(j))));
            mesh.quad(corners);
        }
    }
    let [dark, light] = meshes;
    [
        dark.into_part("dark squares", [0.08, 0.1, 0.14]),
        light.into_part("light squares", [0.7, 0.7, 0.65]),
    ]
}
