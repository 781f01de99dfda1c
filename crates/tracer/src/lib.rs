//! Scenes, loaders and a ray tracer over tahko's four structures.
//!
//! The way of a picture: [`load::load_scene`] reads a file into a [`scene::Scene`]; [`accelerator::Accelerator`]
//! builds brute force, a BSP tree, a kd-tree or a BVH over its triangles; [`render::render`] traces rays through it
//! into a [`film::Film`], which is written as PNG or EXR. The picture is the same, bit for bit, for every
//! structure and every number of threads.
//!
//! ```
//! use tahko_tracer::accelerator::{Accelerator, StructureKind};
//! use tahko_tracer::geometry::{Precision, Transform, glam::Vec3};
//! use tahko_tracer::render::{RenderControl, RenderOptions, render};
//! use tahko_tracer::scene::{Material, MeshPart, SceneBuilder};
//!
//! let mut builder = SceneBuilder::new();
//! let red = builder.add_material(Material { color: Vec3::X, ..Material::default() });
//! let triangle = MeshPart {
//!     positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
//!     indices: vec![[0, 1, 2]],
//!     ..MeshPart::default()
//! };
//! builder.add_part(triangle, red, &Transform::IDENTITY)?;
//! // Camera and light are the default ones, which frame the scene.
//! let scene = builder.finish()?;
//! let bvh = Accelerator::build(StructureKind::Bvh, Precision::default(), scene.mesh())?;
//! let options = RenderOptions { width: 32, height: 32, ..RenderOptions::default() };
//! let (film, statistics) = render(&scene, bvh.query(), &options, &RenderControl::default())?;
//! assert_eq!(statistics.camera_rays, 32 * 32);
//! let center = film.pixels()[16 * 32 + 12];
//! assert!(center.x > center.y, "red is seen: {center}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![forbid(unsafe_code)]

pub mod accelerator;
pub mod film;
pub mod generate;
pub mod load;
mod output;
pub mod render;
pub mod scene;

pub use output::write_atomically;
pub use tahko_geometry as geometry;

/// Compiles and runs the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
