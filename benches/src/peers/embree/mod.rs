//! Embree 4, loaded at run time.

mod denormals;
#[expect(unsafe_code, reason = "functions of a C library are found by name")]
mod ffi;
#[expect(unsafe_code, reason = "makes objects of a C library safe to use")]
mod scene;
#[expect(unsafe_code, reason = "hands rays to a C library")]
mod trace;
#[expect(unsafe_code, reason = "lets a C library build trees of its nodes")]
mod tree;

use std::env;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use anyhow::{Context, Result};
use tahko_tracer::geometry::TriangleMesh;

use self::scene::{Embree, Scene, Settings};
use self::trace::{Packets, Single};
use super::refuse_empty;
use crate::contender::{Built, Contender, Recipe};
use crate::report;

/// Names the library's file.
const VARIABLE: &str = "EMBREE_LIB";

pub(super) fn recipes() -> Result<Vec<Box<dyn Recipe>>> {
    let Some(path) = library(env::var_os(VARIABLE).as_deref()) else {
        eprintln!(
            "note: Embree is left out: `cargo xtask peers` installs it, or {VARIABLE}=FILE names the library"
        );
        return Ok(Vec::new());
    };
    let embree = loaded(&path).with_context(|| format!("Embree from {}", path.display()))?;
    let mut recipes: Vec<Box<dyn Recipe>> = Vec::new();
    for (precision, flags) in [("default", ffi::SCENE_NONE), ("robust", ffi::SCENE_ROBUST)] {
        for (preset, quality) in [("medium", ffi::BUILD_MEDIUM), ("high", ffi::BUILD_HIGH)] {
            let settings = Settings { flags, quality };
            recipes.push(Box::new(EmbreeRecipe {
                embree,
                precision,
                preset,
                settings,
            }));
        }
    }
    Ok(recipes)
}

/// The file that the user names, or that `cargo xtask peers` noted in the target folder.
fn library(named: Option<&OsStr>) -> Option<PathBuf> {
    if let Some(named) = named.filter(|named| !named.is_empty()) {
        return Some(named.into());
    }
    let program = env::current_exe().ok()?;
    program.ancestors().find_map(|folder| {
        let note = fs::read_to_string(folder.join("peers/embree-library.txt")).ok()?;
        let library = PathBuf::from(note.trim());
        library.is_file().then_some(library)
    })
}

/// The library is loaded once and stays: its threads outlive every scene.
fn loaded(path: &Path) -> Result<&'static Embree> {
    static LOADED: Mutex<Option<&'static Embree>> = Mutex::new(None);
    let mut loaded = LOADED.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(embree) = *loaded {
        return Ok(embree);
    }
    let embree: &'static Embree = Box::leak(Box::new(Embree::load(path)?));
    *loaded = Some(embree);
    Ok(embree)
}

struct EmbreeRecipe {
    embree: &'static Embree,
    precision: &'static str,
    preset: &'static str,
    settings: Settings,
}

impl Recipe for EmbreeRecipe {
    fn names(&self) -> Vec<report::Contender> {
        let mut interfaces = vec!["single".to_owned()];
        if self.embree.packet > 1 {
            interfaces.push(format!("packet{}", self.embree.packet));
        }
        interfaces
            .into_iter()
            .map(|interface| report::Contender {
                library: "embree".to_owned(),
                structure: "bvh8".to_owned(),
                preset: self.preset.to_owned(),
                precision: self.precision.to_owned(),
                simd: "native".to_owned(),
                interface,
            })
            .collect()
    }

    fn build(&self, mesh: &TriangleMesh, threads: usize) -> Result<Built> {
        refuse_empty(mesh)?;
        let scene = Arc::new(Scene::build(self.embree, mesh, self.settings, threads)?);
        let bytes = scene.bytes;
        // Robust scenes differ in how they are traced.
        let tree = match self.settings.flags {
            ffi::SCENE_NONE => Some(tree::measure(self.embree, mesh, self.settings, threads)?),
            _ => None,
        };
        let mut contenders: Vec<Box<dyn Contender>> = vec![Box::new(Single(Arc::clone(&scene)))];
        match self.embree.packet {
            16 => contenders.push(Box::new(Packets::<16>(scene))),
            8 => contenders.push(Box::new(Packets::<8>(scene))),
            _ => {}
        }
        Ok(Built {
            contenders,
            bytes: Some(bytes),
            tree,
        })
    }

    fn time_build(&self, mesh: &TriangleMesh, threads: usize) -> Result<f64> {
        let start = Instant::now();
        let scene = Scene::build(self.embree, mesh, self.settings, threads)?;
        let seconds = start.elapsed().as_secs_f64();
        drop(scene);
        Ok(seconds)
    }
}
