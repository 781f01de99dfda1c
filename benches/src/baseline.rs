//! Compares a report with an earlier one.
//!
//! A difference in speed is told from noise by the rounds themselves: it counts if all rounds of one report are faster than all of the other, also
//! after the drift of the machine is taken out, for which the median ratio of all rows is taken. Work per ray and errors have no noise: any difference
//! counts.

use std::path::Path;

use anyhow::{Context, Result, ensure};

use crate::report::{Contender, RayClass, Report, SCHEMA, Sample, TraceRow};

/// A comparison of the rows that both reports have.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Comparison {
    /// The middle of all ratios of rates: what the machine, or a change to everything, did.
    pub(crate) drift: f64,
    pub(crate) rows: Vec<Change>,
    /// Rows of this report that the baseline does not have.
    pub(crate) new_rows: usize,
    /// Rows of the baseline that this report does not have.
    pub(crate) missing_rows: usize,
}

/// A row beside that of the baseline.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Change {
    pub(crate) scene: String,
    pub(crate) contender: Contender,
    pub(crate) class: RayClass,
    pub(crate) threads: usize,
    /// The rate relative to that of the baseline: above 1 is faster.
    pub(crate) ratio: f64,
    pub(crate) speed: Speed,
    /// Node visits and triangle tests relative to the baseline's; `None` where one of them does not tell.
    pub(crate) node_visits: Option<f64>,
    pub(crate) triangle_tests: Option<f64>,
    /// Whether there are other errors than in the baseline.
    pub(crate) errors_differ: bool,
}

/// A change in speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Speed {
    Faster,
    Slower,
    /// Not to be told from noise.
    Same,
}

/// Reads an earlier report.
pub(crate) fn load(file: &Path) -> Result<Report> {
    let text = std::fs::read_to_string(file)
        .with_context(|| format!("cannot read the baseline {}", file.display()))?;
    let value: serde_json::Value = serde_json::from_str(&text)
        .with_context(|| format!("the baseline {} is not JSON", file.display()))?;
    let schema = value["schema"].as_u64();
    ensure!(
        schema == Some(u64::from(SCHEMA)),
        "the baseline {} has schema {}, this program writes {SCHEMA}: make a new one",
        file.display(),
        value["schema"]
    );
    serde_json::from_value(value).with_context(|| {
        format!(
            "the baseline {} is not a report of this program",
            file.display()
        )
    })
}

/// Compares the rows of two reports.
pub(crate) fn compare(report: &Report, baseline: &Report) -> Comparison {
    let pairs: Vec<(&str, &TraceRow, &TraceRow)> = rows(report)
        .filter_map(|(scene, row)| {
            let mut earlier = rows(baseline);
            let (_, before) =
                earlier.find(|(name, other)| *name == scene && is_same(row, other))?;
            Some((scene, row, before))
        })
        .collect();
    let ratios = pairs
        .iter()
        .map(|(_, row, before)| row.rate.median() / before.rate.median());
    let drift = Sample::new(ratios.collect());
    let drift = if pairs.is_empty() {
        1.0
    } else {
        drift.median()
    };
    Comparison {
        drift,
        new_rows: rows(report).count() - pairs.len(),
        missing_rows: rows(baseline).count() - pairs.len(),
        rows: pairs
            .into_iter()
            .map(|(scene, row, before)| change(scene, row, before, drift))
            .collect(),
    }
}

fn rows(report: &Report) -> impl Iterator<Item = (&str, &TraceRow)> {
    let scenes = report.scenes.iter();
    scenes.flat_map(|scene| scene.traces.iter().map(|row| (scene.name.as_str(), row)))
}

fn is_same(row: &TraceRow, other: &TraceRow) -> bool {
    row.contender == other.contender && row.class == other.class && row.threads == other.threads
}

fn change(scene: &str, row: &TraceRow, before: &TraceRow, drift: f64) -> Change {
    let works = row.work.zip(before.work);
    let ratio = |now: f64, before: f64| if now == before { 1.0 } else { now / before };
    Change {
        scene: scene.to_owned(),
        contender: row.contender.clone(),
        class: row.class,
        threads: row.threads,
        ratio: row.rate.median() / before.rate.median(),
        speed: speed(&row.rate, &before.rate, drift),
        node_visits: works.map(|(now, before)| ratio(now.node_visits, before.node_visits)),
        triangle_tests: works.map(|(now, before)| ratio(now.triangle_tests, before.triangle_tests)),
        errors_differ: row.errors != before.errors,
    }
}

/// Whether all rounds are on one side of all rounds of the baseline, as they are and without the drift.
fn speed(rate: &Sample, before: &Sample, drift: f64) -> Speed {
    let is_faster = |drift: f64| rate.low() > before.high() * drift;
    let is_slower = |drift: f64| rate.high() < before.low() * drift;
    if is_faster(1.0) && is_faster(drift) {
        Speed::Faster
    } else if is_slower(1.0) && is_slower(drift) {
        Speed::Slower
    } else {
        Speed::Same
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::example;

    /// The example with all rates of the first row times a factor, those of the others times another.
    fn scaled(first: f64, others: f64) -> Report {
        let mut report = example::report();
        let rows = report.scenes.iter_mut().flat_map(|scene| &mut scene.traces);
        for (index, row) in rows.enumerate() {
            let factor = if index == 0 { first } else { others };
            row.rate = Sample::new(row.rate.values().iter().map(|rate| rate * factor).collect());
        }
        report
    }

    fn speeds(first: f64, others: f64) -> (Speed, Vec<Speed>) {
        let comparison = compare(&scaled(first, others), &example::report());
        let speeds: Vec<Speed> = comparison.rows.iter().map(|row| row.speed).collect();
        (speeds[0], speeds[1..].to_vec())
    }

    #[test]
    fn a_report_is_equal_to_itself() {
        let comparison = compare(&example::report(), &example::report());
        assert_eq!(
            (
                comparison.drift,
                comparison.new_rows,
                comparison.missing_rows
            ),
            (1.0, 0, 0)
        );
        assert!(!comparison.rows.is_empty(), "the example has rows");
        for row in comparison.rows {
            assert_eq!(
                (row.ratio, row.speed, row.errors_differ),
                (1.0, Speed::Same, false)
            );
        }
    }

    #[test]
    fn what_is_beyond_all_rounds_is_outside_the_noise() {
        let (first, others) = speeds(3.0, 1.0);
        assert_eq!(first, Speed::Faster);
        assert!(others.iter().all(|speed| *speed == Speed::Same));
        assert_eq!(speeds(0.3, 1.0).0, Speed::Slower);
        assert_eq!(speeds(1.01, 1.0).0, Speed::Same, "rounds overlap");
    }

    #[test]
    fn a_drift_of_the_whole_machine_is_no_change() {
        let (first, others) = speeds(3.0, 3.0);
        assert_eq!(first, Speed::Same);
        assert!(others.iter().all(|speed| *speed == Speed::Same));
        assert_eq!(
            speeds(1.0, 3.0).0,
            Speed::Same,
            "as fast as before while the machine is faster"
        );
    }

    #[test]
    fn other_errors_and_work_are_changes_and_rows_of_one_side_are_counted() {
        let mut report = example::report();
        let row = &mut report.scenes[0].traces[0];
        row.errors.false_misses += 1;
        row.work = row.work.map(|work| crate::report::Work {
            node_visits: work.node_visits * 2.0,
            ..work
        });
        let dropped = report.scenes[0].traces.pop();
        let comparison = compare(&report, &example::report());
        assert!(dropped.is_some() && comparison.rows[0].errors_differ);
        assert_eq!(comparison.rows[0].node_visits, Some(2.0));
        assert_eq!((comparison.new_rows, comparison.missing_rows), (0, 1));
        assert_eq!(compare(&example::report(), &report).new_rows, 1);
    }

    #[test]
    fn a_file_that_is_no_report_is_refused_with_a_reason() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("report.json");
        let error = |text: &str| {
            std::fs::write(&file, text).unwrap();
            load(&file).unwrap_err().to_string()
        };
        assert!(error("{").ends_with("is not JSON"));
        assert!(error("{\"schema\": 99}").contains("has schema 99"));
        assert!(error(&format!("{{\"schema\": {SCHEMA}}}")).contains("not a report"));
        let text = serde_json::to_string(&example::report()).unwrap();
        std::fs::write(&file, text).unwrap();
        assert_eq!(load(&file).unwrap(), example::report());
    }
}
