//! AVX-512 of x86-64 for vectors of eight f32: masks in registers of their own, and twice as many registers.
//!
//! Longer vectors would want sixteen children, or triangles, and slow some processors down.

#![allow(
    unsafe_code,
    reason = "intrinsics, with the proof that the processor has them"
)]

use std::arch::x86_64::*;

use super::x86::{eight_floats, four_doubles, intrinsic, level};
use super::{Doubles, LANES, Lanes, Simd, WithSimd};

level!(
    /// Shows that the processor has the foundation of AVX-512 and its extensions to vectors of 256 bits, to all lengths of integers and to masks of eight bits.
    Avx512: "avx512f", "avx512vl", "avx512dq", "avx512bw", "avx2", "fma", "bmi1", "bmi2", "lzcnt", "popcnt"
);

impl Doubles for Avx512 {
    four_doubles!();
}

impl Simd for Avx512 {
    eight_floats!();

    type Mask = __mmask8;

    #[inline(always)]
    fn lt(self, a: __m256, b: __m256) -> __mmask8 {
        intrinsic!(_mm256_cmp_ps_mask::<_CMP_LT_OQ>(a, b))
    }
    #[inline(always)]
    fn le(self, a: __m256, b: __m256) -> __mmask8 {
        intrinsic!(_mm256_cmp_ps_mask::<_CMP_LE_OQ>(a, b))
    }
    #[inline(always)]
    fn and(self, a: __mmask8, b: __mmask8) -> __mmask8 {
        a & b
    }
    #[inline(always)]
    fn or(self, a: __mmask8, b: __mmask8) -> __mmask8 {
        a | b
    }
    #[inline(always)]
    fn select(self, mask: __mmask8, a: __m256, b: __m256) -> __m256 {
        intrinsic!(_mm256_mask_blend_ps(mask, b, a))
    }
    #[inline(always)]
    fn bits(self, mask: __mmask8) -> u32 {
        u32::from(mask)
    }
}
