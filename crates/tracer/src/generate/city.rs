//! Towers of many heights on a street grid.

use glam::{Vec2, Vec3};

use super::generator::Recipe;
use super::mesh_builder::MeshBuilder;
use super::random::Random;
use super::shapes::{CUBOID_TRIANGLE_COUNT, GROUND_TRIANGLE_COUNT, cuboid, ground};
use super::{GeneratedScene, SuggestedView};

pub(super) const CITY: Recipe = Recipe {
    name: "city",
    description: "towers of many heights on a street grid",
    size_meaning: "buildings along a side",
    sizes: 1..=2041,
    default_size: 40,
    uses_seed: true,
    triangle_count: |size| {
        let buildings = u64::from(size) * u64::from(size);
        BOXES_PER_BUILDING * CUBOID_TRIANGLE_COUNT * buildings + GROUND_TRIANGLE_COUNT
    },
    generate,
};

const BOXES_PER_BUILDING: u64 = 2;
/// Buildings along the side of a block, on lots of width 1.
const LOTS_PER_BLOCK: u32 = 4;
const STREET_WIDTH: f32 = 0.7;

fn generate(size: u32, seed: u64) -> GeneratedScene {
    let mut random = Random::new(seed);
    let mut meshes: [MeshBuilder; 3] = std::array::from_fn(|_| MeshBuilder::default());
    let half_width = 0.5 * (lot_start(size - 1) + 1.0);
    for j in 0..size {
        for i in 0..size {
            let center = Vec2::new(lot_start(i), lot_start(j)) + 0.5 - half_width;
            let choice = random.unit();
            let material = if choice < 0.5 {
                0
            } else if choice < 0.8 {
                1
            } else {
                2
            };
            building(&mut meshes[material], &mut random, center, half_width);
        }
    }
    let [concrete, brick, glass] = meshes;
    let street = ground(Vec3::ZERO, 1.2 * half_width + 1.0, "street", [0.12; 3]);
    let reach = half_width + 2.0;
    GeneratedScene {
        parts: vec![
            concrete.into_part("concrete", [0.6, 0.58, 0.54]),
            brick.into_part("brick", [0.5, 0.22, 0.14]),
            glass.into_part("glass", [0.12, 0.2, 0.28]).with_mirror(0.5),
            street,
        ],
        view: SuggestedView::new(reach * Vec3::new(1.35, 1.5, 2.35), reach * Vec3::Y * 0.05),
        lights: vec![reach * Vec3::new(-1.5, 3.0, 1.5)],
    }
}

/// Where a lot begins, streets counted in.
fn lot_start(lot: u32) -> f32 {
    lot as f32 + STREET_WIDTH * (lot / LOTS_PER_BLOCK) as f32
}

/// A tower with a narrower one on top; towers grow towards the centre of the city.
fn building(mesh: &mut MeshBuilder, random: &mut Random, center: Vec2, half_width: f32) {
    let downtown = (-4.0 * center.length_squared() / (half_width * half_width)).exp();
    let tallest = 1.0 + 0.35 * half_width * downtown;
    let height = 0.4 + tallest * random.unit().powi(3);
    let half = Vec2::new(random.between(0.3, 0.45), random.between(0.3, 0.45));
    let top_half = half * random.between(0.4, 0.85);
    let top_height = height * random.between(1.05, 1.3);
    // Nothing is coplanar: towers are sunk into the ground, and tops into their towers.
    for (half, bottom, top) in [(half, -0.1, height), (top_half, 0.5 * height, top_height)] {
        let corner = |sign: f32, y: f32| {
            let corner = center + sign * half;
            Vec3::new(corner.x, y, corner.y)
        };
        cuboid(mesh, corner(-1.0, bottom), corner(1.0, top));
    }
}
