//! What exactness costs: time relative to the other precisions, and which arithmetic decided.

use crate::report::{Contender, RayClass, Sample, SceneReport, TraceRow};
use crate::table::{markdown, three_digits};

/// Tables over all scenes; `None` where the exact precision was not measured beside another one.
pub(super) fn section(scenes: &[SceneReport]) -> Option<String> {
    let mut times = Vec::new();
    let mut rungs = Vec::new();
    for scene in scenes {
        for row in scene
            .traces
            .iter()
            .filter(|row| row.threads == 1 && is_exact(row))
        {
            let named = |cells: &mut Vec<String>| {
                cells.extend([
                    scene.name.clone(),
                    super::scene::structure(&row.contender),
                    row.contender.preset.clone(),
                    row.contender.interface.clone(),
                    row.class.name().to_owned(),
                ]);
            };
            let beside = |precision| time_relative_to(scene, row, precision);
            if let (Some(watertight), Some(fast)) = (beside("watertight"), beside("fast")) {
                let mut cells = Vec::new();
                named(&mut cells);
                let nanoseconds = 1e3 / row.rate.median();
                cells.push(three_digits(nanoseconds));
                cells.extend([watertight, fast].map(|ratio| format!("{:.2}", ratio.median())));
                times.push(cells);
            }
            if let Some(work) = row.work {
                let mut cells = Vec::new();
                named(&mut cells);
                cells.push(three_digits(work.triangle_tests));
                let shares = [
                    work.settled_by_f32,
                    work.settled_by_f64,
                    work.settled_by_expansions,
                ];
                cells.extend(shares.map(|share| format!("{:.4}", 100.0 * share)));
                rungs.push(cells);
            }
        }
    }
    (!times.is_empty()).then(|| {
        let names = ["scene", "structure", "preset", "interface", "rays"];
        let of = |columns: &[&'static str]| [&names, columns].concat();
        let times_header = of(&["exact ns/ray", "exact / watertight", "exact / fast"]);
        let rungs_header = of(&["tests/ray", "f32 %", "f64 %", "expansions %"]);
        format!(
            "## What exactness costs\n\nTime of the exact precision relative to the others, the median of the ratios of rounds, one thread:\n\n{}\n\
             Triangle tests of the exact precision, by the arithmetic that settled them:\n\n{}",
            markdown(&times_header, times, 5),
            markdown(&rungs_header, rungs, 5)
        )
    })
}

fn is_exact(row: &TraceRow) -> bool {
    row.contender.precision == "exact" && row.contender.library == crate::structures::LIBRARY
}

/// The time of a row relative to that of the same structure and rays at another precision.
fn time_relative_to(scene: &SceneReport, row: &TraceRow, precision: &str) -> Option<Sample> {
    let wanted = Contender {
        precision: precision.to_owned(),
        ..row.contender.clone()
    };
    let key = |row: &TraceRow| -> (RayClass, usize) { (row.class, row.threads) };
    let mut rows = scene.traces.iter();
    let other = rows.find(|other| other.contender == wanted && key(other) == key(row))?;
    // Times are the reciprocals of rates.
    Some(other.rate.ratios(&row.rate))
}
