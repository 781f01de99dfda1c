//! Spheres, cones, boxes and ground plates.

use std::collections::HashMap;
use std::f32::consts::TAU;

use glam::Vec3;

use super::GeneratedPart;
use super::mesh_builder::MeshBuilder;

/// A tessellated unit sphere, made once and stamped many times.
///
/// An icosahedron whose triangles are cut into four, a number of times, and pushed out to the sphere. Closed:
/// neighbours share vertices.
#[derive(Debug)]
pub(crate) struct UnitSphere {
    points: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

impl UnitSphere {
    pub(crate) fn new(subdivisions: u32) -> Self {
        let mut sphere = Self {
            points: icosahedron_points(),
            triangles: ICOSAHEDRON_TRIANGLES.to_vec(),
        };
        for _ in 0..subdivisions {
            sphere.subdivide();
        }
        sphere
    }

    /// Spheres with 0, 1, .. up to `most` subdivisions.
    pub(super) fn levels(most: u32) -> Vec<Self> {
        (0..=most).map(Self::new).collect()
    }

    /// The number of triangles after some subdivisions.
    pub(super) const fn triangle_count(subdivisions: u32) -> u64 {
        20 << (2 * subdivisions)
    }

    /// The points, all on the unit sphere.
    pub(crate) fn points(&self) -> &[Vec3] {
        &self.points
    }

    /// The triangles between the points.
    pub(crate) fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Adds a copy to a part.
    pub(super) fn stamp(&self, mesh: &mut MeshBuilder, center: Vec3, radius: f32) {
        let mut first = None;
        for &point in &self.points {
            let index = mesh.smooth_vertex(center + radius * point, point);
            first.get_or_insert(index);
        }
        let first = first.unwrap_or(0);
        for corners in &self.triangles {
            mesh.triangle(corners.map(|corner| first + corner));
        }
    }

    fn subdivide(&mut self) {
        let mut midpoints = HashMap::new();
        let mut triangles = Vec::with_capacity(4 * self.triangles.len());
        for [a, b, c] in std::mem::take(&mut self.triangles) {
            let [ab, bc, ca] =
                [[a, b], [b, c], [c, a]].map(|edge| self.midpoint(edge, &mut midpoints));
            triangles.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        self.triangles = triangles;
    }

    fn midpoint(&mut self, [a, b]: [u32; 2], known: &mut HashMap<[u32; 2], u32>) -> u32 {
        *known.entry([a.min(b), a.max(b)]).or_insert_with(|| {
            let sum = self.points[a as usize] + self.points[b as usize];
            self.points.push(sum.normalize());
            u32::try_from(self.points.len() - 1).expect("spheres have few subdivisions")
        })
    }
}

/// The corners of three golden rectangles, pushed to the unit sphere.
fn icosahedron_points() -> Vec<Vec3> {
    let golden = f32::midpoint(1.0, 5.0f32.sqrt());
    [
        [-1.0, golden, 0.0],
        [1.0, golden, 0.0],
        [-1.0, -golden, 0.0],
        [1.0, -golden, 0.0],
        [0.0, -1.0, golden],
        [0.0, 1.0, golden],
        [0.0, -1.0, -golden],
        [0.0, 1.0, -golden],
        [golden, 0.0, -1.0],
        [golden, 0.0, 1.0],
        [-golden, 0.0, -1.0],
        [-golden, 0.0, 1.0],
    ]
    .map(|point| Vec3::from(point).normalize())
    .to_vec()
}

#[rustfmt::skip]
const ICOSAHEDRON_TRIANGLES: [[u32; 3]; 20] = [
    [0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11],
    [1, 5, 9], [5, 11, 4], [11, 10, 2], [10, 7, 6], [7, 1, 8],
    [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9],
    [4, 9, 5], [2, 4, 11], [6, 2, 10], [8, 6, 7], [9, 8, 1],
];

/// A ball that a cone begins or ends with.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ball {
    pub(super) center: Vec3,
    pub(super) radius: f32,
}

/// The number of triangles of [`open_cone`].
pub(super) const fn open_cone_triangle_count(segments: u32) -> u64 {
    2 * segments as u64
}

/// Adds the side of a truncated cone between two discs, without the discs; equal radii make a cylinder.
pub(super) fn open_cone(mesh: &mut MeshBuilder, segments: u32, from: Ball, to: Ball) {
    let axis = to.center - from.center;
    let (direction, length) = (axis.normalize_or(Vec3::Y), axis.length());
    let side = direction.any_orthonormal_vector();
    let other_side = direction.cross(side);
    // The side leans by the difference of the radii over the length.
    let lean = direction * (from.radius - to.radius);
    let rim: Vec<[u32; 2]> = (0..segments)
        .map(|segment| {
            let (sin, cos) = (TAU * segment as f32 / segments as f32).sin_cos();
            let radial = side * cos + other_side * sin;
            let normal = (radial * length + lean).normalize_or(radial);
            [from, to].map(|end| mesh.smooth_vertex(end.center + radial * end.radius, normal))
        })
        .collect();
    for (segment, &[start, end]) in rim.iter().enumerate() {
        let [next_start, next_end] = rim[(segment + 1) % rim.len()];
        mesh.quad([start, next_start, next_end, end]);
    }
}

/// The number of triangles of [`cuboid`].
pub(super) const CUBOID_TRIANGLE_COUNT: u64 = 12;

/// Adds a closed box with its edges along the axes.
pub(super) fn cuboid(mesh: &mut MeshBuilder, min: Vec3, max: Vec3) {
    // Corner number: bit 0 is x, bit 1 is y, bit 2 is z.
    let corners: [u32; 8] = std::array::from_fn(|corner| {
        let pick = |axis: usize| {
            if corner >> axis & 1 == 1 {
                max[axis]
            } else {
                min[axis]
            }
        };
        mesh.vertex(Vec3::new(pick(0), pick(1), pick(2)))
    });
    let faces = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    for face in faces {
        mesh.quad(face.map(|corner: usize| corners[corner]));
    }
}

/// The number of triangles of [`ground`].
pub(super) const GROUND_TRIANGLE_COUNT: u64 = 2;

/// A square plate that faces up, as a part of its own.
pub(super) fn ground(
    center: Vec3,
    half_width: f32,
    name: &'static str,
    color: [f32; 3],
) -> GeneratedPart {
    let mut mesh = MeshBuilder::default();
    let corners = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)]
        .map(|(x, z)| mesh.vertex(center + half_width * Vec3::new(x, 0.0, z)));
    mesh.quad(corners);
    mesh.into_part(name, color)
}
