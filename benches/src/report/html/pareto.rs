//! Which points nothing beats.

/// Marks the points that no other beats: none is as fast or faster and has as few errors or fewer, with one of both better.
pub(super) fn front(points: &[(f64, f64)]) -> Vec<bool> {
    let beats = |(rate, error): (f64, f64), (other_rate, other_error): (f64, f64)| {
        rate >= other_rate && error <= other_error && (rate > other_rate || error < other_error)
    };
    points
        .iter()
        .map(|point| !points.iter().any(|other| beats(*other, *point)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_is_the_fastest_for_its_error_or_less() {
        let points = [
            (2.0, 0.0),  // the fastest without an error
            (1.0, 0.0),  // slower
            (3.0, 5.0),  // faster, with errors
            (2.5, 9.0),  // slower, with more errors
            (2.0, 5.0),  // as fast as the first, with errors
            (9.0, 70.0), // the fastest of all
        ];
        assert_eq!(front(&points), [true, false, true, false, false, true]);
    }

    #[test]
    fn equal_points_are_on_the_front_together() {
        assert_eq!(front(&[(1.0, 1.0), (1.0, 1.0)]), [true, true]);
        assert_eq!(front(&[]), [false; 0]);
    }
}
