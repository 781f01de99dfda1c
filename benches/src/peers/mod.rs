//! Other libraries, asked the same questions in the same run. `docs/peers.md` says how each is used and why.
//!
//! Rays are [valid](tahko_tracer::geometry::Ray::is_valid) and their `t_min` is not negative, as the benchmark's are: some of the libraries end the
//! program on NaN, and most do not look behind a ray's origin.

mod bvh;
mod embree;
mod moller_trumbore;
mod obvhs;
mod parry;
#[cfg(test)]
mod tests;
#[cfg(target_feature = "avx2")]
mod tinybvh;

use anyhow::{Result, ensure};
use tahko_tracer::geometry::TriangleMesh;

use crate::arguments::Library;
use crate::contender::Recipe;
use crate::report;

/// The libraries by name, of those that this build and this machine can ask.
///
/// # Errors
/// If the user names an Embree that cannot be used. Without any Embree a note goes to stderr, and it is left out.
pub(crate) fn recipes(libraries: &[Library]) -> Result<Vec<Box<dyn Recipe>>> {
    let mut recipes = Vec::new();
    for library in libraries {
        recipes.extend(match library {
            Library::Embree => embree::recipes()?,
            Library::Obvhs => obvhs::recipes(),
            Library::Bvh => bvh::recipes(),
            Library::Parry3d => parry::recipes(),
            Library::Tinybvh => tinybvh_recipes(false),
            Library::TinybvhHq => tinybvh_recipes(true),
        });
    }
    Ok(recipes)
}

#[cfg(target_feature = "avx2")]
fn tinybvh_recipes(has_spatial_splits: bool) -> Vec<Box<dyn Recipe>> {
    tinybvh::recipes(has_spatial_splits)
}

/// The binding of tinybvh has rays for its eight-wide layout only where the compiler may use AVX2.
#[cfg(not(target_feature = "avx2"))]
fn tinybvh_recipes(_has_spatial_splits: bool) -> Vec<Box<dyn Recipe>> {
    eprintln!(
        "note: tinybvh is left out, since this build may not use AVX2; `cargo xtask bench --peers` builds for the machine's own processor"
    );
    Vec::new()
}

/// What the SIMD code of a library in Rust was compiled for.
const RUST_SIMD: &str = if cfg!(target_feature = "avx2") {
    "native"
} else {
    "baseline"
};

/// A contender that answers with a call per ray, in the library's only mode.
fn single(library: &str, structure: &str, preset: &str, simd: &str) -> report::Contender {
    report::Contender {
        library: library.to_owned(),
        structure: structure.to_owned(),
        preset: preset.to_owned(),
        precision: "default".to_owned(),
        simd: simd.to_owned(),
        interface: "single".to_owned(),
    }
}

/// Libraries differ in what they do about a mesh without triangles: one ends the program.
fn refuse_empty(mesh: &TriangleMesh) -> Result<()> {
    ensure!(
        !mesh.is_empty(),
        "other libraries cannot be built over a mesh without triangles"
    );
    Ok(())
}
