//! Axes: where on an axis a value lies, and where its ticks stand.

/// Room at both ends of a logarithmic axis, as a part of the whole.
const MARGIN: f64 = 0.07;
/// The least that a logarithmic axis spans, as a logarithm: a factor of 2.
const LEAST_SPAN: f64 = std::f64::consts::LN_2;
/// More decades than this are not all labelled.
const MOST_DECADES: usize = 7;

/// The values that an axis spans.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Domain {
    kind: Kind,
    low: f64,
    high: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Linear,
    Logarithmic,
}

impl Domain {
    /// Spans the positive values on a logarithmic axis, with some room; `None` if there are none.
    pub(super) fn logarithmic(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let positive = values
            .into_iter()
            .filter(|value| value.is_finite() && *value > 0.0);
        let (low, high) = ends(positive)?;
        let (low, high) = (low.ln(), high.ln());
        let margin = (MARGIN * (high - low)).max((LEAST_SPAN - (high - low)) / 2.0);
        Some(Self {
            kind: Kind::Logarithmic,
            low: (low - margin).exp().max(f64::MIN_POSITIVE),
            high: (high + margin).exp().min(f64::MAX),
        })
    }

    /// Spans zero to the largest value on a linear axis, with some room; `None` if no value is positive.
    pub(super) fn from_zero(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let (_, high) = ends(values.into_iter().filter(|value| value.is_finite()))?;
        (high > 0.0).then(|| Self {
            kind: Kind::Linear,
            low: 0.0,
            high: (high * 1.04).min(f64::MAX),
        })
    }

    /// Where a value lies, from 0 to 1; `None` where it has no place: not finite, or not positive on a logarithmic axis.
    pub(super) fn fraction(&self, value: f64) -> Option<f64> {
        let (value, low, high) = match self.kind {
            _ if !value.is_finite() => return None,
            Kind::Linear => (value, self.low, self.high),
            Kind::Logarithmic if value <= 0.0 => return None,
            Kind::Logarithmic => (value.ln(), self.low.ln(), self.high.ln()),
        };
        Some(((value - low) / (high - low)).clamp(0.0, 1.0))
    }

    /// The smallest and the largest value on the axis.
    pub(super) const fn ends(&self) -> (f64, f64) {
        (self.low, self.high)
    }

    /// Values to label, two to about ten, from low to high.
    pub(super) fn ticks(&self) -> Vec<f64> {
        if self.kind == Kind::Linear {
            return self.even_ticks();
        }
        let decades = self.mantissa_ticks(&[1.0]);
        if decades.len() > 2 {
            let step = decades.len().div_ceil(MOST_DECADES);
            return decades.into_iter().step_by(step).collect();
        }
        let ticks = self.mantissa_ticks(&[1.0, 2.0, 5.0]);
        if ticks.len() > 2 {
            return ticks;
        }
        self.even_ticks()
    }

    fn mantissa_ticks(&self, mantissas: &[f64]) -> Vec<f64> {
        steps(mantissas)
            .filter(|tick| (self.low..=self.high).contains(tick))
            .collect()
    }

    fn even_ticks(&self) -> Vec<f64> {
        let about = (self.high - self.low) / 5.0;
        let Some(step) = steps(&[1.0, 2.0, 5.0]).find(|step| *step >= about) else {
            return Vec::new();
        };
        let first = (self.low / step).ceil();
        (0..=5u8)
            .map(|index| (first + f64::from(index)) * step)
            .take_while(|tick| *tick <= self.high)
            .collect()
    }
}

/// The mantissas times all powers of ten, from small to large.
fn steps(mantissas: &[f64]) -> impl Iterator<Item = f64> {
    (-307..308).flat_map(move |exponent| {
        mantissas
            .iter()
            .map(move |mantissa| mantissa * 10f64.powi(exponent))
    })
}

fn ends(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values.fold(None, |ends, value| {
        let (low, high) = ends.unwrap_or((value, value));
        Some((low.min(value), high.max(value)))
    })
}

#[cfg(test)]
mod tests {
    use super::super::format::short;
    use super::*;

    fn labels(domain: Option<Domain>) -> Vec<String> {
        domain
            .expect("a domain")
            .ticks()
            .into_iter()
            .map(short)
            .collect()
    }

    #[test]
    fn a_long_logarithmic_axis_has_ticks_at_decades() {
        let ticks = labels(Domain::logarithmic([0.9, 2e4]));
        assert_eq!(ticks, ["1", "10", "100", "1000", "10\u{202f}000"]);
        assert!(
            labels(Domain::logarithmic([1e-9, 1e12])).len() <= MOST_DECADES,
            "not all decades"
        );
    }

    #[test]
    fn a_short_logarithmic_axis_has_ticks_between_decades() {
        assert_eq!(
            labels(Domain::logarithmic([1.1, 21.0])),
            ["1", "2", "5", "10", "20"]
        );
        assert_eq!(
            labels(Domain::logarithmic([3.0, 4.0])),
            ["2.5", "3", "3.5", "4", "4.5"]
        );
    }

    #[test]
    fn a_linear_axis_begins_at_zero() {
        let ticks = labels(Domain::from_zero([87.0, 12.0]));
        assert_eq!(ticks, ["0", "20", "40", "60", "80"]);
    }

    #[test]
    fn every_axis_has_at_least_two_ticks() {
        for low in [1e-300, 1.3e-5, 0.7, 1.0, 9.9, 4e7, 1e299] {
            for factor in [1.0, 1.01, 1.7, 2.9, 9.0, 40.0, 1e7] {
                let domain = Domain::logarithmic([low, low * factor]).expect("positive");
                let ticks = domain.ticks();
                assert!((2..=10).contains(&ticks.len()), "{low} {factor}: {ticks:?}");
                assert!(ticks.is_sorted(), "{ticks:?}");
            }
        }
    }

    #[test]
    fn values_without_a_place_have_none() {
        let domain = Domain::logarithmic([f64::NAN, 0.0, -3.0, 1.0, 10.0]).expect("positive");
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0, -1.0] {
            assert_eq!(domain.fraction(value), None);
        }
        assert_eq!(Domain::logarithmic([f64::NAN, 0.0, -1.0]), None);
        assert_eq!(Domain::from_zero([0.0, f64::INFINITY]), None);
        let middle = domain.fraction(10f64.sqrt()).expect("on the axis");
        assert!((middle - 0.5).abs() < 1e-12, "{middle}");
    }
}
