//! What was found on a scene.

use crate::report::{BuildRow, Contender, Errors, SceneReport, TraceRow};
use crate::table::{markdown, three_digits};

/// The tables of a scene.
pub(super) fn section(scene: &SceneReport) -> String {
    let mut text = format!("## {}, {} triangles\n\n", scene.name, scene.triangles);
    for note in &scene.notes {
        text += &format!("{note}\n\n");
    }
    if !scene.builds.is_empty() {
        text += &format!("{}\n", builds(&scene.builds));
    }
    if !scene.traces.is_empty() {
        text += &traces(&scene.traces);
    }
    text
}

fn builds(builds: &[BuildRow]) -> String {
    let header = [
        "structure",
        "preset",
        "build ms, one thread",
        "all threads",
        "bytes/triangle",
        "nodes",
        "depth",
        "references/triangle",
        "SAH cost",
        "overlap (EPO)",
        "E inner nodes",
        "E leaves",
        "E triangle tests",
    ];
    let rows = builds.iter().map(|build| {
        let milliseconds = |seconds: f64| three_digits(seconds * 1e3);
        let mut cells = vec![
            structure(&build.contender),
            build.contender.preset.clone(),
            milliseconds(build.seconds.median()),
            milliseconds(build.seconds_all_threads.median()),
            build.bytes_per_triangle.map_or_else(unknown, three_digits),
        ];
        match &build.tree {
            None => cells.extend(std::iter::repeat_n(unknown(), 8)),
            Some(tree) => cells.extend([
                tree.nodes.to_string(),
                tree.depth.to_string(),
                three_digits(tree.references_per_triangle),
                three_digits(tree.sah_cost),
                tree.end_point_overlap.map_or_else(unknown, three_digits),
                three_digits(tree.expected_inner_nodes),
                three_digits(tree.expected_leaves),
                three_digits(tree.expected_triangle_tests),
            ]),
        }
        cells
    });
    markdown(&header, rows.collect(), 2)
}

/// One row for each contender and class: with one thread, and beside it with all.
fn traces(traces: &[TraceRow]) -> String {
    let header = [
        "rays",
        "structure",
        "preset",
        "precision",
        "interface",
        "Mrays/s",
        "spread %",
        "all threads",
        "nodes/ray",
        "bounds/ray",
        "triangles/ray",
        "audited",
        "false misses",
        "false hits",
        "wrong triangles",
        "far off",
        "t ulp median",
        "99.9 %",
        "max",
    ];
    let single = traces.iter().filter(|row| row.threads == 1);
    let rows = single.map(|row| {
        let Contender {
            preset,
            precision,
            interface,
            ..
        } = &row.contender;
        let with_all = traces.iter().find(|other| {
            other.threads > 1 && other.class == row.class && other.contender == row.contender
        });
        let mut cells = vec![
            row.class.name().to_owned(),
            structure(&row.contender),
            preset.clone(),
            precision.clone(),
            interface.clone(),
            three_digits(row.rate.median()),
            format!("{:.0}", 100.0 * row.rate.spread()),
            with_all.map_or_else(unknown, |row| three_digits(row.rate.median())),
        ];
        match &row.work {
            None => cells.extend(std::iter::repeat_n(unknown(), 3)),
            Some(work) => cells.extend(
                [work.node_visits, work.bound_tests, work.triangle_tests].map(three_digits),
            ),
        }
        cells.extend(errors(&row.errors));
        cells
    });
    markdown(&header, rows.collect(), 5)
}

fn errors(errors: &Errors) -> Vec<String> {
    let per_million = |count| three_digits(errors.per_million(count));
    let mut cells = vec![
        errors.audited.to_string(),
        per_million(errors.false_misses),
        per_million(errors.false_hits),
        per_million(errors.wrong_triangles),
        per_million(errors.far_off),
    ];
    match errors.t_ulp {
        None => cells.extend(std::iter::repeat_n(unknown(), 3)),
        Some(t) => {
            cells.extend([t.median, t.quantile_999, t.largest].map(|ulp| format!("{ulp:.2}")));
        }
    }
    cells
}

/// Library and structure, with the instruction set where it is not the default.
pub(super) fn structure(contender: &Contender) -> String {
    let Contender {
        library,
        structure,
        simd,
        ..
    } = contender;
    let library = if library == crate::structures::LIBRARY {
        String::new()
    } else {
        format!("{library} ")
    };
    let simd = if simd == "scalar" || !library.is_empty() {
        String::new()
    } else {
        format!(" {simd}")
    };
    format!("{library}{structure}{simd}")
}

fn unknown() -> String {
    "-".to_owned()
}
