//! Runs the whole program on tiny input: the figures must be there, and the exact precision without errors. No figure is a time.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

/// Runs the program with the arguments and a folder for its reports.
fn bench(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_tahko-bench"))
        .args(["--smoke", "--out"])
        .arg(folder)
        .args(arguments)
        .output()
        .expect("the program starts")
}

fn report(folder: &Path) -> Value {
    let text = fs::read_to_string(folder.join("report.json")).expect("a report");
    serde_json::from_str(&text).expect("JSON")
}

fn list<'a>(value: &'a Value, key: &str) -> &'a Vec<Value> {
    value[key]
        .as_array()
        .unwrap_or_else(|| panic!("no list {key} in {value}"))
}

fn scene(name: &str) -> String {
    format!("{}/../scenes/{name}.ron", env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn every_structure_precision_and_class_has_speed_and_errors_and_exact_has_none() {
    let folder = tempfile::tempdir().unwrap();
    let needles = scene("needles");
    let output = bench(folder.path(), &["--scene", &needles, "--sections", "speed"]);
    let messages = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{messages}");

    let report = report(folder.path());
    let scenes = list(&report, "scenes");
    assert_eq!(scenes.len(), 1);
    assert_eq!(
        list(&scenes[0], "builds").len(),
        4,
        "one for each structure"
    );
    for build in list(&scenes[0], "builds") {
        assert!(
            build["seconds"]["median"].as_f64().unwrap() > 0.0,
            "{build}"
        );
        assert!(
            build["bytes_per_triangle"].as_f64().unwrap() > 0.0,
            "{build}"
        );
    }
    let traces = list(&scenes[0], "traces");
    let single = traces.iter().filter(|row| row["threads"] == 1);
    assert_eq!(single.count(), 4 * 3 * 6, "structures, precisions, classes");
    for row in traces {
        assert!(row["rate"]["median"].as_f64().unwrap() > 0.0, "{row}");
        assert!(
            row["work"]["triangle_tests"].as_f64().unwrap() >= 0.0,
            "{row}"
        );
        assert!(row["errors"]["audited"].as_u64().unwrap() > 0, "{row}");
        if row["contender"]["precision"] == "exact" {
            for kind in ["false_hits", "false_misses", "wrong_triangles", "far_off"] {
                assert_eq!(row["errors"][kind], 0, "{row}");
            }
        }
    }

    let page = fs::read_to_string(folder.path().join("report.md")).unwrap();
    let printed = String::from_utf8(output.stdout).unwrap();
    assert_eq!(
        page.trim_end(),
        printed.trim_end(),
        "the terminal shows the same"
    );
    assert!(page.contains("## needles, 2000 triangles"), "{page}");
    assert!(page.contains("## What exactness costs"), "{page}");
}

#[test]
fn a_baseline_is_compared_with_and_other_errors_are_marked() {
    let folder = tempfile::tempdir().unwrap();
    let needles = scene("needles");
    let arguments = [
        "--scene",
        &needles,
        "--sections",
        "speed",
        "--structures",
        "bvh",
        "--classes",
        "random",
    ];
    assert!(bench(folder.path(), &arguments).status.success());

    // The baseline has another work and other errors than this run will have.
    let mut before = report(folder.path());
    let row = &mut before["scenes"][0]["traces"][0];
    row["errors"]["false_misses"] = 3.into();
    row["work"]["node_visits"] = 1.0.into();
    let baseline = folder.path().join("before.json");
    fs::write(&baseline, before.to_string()).unwrap();

    let file = baseline.display().to_string();
    let output = bench(
        folder.path(),
        &[&arguments[..], &["--baseline", &file]].concat(),
    );
    let printed = String::from_utf8(output.stdout).unwrap();
    assert!(
        printed.contains("## Compared with the baseline"),
        "{printed}"
    );
    assert!(printed.contains("DIFFER"), "{printed}");
}

#[test]
fn a_wrong_baseline_or_scene_is_refused_before_the_work_with_exit_code_2() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, message) in [
        (
            ["--baseline", "no-such-file.json"],
            "cannot read the baseline no-such-file.json",
        ),
        (["--scene", "no-such-file.ply"], "no-such-file.ply"),
    ] {
        let output = bench(folder.path(), &arguments);
        let messages = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{messages}");
        assert!(messages.contains(message), "{messages}");
        assert!(
            !folder.path().join("report.json").exists(),
            "nothing was measured"
        );
    }
}
