//! Exponents of growth, fitted by least squares.

use crate::report::Fit;

/// Fits `y = c x^p` to points: the slope `p` of the line of least squares through `(log x, log y)`, and half of its 95 % confidence interval
/// by Student's t with `n - 2` degrees of freedom.
///
/// The interval supposes that the logarithms scatter about a line independently and normally. Where the true curve bends, as that of
/// `n log n` does, it tells how well a power describes the curve in this range, and nothing beyond it.
///
/// `None` for fewer than three points, for points with one and the same `x`, and unless all coordinates are positive and finite.
///
/// Source: any text on linear regression, such as Draper and Smith, "Applied Regression Analysis", 1998, section 1.4.
pub(crate) fn power_law(points: &[(f64, f64)]) -> Option<Fit> {
    let is_usable = |value: f64| value > 0.0 && value.is_finite();
    if points.len() < 3 || !points.iter().all(|(x, y)| is_usable(*x) && is_usable(*y)) {
        return None;
    }
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let count = logs.len() as f64;
    let mean_x = logs.iter().map(|(x, _)| x).sum::<f64>() / count;
    let mean_y = logs.iter().map(|(_, y)| y).sum::<f64>() / count;
    let [mut sum_xx, mut sum_xy] = [0.0; 2];
    for (x, y) in &logs {
        sum_xx += (x - mean_x) * (x - mean_x);
        sum_xy += (x - mean_x) * (y - mean_y);
    }
    if sum_xx == 0.0 {
        return None;
    }
    let exponent = sum_xy / sum_xx;
    let residual = |(x, y): &(f64, f64)| y - mean_y - exponent * (x - mean_x);
    let squares: f64 = logs.iter().map(|point| residual(point).powi(2)).sum();
    let variance = squares / (count - 2.0);
    Some(Fit {
        exponent,
        uncertainty: student_t(logs.len() - 2) * (variance / sum_xx).sqrt(),
    })
}

/// The exponent that would be fitted to a function of `n` at the same places: what `n log n` looks like as a power there.
pub(crate) fn exponent_of(function: impl Fn(f64) -> f64, places: &[f64]) -> Option<f64> {
    let points: Vec<_> = places.iter().map(|n| (*n, function(*n))).collect();
    power_law(&points).map(|fit| fit.exponent)
}

/// A fit as text.
pub(crate) fn text(fit: Option<Fit>) -> String {
    fit.map_or_else(String::new, |fit| {
        format!("{:.2} ± {:.2}", fit.exponent, fit.uncertainty)
    })
}

/// The 97.5 % quantile of Student's t distribution for 1 degree of freedom and more; that of 30 for all above, which is at most 4 % too large.
///
/// Source: Abramowitz and Stegun, "Handbook of Mathematical Functions", 1964, table 26.10.
fn student_t(degrees: usize) -> f64 {
    const QUANTILES: [f64; 30] = [
        12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201, 2.179, 2.160,
        2.145, 2.131, 2.120, 2.110, 2.101, 2.093, 2.086, 2.080, 2.074, 2.069, 2.064, 2.060, 2.056,
        2.052, 2.048, 2.045, 2.042,
    ];
    QUANTILES[degrees.clamp(1, QUANTILES.len()) - 1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_is_found_without_uncertainty() {
        let points = [1e3, 1e4, 1e5, 1e6].map(|n: f64| (n, 3.0 * n.powf(1.25)));
        let fit = power_law(&points).unwrap();
        assert!((fit.exponent - 1.25).abs() < 1e-12, "{fit:?}");
        assert!(fit.uncertainty < 1e-12, "{fit:?}");
    }

    /// With logarithms 0 to 3 against 0, 1, 1, 2: slope 0.6, squares of residuals 0.2, so the standard error is `sqrt(0.1 / 5)`, and
    /// the quantile for two degrees of freedom 4.303.
    #[test]
    fn the_interval_is_that_of_the_textbook() {
        let points = [(0.0, 0.0), (1.0, 1.0), (2.0, 1.0), (3.0, 2.0)];
        let points = points.map(|(x, y): (f64, f64)| (x.exp(), y.exp()));
        let fit = power_law(&points).unwrap();
        assert!((fit.exponent - 0.6).abs() < 1e-12, "{fit:?}");
        assert!(
            (fit.uncertainty - 4.303 * 0.02f64.sqrt()).abs() < 1e-12,
            "{fit:?}"
        );
    }

    #[test]
    fn too_few_or_impossible_points_are_not_fitted() {
        assert_eq!(power_law(&[(1.0, 1.0), (2.0, 2.0)]), None);
        assert_eq!(power_law(&[(2.0, 1.0), (2.0, 2.0), (2.0, 3.0)]), None);
        assert_eq!(power_law(&[(1.0, 0.0), (2.0, 2.0), (3.0, 3.0)]), None);
        assert_eq!(power_law(&[(1.0, f64::NAN), (2.0, 2.0), (3.0, 3.0)]), None);
    }

    #[test]
    fn quantiles_fall_with_the_degrees_of_freedom() {
        assert_eq!((student_t(1), student_t(30)), (12.706, 2.042));
        assert_eq!(student_t(1000), student_t(30));
        assert!((1..30).all(|degrees| student_t(degrees) > student_t(degrees + 1)));
    }

    #[test]
    fn n_log_n_looks_like_a_power_a_little_above_one() {
        let exponent = exponent_of(|n| n * n.ln(), &[1e3, 1e4, 1e5, 1e6]).unwrap();
        assert!((1.0..1.15).contains(&exponent), "{exponent}");
    }

    #[test]
    fn fits_are_shown_with_their_interval() {
        let fit = Fit {
            exponent: 1.046,
            uncertainty: 0.1,
        };
        assert_eq!(text(Some(fit)), "1.05 ± 0.10");
        assert_eq!(text(None), "");
    }
}
