//! Which scenes there are, and which golden image belongs to which.

/// The folder of the scenes; the golden images lie in a folder of it.
const FOLDER: &str = "scenes/";
const GOLDEN_FOLDER: &str = "scenes/golden/";
const ENDINGS: [&str; 3] = [".ron", ".glb", ".gltf"];

/// A file that is rendered. Files are relative to the workspace, with forward slashes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Scene {
    pub(crate) name: String,
    pub(crate) file: String,
    pub(crate) has_golden: bool,
}

/// Scenes and golden images side by side.
#[derive(Debug, Default)]
pub(crate) struct Pairing {
    /// Sorted by name.
    pub(crate) scenes: Vec<Scene>,
    /// Golden images without a scene.
    pub(crate) stray_goldens: Vec<String>,
    /// Scene files left out because another one has the same name.
    pub(crate) ambiguous: Vec<String>,
}

impl Scene {
    /// The file of the golden image, whether it exists or not.
    pub(crate) fn golden(&self) -> String {
        format!("{GOLDEN_FOLDER}{}.png", self.name)
    }
}

/// Finds the scenes among the files of the workspace.
pub(crate) fn pair(files: &[String]) -> Pairing {
    let mut pairing = Pairing::default();
    let mut files: Vec<&String> = files.iter().collect();
    files.sort();
    for file in &files {
        let Some(name) = scene_name(file) else {
            continue;
        };
        if pairing.scenes.iter().any(|scene| scene.name == name) {
            pairing.ambiguous.push((*file).clone());
            continue;
        }
        let mut scene = Scene {
            name: name.to_owned(),
            file: (*file).clone(),
            has_golden: false,
        };
        scene.has_golden = files.contains(&&scene.golden());
        pairing.scenes.push(scene);
    }
    let is_stray = |file: &&&String| {
        let is_golden = file.starts_with(GOLDEN_FOLDER);
        let mut scenes = pairing.scenes.iter();
        is_golden && !scenes.any(|scene| scene.golden() == ***file)
    };
    pairing.stray_goldens = files
        .iter()
        .filter(is_stray)
        .map(|file| (*file).clone())
        .collect();
    pairing
}

fn scene_name(file: &str) -> Option<&str> {
    let name = file.strip_prefix(FOLDER)?;
    let name = ENDINGS
        .iter()
        .find_map(|ending| name.strip_suffix(ending))?;
    (!name.contains('/')).then_some(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pairing(files: &[&str]) -> Pairing {
        let files: Vec<String> = files.iter().map(|file| (*file).to_owned()).collect();
        pair(&files)
    }

    #[test]
    fn scenes_are_files_of_the_folder_itself() {
        let found = pairing(&[
            "scenes/b.glb",
            "scenes/a.ron",
            "scenes/meshes/c.glb",
            "scenes/bench/e.ron",
            "scenes/README.md",
            "other/d.ron",
        ]);
        let names: Vec<&str> = found
            .scenes
            .iter()
            .map(|scene| scene.name.as_str())
            .collect();
        assert_eq!(names, ["a", "b"]);
    }

    #[test]
    fn golden_images_and_scenes_find_each_other() {
        let found = pairing(&["scenes/a.ron", "scenes/golden/a.png", "scenes/b.gltf"]);
        let has_golden: Vec<bool> = found.scenes.iter().map(|scene| scene.has_golden).collect();
        assert_eq!(has_golden, [true, false]);
        assert!(found.stray_goldens.is_empty(), "{found:?}");
    }

    #[test]
    fn a_golden_image_without_a_scene_is_stray() {
        let found = pairing(&["scenes/golden/a.png"]);
        assert_eq!(found.stray_goldens, ["scenes/golden/a.png"]);
    }

    #[test]
    fn two_scenes_of_one_name_are_ambiguous() {
        let found = pairing(&["scenes/a.ron", "scenes/a.glb"]);
        assert_eq!(found.ambiguous, ["scenes/a.ron"]);
    }
}
