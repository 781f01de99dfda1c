//! Small files for the tests of the readers.

use std::fs;

use tahko_geometry::TriangleMesh;
use tempfile::TempDir;

use super::{LoadError, LoadReport, load_mesh, load_scene};
use crate::scene::Scene;

fn folder(files: &[(&str, &[u8])]) -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    for (name, contents) in files {
        fs::write(folder.path().join(name), contents).expect("the folder can be written to");
    }
    folder
}

/// Loads the triangles of the first of several files in one folder.
pub(super) fn mesh(files: &[(&str, &[u8])]) -> Result<(TriangleMesh, LoadReport), LoadError> {
    let folder = folder(files);
    load_mesh(&folder.path().join(files[0].0))
}

/// Loads the first of several files in one folder.
pub(super) fn scene(files: &[(&str, &[u8])]) -> Result<(Scene, LoadReport), LoadError> {
    let folder = folder(files);
    load_scene(&folder.path().join(files[0].0))
}

/// Why a file is refused, without its path.
pub(super) fn refusal(name: &str, contents: &[u8]) -> String {
    let error = mesh(&[(name, contents)]).expect_err("the file should be refused");
    let message = error.to_string();
    let (_, reason) = message
        .split_once(&format!("{name}: "))
        .expect("messages name the file");
    reason.to_owned()
}
