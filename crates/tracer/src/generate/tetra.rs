//! The Sierpinski tetrahedron.

use glam::{DVec3, Vec3};

use super::generator::Recipe;
use super::mesh_builder::MeshBuilder;
use super::{GeneratedScene, SuggestedView};

pub(super) const TETRA: Recipe = Recipe {
    name: "tetra",
    description: "the Sierpinski tetrahedron",
    size_meaning: "power of four that is the triangle count",
    sizes: 1..=13,
    default_size: 6,
    uses_seed: false,
    triangle_count: |size| 1 << (2 * size),
    generate,
};

/// The faces, counter-clockwise as seen from outside.
const FACES: [[usize; 3]; 4] = [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]];

fn generate(size: u32, _seed: u64) -> GeneratedScene {
    let mut mesh = MeshBuilder::default();
    let levels = size - 1;
    for number in 0..1u32 << (2 * levels) {
        let vertices = tetrahedron(levels, number).map(|corner| mesh.vertex(corner));
        for face in FACES {
            mesh.triangle(face.map(|corner| vertices[corner]));
        }
    }
    GeneratedScene {
        parts: vec![mesh.into_part("tetrahedra", [0.7, 0.5, 0.25])],
        view: SuggestedView::new(Vec3::new(1.0, 1.3, 3.2), Vec3::Y * 0.2),
        lights: vec![Vec3::new(3.0, 5.0, 4.0), Vec3::new(-5.0, 2.0, 3.0)],
    }
}

/// The corners of the whole: a regular tetrahedron in the unit sphere, on its base.
fn corners() -> [DVec3; 4] {
    let (x, z) = (8.0f64.sqrt() / 3.0, (2.0f64 / 3.0).sqrt());
    [
        DVec3::new(x, -1.0 / 3.0, 0.0),
        DVec3::new(-0.5 * x, -1.0 / 3.0, z),
        DVec3::new(-0.5 * x, -1.0 / 3.0, -z),
        DVec3::Y,
    ]
}

/// The corners of a small tetrahedron. The base-four digits of its number say into which corner to go at each level.
///
/// Corners are weighted means of the four corners of the whole, with whole weights over a power of two: where two
/// small tetrahedra touch, their corners have equal weights and are the same point, bit for bit.
fn tetrahedron(levels: u32, number: u32) -> [Vec3; 4] {
    let mut weights = [0u32; 4];
    for level in 0..levels {
        weights[(number >> (2 * level) & 3) as usize] += 1 << level;
    }
    std::array::from_fn(|corner| {
        let mut weights = weights;
        weights[corner] += 1;
        let sum: DVec3 = corners()
            .into_iter()
            .zip(weights)
            .map(|(corner, weight)| corner * f64::from(weight))
            .sum();
        (sum / f64::from(1u32 << levels)).as_vec3()
    })
}
