//! AVX2 and FMA of x86-64.

#![allow(
    unsafe_code,
    reason = "intrinsics, with the proof that the processor has them"
)]

use std::arch::x86_64::*;
use std::mem::MaybeUninit;

use super::{LANES, Lanes, Simd, WithSimd};

/// Shows that the processor has AVX2 and FMA.
#[derive(Clone, Copy, Debug)]
pub struct Avx2(());

impl Avx2 {
    /// The level, if the processor has it. Cheap: the processor was asked once.
    #[inline]
    #[must_use]
    pub fn new() -> Option<Self> {
        let has = is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("fma")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2")
            && is_x86_feature_detected!("lzcnt")
            && is_x86_feature_detected!("popcnt");
        has.then_some(Self(()))
    }

    /// Runs an algorithm compiled with the instructions of the level.
    #[inline]
    pub fn run<T: WithSimd>(self, algorithm: T) -> T::Output {
        // SAFETY: a value of this type exists only where the processor has these features.
        unsafe { run(self, algorithm) }
    }
}

#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn run<T: WithSimd>(simd: Avx2, algorithm: T) -> T::Output {
    algorithm.with_simd(simd)
}

/// A function without features of its own, which cannot be inlined: of one with features the compiler heeds no `inline(never)`.
#[inline(never)]
fn outlined<T: WithSimd>(simd: Avx2, algorithm: T) -> T::Output {
    simd.run(algorithm)
}

/// Eight integers in descending order: Batcher's network, layer by layer. Each lane is compared with a partner, and keeps the larger number if it comes first;
/// without a partner it is compared with itself.
///
/// Source: Batcher, "Sorting networks and their applications", 1968.
#[inline]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn sort_descending(v: __m256i) -> __m256i {
    /// The larger number in the lanes that are not in the mask, the smaller one in those that are.
    macro_rules! exchange {
        ($v:ident, $partner:expr, $second:literal) => {{
            let partner = $partner;
            let larger = _mm256_max_epi32($v, partner);
            let smaller = _mm256_min_epi32($v, partner);
            _mm256_blend_epi32::<$second>(larger, smaller)
        }};
    }
    let v = exchange!(v, _mm256_shuffle_epi32::<0b10_11_00_01>(v), 0b1010_1010);
    let v = exchange!(v, _mm256_shuffle_epi32::<0b01_00_11_10>(v), 0b1100_1100);
    let v = exchange!(v, _mm256_shuffle_epi32::<0b11_01_10_00>(v), 0b0100_0100);
    let v = exchange!(v, _mm256_permute4x64_epi64::<0b01_00_11_10>(v), 0b1111_0000);
    let v = exchange!(v, _mm256_permute4x64_epi64::<0b11_01_10_00>(v), 0b0011_0000);
    let partners = _mm256_setr_epi32(0, 2, 1, 4, 3, 6, 5, 7);
    exchange!(v, _mm256_permutevar8x32_epi32(v, partners), 0b0101_0100)
}

/// Calls an intrinsic of the level.
macro_rules! intrinsic {
    ($call:expr) => {
        // SAFETY: the method has a value of this type, so the processor has AVX2 and FMA. No intrinsic here has further obligations but
        // loads and stores, which are given aligned memory of the right size.
        unsafe { $call }
    };
}

impl Simd for Avx2 {
    type F32s = __m256;
    type Mask = __m256;

    #[inline(always)]
    fn splat(self, value: f32) -> __m256 {
        intrinsic!(_mm256_set1_ps(value))
    }
    #[inline(always)]
    fn load(self, lanes: &Lanes) -> __m256 {
        intrinsic!(_mm256_load_ps(lanes.0.as_ptr()))
    }
    #[inline(always)]
    fn store(self, value: __m256) -> Lanes {
        let mut lanes = Lanes::splat(0.0);
        intrinsic!(_mm256_store_ps(lanes.0.as_mut_ptr(), value));
        lanes
    }
    #[inline(always)]
    fn add(self, a: __m256, b: __m256) -> __m256 {
        intrinsic!(_mm256_add_ps(a, b))
    }
    #[inline(always)]
    fn sub(self, a: __m256, b: __m256) -> __m256 {
        intrinsic!(_mm256_sub_ps(a, b))
    }
    #[inline(always)]
    fn mul(self, a: __m256, b: __m256) -> __m256 {
        intrinsic!(_mm256_mul_ps(a, b))
    }
    #[inline(always)]
    fn div(self, a: __m256, b: __m256) -> __m256 {
        intrinsic!(_mm256_div_ps(a, b))
    }
    #[inline(always)]
    fn mul_add(self, a: __m256, b: __m256, c: __m256) -> __m256 {
        intrinsic!(_mm256_fmadd_ps(a, b, c))
    }
    #[inline(always)]
    fn mul_sub(self, a: __m256, b: __m256, c: __m256) -> __m256 {
        intrinsic!(_mm256_fmsub_ps(a, b, c))
    }
    #[inline(always)]
    fn neg_mul_add(self, a: __m256, b: __m256, c: __m256) -> __m256 {
        intrinsic!(_mm256_fnmadd_ps(a, b, c))
    }
    #[inline(always)]
    fn min(self, a: __m256, b: __m256) -> __m256 {
        intrinsic!(_mm256_min_ps(a, b))
    }
    #[inline(always)]
    fn max(self, a: __m256, b: __m256) -> __m256 {
        intrinsic!(_mm256_max_ps(a, b))
    }
    #[inline(always)]
    fn abs(self, a: __m256) -> __m256 {
        intrinsic!(_mm256_andnot_ps(_mm256_set1_ps(-0.0), a))
    }
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
    #[expect(clippy::cast_sign_loss, reason = "the lowest eight bits")]
    fn bits(self, mask: __m256) -> u32 {
        intrinsic!(_mm256_movemask_ps(mask)) as u32
    }
    #[inline(always)]
    fn write_sorted(
        self,
        keys: __m256,
        mask: __m256,
        items: &[u32; LANES],
        target: &mut [MaybeUninit<u64>; LANES],
    ) -> usize {
        // SAFETY: as for the other intrinsics; the loads and stores are unaligned ones of 32 bytes each, in arrays of 32 and 64 bytes.
        unsafe {
            // The lane's number in the lowest bits of the key goes with it; lanes that are not in the mask have the smallest key.
            let lanes = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
            let numbered = _mm256_or_si256(
                _mm256_andnot_si256(_mm256_set1_epi32(7), _mm256_castps_si256(keys)),
                lanes,
            );
            let unused = _mm256_or_si256(_mm256_set1_epi32(i32::MIN), lanes);
            let order = _mm256_blendv_ps(
                _mm256_castsi256_ps(unused),
                _mm256_castsi256_ps(numbered),
                mask,
            );
            let sorted = sort_descending(_mm256_castps_si256(order));
            // In the order in which the halves of a register are interleaved below.
            let places = _mm256_permute4x64_epi64::<0b11_01_10_00>(sorted);
            let items = _mm256_loadu_si256(items.as_ptr().cast());
            let items = _mm256_permutevar8x32_epi32(items, places);
            let keys = _mm256_permutevar8x32_epi32(_mm256_castps_si256(keys), places);
            let target = target.as_mut_ptr().cast::<__m256i>();
            _mm256_storeu_si256(target, _mm256_unpacklo_epi32(items, keys));
            _mm256_storeu_si256(target.add(1), _mm256_unpackhi_epi32(items, keys));
        }
        self.bits(mask).count_ones() as usize
    }
    #[inline(always)]
    fn outline<T: WithSimd>(self, algorithm: T) -> T::Output {
        outlined(self, algorithm)
    }
    #[inline(always)]
    fn prefetch<T>(self, place: &T) {
        let lines = size_of::<T>().div_ceil(64);
        for line in 0..lines {
            let line = std::ptr::from_ref(place)
                .cast::<i8>()
                .wrapping_add(64 * line);
            intrinsic!(_mm_prefetch::<_MM_HINT_T0>(line));
        }
    }
}
