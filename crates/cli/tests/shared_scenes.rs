//! Renders the files collected in `shared/scenes`, beside the repository, where that folder exists: valid ones
//! become a picture or lack a feature, broken ones are refused, and nothing panics or hangs.
#![expect(clippy::print_stdout, reason = "tests say what they skip")]

mod common;

use std::path::{Path, PathBuf};
use std::process::Stdio;

use common::{Run, Sandbox, files_below, wait};

const EXTENSIONS: [&str; 5] = ["gltf", "glb", "obj", "ply", "stl"];

/// Larger files take too long without optimisation.
const MAX_BYTES: u64 = 1 << 20;

/// Files in folders of valid files that cannot be rendered all the same, and why.
const BROKEN: [(&str, &str); 2] = [
    ("ply/unknown-element.ply", "the header has no end"),
    (
        "stress/Cray_right.obj",
        "no camera position in f32 frames the largest f32",
    ),
];

/// Files in folders of broken files that are legal, and why.
const LEGAL: [(&str, &str); 21] = [
    (
        "assimp/empty_mat.obj",
        "only its material library is missing",
    ),
    (
        "assimp/regr_3429812.obj",
        "only its material library is missing",
    ),
    (
        "assimp/triangle_with_empty_solid.stl",
        "a solid may be empty",
    ),
    ("magnum-ply/colors-not-all.ply", "colours are not read"),
    (
        "magnum-ply/colors-not-tightly-packed.ply",
        "properties may have any order",
    ),
    (
        "magnum-ply/colors4-not-same-type.ply",
        "properties may have any type",
    ),
    (
        "magnum-ply/custom-components-duplicate.ply",
        "the equal names are of properties not read",
    ),
    (
        "magnum-ply/normals-not-tightly-packed.ply",
        "properties may have any order",
    ),
    (
        "magnum-ply/objectid-unsupported-type.ply",
        "other properties may have any type",
    ),
    (
        "magnum-ply/positions-not-tightly-packed.ply",
        "properties may have any order",
    ),
    (
        "magnum-ply/texcoords-not-all.ply",
        "texture coordinates are not read",
    ),
    (
        "magnum-ply/texcoords-not-tightly-packed.ply",
        "properties may have any order",
    ),
    (
        "tinyobjloader/issue-161-inconsistent-f.obj",
        "each face for itself is consistent",
    ),
    (
        "tinyobjloader/issue-319-002.obj",
        "polygons may be concave or degenerate",
    ),
    (
        "tinyobjloader/issue-330.obj",
        "polygons may be concave or degenerate",
    ),
    (
        "tinyobjloader/missing_material_file.obj",
        "materials may be undefined",
    ),
    ("trimesh/empty.stl", "a solid may be empty"),
    ("trimesh/nancolor.obj", "colours are not read"),
    (
        "trimesh/obj_with_no_face_in_chunk.obj",
        "groups may be empty",
    ),
    ("trimesh/points_emptyface.ply", "points need no faces"),
    (
        "trimesh/singlevn.obj",
        "only its material library is missing",
    ),
];

/// Renders each file of some folders and lists those whose outcome `judge` does not accept.
fn render_all(folders: &[&str], judge: impl Fn(&str, &Run) -> bool) {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/scenes");
    let Ok(scenes) = scenes.canonicalize() else {
        println!("skipped: there is no folder {}", scenes.display());
        return;
    };
    let mut failures = Vec::new();
    for folder in folders {
        let files = files_below(&scenes.join(folder), &EXTENSIONS);
        assert!(!files.is_empty(), "there are no files in {folder}");
        for path in files {
            if path
                .metadata()
                .is_ok_and(|metadata| metadata.len() > MAX_BYTES)
            {
                continue;
            }
            let run = render(&path);
            let name = path.strip_prefix(&scenes).unwrap_or(&path);
            let name = name.display().to_string();
            if !judge(&name, &run) {
                failures.push(format!("{name}: {:?} {}", run.code, run.stderr.trim_end()));
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Renders a file; whether that succeeds or fails, it must do so properly.
#[expect(clippy::unwrap_used, reason = "a part of tests")]
fn render(path: &PathBuf) -> Run {
    let sandbox = Sandbox::new();
    let mut child = sandbox
        .command("render -o a.png --width 40 --height 30")
        .arg(path)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    if !wait::comes_true(|| child.try_wait().unwrap().is_some()) {
        child.kill().unwrap();
        panic!("{} takes too long", path.display());
    }
    let run = Run::from(child.wait_with_output().unwrap());
    if run.code == Some(0) {
        assert_eq!(sandbox.files(), ["a.png"], "{}", path.display());
        run.succeeds()
    } else {
        assert!(sandbox.files().is_empty(), "{}", path.display());
        let name = path.file_name().unwrap().to_str().unwrap();
        run.fails(1, &[name])
    }
}

fn is_one_of(list: &[(&str, &str)], name: &str) -> bool {
    list.iter().any(|(ending, _)| name.ends_with(ending))
}

/// Whether a valid file was rendered or lacks a feature.
fn is_valid(name: &str, run: &Run) -> bool {
    let refused = run.code == Some(1);
    if is_one_of(&BROKEN, name) {
        return refused;
    }
    !refused || run.stderr.contains("not supported")
}

/// Whether a broken file was refused.
fn is_broken(name: &str, run: &Run) -> bool {
    is_one_of(&LEGAL, name) == (run.code == Some(0))
}

#[test]
fn valid_gltf_files_render_or_lack_a_feature() {
    render_all(&["gltf"], is_valid);
}

#[test]
fn valid_meshes_render_or_lack_a_feature() {
    let meshes = [
        "cad",
        "exteriors",
        "interiors",
        "mesh-variants",
        "models",
        "quake",
        "scans",
        "stress",
        "terrain",
    ];
    render_all(&meshes, is_valid);
}

#[test]
fn broken_gltf_files_are_refused() {
    render_all(&["gltf-invalid"], is_broken);
}

#[test]
fn broken_meshes_are_refused() {
    render_all(&["mesh-invalid"], is_broken);
}
