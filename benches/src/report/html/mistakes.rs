//! Wrong answers, counted and put in words.

use super::super::Errors;
use super::format::{count, number};

/// Wrong answers of some rays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Mistakes {
    /// False hits, false misses and wrong triangles.
    pub(super) wrong: usize,
    /// Rays that were compared with the exact answer.
    pub(super) audited: usize,
}

impl Mistakes {
    pub(super) const fn of(errors: &Errors) -> Self {
        Self {
            wrong: errors.false_hits + errors.false_misses + errors.wrong_triangles,
            audited: errors.audited,
        }
    }

    pub(super) const fn add(&mut self, other: Self) {
        self.wrong += other.wrong;
        self.audited += other.audited;
    }

    /// Rays were compared, and none was wrong.
    pub(super) const fn is_clean(&self) -> bool {
        self.audited > 0 && self.wrong == 0
    }

    /// Wrong answers per million rays; `None` if nothing was compared.
    pub(super) fn per_million(&self) -> Option<f64> {
        (self.audited > 0).then(|| 1e6 * self.wrong as f64 / self.audited as f64)
    }

    /// `12.3`, `0`, or `not audited`.
    pub(super) fn short(&self) -> String {
        self.per_million()
            .map_or_else(|| "not audited".to_owned(), number)
    }

    /// `12.3 wrong answers per million`, `no wrong answer in 1000 rays`.
    pub(super) fn words(&self) -> String {
        match self.per_million() {
            None => "errors not audited".to_owned(),
            Some(_) if self.wrong == 0 => {
                format!("no wrong answer in {} rays", count(self.audited))
            }
            Some(rate) => format!(
                "{} wrong answers per million ({} of {} rays)",
                number(rate),
                count(self.wrong),
                count(self.audited)
            ),
        }
    }
}

impl<'a> FromIterator<&'a Errors> for Mistakes {
    fn from_iter<I: IntoIterator<Item = &'a Errors>>(errors: I) -> Self {
        errors.into_iter().fold(Self::default(), |mut sum, errors| {
            sum.add(Self::of(errors));
            sum
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_kinds_of_wrong_answers_count() {
        let errors = Errors {
            audited: 1_000_000,
            false_hits: 1,
            false_misses: 20,
            wrong_triangles: 300,
            far_off: 100,
            ..Errors::default()
        };
        let mistakes: Mistakes = [&errors, &errors].into_iter().collect();
        assert_eq!(mistakes.per_million(), Some(321.0));
        assert!(!mistakes.is_clean(), "it has errors");
    }

    #[test]
    fn nothing_audited_is_not_free_of_errors() {
        let none = Mistakes::default();
        assert_eq!((none.per_million(), none.is_clean()), (None, false));
        assert_eq!(none.short(), "not audited");
    }
}
