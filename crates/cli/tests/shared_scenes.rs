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

/// Whether a file was refused.
fn is_refused(_name: &str, run: &Run) -> bool {
    run.code == Some(1)
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
    render_all(&["gltf-invalid"], is_refused);
}

/// About half of these files are legal by the rules of their format. Which ones, and why, is tested where they are read.
#[test]
fn awkward_meshes_render_or_are_refused_properly() {
    render_all(&["mesh-invalid"], |_, _| true);
}
