//! Spheres at the points of a cubic grid, joined by cylinders.

use glam::{UVec3, Vec3};

use super::generator::Recipe;
use super::mesh_builder::MeshBuilder;
use super::shapes::{Ball, UnitSphere, open_cone, open_cone_triangle_count};
use super::{GeneratedScene, SuggestedView};

pub(super) const LATTICE: Recipe = Recipe {
    name: "lattice",
    description: "spheres at grid points, joined by cylinders",
    size_meaning: "cylinders along a side",
    sizes: 1..=93,
    default_size: 5,
    uses_seed: false,
    triangle_count: |size| {
        let cells = u64::from(size);
        let spheres = (cells + 1).pow(3);
        let cylinders = 3 * cells * (cells + 1).pow(2);
        spheres * UnitSphere::triangle_count(SUBDIVISIONS)
            + cylinders * open_cone_triangle_count(SEGMENTS)
    },
    generate,
};

const SUBDIVISIONS: u32 = 1;
const SEGMENTS: u32 = 6;
const SPHERE_RADIUS: f32 = 0.2;
const CYLINDER_RADIUS: f32 = 0.07;

fn generate(size: u32, _seed: u64) -> GeneratedScene {
    let mut spheres = MeshBuilder::default();
    let mut cylinders = MeshBuilder::default();
    let unit_sphere = UnitSphere::new(SUBDIVISIONS);
    let half_width = 0.5 * size as f32;
    for point in grid_points(size) {
        let center = point.as_vec3() - half_width;
        unit_sphere.stamp(&mut spheres, center, SPHERE_RADIUS);
        for step in [UVec3::X, UVec3::Y, UVec3::Z] {
            if (point + step).max_element() <= size {
                let ends = [center, center + step.as_vec3()].map(|center| Ball {
                    center,
                    radius: CYLINDER_RADIUS,
                });
                open_cone(&mut cylinders, SEGMENTS, ends[0], ends[1]);
            }
        }
    }
    let extent = size as f32 + 0.6;
    GeneratedScene {
        parts: vec![
            spheres
                .into_part("spheres", [0.65, 0.25, 0.2])
                .with_mirror(0.25),
            cylinders
                .into_part("cylinders", [0.65, 0.65, 0.68])
                .with_mirror(0.25),
        ],
        view: SuggestedView::new(Vec3::new(1.1, 0.85, 2.05) * extent, Vec3::ZERO),
        lights: vec![
            Vec3::new(2.0, 2.0, 2.0) * extent,
            Vec3::new(-2.0, 1.0, 2.0) * extent,
        ],
    }
}

/// All points with coordinates from 0 to `size`.
fn grid_points(size: u32) -> impl Iterator<Item = UVec3> {
    (0..=size).flat_map(move |z| {
        (0..=size).flat_map(move |y| (0..=size).map(move |x| UVec3::new(x, y, z)))
    })
}
