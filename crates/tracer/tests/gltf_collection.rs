//! Loads the glTF files collected in `shared/scenes`, beside the repository, where that folder exists.
#![expect(
    clippy::print_stdout,
    reason = "tests say what they skip and what is refused"
)]

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use tahko_tracer::load::{LoadError, LoadReport, load_scene};
use tahko_tracer::scene::Scene;

/// Valid files with their number of triangles, from the table in the collection's README.
const TRIANGLES: [(&str, usize); 31] = [
    ("gltf/2CylinderEngine.glb", 121_496),
    ("gltf/Box.gltf", 12),
    ("gltf/BoxInterleaved.glb", 12),
    ("gltf/BoxTextured.gltf", 12),
    ("gltf/Cameras.gltf", 2),
    ("gltf/CesiumMilkTruck.glb", 3_624),
    ("gltf/CornellBox.glb", 36),
    ("gltf/Cubes.glb", 36),
    ("gltf/Duck.glb", 4_212),
    ("gltf/Fox.gltf", 576),
    ("gltf/MeshPrimitiveModes.gltf", 16),
    ("gltf/ShapeCollection.glb", 3_542),
    ("gltf/SimpleSparseAccessor.gltf", 12),
    ("gltf/TextureSettingsTest.gltf", 72),
    ("gltf/TriangleWithoutIndices.gltf", 1),
    ("gltf/UnlitTest.gltf", 88),
    ("gltf/balloon/scene.gltf", 35_698),
    ("gltf/box_sparse.gltf", 12),
    ("gltf/meshopt-fallback.gltf", 60),
    ("gltf/mountains/Mountains.gltf", 25_600),
    ("gltf/nested.glb", 36),
    ("gltf/palm-tree/PalmTree.gltf", 10_124),
    ("gltf/simple_pole.glb", 580),
    ("gltf/small-pine/scene.gltf", 1_650),
    ("gltf/sphere_lights.gltf", 224),
    ("gltf/transform_matrices.gltf", 0),
    ("gltf/unicode/Unicode ❤♻ Test.gltf", 2),
    ("gltf/uri-spaces/CubeImageUriSpaces.gltf", 12),
    ("gltf/zero-sized-bin-chunk-issue-440.glb", 1),
    ("interiors/coffee-maker.glb", 235_271),
    ("interiors/country-kitchen.glb", 1_443_517),
];

/// A path in the collection; `None`, with a message, if there is no collection.
fn collected(path: &str) -> Option<PathBuf> {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/scenes");
    if !scenes.is_dir() {
        println!("skipped: there is no folder {}", scenes.display());
        return None;
    }
    Some(scenes.join(path))
}

/// All glTF files below a folder, sorted.
fn gltf_files(folder: PathBuf) -> Vec<PathBuf> {
    let mut files = Vec::new();
    let mut folders = vec![folder];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).expect("the folder exists") {
            let path = entry.expect("the folder can be read").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "gltf" || e == "glb") {
                files.push(path);
            }
        }
    }
    files.sort();
    files
}

/// Loads a file; a panic is a failure of the test that names the file.
fn load(path: &Path) -> Result<(Scene, LoadReport), LoadError> {
    catch_unwind(AssertUnwindSafe(|| load_scene(path)))
        .unwrap_or_else(|_| panic!("{} made the loader panic", path.display()))
}

#[test]
fn main_files_have_their_triangles() {
    for (file, expected) in TRIANGLES {
        let Some(path) = collected(file) else {
            return;
        };
        let (scene, _) = load(&path).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(scene.mesh().len(), expected, "{file}");
    }
}

#[test]
fn valid_files_load_or_lack_a_named_feature() {
    let Some(folder) = collected("gltf") else {
        return;
    };
    let files = gltf_files(folder);
    assert!(!files.is_empty(), "the collection has valid files");
    for path in files {
        match load(&path) {
            Ok(_) => {}
            Err(error @ LoadError::Unsupported { .. }) => println!("{error}"),
            Err(error) => panic!("{error}"),
        }
    }
}

#[test]
fn malformed_files_are_refused() {
    let Some(folder) = collected("gltf-invalid") else {
        return;
    };
    let files = gltf_files(folder);
    assert!(!files.is_empty(), "the collection has malformed files");
    let accepted: Vec<PathBuf> = files
        .into_iter()
        .filter(|path| load(path).is_ok())
        .collect();
    assert_eq!(accepted, [""; 0].map(PathBuf::from));
}
