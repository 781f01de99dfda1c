//! The level of every processor: arrays, which the compiler turns into what vectors the architecture is sure to have.

use super::{LANES, Lanes, Simd, WithSimd};

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
fn map<T: Copy, R>(a: [T; LANES], b: [T; LANES], operation: impl Fn(T, T) -> R) -> [R; LANES] {
    std::array::from_fn(|lane| operation(a[lane], b[lane]))
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
    fn outline<T: WithSimd>(self, algorithm: T) -> T::Output {
        outlined(algorithm)
    }
}

#[inline(never)]
fn outlined<T: WithSimd>(algorithm: T) -> T::Output {
    algorithm.with_simd(Portable)
}
