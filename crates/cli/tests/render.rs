//! `tahko render`, as its users see it.

mod common;

use common::{Sandbox, hills};
use serde_json::Value;

const STRUCTURES: [&str; 4] = ["brute", "bsp", "kdtree", "bvh"];

#[test]
fn all_structures_and_thread_counts_write_the_same_picture() {
    let sandbox = Sandbox::new();
    sandbox.write("hills.ply", hills(12));
    let mut pictures = Vec::new();
    for structure in STRUCTURES {
        for threads in [1, 2] {
            let options = format!("--accel {structure} --threads {threads} --spp 2 --seed 7");
            let run = sandbox
                .run(&format!(
                    "render hills.ply -o a.png --width 50 --height 40 {options}"
                ))
                .succeeds();
            assert_eq!(run.stdout, "");
            assert!(run.stderr.contains("288 triangles"), "{}", run.stderr);
            pictures.push(sandbox.read("a.png"));
        }
    }
    assert!(pictures[0].starts_with(b"\x89PNG"), "not a PNG");
    assert!(
        pictures.windows(2).all(|pair| pair[0] == pair[1]),
        "all equal"
    );
    assert_eq!(sandbox.files(), ["a.png", "hills.ply"]);
}

#[test]
fn quiet_prints_nothing_and_exr_is_written_in_upper_case_too() {
    let sandbox = Sandbox::new();
    sandbox.write("hills.ply", hills(2));
    let run = sandbox
        .run("render hills.ply -o a.EXR --width 8 --height 8 -q")
        .succeeds();
    assert_eq!((run.stdout, run.stderr), (String::new(), String::new()));
    assert!(
        sandbox.read("a.EXR").starts_with(b"\x76\x2f\x31\x01"),
        "EXR"
    );
}

#[test]
fn statistics_have_their_keys() {
    let sandbox = Sandbox::new();
    sandbox.write("hills.ply", hills(8));
    let line =
        "render hills.ply -o a.png --width 20 --height 10 --spp 3 --threads 2 --stats a.json";
    sandbox.run(line).succeeds();
    let stats: Value = serde_json::from_str(&sandbox.read_text("a.json")).unwrap();
    for (key, value) in [
        ("/scene", "hills.ply".into()),
        ("/output", "a.png".into()),
        ("/width", 20.into()),
        ("/height", 10.into()),
        ("/samples_per_pixel", 3.into()),
        ("/seed", 0.into()),
        ("/integrator", "whitted".into()),
        ("/max_depth", 8.into()),
        ("/precision", "exact".into()),
        ("/threads", 2.into()),
        ("/structure/name", "bvh".into()),
        ("/structure/triangles", 128.into()),
        ("/rays/camera", 600.into()),
    ] {
        assert_eq!(stats.pointer(key), Some(&value), "{key} in {stats}");
    }
    for key in [
        "/structure/build_seconds",
        "/structure/nodes",
        "/structure/leaves",
        "/structure/depth",
        "/structure/references_per_triangle",
        "/structure/bytes",
        "/structure/sah_cost",
        "/render_seconds",
        "/rays/shadow",
        "/rays/total",
        "/per_ray/node_visits",
        "/per_ray/bound_tests",
        "/per_ray/triangle_tests",
    ] {
        let value = stats.pointer(key).and_then(Value::as_f64);
        assert!(value.is_some_and(|value| value > 0.0), "{key} in {stats}");
    }
}

#[test]
fn counting_does_not_change_the_picture() {
    let sandbox = Sandbox::new();
    sandbox.write("hills.ply", hills(8));
    let line = "render hills.ply --width 30 --height 30 -o";
    sandbox.run(&format!("{line} a.png")).succeeds();
    sandbox
        .run(&format!("{line} b.png --stats b.json"))
        .succeeds();
    assert!(sandbox.read("a.png") == sandbox.read("b.png"), "differ");
}

#[test]
fn bad_input_is_named_and_leaves_the_old_picture() {
    let sandbox = Sandbox::new();
    sandbox.write("good.ply", hills(2));
    sandbox.write(
        "bad.ply",
        "ply\nformat ascii 1.0\nelement vertex many\nend_header\n",
    );
    let truncated = hills(2);
    sandbox.write("short.ply", &truncated[..truncated.len() - 20]);
    sandbox.write("notes.txt", "not a scene");
    sandbox.write("empty.obj", "f 1 2 3\n");
    sandbox.write("old.png", "old");
    std::fs::create_dir(sandbox.path("folder.png")).unwrap();
    let files = sandbox.files();
    for (arguments, code, parts) in [
        ("none.ply -o old.png", 1, vec!["none.ply", "No such file"]),
        (
            "notes.txt -o old.png",
            1,
            vec!["notes.txt", "not supported"],
        ),
        ("bad.ply -o old.png", 1, vec!["bad.ply"]),
        ("short.ply -o old.png", 1, vec!["short.ply"]),
        ("empty.obj -o old.png", 1, vec!["empty.obj"]),
        (
            "good.ply -o none/a.png",
            1,
            vec!["none/a.png", "there is no folder 'none'"],
        ),
        (
            "good.ply -o folder.png",
            1,
            vec!["folder.png", "not a regular file"],
        ),
        (
            "good.ply -o old.png --stats old.png",
            1,
            vec!["old.png", "two purposes"],
        ),
        (
            "good.ply -o old.png --stats ./good.ply",
            1,
            vec!["good.ply", "two purposes"],
        ),
        (
            "good.ply -o old.png --stats none/a.json",
            1,
            vec!["none/a.json"],
        ),
        ("good.ply -o old.jpg", 2, vec!["old.jpg", ".png or .exr"]),
        ("good.ply -o old.png --width 0", 2, vec!["--width", "'0'"]),
        (
            "good.ply -o old.png --height 20000",
            2,
            vec!["--height", "16384"],
        ),
        (
            "good.ply -o old.png --accel octree",
            2,
            vec!["octree", "kdtree"],
        ),
        ("good.ply -o old.png --threads 0", 2, vec!["--threads"]),
        ("good.ply", 2, vec!["--output"]),
    ] {
        sandbox
            .run(&format!("render {arguments}"))
            .fails(code, &parts);
        assert_eq!(sandbox.files(), files, "after {arguments}");
        assert_eq!(sandbox.read("old.png"), b"old", "after {arguments}");
    }
}

#[test]
fn names_from_files_cannot_write_control_characters() {
    let sandbox = Sandbox::new();
    sandbox
        .run("render \u{1b}[2J.ply -o a.png")
        .fails(1, &["\\u{1b}[2J.ply"]);
}

#[cfg(unix)]
#[test]
fn a_folder_without_permission_is_reported_before_the_work() {
    use std::os::unix::fs::PermissionsExt;
    let sandbox = Sandbox::new();
    let folder = sandbox.path("locked");
    std::fs::create_dir(&folder).unwrap();
    std::fs::set_permissions(&folder, std::fs::Permissions::from_mode(0o555)).unwrap();
    if std::fs::write(folder.join("probe"), "").is_ok() {
        return; // The user may write everywhere.
    }
    let run = sandbox.run("render none.ply -o locked/a.png");
    run.fails(1, &["locked/a.png", "cannot be written"]);
}
