//! The sphereflake, alone and as the standard database "balls".
//!
//! A sphere carries nine spheres of a third of its radius: six around its equator and three above, in nine of the
//! twelve directions in which equal spheres touch a central one. Each of them carries nine more, with its own
//! pole pointing away from its parent. Branches touch in the limit but never overlap.

use std::f32::consts::TAU;

use glam::{Quat, Vec3};

use super::generator::Recipe;
use super::mesh_builder::MeshBuilder;
use super::shapes::{GROUND_TRIANGLE_COUNT, UnitSphere, ground};
use super::{GeneratedPart, GeneratedScene, SuggestedView};

pub(super) const SPHEREFLAKE: Recipe = Recipe {
    name: "sphereflake",
    description: "spheres that carry nine smaller spheres each",
    size_meaning: "generations of spheres after the first",
    sizes: 0..=6,
    default_size: 3,
    uses_seed: false,
    triangle_count: flake_triangle_count,
    generate: |size, _seed| scene(vec![flake(size)]),
};

pub(super) const BALLS: Recipe = Recipe {
    name: "balls",
    description: "the sphereflake on a ground plate",
    size_meaning: "generations of spheres after the first",
    sizes: 0..=6,
    default_size: 3,
    uses_seed: false,
    triangle_count: |size| flake_triangle_count(size) + GROUND_TRIANGLE_COUNT,
    generate: |size, _seed| {
        let plate = ground(Vec3::NEG_Y, 6.0, "plate", [0.45, 0.4, 0.35]);
        scene(vec![flake(size), plate])
    },
};

/// Large spheres are cut finer, but not more than this often.
const MOST_SUBDIVISIONS: u32 = 4;

const fn subdivisions(generations_left: u32) -> u32 {
    if generations_left + 1 < MOST_SUBDIVISIONS {
        generations_left + 1
    } else {
        MOST_SUBDIVISIONS
    }
}

fn flake_triangle_count(size: u32) -> u64 {
    (0..=size)
        .map(|generation| {
            9u64.pow(generation) * UnitSphere::triangle_count(subdivisions(size - generation))
        })
        .sum()
}

fn scene(parts: Vec<GeneratedPart>) -> GeneratedScene {
    GeneratedScene {
        parts,
        view: SuggestedView::new(Vec3::new(2.4, 2.8, 5.2), Vec3::new(0.0, 0.25, 0.0)),
        lights: vec![Vec3::new(6.0, 8.0, 4.0), Vec3::new(-5.0, 6.0, 6.0)],
    }
}

/// A sphere, with the rotation that takes y to its pole.
#[derive(Clone, Copy)]
struct Sphere {
    center: Vec3,
    radius: f32,
    rotation: Quat,
}

fn flake(size: u32) -> GeneratedPart {
    let mut mesh = MeshBuilder::default();
    let spheres = UnitSphere::levels(subdivisions(size));
    let mut generation = vec![Sphere {
        center: Vec3::ZERO,
        radius: 1.0,
        rotation: Quat::IDENTITY,
    }];
    for generations_left in (0..=size).rev() {
        let unit_sphere = &spheres[subdivisions(generations_left) as usize];
        for sphere in &generation {
            unit_sphere.stamp(&mut mesh, sphere.center, sphere.radius);
        }
        if generations_left > 0 {
            generation = generation.iter().flat_map(children).collect();
        }
    }
    mesh.into_part("spheres", [0.75, 0.6, 0.35])
        .with_mirror(0.3)
}

fn children(parent: &Sphere) -> impl Iterator<Item = Sphere> + use<> {
    let parent = *parent;
    // Elevation of the upper three: they touch each other and two of the equator, were they all of the parent's size.
    let (sin, cos) = ((2.0f32 / 3.0).sqrt(), (1.0f32 / 3.0).sqrt());
    let equator = (0..6).map(|i| (TAU * i as f32 / 6.0, 0.0, 1.0));
    let above = (0..3).map(move |i| (TAU * (i as f32 + 0.25) / 3.0, sin, cos));
    equator
        .chain(above)
        .map(move |(longitude, height, distance)| {
            let direction = Vec3::new(
                distance * longitude.cos(),
                height,
                distance * longitude.sin(),
            );
            let rotation = parent.rotation * Quat::from_rotation_arc(Vec3::Y, direction);
            Sphere {
                center: parent.center + parent.rotation * direction * (parent.radius * (4.0 / 3.0)),
                radius: parent.radius / 3.0,
                rotation: rotation.normalize(),
            }
        })
}
