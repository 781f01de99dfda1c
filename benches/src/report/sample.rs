//! Repeated measurements of one quantity.

use serde::{Deserialize, Serialize};

/// Repeated measurements, in the order in which they were made.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(from = "Stored", into = "Stored")]
pub(crate) struct Sample {
    values: Vec<f64>,
}

/// The form in the file: for readers that want no statistics of their own.
#[derive(Serialize, Deserialize)]
struct Stored {
    median: f64,
    low: f64,
    high: f64,
    values: Vec<f64>,
}

impl Sample {
    pub(crate) fn new(values: Vec<f64>) -> Self {
        Self { values }
    }

    pub(crate) fn push(&mut self, value: f64) {
        self.values.push(value);
    }

    /// The measurements in the order in which they were made.
    pub(crate) fn values(&self) -> &[f64] {
        &self.values
    }

    /// The middle value, of two the larger one; zero without values.
    pub(crate) fn median(&self) -> f64 {
        let mut sorted = self.values.clone();
        sorted.sort_by(f64::total_cmp);
        sorted.get(sorted.len() / 2).copied().unwrap_or(0.0)
    }

    /// The smallest value; zero without values.
    pub(crate) fn low(&self) -> f64 {
        self.values.iter().copied().reduce(f64::min).unwrap_or(0.0)
    }

    /// The largest value; zero without values.
    pub(crate) fn high(&self) -> f64 {
        self.values.iter().copied().reduce(f64::max).unwrap_or(0.0)
    }

    /// The difference between the largest and the smallest value, as a part of the median.
    pub(crate) fn spread(&self) -> f64 {
        let median = self.median();
        if median == 0.0 {
            0.0
        } else {
            (self.high() - self.low()) / median
        }
    }

    /// The ratios to another sample that was measured in the same rounds, round by round: what both rounds have in common cancels.
    pub(crate) fn ratios(&self, to: &Self) -> Self {
        let pairs = self.values.iter().zip(&to.values);
        Self::new(pairs.map(|(value, to)| value / to).collect())
    }
}

impl From<Sample> for Stored {
    fn from(sample: Sample) -> Self {
        Self {
            median: sample.median(),
            low: sample.low(),
            high: sample.high(),
            values: sample.values,
        }
    }
}

impl From<Stored> for Sample {
    fn from(stored: Stored) -> Self {
        Self::new(stored.values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sample_knows_its_middle_and_ends() {
        let sample = Sample::new(vec![4.0, 1.0, 2.0]);
        assert_eq!(
            (sample.median(), sample.low(), sample.high()),
            (2.0, 1.0, 4.0)
        );
        assert_eq!(sample.spread(), 1.5);
        assert_eq!(Sample::new(vec![2.0, 1.0]).median(), 2.0);
    }

    #[test]
    fn an_empty_sample_is_zero() {
        let empty = Sample::default();
        assert_eq!(
            (empty.median(), empty.low(), empty.high(), empty.spread()),
            (0.0, 0.0, 0.0, 0.0)
        );
    }

    #[test]
    fn ratios_are_taken_round_by_round() {
        let [ours, theirs] = [vec![2.0, 9.0], vec![1.0, 3.0]].map(Sample::new);
        assert_eq!(ours.ratios(&theirs).values(), [2.0, 3.0]);
    }

    #[test]
    fn the_stored_form_has_the_statistics_and_gives_the_sample_back() {
        let sample = Sample::new(vec![4.0, 1.0, 2.5]);
        let text = serde_json::to_string(&sample).unwrap();
        assert_eq!(
            text,
            r#"{"median":2.5,"low":1.0,"high":4.0,"values":[4.0,1.0,2.5]}"#
        );
        assert_eq!(serde_json::from_str::<Sample>(&text).unwrap(), sample);
    }
}
