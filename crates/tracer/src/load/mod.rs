//! Reads scenes from files: RON, glTF and GLB, OBJ with MTL, PLY, STL.

mod gltf;
mod obj;
mod ply;
mod polygon;
mod ron;
mod stl;
#[cfg(test)]
mod test_files;
mod text;

use std::io;
use std::path::{Path, PathBuf};

use tahko_geometry::{Transform, TriangleMesh};
use thiserror::Error;

use crate::scene::{Material, MaterialId, MeshPart, Scene, SceneBuilder, SceneError};

/// The file types that can be read, by file name extension.
pub const EXTENSIONS: [&str; 6] = ["ron", "gltf", "glb", "obj", "ply", "stl"];

/// Reads a scene. What the file does not give (camera, lights) gets a default.
///
/// # Errors
/// If the file cannot be read, is malformed, or needs something that is not supported.
pub fn load_scene(path: &Path) -> Result<(Scene, LoadReport), LoadError> {
    let (builder, report) = load(path)?;
    let scene = builder
        .finish()
        .map_err(|source| LoadError::scene(path, source))?;
    Ok((scene, report))
}

/// Reads the triangles of a scene, in the order of the file.
///
/// # Errors
/// As [`load_scene`], except that no camera is needed.
pub fn load_mesh(path: &Path) -> Result<(TriangleMesh, LoadReport), LoadError> {
    let (builder, report) = load(path)?;
    let mesh = builder
        .finish_mesh()
        .map_err(|source| LoadError::scene(path, source))?;
    Ok((mesh, report))
}

fn load(path: &Path) -> Result<(SceneBuilder, LoadReport), LoadError> {
    let mut import = Import::default();
    import.file(path)?;
    Ok((import.builder, import.report))
}

/// Where the contents of a file go: the scene under construction, and how they are placed in it.
#[derive(Debug, Default)]
pub(crate) struct Import {
    pub(crate) builder: SceneBuilder,
    pub(crate) report: LoadReport,
    /// From the coordinates of the file to the world.
    pub(crate) placement: Transform,
    /// Takes the place of the materials of the file, which then need not be read.
    pub(crate) material: Option<MaterialId>,
}

impl Import {
    /// Reads a file of any supported type into the scene.
    pub(crate) fn file(&mut self, path: &Path) -> Result<(), LoadError> {
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        match extension.to_str() {
            Some("gltf" | "glb") => gltf::read(path, self),
            Some("ron") => ron::read(path, self),
            Some("obj") => obj::read(path, self),
            Some("ply") => ply::read(path, self),
            Some("stl") => stl::read(path, self),
            _ => Err(LoadError::unsupported(
                path,
                format!("the file type (one of {} is needed)", EXTENSIONS.join(", ")),
            )),
        }
    }

    /// Adds a part that is given in coordinates from which `to_file` leads to those of the file.
    ///
    /// # Errors
    /// If the part is not a valid mesh.
    pub(crate) fn add_part(
        &mut self,
        path: &Path,
        part: MeshPart,
        material: MaterialId,
        to_file: &Transform,
    ) -> Result<(), LoadError> {
        let material = self.material.unwrap_or(material);
        self.builder
            .add_part(part, material, &to_file.then(&self.placement))
            .map_err(|source| LoadError::scene(path, source))
    }

    /// The material for files that have none: the one that was asked for, or a new default material.
    pub(crate) fn material_or_default(&mut self) -> MaterialId {
        match self.material {
            Some(material) => material,
            None => self.builder.add_material(Material::default()),
        }
    }

    /// Notes what was left out of a file or assumed about it.
    pub(crate) fn note(&mut self, path: &Path, note: &str) {
        self.report.note(format!("{}: {note}", path.display()));
    }
}

/// What a loader left out or made up, for the user to know.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoadReport {
    notes: Vec<String>,
}

impl LoadReport {
    /// Adds a note: what was skipped or assumed, where, and why. A note that is already there is not repeated.
    pub fn note(&mut self, note: impl Into<String>) {
        let note = note.into();
        if !self.notes.contains(&note) {
            self.notes.push(note);
        }
    }

    /// The notes in the order in which they came up.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        &self.notes
    }
}

/// Why a file cannot be loaded.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum LoadError {
    /// The file cannot be read.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The file breaks the rules of its format.
    #[error("{}: {place}: {reason}", path.display())]
    Invalid {
        /// The file.
        path: PathBuf,
        /// Where in the file: a line and column, or the name or number of an element.
        place: String,
        /// What is wrong.
        reason: String,
    },
    /// The file needs something that is not supported.
    #[error("{}: {feature} is not supported", path.display())]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// What is needed.
        feature: String,
    },
    /// The file's contents do not make a scene.
    #[error("{}: {source}", path.display())]
    Scene {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: SceneError,
    },
}

impl LoadError {
    pub(crate) fn io(path: &Path, source: io::Error) -> Self {
        Self::Io {
            path: path.to_owned(),
            source,
        }
    }

    #[expect(
        clippy::needless_pass_by_value,
        reason = "errors are passed on as they come"
    )]
    pub(crate) fn invalid(path: &Path, place: impl Into<String>, reason: impl ToString) -> Self {
        Self::Invalid {
            path: path.to_owned(),
            place: place.into(),
            reason: reason.to_string(),
        }
    }

    pub(crate) fn unsupported(path: &Path, feature: impl Into<String>) -> Self {
        Self::Unsupported {
            path: path.to_owned(),
            feature: feature.into(),
        }
    }

    pub(crate) fn scene(path: &Path, source: SceneError) -> Self {
        Self::Scene {
            path: path.to_owned(),
            source,
        }
    }
}
