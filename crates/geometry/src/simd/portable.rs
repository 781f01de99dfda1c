//! The level of every processor: arrays, which the compiler turns into what vectors the architecture is sure to have.

use super::{Doubles, LANES, Lanes, Simd, WithSimd};

/// The level that every processor has.
#[derive(Clone, Copy, Debug)]
pub struct Portable;

impl Portable {
    /// Runs an algorithm in a function of its own: what it needs of the stack is not to be had by a caller that chooses another level.
    #[inline(never)]
    pub fn run<T: WithSimd>(self, algorithm: T) -> T::Output {
        algorithm.with_simd(self)
    }
}

#[inline(always)]
fn map<const N: usize, T: Copy, R>(a: [T; N], b: [T; N], operation: impl Fn(T, T) -> R) -> [R; N] {
    std::array::from_fn(|lane| operation(a[lane], b[lane]))
}

impl Doubles for Portable {
    type F64s = [f64; LANES / 2];

    #[inline(always)]
    fn splat_f64(self, value: f64) -> Self::F64s {
        [value; LANES / 2]
    }
    #[inline(always)]
    fn add_f64(self, a: Self::F64s, b: Self::F64s) -> Self::F64s {
        map(a, b, |a, b| a + b)
    }
    #[inline(always)]
    fn sub_f64(self, a: Self::F64s, b: Self::F64s) -> Self::F64s {
        map(a, b, |a, b| a - b)
    }
    #[inline(always)]
    fn mul_f64(self, a: Self::F64s, b: Self::F64s) -> Self::F64s {
        map(a, b, |a, b| a * b)
    }
    #[inline(always)]
    fn div_f64(self, a: Self::F64s, b: Self::F64s) -> Self::F64s {
        map(a, b, |a, b| a / b)
    }
    #[inline(always)]
    fn abs_f64(self, a: Self::F64s) -> Self::F64s {
        a.map(f64::abs)
    }
}

impl Simd for Portable {
    type F32s = [f32; LANES];
    type Mask = [bool; LANES];

    #[inline(always)]
    fn splat(self, value: f32) -> Self::F32s {
        [value; LANES]
    }
    #[inline(always)]
    fn load(self, lanes: &Lanes) -> Self::F32s {
        lanes.0
    }
    #[inline(always)]
    fn load_u8(self, numbers: &[u8; LANES]) -> Self::F32s {
        numbers.map(f32::from)
    }
    #[inline(always)]
    fn store(self, value: Self::F32s) -> Lanes {
        Lanes(value)
    }
    #[inline(always)]
    fn halves(self, [a, b, c, d]: [f32; 4], [e, f, g, h]: [f32; 4]) -> Self::F32s {
        [a, b, c, d, e, f, g, h]
    }
    #[inline(always)]
    fn to_halves(self, [a, b, c, d, e, f, g, h]: Self::F32s) -> [[f32; 4]; 2] {
        [[a, b, c, d], [e, f, g, h]]
    }
    #[inline(always)]
    fn add(self, a: Self::F32s, b: Self::F32s) -> Self::F32s {
        map(a, b, |a, b| a + b)
    }
    #[inline(always)]
    fn sub(self, a: Self::F32s, b: Self::F32s) -> Self::F32s {
        map(a, b, |a, b| a - b)
    }
    #[inline(always)]
    fn mul(self, a: Self::F32s, b: Self::F32s) -> Self::F32s {
        map(a, b, |a, b| a * b)
    }
    #[inline(always)]
    fn div(self, a: Self::F32s, b: Self::F32s) -> Self::F32s {
        map(a, b, |a, b| a / b)
    }
    // Not `f32::mul_add`: without the instruction that is a call into a library.
    #[inline(always)]
    fn mul_add(self, a: Self::F32s, b: Self::F32s, c: Self::F32s) -> Self::F32s {
        self.add(self.mul(a, b), c)
    }
    #[inline(always)]
    fn mul_sub(self, a: Self::F32s, b: Self::F32s, c: Self::F32s) -> Self::F32s {
        self.sub(self.mul(a, b), c)
    }
    #[inline(always)]
    fn neg_mul_add(self, a: Self::F32s, b: Self::F32s, c: Self::F32s) -> Self::F32s {
        self.sub(c, self.mul(a, b))
    }
    #[inline(always)]
    fn min(self, a: Self::F32s, b: Self::F32s) -> Self::F32s {
        map(a, b, |a, b| if a < b { a } else { b })
    }
    #[inline(always)]
    fn max(self, a: Self::F32s, b: Self::F32s) -> Self::F32s {
        map(a, b, |a, b| if a > b { a } else { b })
    }
    #[inline(always)]
    fn abs(self, a: Self::F32s) -> Self::F32s {
        a.map(f32::abs)
    }
    #[inline(always)]
    fn lt(self, a: Self::F32s, b: Self::F32s) -> Self::Mask {
        map(a, b, |a, b| a < b)
    }
    #[inline(always)]
    fn le(self, a: Self::F32s, b: Self::F32s) -> Self::Mask {
        map(a, b, |a, b| a <= b)
    }
    #[inline(always)]
    fn and(self, a: Self::Mask, b: Self::Mask) -> Self::Mask {
        map(a, b, |a, b| a & b)
    }
    #[inline(always)]
    fn or(self, a: Self::Mask, b: Self::Mask) -> Self::Mask {
        map(a, b, |a, b| a | b)
    }
    #[inline(always)]
    fn select(self, mask: Self::Mask, a: Self::F32s, b: Self::F32s) -> Self::F32s {
        std::array::from_fn(|lane| if mask[lane] { a[lane] } else { b[lane] })
    }
    #[inline(always)]
    fn bits(self, mask: Self::Mask) -> u32 {
        let lanes = mask.into_iter().enumerate();
        lanes.fold(0, |bits, (lane, is_set)| bits | u32::from(is_set) << lane)
    }
    #[inline(always)]
    fn sign_bits(self, a: Self::F32s) -> u32 {
        self.bits(a.map(f32::is_sign_negative))
    }
    #[inline(always)]
    fn transpose(self, rows: [Self::F32s; LANES]) -> [Self::F32s; LANES] {
        std::array::from_fn(|lane| rows.map(|row| row[lane]))
    }
    #[inline(always)]
    fn widen(self, [a, b, c, d, e, f, g, h]: Self::F32s) -> [Self::F64s; 2] {
        [[a, b, c, d], [e, f, g, h]].map(|half| half.map(f64::from))
    }
    #[inline(always)]
    fn narrow(self, halves: [Self::F64s; 2]) -> Self::F32s {
        #[expect(clippy::cast_possible_truncation, reason = "rounds to the nearest f32")]
        let [[a, b, c, d], [e, f, g, h]] = halves.map(|half| half.map(|number| number as f32));
        [a, b, c, d, e, f, g, h]
    }
    #[inline(always)]
    fn sign_bits_f64(self, halves: [Self::F64s; 2]) -> u32 {
        let lanes = halves.into_iter().flatten().enumerate();
        lanes.fold(0, |bits, (lane, number)| {
            bits | u32::from(number.is_sign_negative()) << lane
        })
    }
    #[inline(always)]
    fn outline<T: WithSimd>(self, algorithm: T) -> T::Output {
        outlined(algorithm)
    }
}

#[inline(never)]
fn outlined<T: WithSimd>(algorithm: T) -> T::Output {
    algorithm.with_simd(Portable)
}
