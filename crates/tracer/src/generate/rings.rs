//! A pyramid of dodecahedra, each made of twelve rings: a pentagon of cylinders joined by spheres on every face.

use glam::Vec3;

use super::generator::Recipe;
use super::mesh_builder::MeshBuilder;
use super::shapes::{
    Ball, GROUND_TRIANGLE_COUNT, UnitSphere, ground, open_cone, open_cone_triangle_count,
};
use super::{GeneratedScene, SuggestedView};

pub(super) const RINGS: Recipe = Recipe {
    name: "rings",
    description: "a pyramid of dodecahedra made of rings",
    size_meaning: "layers of the pyramid",
    sizes: 1..=37,
    default_size: 4,
    uses_seed: false,
    triangle_count: |size| {
        let size_64 = u64::from(size);
        let dodecahedra = size_64 * (size_64 + 1) * (2 * size_64 + 1) / 6;
        let per_corner = UnitSphere::triangle_count(joint_subdivisions(size))
            + open_cone_triangle_count(SEGMENTS);
        dodecahedra * RINGS_PER_DODECAHEDRON * CORNERS as u64 * per_corner + GROUND_TRIANGLE_COUNT
    },
    generate,
};

const RINGS_PER_DODECAHEDRON: u64 = 12;
const CORNERS: usize = 5;
const SEGMENTS: u32 = 6;
const TUBE_RADIUS: f32 = 0.05;
const JOINT_RADIUS: f32 = 0.08;
/// How much a ring is smaller than its face, so that neighbours stay apart.
const SHRINKING: f32 = 0.82;
const DISTANCE: f32 = 2.2;

/// A single dodecahedron is coarse, so that small scenes can be had.
const fn joint_subdivisions(size: u32) -> u32 {
    if size == 1 { 0 } else { 1 }
}

fn generate(size: u32, _seed: u64) -> GeneratedScene {
    let mut joints = MeshBuilder::default();
    let mut tubes = MeshBuilder::default();
    let joint = UnitSphere::new(joint_subdivisions(size));
    let rings = dodecahedron_rings();
    // As in a pyramid of balls: each rests on four below.
    let layer_height = DISTANCE * 0.5f32.sqrt();
    for layer in 0..size {
        let per_side = size - layer;
        let coordinate = |i: u32| DISTANCE * (i as f32 - 0.5 * (per_side - 1) as f32);
        for j in 0..per_side {
            for i in 0..per_side {
                let height = 1.0 + layer_height * layer as f32;
                let center = Vec3::new(coordinate(i), height, coordinate(j));
                for ring in &rings {
                    add_ring(&mut joints, &mut tubes, &joint, ring.map(|p| center + p));
                }
            }
        }
    }
    let extent = DISTANCE * size as f32;
    GeneratedScene {
        parts: vec![
            joints
                .into_part("joints", [0.7, 0.25, 0.2])
                .with_mirror(0.2),
            tubes.into_part("tubes", [0.75, 0.6, 0.3]).with_mirror(0.2),
            ground(Vec3::Y * -0.1, 2.0 * extent, "plate", [0.35, 0.38, 0.42]),
        ],
        view: SuggestedView::new(Vec3::new(0.8, 0.9, 1.5) * extent, Vec3::Y * (0.3 * extent)),
        lights: vec![
            Vec3::new(1.5, 3.0, 1.5) * extent,
            Vec3::new(-2.0, 2.0, 1.0) * extent,
        ],
    }
}

/// The pentagons of a dodecahedron of circumradius 1, shrunk within their planes.
///
/// The dodecahedron is the dual of the icosahedron: a face per vertex, a corner per triangle.
fn dodecahedron_rings() -> Vec<[Vec3; CORNERS]> {
    let icosahedron = UnitSphere::new(0);
    let points = icosahedron.points();
    (0u32..)
        .zip(points)
        .map(|(vertex, axis)| {
            let mut corners: Vec<Vec3> = icosahedron
                .triangles()
                .iter()
                .filter(|triangle| triangle.contains(&vertex))
                .map(|triangle| triangle.iter().map(|&p| points[p as usize]).sum())
                .map(Vec3::normalize)
                .collect();
            let side = axis.any_orthonormal_vector();
            let angle = |p: &Vec3| p.dot(axis.cross(side)).atan2(p.dot(side));
            corners.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
            let center = corners.iter().sum::<Vec3>() / corners.len() as f32;
            std::array::from_fn(|corner| center + SHRINKING * (corners[corner] - center))
        })
        .collect()
}

fn add_ring(
    joints: &mut MeshBuilder,
    tubes: &mut MeshBuilder,
    joint: &UnitSphere,
    corners: [Vec3; CORNERS],
) {
    let ball = |center| Ball {
        center,
        radius: TUBE_RADIUS,
    };
    for (number, &corner) in corners.iter().enumerate() {
        let next = corners[(number + 1) % corners.len()];
        joint.stamp(joints, corner, JOINT_RADIUS);
        open_cone(tubes, SEGMENTS, ball(corner), ball(next));
    }
}
