//! A fractal tree: every branch is a cone that ends in a sphere and carries two shorter branches.

use glam::{Quat, Vec3};

use super::generator::Recipe;
use super::mesh_builder::MeshBuilder;
use super::random::Random;
use super::shapes::{
    Ball, GROUND_TRIANGLE_COUNT, UnitSphere, ground, open_cone, open_cone_triangle_count,
};
use super::{GeneratedScene, SuggestedView};

pub(super) const TREE: Recipe = Recipe {
    name: "tree",
    description: "a fractal tree of cones and spheres",
    size_meaning: "generations of branches after the trunk",
    sizes: 1..=20,
    default_size: 10,
    uses_seed: true,
    triangle_count: |size| {
        let branches: u64 = (0..=size)
            .map(|generation| (1 << generation) * branch_triangle_count(size - generation))
            .sum();
        branches + GROUND_TRIANGLE_COUNT
    },
    generate,
};

const TRUNK_LENGTH: f32 = 1.0;
const TRUNK_RADIUS: f32 = 0.13;
/// Lengths and radii of a branch, in those of the branch that carries it.
const LENGTH_RATIO: f32 = 0.8;
const RADIUS_RATIO: f32 = 0.7;
/// Radius of the sphere at the end of a twig, in lengths of the twig.
const LEAF_RADIUS: f32 = 0.4;

/// A branch, with the direction towards which its first child leans.
#[derive(Clone, Copy)]
struct Branch {
    start: Vec3,
    direction: Vec3,
    side: Vec3,
    length: f32,
    radius: f32,
}

/// Thick branches are cut finer.
const fn segments(generations_left: u32) -> u32 {
    5 + if generations_left < 5 {
        generations_left
    } else {
        5
    }
}

const fn subdivisions(generations_left: u32) -> u32 {
    if generations_left < 6 { 0 } else { 1 }
}

fn branch_triangle_count(generations_left: u32) -> u64 {
    open_cone_triangle_count(segments(generations_left))
        + UnitSphere::triangle_count(subdivisions(generations_left))
}

fn generate(size: u32, seed: u64) -> GeneratedScene {
    let mut random = Random::new(seed);
    let mut wood = MeshBuilder::default();
    let mut leaves = MeshBuilder::default();
    let spheres = UnitSphere::levels(subdivisions(size));
    let mut branches = vec![Branch {
        start: Vec3::ZERO,
        direction: Vec3::Y,
        side: Vec3::X,
        length: TRUNK_LENGTH,
        radius: TRUNK_RADIUS,
    }];
    for generations_left in (0..=size).rev() {
        let sphere = &spheres[subdivisions(generations_left) as usize];
        for branch in &branches {
            open_cone(
                &mut wood,
                segments(generations_left),
                branch.first_ball(),
                branch.last_ball(),
            );
            let end = branch.last_ball();
            if generations_left == 0 {
                sphere.stamp(&mut leaves, end.center, LEAF_RADIUS * branch.length);
            } else {
                sphere.stamp(&mut wood, end.center, end.radius);
            }
        }
        if generations_left > 0 {
            branches = branches
                .iter()
                .flat_map(|branch| branch.children(&mut random))
                .collect();
        }
    }
    GeneratedScene {
        parts: vec![
            wood.into_part("wood", [0.3, 0.19, 0.11]),
            leaves.into_part("leaves", [0.2, 0.42, 0.1]),
            ground(Vec3::ZERO, 6.0, "lawn", [0.25, 0.33, 0.16]),
        ],
        view: SuggestedView::new(Vec3::new(1.0, 2.8, 8.0), Vec3::Y * 1.9),
        lights: vec![Vec3::new(5.0, 8.0, 6.0), Vec3::new(-7.0, 5.0, 4.0)],
    }
}

impl Branch {
    fn first_ball(&self) -> Ball {
        Ball {
            center: self.start,
            radius: self.radius,
        }
    }

    fn last_ball(&self) -> Ball {
        Ball {
            center: self.start + self.length * self.direction,
            radius: RADIUS_RATIO * self.radius,
        }
    }

    fn children(&self, random: &mut Random) -> [Self; 2] {
        let end = self.last_ball();
        [1.0, -1.0].map(|sign| {
            let lean = random.between(0.35, 0.65);
            let direction =
                (self.direction * lean.cos() + sign * self.side * lean.sin()).normalize_or(Vec3::Y);
            // The next fork is turned by about a right angle.
            let side = direction.cross(self.direction.cross(self.side));
            let turn = Quat::from_axis_angle(direction, random.between(1.1, 2.0));
            Self {
                start: end.center,
                direction,
                side: (turn * side)
                    .reject_from(direction)
                    .normalize_or(direction.any_orthonormal_vector()),
                length: self.length * LENGTH_RATIO * random.between(0.85, 1.1),
                radius: end.radius,
            }
        })
    }
}
