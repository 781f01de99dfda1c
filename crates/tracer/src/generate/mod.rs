//! Procedural scenes of any size: the standard procedural databases and the shapes that structures find hard.
//!
//! Every generator has one size parameter that drives its triangle count from about a thousand to a
//! million and beyond. The same generator, size and seed give the same triangles. Time and memory are linear in the
//! triangle count. All scenes stand in a right-handed space with y up, and all triangles are counter-clockwise as seen
//! from outside, or from above for open surfaces.
//!
//! ```
//! use tahko_tracer::generate::{Generator, generate};
//!
//! let scene = generate(Generator::Gears, 2, 0)?;
//! assert_eq!(scene.triangle_count(), Generator::Gears.triangle_count(2)?);
//! let size = Generator::Gears.size_for_triangles(1_000_000)?;
//! assert_eq!(size, 14);
//! # Ok::<(), tahko_tracer::generate::GenerateError>(())
//! ```
//!
//! Balls, gears, mount, rings, teapot, tetra, tree and lattice follow the descriptions in Source: E. Haines, "A Proposal for
//! Standard Graphics Environments", IEEE Computer Graphics and Applications 7(11), 1987, and its later
//! additions. What differs: curved surfaces are tessellated, and the trees' proportions, colours, views and lights are our own.

mod city;
mod cylinders;
mod error;
mod gears;
mod generator;
mod hairball;
mod height_field;
mod lattice;
mod mesh_builder;
mod mount;
mod needles;
mod random;
mod rings;
mod shapes;
mod sphereflake;
mod teapot;
mod terrain;
mod tetra;
mod tree;

use glam::Vec3;

pub use error::GenerateError;
pub use generator::Generator;
pub(crate) use shapes::UnitSphere;

/// A generated scene: triangles in parts, with a view and lights that suit them.
#[derive(Clone, Debug, PartialEq)]
pub struct GeneratedScene {
    /// The parts; none is empty.
    pub parts: Vec<GeneratedPart>,
    /// A view that shows the whole scene.
    pub view: SuggestedView,
    /// Positions of point lights, outside all parts.
    pub lights: Vec<Vec3>,
}

/// A part of a generated scene that shares one look.
#[derive(Clone, Debug, PartialEq)]
pub struct GeneratedPart {
    /// What it is, unique in its scene.
    pub name: &'static str,
    /// Vertices, all finite.
    pub positions: Vec<Vec3>,
    /// Vertex indices of each triangle, in range.
    pub indices: Vec<[u32; 3]>,
    /// Unit shading normals, one per position, where the surface is smooth; `None` where it is faceted.
    pub normals: Option<Vec<Vec3>>,
    /// Suggested diffuse reflectance, linear RGB in `[0, 1]`.
    pub color: Vec3,
    /// Suggested mirror reflectance in `[0, 1]`.
    pub mirror: f32,
    /// Suggested index of refraction, if the part should be clear.
    pub refractive_index: Option<f32>,
}

/// A camera placement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SuggestedView {
    /// Where the camera is.
    pub eye: Vec3,
    /// The point in the middle of the picture.
    pub target: Vec3,
    /// What is up in the picture.
    pub up: Vec3,
    /// The angle between the upper and the lower border of the picture, in degrees.
    pub vertical_fov_degrees: f32,
}

/// Generates a scene. The seed matters where [`Generator::uses_seed`] says so.
///
/// # Errors
/// If the size is not in [`Generator::sizes`].
pub fn generate(
    generator: Generator,
    size: u32,
    seed: u64,
) -> Result<GeneratedScene, GenerateError> {
    generator.check_size(size)?;
    let mut scene = (generator.recipe().generate)(size, seed);
    scene.parts.retain(|part| !part.indices.is_empty());
    Ok(scene)
}

impl GeneratedScene {
    /// The number of triangles of all parts.
    #[must_use]
    pub fn triangle_count(&self) -> u64 {
        self.parts
            .iter()
            .map(|part| part.indices.len() as u64)
            .sum()
    }
}

impl GeneratedPart {
    fn with_mirror(self, mirror: f32) -> Self {
        Self { mirror, ..self }
    }

    fn with_refractive_index(self, index: f32) -> Self {
        Self {
            refractive_index: Some(index),
            ..self
        }
    }
}

impl SuggestedView {
    /// Looks with y up and a field of view of 40 degrees.
    fn new(eye: Vec3, target: Vec3) -> Self {
        Self {
            eye,
            target,
            up: Vec3::Y,
            vertical_fov_degrees: 40.0,
        }
    }
}

#[cfg(test)]
mod tests;
