//! `tahko verify`, as its users see it.

mod common;

use common::{Sandbox, hills, ply, two_triangles};
use serde_json::Value;

const STRUCTURES: [&str; 4] = ["brute", "bsp", "kdtree", "bvh"];

#[expect(clippy::unwrap_used, reason = "a part of tests")]
fn json(sandbox: &Sandbox, arguments: &str) -> Value {
    let run = sandbox
        .run(&format!("verify {arguments} --json"))
        .succeeds();
    serde_json::from_str(&run.stdout).unwrap()
}

/// The counts of a mistake by all structures at a precision.
#[expect(clippy::unwrap_used, reason = "a part of tests")]
fn counts(report: &Value, precision: &str, mistake: &str) -> Vec<u64> {
    let runs = report["runs"].as_array().unwrap().iter();
    runs.filter(|run| run["precision"] == precision)
        .map(|run| run["all"][mistake].as_u64().unwrap())
        .collect()
}

#[test]
fn fast_errs_on_a_closed_scene_and_exact_does_not() {
    let sandbox = Sandbox::new();
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/rings.ron");
    let report = json(&sandbox, &format!("{scene} --rays 3000"));
    assert_eq!(report["rays"], 3000);
    assert_eq!(report["exact_is_exact"], true);
    let names = report["runs"]
        .as_array()
        .unwrap()
        .iter()
        .map(|run| run["structure"].as_str());
    let names: Vec<&str> = names.map(Option::unwrap).collect();
    assert_eq!(names, STRUCTURES.map(|name| [name; 3]).concat());

    let misses = counts(&report, "fast", "false_misses");
    assert!(misses.iter().all(|count| *count > 0), "{misses:?}");
    for mistake in [
        "false_hits",
        "false_misses",
        "wrong_triangles",
        "inexact_t",
        "inexact_weights",
        "wrong_any_hits",
        "batch_differences",
        "wrong_crossings",
    ] {
        assert_eq!(counts(&report, "exact", mistake), [0; 4], "{mistake}");
    }
    for run in report["runs"].as_array().unwrap() {
        let kinds = run["kinds"].as_object().unwrap();
        assert_eq!(kinds.len(), 5, "{run}");
        let rays: u64 = kinds
            .values()
            .map(|kind| kind["rays"].as_u64().unwrap())
            .sum();
        assert_eq!(run["all"]["rays"], rays);
        assert_eq!(
            run["all"]["wrong_crossings"].is_null(),
            run["precision"] != "exact"
        );
    }
}

#[test]
fn a_ray_that_shows_a_mistake_can_be_queried() {
    let sandbox = Sandbox::new();
    sandbox.write("hills.ply", hills(12));
    let report = json(&sandbox, "hills.ply --rays 2000");
    let header = "ox,oy,oz,dx,dy,dz,tmin,tmax\n";
    for run in report["runs"].as_array().unwrap() {
        let (structure, precision) = (&run["structure"], run["precision"].as_str().unwrap());
        let example = &run["example"];
        assert_eq!(
            example.is_null(),
            precision == "exact",
            "{structure} {precision}"
        );
        if example.is_null() {
            continue;
        }
        sandbox.write(
            "ray.csv",
            format!("{header}{}\n", example["ray"].as_str().unwrap()),
        );
        let structure = structure.as_str().unwrap();
        for (precision, expected) in [(precision, &example["given"]), ("exact", &example["exact"])]
        {
            let options = format!("--accel {structure} --precision {precision}");
            let line = format!("query hills.ply --rays ray.csv --out - {options}");
            let hits = sandbox.run(&line).succeeds().stdout;
            let fields: Vec<&str> = hits.lines().nth(1).unwrap().split(',').collect();
            assert_eq!(fields[1] == "1", !expected.is_null(), "{hits} {example}");
            if !expected.is_null() {
                assert_eq!(
                    fields[3],
                    expected["triangle"].to_string(),
                    "{hits} {example}"
                );
            }
        }
    }
}

#[test]
fn the_same_seed_gives_the_same_report_for_every_number_of_threads() {
    let sandbox = Sandbox::new();
    sandbox.write("hills.ply", hills(6));
    let report = json(&sandbox, "hills.ply --rays 1000 --threads 1");
    assert_eq!(json(&sandbox, "hills.ply --rays 1000 --threads 2"), report);
    assert_eq!(json(&sandbox, "hills.ply --rays 1000 --seed 1"), report);
    assert_ne!(
        json(&sandbox, "hills.ply --rays 1000 --seed 2")["runs"],
        report["runs"]
    );
}

#[test]
fn a_table_shows_every_precision_and_kind_of_ray() {
    let sandbox = Sandbox::new();
    sandbox.write("mesh.ply", two_triangles());
    let table = sandbox.run("verify mesh.ply --rays 500").succeeds().stdout;
    assert!(
        table.contains("triangles  2\nrays       500 (seed 1)\n"),
        "{table}"
    );
    for precision in ["fast", "watertight", "exact"] {
        for rays in [
            "all",
            "random",
            "edge",
            "vertex",
            "grazing",
            "axis-parallel",
        ] {
            let is_row = |line: &str| {
                let words: Vec<&str> = line.split_whitespace().take(2).collect();
                words == [precision, rays]
            };
            assert!(table.lines().any(is_row), "{precision} {rays}: {table}");
        }
    }
    assert!(table.ends_with("\nexact: no mistake\n"), "{table}");
}

#[test]
fn brute_force_answers_fewer_rays_of_a_large_mesh() {
    let sandbox = Sandbox::new();
    sandbox.write("hills.ply", hills(45));
    let table = sandbox
        .run("verify hills.ply --rays 3000")
        .succeeds()
        .stdout;
    assert!(table.contains("brute      the first "), "{table}");
    let report = json(&sandbox, "hills.ply --rays 3000");
    let rays: Vec<u64> = counts(&report, "exact", "rays");
    assert!(rays[0] < 3000 && rays[1..] == [3000; 3], "{rays:?}");
}

#[test]
fn meshes_without_triangles_and_without_area_are_fine() {
    let sandbox = Sandbox::new();
    sandbox.write("empty.ply", ply(&[], &[]));
    sandbox.write(
        "flat.ply",
        ply(
            &[[0.0; 3], [1.0, 2.0, 3.0], [2.0, 4.0, 6.0]],
            &[[0, 1, 2], [0, 0, 0]],
        ),
    );
    let empty = json(&sandbox, "empty.ply");
    assert_eq!(
        (&empty["triangles"], &empty["rays"]),
        (&0.into(), &0.into())
    );
    let table = sandbox.run("verify empty.ply").succeeds().stdout;
    assert!(table.contains("rays       0"), "{table}");
    let flat = json(&sandbox, "flat.ply --rays 500");
    for precision in ["watertight", "exact"] {
        assert_eq!(counts(&flat, precision, "hits"), [0; 4]);
        assert_eq!(counts(&flat, precision, "false_hits"), [0; 4]);
    }
}

#[test]
fn huge_and_tiny_numbers_are_exact_too() {
    let sandbox = Sandbox::new();
    for (name, scale) in [("huge.ply", 3.4e38), ("tiny.ply", 3e-44)] {
        let [a, b, c, d] = [
            [1.0, 1.0, 1.0],
            [-1.0, -1.0, 1.0],
            [-1.0, 1.0, -1.0],
            [1.0, -1.0, -1.0],
        ];
        let corners = [a, b, c, d].map(|corner: [f32; 3]| corner.map(|value| value * scale));
        let tetrahedron = ply(&corners, &[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]);
        sandbox.write(name, tetrahedron);
        let report = json(&sandbox, &format!("{name} --rays 2000"));
        let hits = counts(&report, "exact", "hits");
        assert!(hits.iter().all(|count| *count > 200), "{name}: {hits:?}");
        assert_eq!(report["exact_is_exact"], true);
    }
}

#[test]
fn quiet_prints_the_report_alone_and_bad_input_is_named() {
    let sandbox = Sandbox::new();
    sandbox.write(
        "a.obj",
        "mtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
    );
    let run = sandbox.run("verify a.obj --rays 10").succeeds();
    assert!(run.stderr.contains("none.mtl"), "{}", run.stderr);
    let quiet = sandbox.run("verify a.obj --rays 10 --quiet").succeeds();
    assert_eq!((quiet.stderr.as_str(), quiet.stdout), ("", run.stdout));
    sandbox.run("verify none.ply").fails(1, &["none.ply"]);
    sandbox.run("verify a.obj --rays 0").fails(2, &["--rays"]);
    sandbox.run("verify").fails(2, &["MESH"]);
}
