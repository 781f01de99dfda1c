//! Arithmetic on f64: one number at a time, or four. What is written for [`Doubles`] gives the same bits for both, and at every level.

use super::Simd;

/// Operations on f64, each rounded once.
pub trait Doubles: Copy {
    /// One number or four.
    type F64s: Copy;

    /// The same number in all lanes.
    fn splat_f64(self, value: f64) -> Self::F64s;
    /// `a + b`
    fn add_f64(self, a: Self::F64s, b: Self::F64s) -> Self::F64s;
    /// `a - b`
    fn sub_f64(self, a: Self::F64s, b: Self::F64s) -> Self::F64s;
    /// `a * b`
    fn mul_f64(self, a: Self::F64s, b: Self::F64s) -> Self::F64s;
    /// `a / b`
    fn div_f64(self, a: Self::F64s, b: Self::F64s) -> Self::F64s;
    /// The magnitudes.
    fn abs_f64(self, a: Self::F64s) -> Self::F64s;
}

/// One number at a time.
#[derive(Clone, Copy, Debug)]
pub struct Scalar;

impl Doubles for Scalar {
    type F64s = f64;

    #[inline(always)]
    fn splat_f64(self, value: f64) -> f64 {
        value
    }
    #[inline(always)]
    fn add_f64(self, a: f64, b: f64) -> f64 {
        a + b
    }
    #[inline(always)]
    fn sub_f64(self, a: f64, b: f64) -> f64 {
        a - b
    }
    #[inline(always)]
    fn mul_f64(self, a: f64, b: f64) -> f64 {
        a * b
    }
    #[inline(always)]
    fn div_f64(self, a: f64, b: f64) -> f64 {
        a / b
    }
    #[inline(always)]
    fn abs_f64(self, a: f64) -> f64 {
        a.abs()
    }
}

/// Vectors of three components, of the first or the last four lanes.
pub(crate) type Halves<S> = [[<S as Doubles>::F64s; 3]; 2];

/// The components of vectors, as f64.
#[inline(always)]
pub(crate) fn widen_all<S: Simd>(simd: S, [x, y, z]: [S::F32s; 3]) -> Halves<S> {
    let [[x, u], [y, v], [z, w]] = [simd.widen(x), simd.widen(y), simd.widen(z)];
    [[x, y, z], [u, v, w]]
}

#[cfg(test)]
mod tests;
