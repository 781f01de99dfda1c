//! What the levels of x86-64 have in common: vectors of 256 bits.

/// Calls intrinsics of a level, in a method of a value that shows that the processor has it.
macro_rules! intrinsic {
    ($call:expr) => {
        // SAFETY: the method has a value of the level's type, so the processor has its instructions. No intrinsic here has further obligations but
        // loads and stores, which are given memory of the right size, aligned where they want it: that of bytes need not be.
        unsafe { $call }
    };
}

/// The type that shows that the processor has some instructions, and the functions that use them.
macro_rules! level {
    ($(#[$documentation:meta])* $level:ident: $($feature:tt),+) => {
        $(#[$documentation])*
        #[derive(Clone, Copy, Debug)]
        pub struct $level(());

        impl $level {
            /// The level, if the processor has it. Cheap: the processor was asked once.
            #[inline]
            #[must_use]
            pub fn new() -> Option<Self> {
                let has = $(is_x86_feature_detected!($feature))&&+;
                has.then_some(Self(()))
            }

            /// Runs an algorithm compiled with the instructions of the level.
            #[inline]
            pub fn run<T: WithSimd>(self, algorithm: T) -> T::Output {
                // SAFETY: a value of this type exists only where the processor has these features.
                unsafe { run(self, algorithm) }
            }
        }

        $(#[target_feature(enable = $feature)])+
        fn run<T: WithSimd>(simd: $level, algorithm: T) -> T::Output {
            algorithm.with_simd(simd)
        }

        /// A function without features of its own, which cannot be inlined: of one with features the compiler heeds no `inline(never)`.
        #[inline(never)]
        fn outlined<T: WithSimd>(simd: $level, algorithm: T) -> T::Output {
            simd.run(algorithm)
        }
    };
}

/// The operations on four f64.
macro_rules! four_doubles {
    () => {
        type F64s = __m256d;

        #[inline(always)]
        fn splat_f64(self, value: f64) -> __m256d {
            intrinsic!(_mm256_set1_pd(value))
        }
        #[inline(always)]
        fn add_f64(self, a: __m256d, b: __m256d) -> __m256d {
            intrinsic!(_mm256_add_pd(a, b))
        }
        #[inline(always)]
        fn sub_f64(self, a: __m256d, b: __m256d) -> __m256d {
            intrinsic!(_mm256_sub_pd(a, b))
        }
        #[inline(always)]
        fn mul_f64(self, a: __m256d, b: __m256d) -> __m256d {
            intrinsic!(_mm256_mul_pd(a, b))
        }
        #[inline(always)]
        fn div_f64(self, a: __m256d, b: __m256d) -> __m256d {
            intrinsic!(_mm256_div_pd(a, b))
        }
        #[inline(always)]
        fn abs_f64(self, a: __m256d) -> __m256d {
            intrinsic!(_mm256_andnot_pd(_mm256_set1_pd(-0.0), a))
        }
    };
}

/// The operations on eight f32 that have nothing to do with masks.
macro_rules! eight_floats {
    () => {
        type F32s = __m256;

        #[inline(always)]
        fn splat(self, value: f32) -> __m256 {
            intrinsic!(_mm256_set1_ps(value))
        }
        #[inline(always)]
        fn load(self, lanes: &Lanes) -> __m256 {
            intrinsic!(_mm256_load_ps(lanes.0.as_ptr()))
        }
        #[inline(always)]
        fn load_u8(self, numbers: &[u8; LANES]) -> __m256 {
            intrinsic!(_mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(_mm_loadl_epi64(
                numbers.as_ptr().cast()
            ))))
        }
        #[inline(always)]
        fn store(self, value: __m256) -> Lanes {
            let mut lanes = Lanes::splat(0.0);
            intrinsic!(_mm256_store_ps(lanes.0.as_mut_ptr(), value));
            lanes
        }
        #[inline(always)]
        fn halves(self, lower: [f32; 4], upper: [f32; 4]) -> __m256 {
            intrinsic!(_mm256_set_m128(
                _mm_loadu_ps(upper.as_ptr()),
                _mm_loadu_ps(lower.as_ptr())
            ))
        }
        #[inline(always)]
        fn to_halves(self, value: __m256) -> [[f32; 4]; 2] {
            let mut halves = [[0.0; 4]; 2];
            let [lower, upper] = &mut halves;
            intrinsic!(_mm_storeu_ps(
                lower.as_mut_ptr(),
                _mm256_castps256_ps128(value)
            ));
            intrinsic!(_mm_storeu_ps(
                upper.as_mut_ptr(),
                _mm256_extractf128_ps::<1>(value)
            ));
            halves
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
        #[expect(clippy::cast_sign_loss, reason = "the lowest eight bits")]
        fn sign_bits(self, a: __m256) -> u32 {
            intrinsic!(_mm256_movemask_ps(a)) as u32
        }
        #[inline(always)]
        fn transpose(self, [a, b, c, d, e, f, g, h]: [__m256; LANES]) -> [__m256; LANES] {
            // Four rows by four columns in each half of the registers: of two rows, then of four; at last halves of registers change places.
            let two = |a, b| intrinsic!([_mm256_unpacklo_ps(a, b), _mm256_unpackhi_ps(a, b)]);
            let four = |a, b| {
                intrinsic!([
                    _mm256_shuffle_ps::<0b01_00_01_00>(a, b),
                    _mm256_shuffle_ps::<0b11_10_11_10>(a, b),
                ])
            };
            let low = |a, b| intrinsic!(_mm256_permute2f128_ps::<0x20>(a, b));
            let high = |a, b| intrinsic!(_mm256_permute2f128_ps::<0x31>(a, b));
            let ([ab, ab2], [cd, cd2]) = (two(a, b), two(c, d));
            let ([ef, ef2], [gh, gh2]) = (two(e, f), two(g, h));
            let ([p0, p1], [p2, p3]) = (four(ab, cd), four(ab2, cd2));
            let ([q0, q1], [q2, q3]) = (four(ef, gh), four(ef2, gh2));
            [
                low(p0, q0),
                low(p1, q1),
                low(p2, q2),
                low(p3, q3),
                high(p0, q0),
                high(p1, q1),
                high(p2, q2),
                high(p3, q3),
            ]
        }
        #[inline(always)]
        fn widen(self, a: __m256) -> [__m256d; 2] {
            intrinsic!([
                _mm256_cvtps_pd(_mm256_castps256_ps128(a)),
                _mm256_cvtps_pd(_mm256_extractf128_ps::<1>(a)),
            ])
        }
        #[inline(always)]
        fn narrow(self, [first, last]: [__m256d; 2]) -> __m256 {
            intrinsic!(_mm256_set_m128(
                _mm256_cvtpd_ps(last),
                _mm256_cvtpd_ps(first)
            ))
        }
        #[inline(always)]
        fn widen_four(self, numbers: [f32; LANES / 2]) -> __m256d {
            intrinsic!(_mm256_cvtps_pd(_mm_loadu_ps(numbers.as_ptr())))
        }
        #[inline(always)]
        fn rotate_three(self, a: __m256d) -> __m256d {
            intrinsic!(_mm256_permute4x64_pd::<0b11_00_10_01>(a))
        }
        #[inline(always)]
        fn sums_of_three(self, [a, b, c, d]: [__m256d; 4]) -> [f64; 4] {
            let sums_of_two = |a, b| {
                intrinsic!({
                    let (first, second) = (_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b));
                    let sums = _mm_add_pd(
                        _mm256_castpd256_pd128(first),
                        _mm256_castpd256_pd128(second),
                    );
                    let sums = _mm_add_pd(sums, _mm256_extractf128_pd::<1>(first));
                    [
                        _mm_cvtsd_f64(sums),
                        _mm_cvtsd_f64(_mm_unpackhi_pd(sums, sums)),
                    ]
                })
            };
            let ([a, b], [c, d]) = (sums_of_two(a, b), sums_of_two(c, d));
            [a, b, c, d]
        }
        #[inline(always)]
        #[expect(clippy::cast_sign_loss, reason = "the lowest four bits")]
        fn sign_bits_f64(self, [first, last]: [__m256d; 2]) -> u32 {
            intrinsic!(_mm256_movemask_pd(first) | _mm256_movemask_pd(last) << 4) as u32
        }
        #[inline(always)]
        fn outline<T: WithSimd>(self, algorithm: T) -> T::Output {
            outlined(self, algorithm)
        }
        #[inline(always)]
        fn prefetch(self, place: *const u8, bytes: usize) {
            for line in 0..bytes.div_ceil(64) {
                let line = place.wrapping_add(64 * line).cast();
                intrinsic!(_mm_prefetch::<_MM_HINT_T0>(line));
            }
        }
    };
}

pub(super) use {eight_floats, four_doubles, intrinsic, level};
