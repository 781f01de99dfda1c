//! A fractal island: octaves of gradient noise, over water.
//!
//! Source: K. Perlin, "Improving Noise", SIGGRAPH 2002, for the noise.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};

use super::generator::Recipe;
use super::height_field::{height_field, height_field_triangle_count};
use super::random::hash_grid_point;
use super::shapes::{GROUND_TRIANGLE_COUNT, ground};
use super::{GeneratedScene, SuggestedView};

pub(super) const TERRAIN: Recipe = Recipe {
    name: "terrain",
    description: "a fractal island in water",
    size_meaning: "grid cells along a side",
    sizes: 1..=7071,
    default_size: 256,
    uses_seed: true,
    triangle_count: |size| height_field_triangle_count(size) + GROUND_TRIANGLE_COUNT,
    generate,
};

const HALF_WIDTH: f32 = 10.0;
const HEIGHT: f32 = 4.5;
/// Lattice cells of the coarsest octave along a side.
const COARSEST: u32 = 4;
/// A bound on the octaves keeps the time linear; finer ones would be lower than a thousandth of the height.
const MOST_OCTAVES: u32 = 10;

fn generate(size: u32, seed: u64) -> GeneratedScene {
    // No octave is finer than the grid.
    let octaves = (size / COARSEST).max(1).ilog2().min(MOST_OCTAVES - 1) + 1;
    let land = height_field(size, HALF_WIDTH, |i, j| {
        let place = Vec2::new(i as f32, j as f32) / size as f32;
        HEIGHT * fractal_noise(seed, place, octaves) - sinking(place)
    });
    let water =
        ground(Vec3::Y * -0.3, 4.0 * HALF_WIDTH, "water", [0.05, 0.12, 0.2]).with_mirror(0.35);
    GeneratedScene {
        parts: vec![land.into_part("land", [0.35, 0.42, 0.22]), water],
        view: SuggestedView::new(Vec3::new(6.8, 13.0, 24.0), Vec3::new(0.0, -0.6, 0.0)),
        lights: vec![Vec3::new(-25.0, 22.0, 5.0)],
    }
}

/// How far the land goes down, in its outer part to below the water: it is an island.
fn sinking(place: Vec2) -> f32 {
    let from_center = (2.0 * place - 1.0).abs().max_element();
    let outward = ((from_center - 0.7) / 0.3).clamp(0.0, 1.0);
    0.8 * HEIGHT * outward * outward * (3.0 - 2.0 * outward)
}

/// Noise at doubled frequency and half the height, again and again.
fn fractal_noise(seed: u64, place: Vec2, octaves: u32) -> f32 {
    (0..octaves)
        .map(|octave| {
            let frequency = (COARSEST << octave) as f32;
            gradient_noise(seed.wrapping_add(u64::from(octave)), place * frequency)
                / (1 << octave) as f32
        })
        .sum()
}

/// A smooth function that is zero at lattice points and has random slopes there. Coordinates are not negative.
fn gradient_noise(seed: u64, place: Vec2) -> f32 {
    let cell = place.floor();
    let within = place - cell;
    let corner = |dx: u32, dy: u32| {
        let [x, y] = [cell.x, cell.y].map(lattice_number);
        let angle = TAU * (hash_grid_point(seed, x + dx, y + dy) >> 40) as f32 / (1 << 24) as f32;
        Vec2::from_angle(angle).dot(within - Vec2::new(dx as f32, dy as f32))
    };
    // 6t^5 - 15t^4 + 10t^3: first and second derivatives vanish at both ends.
    let fade = within * within * within * (within * (within * 6.0 - 15.0) + 10.0);
    let mix = |a: f32, b: f32, weight: f32| a + (b - a) * weight;
    mix(
        mix(corner(0, 0), corner(1, 0), fade.x),
        mix(corner(0, 1), corner(1, 1), fade.x),
        fade.y,
    )
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a whole number from 0 to the finest octave's lattice cells"
)]
fn lattice_number(coordinate: f32) -> u32 {
    coordinate as u32
}
