//! The comparison with a baseline.

use crate::baseline::{Change, Comparison, Speed};
use crate::table::markdown;

/// The rows that changed, and how many did not.
pub(super) fn section(comparison: &Comparison) -> String {
    let Comparison {
        drift,
        rows,
        new_rows,
        missing_rows,
    } = comparison;
    let changed: Vec<&Change> = rows.iter().filter(|row| is_change(row)).collect();
    let unchanged = rows.len() - changed.len();
    let mut text = format!(
        "## Compared with the baseline\n\nThe middle of all ratios of rates is {drift:.3}; a change in speed is beyond that and beyond every round. \
         {unchanged} rows did not change, {new_rows} are new, {missing_rows} are missing.\n"
    );
    if !changed.is_empty() {
        let header = [
            "scene",
            "rays",
            "structure",
            "preset",
            "precision",
            "interface",
            "threads",
            "speed",
            "ratio",
            "nodes/ray",
            "triangles/ray",
            "errors",
        ];
        text += &format!(
            "\n{}",
            markdown(&header, changed.into_iter().map(cells).collect(), 6)
        );
    }
    text
}

fn is_change(row: &Change) -> bool {
    let differs = |ratio: Option<f64>| ratio.is_some_and(|ratio| ratio != 1.0);
    row.speed != Speed::Same
        || row.errors_differ
        || differs(row.node_visits)
        || differs(row.triangle_tests)
}

fn cells(row: &Change) -> Vec<String> {
    let ratio =
        |ratio: Option<f64>| ratio.map_or_else(|| "-".to_owned(), |ratio| format!("{ratio:.3}"));
    let speed = match row.speed {
        Speed::Faster => "FASTER",
        Speed::Slower => "SLOWER",
        Speed::Same => "same",
    };
    vec![
        row.scene.clone(),
        row.class.name().to_owned(),
        super::scene::structure(&row.contender),
        row.contender.preset.clone(),
        row.contender.precision.clone(),
        row.contender.interface.clone(),
        row.threads.to_string(),
        speed.to_owned(),
        format!("{:.3}", row.ratio),
        ratio(row.node_visits),
        ratio(row.triangle_tests),
        if row.errors_differ { "DIFFER" } else { "same" }.to_owned(),
    ]
}
