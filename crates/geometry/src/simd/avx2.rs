//! AVX2 and FMA of x86-64: eight lanes, masks in vectors.

#![allow(
    unsafe_code,
    reason = "intrinsics, with the proof that the processor has them"
)]

use std::arch::x86_64::*;

use super::x86::{eight_floats, four_doubles, intrinsic, level};
use super::{Doubles, LANES, Lanes, Simd, WithSimd};

level!(
    /// Shows that the processor has AVX2 and FMA.
    Avx2: "avx2", "fma", "bmi1", "bmi2", "lzcnt", "popcnt"
);

impl Doubles for Avx2 {
    four_doubles!();
}

impl Simd for Avx2 {
    eight_floats!();

    type Mask = __m256;

    #[inline(always)]
    fn lt(self, a: __m256, b: __m256) -> __m256 {
        intrinsic!(_mm256_cmp_ps::<_CMP_LT_OQ>(a, b))
    }
    #[inline(always)]
    fn le(self, a: __m256, b: __m256) -> __m256 {
        intrinsic!(_mm256_cmp_ps::<_CMP_LE_OQ>(a, b))
    }
    #[inline(always)]
    fn and(self, a: __m256, b: __m256) -> __m256 {
        intrinsic!(_mm256_and_ps(a, b))
    }
    #[inline(always)]
    fn or(self, a: __m256, b: __m256) -> __m256 {
        intrinsic!(_mm256_or_ps(a, b))
    }
    #[inline(always)]
    fn select(self, mask: __m256, a: __m256, b: __m256) -> __m256 {
        intrinsic!(_mm256_blendv_ps(b, a, mask))
    }
    #[inline(always)]
    fn bits(self, mask: __m256) -> u32 {
        self.sign_bits(mask)
    }
}
