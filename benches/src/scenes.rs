//! Which scenes are measured.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

/// Endings of files that hold scenes or meshes.
const ENDINGS: [&str; 6] = ["ron", "glb", "gltf", "obj", "ply", "stl"];

/// The scenes of a quick run: a closed room, curved surfaces in the open, and thin triangles where boxes fail.
const QUICK: [&str; 3] = ["cornell", "sphereflake", "needles"];

/// The folder of the scenes that ship with the project.
fn shipped_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).with_file_name("scenes")
}

/// The scenes that ship with the project.
pub(crate) fn shipped() -> Result<Vec<PathBuf>> {
    in_folder(&shipped_folder())
}

/// Three of them.
pub(crate) fn quick() -> Vec<PathBuf> {
    let folder = shipped_folder();
    QUICK
        .iter()
        .map(|name| folder.join(name).with_extension("ron"))
        .collect()
}

/// The files that were asked for; a folder stands for the scenes and meshes in it and in folders below.
pub(crate) fn expand(paths: &[PathBuf]) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for path in paths {
        if path.is_dir() {
            files.extend(below(path)?);
        } else {
            files.push(path.clone());
        }
    }
    Ok(files)
}

/// The name of a scene in reports: its file's, without folder and ending.
pub(crate) fn name(file: &Path) -> String {
    file.file_stem().unwrap_or_default().display().to_string()
}

fn in_folder(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut files = entries(folder)?;
    files.retain(|path| is_scene(path));
    files.sort();
    if files.is_empty() {
        bail!("{}: no scenes or meshes in this folder", folder.display());
    }
    Ok(files)
}

/// The files of a folder and those below it.
fn below(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for path in entries(&folder)? {
            if path.is_dir() {
                folders.push(path);
            } else if is_scene(&path) {
                files.push(path);
            }
        }
    }
    files.sort();
    if files.is_empty() {
        bail!("{}: no scenes or meshes in this folder", folder.display());
    }
    Ok(files)
}

fn entries(folder: &Path) -> Result<Vec<PathBuf>> {
    let name = || folder.display().to_string();
    let entries = folder.read_dir().with_context(name)?;
    entries
        .map(|entry| Ok(entry?.path()))
        .collect::<Result<_>>()
        .with_context(name)
}

fn is_scene(path: &Path) -> bool {
    let ending = path.extension().map(std::ffi::OsStr::to_ascii_lowercase);
    let is_known = |ending: std::ffi::OsString| ENDINGS.iter().any(|known| ending == *known);
    path.is_file() && ending.is_some_and(is_known)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shipped_scenes_are_found_and_the_quick_ones_are_among_them() {
        let shipped: Vec<String> = shipped().unwrap().iter().map(|file| name(file)).collect();
        assert!(shipped.len() >= 12 && shipped.is_sorted(), "{shipped:?}");
        for file in quick() {
            assert!(
                file.is_file() && shipped.contains(&name(&file)),
                "{}",
                file.display()
            );
        }
    }

    #[test]
    fn a_folder_stands_for_its_scenes_and_an_empty_one_is_an_error() {
        let folder = shipped_folder();
        let file = folder.join("README.md");
        let bench = folder.join("bench");
        let expanded = expand(&[folder.clone(), file.clone()]).unwrap();
        let large = in_folder(&bench).unwrap();
        assert!(
            large.iter().all(|file| expanded.contains(file)),
            "also what is below"
        );
        assert_eq!(
            expanded.len(),
            shipped().unwrap().len() + large.len() + 1,
            "a named file is taken as it is"
        );
        let error = expand(&[folder.join("golden")]).unwrap_err().to_string();
        assert!(
            error.ends_with("no scenes or meshes in this folder"),
            "{error}"
        );
    }
}
