//! Curled strands that grow out of a sphere in all directions.
//!
//! Thin curved geometry without any order: boxes overlap everywhere and most of each is empty. Every strand is a helix, made
//! segment by segment: a frame that turns by the same small rotation at each step, which is constant curvature and torsion.

use std::f32::consts::TAU;

use glam::{Mat3, Quat, Vec2, Vec3};

use super::generator::Recipe;
use super::mesh_builder::MeshBuilder;
use super::random::Random;
use super::{GeneratedScene, SuggestedView};

pub(super) const HAIRBALL: Recipe = Recipe {
    name: "hairball",
    description: "curled strands that grow out of a sphere",
    size_meaning: "strands of 300 triangles",
    sizes: 1..=333_333,
    default_size: 300,
    uses_seed: true,
    triangle_count: |size| u64::from(2 * SIDES * SEGMENTS) * u64::from(size),
    generate,
};

const SIDES: u32 = 3;
const SEGMENTS: u32 = 50;
const SPHERE_RADIUS: f32 = 0.5;
const SEGMENT_LENGTH: f32 = 0.04;

fn generate(size: u32, seed: u64) -> GeneratedScene {
    let mut random = Random::new(seed);
    // The more strands, the thinner, so that they hide as much of each other. Few are not made thicker than 25.
    let radius = 0.2 / (size as f32).sqrt().max(5.0);
    let section: [Vec2; SIDES as usize] =
        std::array::from_fn(|side| radius * Vec2::from_angle(TAU * side as f32 / SIDES as f32));
    let mut mesh = MeshBuilder::default();
    for _ in 0..size {
        strand(&mut mesh, &mut random, &section);
    }
    GeneratedScene {
        parts: vec![mesh.into_part("hair", [0.62, 0.42, 0.24])],
        view: SuggestedView::new(Vec3::new(1.8, 1.4, 5.8), Vec3::ZERO),
        lights: vec![Vec3::new(4.0, 6.0, 5.0), Vec3::new(-6.0, 2.0, 4.0)],
    }
}

/// Adds an open tube with the given cross-section.
fn strand(mesh: &mut MeshBuilder, random: &mut Random, section: &[Vec2]) {
    let outward = direction(random);
    let mut position = SPHERE_RADIUS * outward;
    // z runs along the strand.
    let mut frame =
        Quat::from_rotation_arc(Vec3::Z, outward) * Quat::from_rotation_z(TAU * random.unit());
    let (curvature, torsion) = (random.between(2.5, 7.0), random.between(-3.0, 3.0));
    let turn = Quat::from_scaled_axis(SEGMENT_LENGTH * Vec3::new(curvature, 0.0, torsion));
    let mut last: Option<Vec<u32>> = None;
    for _ in 0..=SEGMENTS {
        let axes = Mat3::from_quat(frame);
        let ring: Vec<u32> = section
            .iter()
            .map(|point| mesh.vertex(position + axes * point.extend(0.0)))
            .collect();
        if let Some(last) = &last {
            for (side, (&a, &d)) in last.iter().zip(&ring).enumerate() {
                let next = (side + 1) % ring.len();
                mesh.quad([a, last[next], ring[next], d]);
            }
        }
        last = Some(ring);
        position += SEGMENT_LENGTH * axes.z_axis;
        frame = (frame * turn).normalize();
    }
}

/// A random direction, all equally likely: by Archimedes, the height on a sphere is evenly distributed.
fn direction(random: &mut Random) -> Vec3 {
    let z = random.between(-1.0, 1.0);
    let (sin, cos) = (TAU * random.unit()).sin_cos();
    let across = (1.0 - z * z).sqrt();
    Vec3::new(across * cos, across * sin, z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::{Generator, generate};

    const VERTICES: usize = (SIDES * (SEGMENTS + 1)) as usize;

    /// The middles of the rings of each strand.
    fn middles(size: u32) -> Vec<Vec<Vec3>> {
        let scene = generate(Generator::Hairball, size, 3).unwrap();
        let middle = |ring: &[Vec3]| ring.iter().sum::<Vec3>() / SIDES as f32;
        let strands = scene.parts[0].positions.chunks(VERTICES);
        strands
            .map(|strand| strand.chunks(SIDES as usize).map(middle).collect())
            .collect()
    }

    #[test]
    fn strands_begin_on_the_sphere_and_leave_it_at_right_angles() {
        for strand in middles(200) {
            assert!((strand[0].length() - SPHERE_RADIUS).abs() < 1e-5);
            let first = (strand[1] - strand[0]).normalize();
            assert!(first.dot(strand[0].normalize()) > 0.999);
        }
    }

    #[test]
    fn strands_are_curled_and_of_one_length() {
        for strand in middles(200) {
            let lengths = strand.windows(2).map(|ends| ends[0].distance(ends[1]));
            let length: f32 = lengths.sum();
            assert!(
                (length - SEGMENT_LENGTH * SEGMENTS as f32).abs() < 1e-4,
                "{length}"
            );
            let reach = strand[0].distance(strand[strand.len() - 1]);
            assert!(reach < 0.99 * length, "{reach} is not curled");
        }
    }

    #[test]
    fn tubes_face_outwards() {
        let scene = generate(Generator::Hairball, 20, 3).unwrap();
        let part = &scene.parts[0];
        for corners in &part.indices {
            let first = corners[0] as usize / VERTICES * VERTICES;
            let ring = |index: u32| {
                let start = first + (index as usize - first) / SIDES as usize * SIDES as usize;
                part.positions[start..start + SIDES as usize]
                    .iter()
                    .sum::<Vec3>()
                    / SIDES as f32
            };
            let [a, b, c] = corners.map(|index| part.positions[index as usize]);
            let middle = corners.map(ring).iter().sum::<Vec3>() / 3.0;
            let outward = (a + b + c) / 3.0 - middle;
            assert!((b - a).cross(c - a).dot(outward) > 0.0, "{corners:?}");
        }
    }
}
