//! Holds what was measured against what the project promises.

use crate::report::{Errors, Report, SceneReport, TraceRow};
use crate::structures::LIBRARY;

/// The promises that a report breaks, each in a sentence: errors of the exact precision, and structures that do not answer alike.
pub(crate) fn broken(report: &Report) -> Vec<String> {
    let mut broken = Vec::new();
    for scene in &report.scenes {
        let own = || {
            scene
                .traces
                .iter()
                .filter(|row| row.contender.library == LIBRARY)
        };
        for (index, row) in own().enumerate() {
            let first = own().take(index).find(|other| are_alike(other, row));
            if first.is_some_and(|first| first.errors != row.errors) {
                broken.push(sentence(
                    scene,
                    row,
                    "does not err as the first structure does",
                ));
            }
            if row.contender.precision == "exact" && has_errors(&row.errors) {
                broken.push(sentence(scene, row, "is not exact"));
            }
        }
    }
    broken
}

fn are_alike(row: &TraceRow, other: &TraceRow) -> bool {
    let of = |row: &TraceRow| (row.contender.precision.clone(), row.class, row.threads);
    of(row) == of(other)
}

/// Any wrong answer, or a `t` that is not correctly rounded.
fn has_errors(errors: &Errors) -> bool {
    let wrong = errors.false_hits + errors.false_misses + errors.wrong_triangles;
    wrong > 0
        || errors
            .t_ulp
            .is_some_and(|t| t.largest.is_nan() || t.largest > 0.5)
}

fn sentence(scene: &SceneReport, row: &TraceRow, what: &str) -> String {
    let (contender, class, errors) = (&row.contender, row.class.name(), &row.errors);
    format!(
        "{}: {} ({}) at {} {what} on {class} rays: {errors:?}",
        scene.name, contender.structure, contender.preset, contender.precision
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::{Distribution, RayClass, Sample, example};

    fn report(errors: [Errors; 2]) -> Report {
        let mut report = example::report();
        report.scenes.truncate(1);
        report.scenes[0].traces = ["bvh", "bsp"]
            .iter()
            .zip(errors)
            .map(|(structure, errors)| TraceRow {
                contender: example::contender(structure, "exact"),
                class: RayClass::Edge,
                threads: 1,
                rate: Sample::new(vec![1.0]),
                work: None,
                errors,
            })
            .collect();
        report
    }

    fn broken_by(change: impl Fn(&mut Errors)) -> usize {
        let mut errors = Errors {
            audited: 10,
            hits: 5,
            ..Errors::default()
        };
        let right = errors;
        change(&mut errors);
        broken(&report([right, errors])).len()
    }

    #[test]
    fn right_answers_break_no_promise() {
        assert_eq!(broken_by(|_| ()), 0);
        let half = Distribution {
            median: 0.2,
            quantile_999: 0.5,
            largest: 0.5,
        };
        let mut errors = Errors {
            t_ulp: Some(half),
            ..Errors::default()
        };
        assert!(
            broken(&report([errors; 2])).is_empty(),
            "half a unit is the best rounding"
        );
        errors.t_ulp = Some(Distribution {
            largest: 0.51,
            ..half
        });
        assert_eq!(broken(&report([errors; 2])).len(), 2);
    }

    #[test]
    fn every_error_of_the_exact_precision_and_every_difference_is_told() {
        assert_eq!(
            broken_by(|errors| errors.false_hits = 1),
            2,
            "wrong, and unlike the other"
        );
        assert_eq!(broken_by(|errors| errors.false_misses = 1), 2);
        assert_eq!(broken_by(|errors| errors.wrong_triangles = 1), 2);
        assert_eq!(
            broken_by(|errors| errors.hits = 4),
            1,
            "unlike the other only"
        );
    }

    #[test]
    fn other_libraries_and_precisions_promise_nothing() {
        let wrong = Errors {
            false_hits: 3,
            ..Errors::default()
        };
        let mut report = report([Errors::default(), wrong]);
        report.scenes[0].traces[1].contender.library = "other".to_owned();
        assert!(broken(&report).is_empty(), "another library");
        report.scenes[0].traces[1].contender = example::contender("bsp", "fast");
        assert!(broken(&report).is_empty(), "another precision");
    }
}
