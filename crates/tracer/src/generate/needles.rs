//! Thin triangles along the four diagonals of a cube.
//!
//! The worst case of axis-aligned boxes: each box is as large as the scene, nearly empty, and overlaps all others.

use glam::Vec3;

use super::generator::Recipe;
use super::mesh_builder::MeshBuilder;
use super::random::Random;
use super::{GeneratedScene, SuggestedView};

pub(super) const NEEDLES: Recipe = Recipe {
    name: "needles",
    description: "thin triangles along the diagonals of a cube, where bounding boxes are at their worst",
    size_meaning: "triangles",
    // At ten million the needles are 180 units in the last place of their coordinates wide.
    sizes: 1..=10_000_000,
    default_size: 4000,
    uses_seed: true,
    triangle_count: |size| size as u64,
    generate,
};

/// The diagonals, each with the name and colour of its needles.
pub(super) const DIAGONALS: [([f32; 3], &str, [f32; 3]); 4] = [
    ([1.0, 1.0, 1.0], "needles along +++", [0.8, 0.35, 0.2]),
    ([-1.0, 1.0, 1.0], "needles along -++", [0.25, 0.5, 0.75]),
    ([1.0, 1.0, -1.0], "needles along ++-", [0.75, 0.65, 0.25]),
    ([-1.0, 1.0, -1.0], "needles along -+-", [0.35, 0.6, 0.35]),
];

fn generate(size: u32, seed: u64) -> GeneratedScene {
    let mut random = Random::new(seed);
    // The more needles, the thinner, so that one can still look into the field.
    let width = (size as f32).powf(-2.0 / 3.0);
    let mut meshes: [MeshBuilder; 4] = std::array::from_fn(|_| MeshBuilder::default());
    for (mesh, (diagonal, ..)) in (0..size)
        .zip((0..4).cycle())
        .map(|(_, k)| (k, DIAGONALS[k]))
    {
        needle(&mut meshes[mesh], &mut random, Vec3::from(diagonal), width);
    }
    let parts = meshes
        .into_iter()
        .zip(DIAGONALS)
        .map(|(mesh, (_, name, color))| mesh.into_part(name, color))
        .collect();
    GeneratedScene {
        parts,
        view: SuggestedView::new(Vec3::new(1.5, 1.2, 5.4), Vec3::ZERO),
        lights: vec![Vec3::new(4.0, 5.0, 6.0), Vec3::new(-6.0, 3.0, 2.0)],
    }
}

/// A triangle with a short base around `-diagonal` and its tip near `diagonal`.
fn needle(mesh: &mut MeshBuilder, random: &mut Random, diagonal: Vec3, width: f32) {
    let center = 0.5 * random.in_cube();
    let half_axis = 0.7 * diagonal + 0.05 * random.in_cube();
    let across = half_axis.cross(random.in_cube()).normalize_or(Vec3::X) * (0.5 * width);
    let base = center - half_axis;
    let corners = [base - across, base + across, center + half_axis];
    let corners = corners.map(|corner| mesh.vertex(corner));
    mesh.triangle(corners);
}
