//! A small report for tests.

use super::{
    Contender, Distribution, Errors, Machine, RayClass, Report, SCHEMA, Sample, SceneReport,
    Settings, TraceRow, Work,
};

/// One of the project's structures with its default preset.
pub(crate) fn contender(structure: &str, precision: &str) -> Contender {
    Contender {
        library: crate::structures::LIBRARY.to_owned(),
        structure: structure.to_owned(),
        preset: "balanced".to_owned(),
        precision: precision.to_owned(),
        simd: "scalar".to_owned(),
        interface: "single".to_owned(),
    }
}

/// Two scenes, two structures, three precisions.
pub(crate) fn report() -> Report {
    let mut scenes = Vec::new();
    for (name, rate) in [("room", 4.0), ("hills", 2.0)] {
        let mut traces = Vec::new();
        for structure in ["kdtree", "bvh"] {
            for (precision, factor) in [("fast", 1.1), ("watertight", 1.05), ("exact", 1.0)] {
                traces.push(trace(structure, precision, rate * factor));
            }
        }
        scenes.push(SceneReport {
            name: name.to_owned(),
            triangles: 1000,
            builds: Vec::new(),
            traces,
            images: Vec::new(),
            notes: Vec::new(),
        });
    }
    Report {
        schema: SCHEMA,
        command: "bench --quick".to_owned(),
        started: 1_700_000_000,
        seconds: 12.5,
        machine: Machine {
            processor: "Some CPU".to_owned(),
            threads: 2,
            system: "linux x86_64".to_owned(),
            compiler: "rustc 1.89.0".to_owned(),
            version: "0.1.0".to_owned(),
        },
        settings: Settings {
            quick: true,
            rays: 1024,
            rounds: 3,
        },
        scenes,
        growth: Vec::new(),
        claims: Vec::new(),
    }
}

fn trace(structure: &str, precision: &str, rate: f64) -> TraceRow {
    let is_exact = precision == "exact";
    TraceRow {
        contender: contender(structure, precision),
        class: RayClass::Random,
        threads: 1,
        rate: Sample::new([0.9, 1.0, 1.05].map(|factor| rate * factor).to_vec()),
        work: Some(Work {
            node_visits: 20.0,
            bound_tests: 40.0,
            triangle_tests: 3.0,
            settled_by_f32: if is_exact { 0.75 } else { 0.0 },
            settled_by_f64: if is_exact { 0.25 } else { 0.0 },
            settled_by_expansions: 0.0,
        }),
        errors: Errors {
            audited: 500,
            hits: 300,
            false_misses: if is_exact { 0 } else { 2 },
            t_ulp: Some(Distribution {
                median: 0.25,
                quantile_999: 0.5,
                largest: 0.5,
            }),
            ..Errors::default()
        },
    }
}
