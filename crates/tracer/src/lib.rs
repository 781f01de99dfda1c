//! Scenes, loaders and a ray tracer over tahko's four structures.
//!
//! The way of a picture: [`load::load_scene`] reads a file into a [`scene::Scene`]; [`accelerator::Accelerator`]
//! builds brute force, a BSP tree, a kd-tree or a BVH over its triangles; [`render::render`] traces rays through it
//! into a [`film::Film`], which is written as PNG or EXR. The picture is the same, bit for bit, for every
//! structure and every number of threads.
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
