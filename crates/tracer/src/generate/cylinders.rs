//! Thin cylinders from end to end of the scene, near the diagonals of a cube.
//!
//! Each is a bundle of slivers as long as the scene, so that boxes are at their worst, as for `needles`, and rays
//! pass many triangles of one cylinder at grazing angles.

use glam::Vec3;

use super::generator::Recipe;
use super::mesh_builder::MeshBuilder;
use super::needles::DIAGONALS;
use super::random::Random;
use super::shapes::{Ball, open_cone, open_cone_triangle_count};
use super::{GeneratedScene, SuggestedView};

pub(super) const CYLINDERS: Recipe = Recipe {
    name: "cylinders",
    description: "thin open cylinders near the diagonals of a cube, made of slivers as long as the scene",
    size_meaning: "cylinders of 32 triangles",
    // At this many a sliver is more than 100 units in the last place of its coordinates wide.
    sizes: 1..=300_000,
    default_size: 500,
    uses_seed: true,
    triangle_count: |size| open_cone_triangle_count(SIDES) * u64::from(size),
    generate,
};

const SIDES: u32 = 16;

const NAMES: [&str; 4] = [
    "cylinders along +++",
    "cylinders along -++",
    "cylinders along ++-",
    "cylinders along -+-",
];

fn generate(size: u32, seed: u64) -> GeneratedScene {
    let mut random = Random::new(seed);
    // The more cylinders, the thinner, so that one can still look into the field.
    let radius = 0.25 * (size as f32).powf(-2.0 / 3.0);
    let mut meshes: [MeshBuilder; 4] = std::array::from_fn(|_| MeshBuilder::default());
    for (_, number) in (0..size).zip((0..4).cycle()) {
        let (diagonal, ..) = DIAGONALS[number];
        let center = 0.5 * random.in_cube();
        let half_axis = 0.7 * Vec3::from(diagonal) + 0.05 * random.in_cube();
        let [from, to] =
            [center - half_axis, center + half_axis].map(|center| Ball { center, radius });
        open_cone(&mut meshes[number], SIDES, from, to);
    }
    let parts = meshes.into_iter().zip(DIAGONALS).zip(NAMES);
    GeneratedScene {
        parts: parts
            .map(|((mesh, (_, _, color)), name)| mesh.into_part(name, color))
            .collect(),
        view: SuggestedView::new(Vec3::new(1.5, 1.2, 5.4), Vec3::ZERO),
        lights: vec![Vec3::new(4.0, 5.0, 6.0), Vec3::new(-6.0, 3.0, 2.0)],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::{Generator, generate};

    #[test]
    fn slivers_are_as_long_as_the_scene_and_stay_distinct_at_the_largest_size() {
        let scene = generate(Generator::Cylinders, 400, 5).unwrap();
        for part in &scene.parts {
            for corners in &part.indices {
                let [a, b, c] = corners.map(|index| part.positions[index as usize]);
                let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
                assert!((2.2..2.7).contains(&longest), "{longest}");
            }
        }
        let largest = *Generator::Cylinders.sizes().end() as f32;
        let width =
            2.0 * 0.25 * largest.powf(-2.0 / 3.0) * (std::f32::consts::PI / SIDES as f32).sin();
        assert!(width > 100.0 * f32::EPSILON, "{width}");
    }
}
