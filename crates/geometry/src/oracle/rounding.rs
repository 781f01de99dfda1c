//! Between exact values of `t` and floating-point numbers.

use dashu_ratio::RBig;

/// An exact value as f32: the nearest, of two the one with an even last digit; the largest f32 instead of an infinity; and never -0.
#[must_use]
pub fn round_to_f32(exact: &RBig) -> f32 {
    exact.to_f32().value().clamp(f32::MIN, f32::MAX) + 0.0
}

/// The distance of an f32 from an exact value, in units in the last place: the spacing of the f32 numbers between those that enclose
/// the exact value. At most a half if the f32 is the nearest.
///
/// Exact values beyond the largest f32 count as that one; the distance of a NaN is infinite.
#[must_use]
pub fn error_in_ulps(t: f32, exact: &RBig) -> f64 {
    if t.is_nan() {
        return f64::INFINITY;
    }
    let largest = rational(f32::MAX);
    let exact = exact.clone().clamp(-largest.clone(), largest);
    let ulp = ulp(&exact);
    if t.is_infinite() {
        return f64::INFINITY;
    }
    ((rational(t) - exact) / ulp).to_f64().value().abs()
}

/// A number of f64 that is at least the exact one.
pub(super) fn upper_bound(exact: &RBig) -> f64 {
    exact.to_f64().value().next_up()
}

/// The spacing of the f32 numbers around a value that is not beyond the largest.
fn ulp(exact: &RBig) -> RBig {
    let magnitude = if *exact < RBig::ZERO {
        -exact.clone()
    } else {
        exact.clone()
    };
    let nearest = magnitude.to_f32().value();
    let below = if rational(nearest) > magnitude {
        nearest.next_down()
    } else {
        nearest.min(f32::MAX.next_down())
    };
    rational(below.next_up()) - rational(below)
}

/// The value of a finite number.
fn rational(value: f32) -> RBig {
    RBig::try_from(value).expect("the number is finite")
}
