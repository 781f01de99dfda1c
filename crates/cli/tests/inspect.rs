//! `tahko inspect`, and what all commands have in common, as their users see it.

mod common;

use common::{Sandbox, two_triangles};
use serde_json::{Value, json};

#[test]
fn json_holds_the_scene_and_every_structure() {
    let sandbox = Sandbox::new();
    sandbox.write("mesh.ply", two_triangles());
    let run = sandbox
        .run("inspect mesh.ply --json --threads 1")
        .succeeds();
    let report: Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!(report["scene"], "mesh.ply");
    assert_eq!(report["triangles"], 2);
    assert_eq!(report["threads"], 1);
    assert_eq!(
        report["bounds"],
        json!({"min": [0.0, 0.0, 0.0], "max": [1.0, 1.0, 2.0]})
    );
    for (index, name) in ["brute", "bsp", "kdtree", "bvh"].into_iter().enumerate() {
        let structure = &report["structures"][index];
        assert_eq!(structure["name"], name);
        assert_eq!(structure["triangles"], 2);
        let references = structure["references_per_triangle"].as_f64();
        assert!(
            references.is_some_and(|references| references >= 1.0),
            "{structure}"
        );
        let tests = structure["expected_visits"]["triangle_tests"].as_f64();
        assert!(tests.is_some_and(|tests| tests > 0.0), "{structure}");
        let overlap = &structure["end_point_overlap"];
        assert_eq!(overlap.is_number(), name == "bvh", "{structure}");
    }
    assert_eq!(report["structures"].as_array().map(Vec::len), Some(4));
}

#[test]
fn a_table_has_a_column_for_each_structure() {
    let sandbox = Sandbox::new();
    sandbox.write("mesh.ply", two_triangles());
    let all = sandbox.run("inspect mesh.ply").succeeds().stdout;
    assert!(all.contains("triangles  2\n"), "{all}");
    let row = |table: &str, label: &str| -> Vec<String> {
        let line = table.lines().find(|line| line.starts_with(label));
        let words = line.unwrap_or_else(|| panic!("no {label} in {table}"));
        words[label.len()..]
            .split_whitespace()
            .map(str::to_owned)
            .collect()
    };
    assert_eq!(row(&all, "references/triangle").len(), 4, "{all}");
    let overlaps = row(&all, "end-point overlap");
    assert_eq!(overlaps[..3], ["-", "-", "-"], "{all}");
    assert!(overlaps[3].parse::<f64>().is_ok(), "{all}");
    assert_eq!(
        row(&all, "expected tests")[0],
        "2.00",
        "brute force tests all: {all}"
    );
    assert_eq!(
        row(&all, "nodes")[0],
        "0",
        "brute force has no nodes: {all}"
    );

    let one = sandbox
        .run("inspect mesh.ply --accel bvh")
        .succeeds()
        .stdout;
    assert_eq!(row(&one, "bytes").len(), 1, "{one}");
    assert_eq!(row(&one, "nodes")[0], row(&all, "nodes")[3]);
}

#[test]
fn wrong_usage_and_bad_files_are_told_apart() {
    let sandbox = Sandbox::new();
    sandbox.run("inspect none.stl").fails(1, &["none.stl"]);
    sandbox
        .run("inspect none.stl --accel most")
        .fails(2, &["most"]);
    sandbox.run("inspekt none.stl").fails(2, &["inspekt"]);
    assert_eq!(sandbox.run("").code, Some(2));
}

#[test]
fn help_and_version_go_to_standard_output() {
    let sandbox = Sandbox::new();
    for line in ["--help", "-h", "help render", "query --help", "inspect -h"] {
        let run = sandbox.run(line).succeeds();
        assert!(run.stdout.contains("Examples:"), "{}", run.stdout);
        assert_eq!(run.stderr, "");
    }
    let version = sandbox.run("--version").succeeds().stdout;
    assert_eq!(version, format!("tahko {}\n", env!("CARGO_PKG_VERSION")));
}
