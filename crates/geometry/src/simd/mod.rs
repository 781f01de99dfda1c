//! Eight f32 lanes at a time, and four of f64, on whatever the processor has.
//!
//! An algorithm is written once, generic over [`Simd`], as a [`WithSimd`]. [`AvailableSimd::dispatch`] compiles it for every level, each
//! inside one function that may use the level's instructions. A value of a level's type exists only where the processor has its
//! instructions, so calling its operations is safe.
//!
//! **Equal bits.** Every operation but [`mul_add`](Simd::mul_add) and its relatives is defined to the last bit, NaN and signed zeros
//! included, and the same at every level. Those may round once or twice: they are for filters, whose bounds allow both.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod doubles;
mod portable;
#[cfg(target_arch = "x86_64")]
mod x86;

#[cfg(target_arch = "x86_64")]
pub use avx2::Avx2;
#[cfg(target_arch = "x86_64")]
pub use avx512::Avx512;
pub(crate) use doubles::widen_all;
pub use doubles::{Doubles, Scalar};
pub use portable::Portable;

/// Lanes of a vector.
pub const LANES: usize = 8;

/// Eight numbers in memory, as vectors are loaded.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(32))]
pub struct Lanes(pub [f32; LANES]);

impl Lanes {
    /// The same number in all lanes.
    #[must_use]
    pub const fn splat(value: f32) -> Self {
        Self([value; LANES])
    }
}

/// The numbers of the bits that are set, from the lowest on.
#[inline(always)]
pub fn bits_of(mut mask: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let bit = mask.trailing_zeros();
        (mask != 0).then(|| {
            mask &= mask - 1;
            bit as usize
        })
    })
}

/// The numbers of the bits that are set, all below 8.
#[inline(always)]
pub(crate) fn lanes_of(bits: u32) -> impl Iterator<Item = usize> {
    // Says that lanes are in range.
    bits_of(u64::from(bits)).map(|lane| lane % LANES)
}

/// The operations of a level; those on f64 take four lanes.
pub trait Simd: Doubles {
    /// Eight numbers.
    type F32s: Copy;
    /// Eight truth values.
    type Mask: Copy;

    /// The same number in all lanes.
    fn splat(self, value: f32) -> Self::F32s;
    /// The numbers in memory.
    fn load(self, lanes: &Lanes) -> Self::F32s;
    /// Small whole numbers in memory, as floating-point numbers.
    fn load_u8(self, numbers: &[u8; LANES]) -> Self::F32s;
    /// Puts the numbers into memory.
    fn store(self, value: Self::F32s) -> Lanes;
    /// The first four numbers in the lower lanes, the others in the upper ones.
    fn halves(self, lower: [f32; LANES / 2], upper: [f32; LANES / 2]) -> Self::F32s;
    /// The four lower lanes, and the four upper ones.
    fn to_halves(self, value: Self::F32s) -> [[f32; LANES / 2]; 2];

    /// `a + b`
    fn add(self, a: Self::F32s, b: Self::F32s) -> Self::F32s;
    /// `a - b`
    fn sub(self, a: Self::F32s, b: Self::F32s) -> Self::F32s;
    /// `a * b`
    fn mul(self, a: Self::F32s, b: Self::F32s) -> Self::F32s;
    /// `a / b`
    fn div(self, a: Self::F32s, b: Self::F32s) -> Self::F32s;
    /// `a * b + c`, rounded once or twice.
    fn mul_add(self, a: Self::F32s, b: Self::F32s, c: Self::F32s) -> Self::F32s;
    /// `a * b - c`, rounded once or twice.
    fn mul_sub(self, a: Self::F32s, b: Self::F32s, c: Self::F32s) -> Self::F32s;
    /// `c - a * b`, rounded once or twice.
    fn neg_mul_add(self, a: Self::F32s, b: Self::F32s, c: Self::F32s) -> Self::F32s;
    /// `a` where it is smaller than `b`, otherwise `b`: also where one of them is NaN, or both are zero.
    fn min(self, a: Self::F32s, b: Self::F32s) -> Self::F32s;
    /// `a` where it is larger than `b`, otherwise `b`: also where one of them is NaN, or both are zero.
    fn max(self, a: Self::F32s, b: Self::F32s) -> Self::F32s;
    /// The magnitudes.
    fn abs(self, a: Self::F32s) -> Self::F32s;

    /// `a < b`; false where one of them is NaN.
    fn lt(self, a: Self::F32s, b: Self::F32s) -> Self::Mask;
    /// `a <= b`; false where one of them is NaN.
    fn le(self, a: Self::F32s, b: Self::F32s) -> Self::Mask;
    /// Where both are true.
    fn and(self, a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// Where at least one is true.
    fn or(self, a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// `a` where the mask is true, otherwise `b`.
    fn select(self, mask: Self::Mask, a: Self::F32s, b: Self::F32s) -> Self::F32s;
    /// Bit `i` for lane `i`.
    fn bits(self, mask: Self::Mask) -> u32;

    /// The sign bits: bit `i` for lane `i`. Set for -0.0.
    fn sign_bits(self, a: Self::F32s) -> u32;

    /// Lane `i` of vector `j` becomes lane `j` of vector `i`.
    fn transpose(self, rows: [Self::F32s; LANES]) -> [Self::F32s; LANES];

    /// The first four lanes and the last, as f64.
    fn widen(self, a: Self::F32s) -> [Self::F64s; 2];
    /// The nearest f32.
    fn narrow(self, halves: [Self::F64s; 2]) -> Self::F32s;
    /// Four numbers as f64.
    fn widen_four(self, numbers: [f32; LANES / 2]) -> Self::F64s;
    /// Lanes 1, 2 and 0 of four. The last one means nothing.
    fn rotate_three(self, a: Self::F64s) -> Self::F64s;
    /// For each row the sum of its first three numbers, in their order.
    fn sums_of_three(self, rows: [Self::F64s; 4]) -> [f64; 4];
    /// The sign bits of the first four lanes and the last: bit `i` for lane `i`. Set for -0.0.
    fn sign_bits_f64(self, halves: [Self::F64s; 2]) -> u32;

    /// Runs a part of an algorithm in a function of its own: what it keeps in registers is not mixed with the rest.
    fn outline<T: WithSimd>(self, algorithm: T) -> T::Output;

    /// Asks for some bytes of memory that are soon needed, where the processor can be asked. The address may be any.
    fn prefetch(self, _place: *const u8, _bytes: usize) {}
}

/// An algorithm that is compiled for every level.
pub trait WithSimd {
    /// Its result.
    type Output;

    /// The algorithm. To be marked `#[inline(always)]`, as all of the vector code that it calls: what is not inlined is compiled without the
    /// instructions of the level.
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output;
}

/// A set of instructions that queries can use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum SimdLevel {
    /// Whatever every processor of the architecture has.
    Portable,
    /// AVX2 and FMA of x86-64.
    Avx2,
    /// AVX-512 of x86-64: F, VL, DQ and BW.
    Avx512,
}

impl SimdLevel {
    /// All levels, from the simplest on.
    pub const ALL: [Self; 3] = [Self::Portable, Self::Avx2, Self::Avx512];

    /// The name in reports and on command lines: `portable`, `avx2` or `avx512`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Portable => "portable",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }

    /// Whether this processor has the level.
    #[must_use]
    pub fn is_available(self) -> bool {
        self.available().is_some()
    }

    /// The level, if this processor has it.
    #[must_use]
    pub fn available(self) -> Option<AvailableSimd> {
        match self {
            Self::Portable => Some(AvailableSimd(Available::Portable)),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => Avx2::new().map(|simd| AvailableSimd(Available::Avx2(simd))),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => Avx512::new().map(|simd| AvailableSimd(Available::Avx512(simd))),
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx2 | Self::Avx512 => None,
        }
    }
}

/// A level that this processor has: made once, it dispatches without another look at the processor.
#[derive(Clone, Copy, Debug)]
pub struct AvailableSimd(Available);

#[derive(Clone, Copy, Debug)]
enum Available {
    Portable,
    #[cfg(target_arch = "x86_64")]
    Avx2(Avx2),
    #[cfg(target_arch = "x86_64")]
    Avx512(Avx512),
}

impl AvailableSimd {
    /// The best level that this processor has.
    #[must_use]
    pub fn best() -> Self {
        let mut available = SimdLevel::ALL.into_iter().filter_map(SimdLevel::available);
        available.next_back().unwrap_or(Self(Available::Portable))
    }

    /// Which level it is.
    #[must_use]
    pub const fn level(self) -> SimdLevel {
        match self.0 {
            Available::Portable => SimdLevel::Portable,
            #[cfg(target_arch = "x86_64")]
            Available::Avx2(_) => SimdLevel::Avx2,
            #[cfg(target_arch = "x86_64")]
            Available::Avx512(_) => SimdLevel::Avx512,
        }
    }

    /// Runs an algorithm at this level.
    #[inline]
    pub fn dispatch<T: WithSimd>(self, algorithm: T) -> T::Output {
        match self.0 {
            Available::Portable => Portable.run(algorithm),
            #[cfg(target_arch = "x86_64")]
            Available::Avx2(simd) => simd.run(algorithm),
            #[cfg(target_arch = "x86_64")]
            Available::Avx512(simd) => simd.run(algorithm),
        }
    }
}

#[cfg(test)]
mod tests;
