//! Layers of meshing gears.
//!
//! All gears have twelve teeth. In a layer their centres lie on a square grid two pitch radii wide, and every
//! other gear is turned by half a tooth: as twelve is a multiple of four, a tooth then meets a gap at each neighbour.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};

use super::generator::Recipe;
use super::mesh_builder::MeshBuilder;
use super::shapes::{GROUND_TRIANGLE_COUNT, ground};
use super::{GeneratedScene, SuggestedView};

pub(super) const GEARS: Recipe = Recipe {
    name: "gears",
    description: "layers of meshing gears",
    size_meaning: "gears along a side of the cube that they fill",
    sizes: 1..=63,
    default_size: 4,
    uses_seed: false,
    triangle_count: |size| {
        // Outline and hole have four points per tooth, and each point brings eight triangles.
        u64::from(8 * OUTLINE_POINTS) * u64::from(size).pow(3) + GROUND_TRIANGLE_COUNT
    },
    generate,
};

const TEETH: u32 = 12;
const OUTLINE_POINTS: u32 = 4 * TEETH;
const PITCH_RADIUS: f32 = 1.0;
const TIP_RADIUS: f32 = 1.13;
const ROOT_RADIUS: f32 = 0.84;
const HOLE_RADIUS: f32 = 0.35;
const THICKNESS: f32 = 0.5;
const LAYER_DISTANCE: f32 = 1.2;

fn generate(size: u32, _seed: u64) -> GeneratedScene {
    let mut meshes: [MeshBuilder; 2] = std::array::from_fn(|_| MeshBuilder::default());
    let outlines = [outline(0.0), outline(0.5)];
    let width = 2.0 * PITCH_RADIUS * size as f32;
    let depth = LAYER_DISTANCE * size as f32;
    for layer in 0..size {
        for row in 0..size {
            for column in 0..size {
                let center = Vec3::new(
                    2.0 * PITCH_RADIUS * (column as f32 + 0.5) - 0.5 * width,
                    2.0 * PITCH_RADIUS * (row as f32 + 0.5),
                    LAYER_DISTANCE * (layer as f32 + 0.5) - 0.5 * depth,
                );
                let turned = (layer + row + column) as usize % 2;
                gear(&mut meshes[turned], center, &outlines[turned]);
            }
        }
    }
    let [even, odd] = meshes;
    let floor = ground(Vec3::Y * -0.25, 1.5 * width, "floor", [0.3, 0.3, 0.32]);
    GeneratedScene {
        parts: vec![
            even.into_part("even gears", [0.75, 0.55, 0.2])
                .with_mirror(0.15),
            odd.into_part("odd gears", [0.3, 0.42, 0.6])
                .with_mirror(0.15),
            floor.with_mirror(0.1),
        ],
        view: SuggestedView::new(
            Vec3::new(0.9, 1.1, 1.5) * (width + 0.7),
            Vec3::Y * (0.45 * width),
        ),
        lights: vec![
            Vec3::new(1.0, 2.0, 2.0) * (width + 0.5),
            Vec3::new(-1.5, 1.5, 2.0) * (width + 0.5),
        ],
    }
}

/// The outline of a gear around the origin, counter-clockwise, turned by a part of a tooth.
fn outline(turn: f32) -> Vec<Vec2> {
    let tooth = [
        (-0.3, ROOT_RADIUS),
        (-0.14, TIP_RADIUS),
        (0.14, TIP_RADIUS),
        (0.3, ROOT_RADIUS),
    ];
    (0..TEETH)
        .flat_map(|number| {
            tooth.map(|(offset, radius)| {
                let angle = TAU * (number as f32 + turn + offset) / TEETH as f32;
                radius * Vec2::from_angle(angle)
            })
        })
        .collect()
}

/// Adds a closed gear with its axis along z.
fn gear(mesh: &mut MeshBuilder, center: Vec3, outline: &[Vec2]) {
    // Of each outline point: outside front, outside back, hole front, hole back.
    let points: Vec<[u32; 4]> = outline
        .iter()
        .map(|&outer| {
            let hole = outer.normalize() * HOLE_RADIUS;
            [
                outer.extend(0.5 * THICKNESS),
                outer.extend(-0.5 * THICKNESS),
                hole.extend(0.5 * THICKNESS),
                hole.extend(-0.5 * THICKNESS),
            ]
            .map(|point| mesh.vertex(center + point))
        })
        .collect();
    for (number, &[front, back, hole_front, hole_back]) in points.iter().enumerate() {
        let next = points[(number + 1) % points.len()];
        mesh.quad([front, next[0], next[2], hole_front]);
        mesh.quad([back, hole_back, next[3], next[1]]);
        mesh.quad([front, back, next[1], next[0]]);
        mesh.quad([hole_front, next[2], next[3], hole_back]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cross(a: Vec2, b: Vec2, c: Vec2) -> f32 {
        (b - a).perp_dot(c - a)
    }

    fn edges(points: &[Vec2]) -> impl Iterator<Item = [Vec2; 2]> {
        (0..points.len()).map(|i| [points[i], points[(i + 1) % points.len()]])
    }

    #[test]
    fn teeth_of_neighbours_interlock_without_touching() {
        let gear = outline(0.0);
        for step in [Vec2::X, Vec2::Y] {
            let neighbour: Vec<Vec2> = outline(0.5)
                .iter()
                .map(|point| point + step * 2.0 * PITCH_RADIUS)
                .collect();
            for [a, b] in edges(&gear) {
                for [c, d] in edges(&neighbour) {
                    let crossing = cross(a, b, c) * cross(a, b, d) <= 0.0
                        && cross(c, d, a) * cross(c, d, b) <= 0.0;
                    assert!(!crossing, "{a} {b} crosses {c} {d}");
                }
            }
            let reach = gear.iter().map(|p| p.dot(step)).fold(0.0, f32::max);
            let start = neighbour.iter().map(|p| p.dot(step)).fold(9.0, f32::min);
            assert!(reach > start, "the teeth reach between each other");
        }
    }
}
