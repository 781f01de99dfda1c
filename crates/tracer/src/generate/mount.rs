//! A fractal mountain below four glass spheres.
//!
//! Source: A. Fournier, D. Fussell, L. Carpenter, "Computer Rendering of Stochastic Models", CACM 25(6), 1982, for the
//! midpoint displacement, here on a square grid with a diamond step between.

use glam::Vec3;

use super::generator::Recipe;
use super::height_field::{height_field, height_field_triangle_count};
use super::mesh_builder::MeshBuilder;
use super::random::Random;
use super::shapes::UnitSphere;
use super::{GeneratedScene, SuggestedView};

pub(super) const MOUNT: Recipe = Recipe {
    name: "mount",
    description: "a fractal mountain below four glass spheres",
    size_meaning: "times that the mountain is subdivided",
    sizes: 1..=12,
    default_size: 7,
    uses_seed: true,
    triangle_count: |size| {
        height_field_triangle_count(1 << size)
            + SPHERES.len() as u64 * UnitSphere::triangle_count(sphere_subdivisions(size))
    },
    generate,
};

/// Centre and radius.
const SPHERES: [([f32; 3], f32); 4] = [
    ([-1.1, 1.25, 0.9], 0.32),
    ([-0.1, 1.75, 1.1], 0.3),
    ([1.0, 1.5, 0.8], 0.34),
    ([0.6, 0.95, 1.7], 0.26),
];

const HALF_WIDTH: f32 = 2.0;
const SUMMIT: f32 = 1.3;
/// How much lower the random heights are after each subdivision.
const ROUGHNESS: f32 = 0.52;

/// Small mountains have coarse spheres, so that most triangles are the mountain's.
fn sphere_subdivisions(size: u32) -> u32 {
    (size / 2).clamp(1, 4)
}

fn generate(size: u32, seed: u64) -> GeneratedScene {
    let grid = displaced_grid(size, seed);
    let mountain = height_field(1 << size, HALF_WIDTH, |i, j| grid.get(i, j));
    let mut spheres = MeshBuilder::default();
    let unit_sphere = UnitSphere::new(sphere_subdivisions(size));
    for (center, radius) in SPHERES {
        unit_sphere.stamp(&mut spheres, Vec3::from(center), radius);
    }
    GeneratedScene {
        parts: vec![
            mountain.into_part("mountain", [0.5, 0.44, 0.36]),
            spheres
                .into_part("spheres", [0.95; 3])
                .with_mirror(0.1)
                .with_refractive_index(1.5),
        ],
        view: SuggestedView::new(Vec3::new(-1.3, 2.8, 6.0), Vec3::new(0.0, 0.75, 0.0)),
        lights: vec![Vec3::new(-5.0, 3.5, 1.5)],
    }
}

/// Heights at the points of a square grid.
struct Grid {
    cells: u32,
    heights: Vec<f32>,
}

impl Grid {
    fn place(&self, i: u32, j: u32) -> usize {
        j as usize * (self.cells as usize + 1) + i as usize
    }

    fn get(&self, i: u32, j: u32) -> f32 {
        self.heights[self.place(i, j)]
    }

    fn set(&mut self, i: u32, j: u32, height: f32) {
        let place = self.place(i, j);
        self.heights[place] = height;
    }

    /// The mean of the four points at some offsets, those outside the grid left out.
    fn mean(&self, i: u32, j: u32, offsets: [(i64, i64); 4]) -> f32 {
        let shifted = |start: u32, offset: i64| {
            u32::try_from(i64::from(start) + offset)
                .ok()
                .filter(|&sum| sum <= self.cells)
        };
        let (mut sum, mut count) = (0.0, 0.0);
        for (di, dj) in offsets {
            if let (Some(i), Some(j)) = (shifted(i, di), shifted(j, dj)) {
                sum += self.get(i, j);
                count += 1.0;
            }
        }
        // At least two of the four are always inside.
        sum / count
    }
}

/// Sets the middles of all squares, then the middles of their sides, to the mean of their neighbours plus a
/// random height that shrinks with the square.
fn displaced_grid(size: u32, seed: u64) -> Grid {
    let cells = 1u32 << size;
    let points = cells as usize + 1;
    let mut grid = Grid {
        cells,
        heights: vec![0.0; points * points],
    };
    let mut random = Random::new(seed);
    let mut spread = 1.6;
    let mut step = cells;
    while step > 1 {
        let half = step / 2;
        let reach = i64::from(half);
        for j in (half..cells).step_by(step as usize) {
            for i in (half..cells).step_by(step as usize) {
                let diagonal = [
                    (-reach, -reach),
                    (reach, -reach),
                    (-reach, reach),
                    (reach, reach),
                ];
                // The first middle is the summit.
                let height = if step == cells {
                    SUMMIT
                } else {
                    grid.mean(i, j, diagonal) + spread * random.between(-0.5, 0.5)
                };
                grid.set(i, j, height);
            }
        }
        for j in (0..=cells).step_by(half as usize) {
            let first = if j % step == 0 { half } else { 0 };
            for i in (first..=cells).step_by(step as usize) {
                let straight = [(-reach, 0), (reach, 0), (0, -reach), (0, reach)];
                let height = grid.mean(i, j, straight) + spread * random.between(-0.5, 0.5);
                // The foot stays flat at the border.
                let on_border = i == 0 || j == 0 || i == cells || j == cells;
                grid.set(i, j, if on_border { 0.0 } else { height });
            }
        }
        spread *= ROUGHNESS;
        step = half;
    }
    grid
}
