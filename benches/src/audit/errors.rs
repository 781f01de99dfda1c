//! Counts of mistakes.

use serde::{Deserialize, Serialize};

/// What can be wrong with an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mistake {
    /// A closest hit where the ray hits nothing.
    FalseHit,
    /// No closest hit where the ray hits something.
    FalseMiss,
    /// A false miss of a half-line from `t = 0` that crosses the surface an odd number of times: on a closed mesh, a ray that
    /// escapes from inside.
    Leak,
    /// Another triangle than the closest, or than the first of those that are equally close.
    WrongTriangle,
    /// The right triangle with a `t` that is not the exact one, correctly rounded.
    InexactT,
    /// The right triangle with weights outside it, or farther from the exact ones than f32 needs.
    InexactWeights,
    /// `any_hit` says something else than the exact answer.
    AnyHit,
    /// A batch gives another answer than a single query.
    Batch,
    /// Other crossings, another number or another order of them.
    Crossings,
}

impl Mistake {
    /// All of them.
    pub const ALL: [Self; 9] = [
        Self::FalseHit,
        Self::FalseMiss,
        Self::Leak,
        Self::WrongTriangle,
        Self::InexactT,
        Self::InexactWeights,
        Self::AnyHit,
        Self::Batch,
        Self::Crossings,
    ];

    /// A name for several of them.
    #[must_use]
    pub const fn plural(self) -> &'static str {
        match self {
            Self::FalseHit => "false hits",
            Self::FalseMiss => "false misses",
            Self::Leak => "leaks",
            Self::WrongTriangle => "wrong triangles",
            Self::InexactT => "inexact t",
            Self::InexactWeights => "inexact weights",
            Self::AnyHit => "wrong any-hits",
            Self::Batch => "batch differences",
            Self::Crossings => "wrong crossings",
        }
    }
}

/// The mistakes in the answers to one ray.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Mistakes([bool; Mistake::ALL.len()]);

impl Mistakes {
    pub(super) const fn add_if(&mut self, condition: bool, mistake: Mistake) {
        self.0[mistake as usize] |= condition;
    }

    pub(super) fn iter(self) -> impl Iterator<Item = Mistake> {
        Mistake::ALL
            .into_iter()
            .filter(move |mistake| self.0[*mistake as usize])
    }
}

/// How often a structure erred on some rays.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Rays that were asked.
    pub rays: usize,
    /// Rays that exactly hit something.
    pub hits: usize,
    /// Rays with a mistake of any kind.
    pub wrong_rays: usize,
    counts: [usize; Mistake::ALL.len()],
    /// Errors of `t` where the triangle is right; `None` if there is no such ray.
    pub t_errors: Option<TErrors>,
}

/// The distribution of the errors of `t`, in units in the last place of the exact one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TErrors {
    /// Half of the errors are not above this.
    #[serde(with = "finite_or_word")]
    pub median: f64,
    /// 999 of 1000 errors are not above this.
    #[serde(with = "finite_or_word")]
    pub quantile_999: f64,
    /// The largest.
    #[serde(with = "finite_or_word")]
    pub largest: f64,
}

/// JSON has no infinity, but a `t` can be infinitely wrong: the word `inf` stands for it.
mod finite_or_word {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    #[derive(Serialize, Deserialize)]
    #[serde(untagged)]
    enum Stored {
        Finite(f64),
        Word(String),
    }

    #[expect(
        clippy::trivially_copy_pass_by_ref,
        reason = "the signature that serde calls"
    )]
    pub(super) fn serialize<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
        let stored = if value.is_finite() {
            Stored::Finite(*value)
        } else {
            Stored::Word(value.to_string())
        };
        stored.serialize(serializer)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
        match Stored::deserialize(deserializer)? {
            Stored::Finite(value) => Ok(value),
            Stored::Word(word) => word.parse().map_err(serde::de::Error::custom),
        }
    }
}

impl TErrors {
    /// The distribution of some errors; `None` for none.
    #[must_use]
    pub fn of(mut errors: Vec<f64>) -> Option<Self> {
        errors.sort_unstable_by(f64::total_cmp);
        // The smallest value that a part of all values is not above.
        let quantile = |permille: usize| {
            let rank = (permille * errors.len()).div_ceil(1000).max(1);
            errors[rank - 1]
        };
        (!errors.is_empty()).then(|| Self {
            median: quantile(500),
            quantile_999: quantile(999),
            largest: quantile(1000),
        })
    }
}

impl Errors {
    /// How many rays have a mistake of a kind.
    #[must_use]
    pub const fn count(&self, mistake: Mistake) -> usize {
        self.counts[mistake as usize]
    }

    /// The same per million rays; 0 without rays.
    #[must_use]
    pub fn per_million(&self, mistake: Mistake) -> f64 {
        1e6 * self.count(mistake) as f64 / self.rays.max(1) as f64
    }
}

/// Collects what is known about single rays.
#[derive(Clone, Debug, Default)]
pub(super) struct Tally {
    errors: Errors,
    t_errors: Vec<f64>,
}

impl Tally {
    pub(super) fn add(&mut self, is_hit: bool, mistakes: Mistakes, t_error: Option<f64>) {
        self.errors.rays += 1;
        self.errors.hits += usize::from(is_hit);
        self.errors.wrong_rays += usize::from(mistakes != Mistakes::default());
        for mistake in mistakes.iter() {
            self.errors.counts[mistake as usize] += 1;
        }
        self.t_errors.extend(t_error);
    }

    pub(super) fn merge(&mut self, other: &Self) {
        self.errors.rays += other.errors.rays;
        self.errors.hits += other.errors.hits;
        self.errors.wrong_rays += other.errors.wrong_rays;
        for (count, other) in self.errors.counts.iter_mut().zip(other.errors.counts) {
            *count += other;
        }
        self.t_errors.extend(&other.t_errors);
    }

    pub(super) fn finish(self) -> Errors {
        Errors {
            t_errors: TErrors::of(self.t_errors),
            ..self.errors
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_values_that_enough_others_are_not_above() {
        let finish = |errors: &[f64]| {
            let mut tally = Tally::default();
            for error in errors {
                tally.add(true, Mistakes::default(), Some(*error));
            }
            assert_eq!(
                tally.clone().finish().t_errors,
                TErrors::of(errors.to_vec())
            );
            tally.finish().t_errors
        };
        let expected = |median, quantile_999, largest| TErrors {
            median,
            quantile_999,
            largest,
        };
        assert_eq!(finish(&[]), None);
        assert_eq!(finish(&[3.0]), Some(expected(3.0, 3.0, 3.0)));
        assert_eq!(finish(&[3.0, 1.0]), Some(expected(1.0, 3.0, 3.0)));
        let many: Vec<f64> = (1..=2000u16).rev().map(f64::from).collect();
        assert_eq!(finish(&many), Some(expected(1000.0, 1998.0, 2000.0)));
    }

    #[test]
    fn infinite_errors_survive_json() {
        let errors = TErrors {
            median: 0.25,
            quantile_999: 1.5,
            largest: f64::INFINITY,
        };
        let text = serde_json::to_string(&errors).unwrap();
        assert_eq!(
            text,
            r#"{"median":0.25,"quantile_999":1.5,"largest":"inf"}"#
        );
        assert_eq!(serde_json::from_str::<TErrors>(&text).unwrap(), errors);
    }

    #[test]
    fn rates_are_per_million_rays() {
        let mut tally = Tally::default();
        let mut mistakes = Mistakes::default();
        mistakes.add_if(true, Mistake::FalseMiss);
        mistakes.add_if(false, Mistake::Batch);
        tally.add(true, mistakes, None);
        tally.add(false, Mistakes::default(), None);
        let mut twice = tally.clone();
        twice.merge(&tally);
        let errors = twice.finish();
        assert_eq!((errors.rays, errors.hits, errors.wrong_rays), (4, 2, 2));
        assert_eq!(errors.count(Mistake::FalseMiss), 2);
        assert_eq!(errors.per_million(Mistake::FalseMiss), 500_000.0);
        assert_eq!(errors.count(Mistake::Batch), 0);
        assert_eq!(Errors::default().per_million(Mistake::Batch), 0.0);
    }
}
