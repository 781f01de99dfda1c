//! The cost of crossing an axis-aligned plane against that of a plane in any direction.
//!
//! Four tests, in two forms each. *Plain*: f32 without any margin, as the textbooks have it: one subtraction and one multiplication by a stored
//! reciprocal, against two dot products and a division. *Conservative*: as the trees of this project do it, with margins that lose no hit, f32 for axis planes and f64 for
//! others.
//!
//! Two ways of asking. *Independent*: many planes whose numbers are known beforehand, so that the tests overlap: the throughput. *Dependent*: the result
//! of a test chooses the next plane, as on the way down a tree: the latency, with the load of a node from the first level cache.

mod nodes;
mod operations;

use anyhow::Result;

use self::nodes::{Accuracy, Nodes};
use self::operations::{AxisConservative, AxisPlain, GeneralConservative, GeneralPlain, PlaneTest};
use super::{Effort, range_text, turns, verdict};
use crate::report::{Claim, Sample, Verdict};
use crate::table;

/// Ratios that count as "about three".
const ABOUT_THREE: std::ops::RangeInclusive<f64> = 2.0..=4.0;

/// A measured pair of tests.
struct Row {
    form: &'static str,
    way: &'static str,
    /// Nanoseconds of a test, one value a round.
    axis: Sample,
    general: Sample,
    /// What was found about the crossings of both.
    accuracy: [String; 2],
}

impl Row {
    fn ratio(&self) -> Sample {
        self.general.ratios(&self.axis)
    }

    fn cells(&self) -> Vec<String> {
        let ratio = self.ratio();
        let [axis, general] = &self.accuracy;
        vec![
            self.form.to_owned(),
            self.way.to_owned(),
            table::three_digits(self.axis.median()),
            table::three_digits(self.general.median()),
            format!("{:.2}", ratio.median()),
            format!("{:.2} to {:.2}", ratio.low(), ratio.high()),
            axis.clone(),
            general.clone(),
        ]
    }
}

pub(super) fn measure(effort: Effort, progress: &dyn Fn(&str)) -> Result<Claim> {
    progress("cost of plane tests");
    let plain = pair::<AxisPlain, GeneralPlain>("plain f32", effort)?;
    let conservative = pair::<AxisConservative, GeneralConservative>("conservative", effort)?;
    let rows: Vec<Row> = plain.into_iter().chain(conservative).collect();
    Ok(claim(&rows))
}

fn claim(rows: &[Row]) -> Claim {
    let ratios = |form: &'static str| {
        let rows = rows.iter().filter(move |row| row.form == form);
        rows.map(|row| row.ratio().median())
    };
    let header = [
        "arithmetic",
        "tests are",
        "axis plane ns",
        "general plane ns",
        "ratio",
        "range of ratio",
        "axis plane accuracy",
        "general plane accuracy",
    ];
    Claim {
        title: "Cost of a plane test".to_owned(),
        claim: "Crossing a plane at right angles to an axis is about three times as cheap as crossing a plane in any direction.".to_owned(),
        source: "Havran, Heuristic ray shooting algorithms, PhD thesis, Prague, 2000".to_owned(),
        verdict: judge(rows.iter().map(|row| row.ratio().median())),
        finding: format!(
            "A general plane cost {} times as much as an axis plane in plain f32 arithmetic, and {} times in the conservative tests of the trees.",
            range_text(ratios("plain f32"), 2),
            range_text(ratios("conservative"), 2)
        ),
        header: header.map(str::to_owned).to_vec(),
        rows: rows.iter().map(Row::cells).collect(),
    }
}

fn judge(ratios: impl Iterator<Item = f64>) -> Verdict {
    verdict::of(ratios.map(|ratio| ABOUT_THREE.contains(&ratio)))
}

/// Measures two tests against each other, both ways.
fn pair<A: PlaneTest, G: PlaneTest>(form: &'static str, effort: Effort) -> Result<[Row; 2]> {
    let (mut axis, mut general) = (Nodes::<A>::new(), Nodes::<G>::new());
    let audited = effort.pick(16, 4, 1);
    let accuracy = [axis.accuracy(audited), general.accuracy(audited)];
    for accuracy in &accuracy {
        accuracy.require_enclosed(form)?;
    }
    let passes = effort.pick(1000, 200, 2);
    let rounds = effort.pick(31, 11, 1);
    let independent = turns::seconds::<2>(rounds, |task| match task {
        0 => axis.test_independently(passes),
        _ => general.test_independently(passes),
    });
    let dependent = turns::seconds::<2>(rounds, |task| match task {
        0 => axis.descend(passes),
        _ => general.descend(passes),
    });
    let rows = [("independent", independent), ("dependent", dependent)];
    Ok(rows.map(|(way, samples)| {
        let [axis, general] = samples.map(|sample| {
            let tests = (passes * Nodes::<A>::LEN) as f64;
            let nanoseconds = sample.values().iter().map(|seconds| seconds * 1e9 / tests);
            Sample::new(nanoseconds.collect())
        });
        Row {
            form,
            way,
            axis,
            general,
            accuracy: accuracy.each_ref().map(Accuracy::text),
        }
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn about_three_is_two_to_four() {
        assert_eq!(judge([2.0, 3.1, 4.0].into_iter()), Verdict::Confirmed);
        assert_eq!(judge([1.9, 3.1].into_iter()), Verdict::PartlyConfirmed);
        assert_eq!(judge([1.2, 4.1].into_iter()), Verdict::NotConfirmed);
    }
}
