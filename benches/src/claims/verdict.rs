//! What becomes of a claim.

use crate::report::Verdict;

/// Confirmed if all cases hold, partly if some do, and otherwise not; a claim that was held against nothing is not confirmed.
pub(super) fn of(cases: impl IntoIterator<Item = bool>) -> Verdict {
    let (mut held, mut failed) = (false, false);
    for holds in cases {
        held |= holds;
        failed |= !holds;
    }
    match (held, failed) {
        (true, false) => Verdict::Confirmed,
        (true, true) => Verdict::PartlyConfirmed,
        (false, _) => Verdict::NotConfirmed,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_some_and_no_cases_are_told_apart() {
        assert_eq!(of([true, true]), Verdict::Confirmed);
        assert_eq!(of([true, false]), Verdict::PartlyConfirmed);
        assert_eq!(of([false, false]), Verdict::NotConfirmed);
        assert_eq!(of([]), Verdict::NotConfirmed);
    }
}
