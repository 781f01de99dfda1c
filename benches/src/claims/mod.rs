//! Statements of the literature about space partitioning, each measured and judged.
//!
//! One module per claim. Each says in constants what counts as holding; the verdict and the figures of the finding are computed from the
//! measurement. Where speed is claimed, the rows have the errors of the same rays against the oracle, and a structure that does not answer exactly at
//! [`Precision::Exact`](tahko_tracer::geometry::Precision::Exact) is an error of the whole run.

mod bsp_growth;
mod intersection_share;
mod kd_policies;
mod plane_tests;
mod tape;
mod tests_per_ray;
mod turns;
mod verdict;

use anyhow::Result;

use crate::report::Claim;

/// How much is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Effort {
    /// For figures to publish: about a minute on two cores.
    Full,
    /// For a look: some ten seconds.
    Quick,
    /// To see that everything works: the figures mean nothing.
    Smoke,
}

impl Effort {
    /// One value for each effort.
    fn pick<T>(self, full: T, quick: T, smoke: T) -> T {
        match self {
            Self::Full => full,
            Self::Quick => quick,
            Self::Smoke => smoke,
        }
    }
}

/// Measures and judges all claims.
///
/// # Errors
/// If a structure does not answer exactly at the exact precision.
pub(crate) fn measure(effort: Effort, progress: &dyn Fn(&str)) -> Result<Vec<Claim>> {
    Ok(vec![
        intersection_share::measure(effort, progress)?,
        plane_tests::measure(effort, progress)?,
        bsp_growth::measure(effort, progress)?,
        kd_policies::measure(effort, progress)?,
        tests_per_ray::measure(effort, progress)?,
    ])
}

/// A header of own columns and the columns of errors.
fn header_with_errors(columns: &[&str]) -> Vec<String> {
    let columns = columns.iter().chain(&crate::check::ERROR_COLUMNS);
    columns.map(|column| (*column).to_owned()).collect()
}

/// The smallest and the largest of some values; `None` for none.
fn range(values: impl Iterator<Item = f64> + Clone) -> Option<(f64, f64)> {
    let low = values.clone().reduce(f64::min)?;
    Some((low, values.reduce(f64::max)?))
}

/// A range as text with so many digits behind the point, for a sentence; one number where both ends read the same.
fn range_text(values: impl Iterator<Item = f64> + Clone, digits: usize) -> String {
    let Some(ends) = range(values) else {
        return "nothing".to_owned();
    };
    let [low, high] = [ends.0, ends.1].map(|end| format!("{end:.digits$}"));
    if low == high {
        low
    } else {
        format!("{low} to {high}")
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    #[test]
    fn every_claim_is_measured_and_judged_with_exact_answers() {
        let steps = Cell::new(0);
        let claims = measure(Effort::Smoke, &|_| steps.set(steps.get() + 1)).unwrap();
        assert_eq!(claims.len(), 5);
        assert!(steps.get() >= 5);
        for claim in claims {
            let name = &claim.title;
            assert!(!claim.rows.is_empty(), "{name}");
            assert!(
                claim.finding.contains(|c: char| c.is_ascii_digit()),
                "{name}"
            );
            for row in &claim.rows {
                assert_eq!(row.len(), claim.header.len(), "{name}: {row:?}");
            }
            assert_exact(&claim);
        }
    }

    /// Where there are errors in the table, the rows that do not say they are of another precision have none.
    fn assert_exact(claim: &Claim) {
        for wrong in ["false hits", "false misses", "wrong triangles"] {
            let Some(column) = claim.header.iter().position(|name| name == wrong) else {
                continue;
            };
            for row in &claim.rows {
                if !row.contains(&"fast".to_owned()) {
                    assert_eq!(row[column], "0", "{}: {row:?}", claim.title);
                }
            }
        }
    }

    #[test]
    fn ranges_have_two_ends() {
        assert_eq!(range_text([2.0, 1.04, 3.0].into_iter(), 1), "1.0 to 3.0");
        assert_eq!(range_text([1.04, 1.0].into_iter(), 1), "1.0");
        assert_eq!(range_text([].into_iter(), 1), "nothing");
        assert_eq!(range([].into_iter()), None);
    }
}
