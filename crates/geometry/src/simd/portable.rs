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

/// An array of what the expression gives for each lane, written out. Functions of arrays that take a closure are several functions deep: here, where every operation of every search
/// is made of them, they take the compiler long, and a build with little optimisation calls them lane by lane.
macro_rules! each {
    ([$($number:literal)*] $lane:ident => $value:expr) => {
        [$({
            let $lane: usize = $number;
            $value
        }),*]
    };
}

macro_rules! four {
    ($lane:ident => $value:expr) => { each!([0 1 2 3] $lane => $value) };
}

macro_rules! eight {
    ($lane:ident => $value:expr) => { each!([0 1 2 3 4 5 6 7] $lane => $value) };
}

/// The lowest bits, from lane 0 on.
#[inline(always)]
fn bits_of([a, b, c, d, e, f, g, h]: [u32; LANES]) -> u32 {
    a | b << 1 | c << 2 | d << 3 | e << 4 | f << 5 | g << 6 | h << 7
}

impl Doubles for Portable {
    type F64s = [f64; LANES / 2];

    #[inline(always)]
    fn splat_f64(self, value: f64) -> Self::F64s {
        [value; LANES / 2]
    }
    #[inline(always)]
    fn add_f64(self, a: Self::F64s, b: Self::F64s) -> Self::F64s {
        four!(lane => a[lane] + b[lane])
    }
    #[inline(always)]
    fn sub_f64(self, a: Self::F64s, b: Self::F64s) -> Self::F64s {
        four!(lane => a[lane] - b[lane])
    }
    #[inline(always)]
    fn mul_f64(self, a: Self::F64s, b: Self::F64s) -> Self::F64s {
        four!(lane => a[lane] * b[lane])
    }
    #[inline(always)]
    fn div_f64(self, a: Self::F64s, b: Self::F64s) -> Self::F64s {
        four!(lane => a[lane] / b[lane])
    }
    #[inline(always)]
    fn abs_f64(self, a: Self::F64s) -> Self::F64s {
        four!(lane => a[lane].abs())
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
        eight!(lane => f32::from(numbers[lane]))
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
        eight!(lane => a[lane] + b[lane])
    }
    #[inline(always)]
    fn sub(self, a: Self::F32s, b: Self::F32s) -> Self::F32s {
        eight!(lane => a[lane] - b[lane])
    }
    #[inline(always)]
    fn mul(self, a: Self::F32s, b: Self::F32s) -> Self::F32s {
        eight!(lane => a[lane] * b[lane])
    }
    #[inline(always)]
    fn div(self, a: Self::F32s, b: Self::F32s) -> Self::F32s {
        eight!(lane => a[lane] / b[lane])
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
        eight!(lane => if a[lane] < b[lane] { a[lane] } else { b[lane] })
    }
    #[inline(always)]
    fn max(self, a: Self::F32s, b: Self::F32s) -> Self::F32s {
        eight!(lane => if a[lane] > b[lane] { a[lane] } else { b[lane] })
    }
    #[inline(always)]
    fn abs(self, a: Self::F32s) -> Self::F32s {
        eight!(lane => a[lane].abs())
    }
    #[inline(always)]
    fn lt(self, a: Self::F32s, b: Self::F32s) -> Self::Mask {
        eight!(lane => a[lane] < b[lane])
    }
    #[inline(always)]
    fn le(self, a: Self::F32s, b: Self::F32s) -> Self::Mask {
        eight!(lane => a[lane] <= b[lane])
    }
    #[inline(always)]
    fn and(self, a: Self::Mask, b: Self::Mask) -> Self::Mask {
        eight!(lane => a[lane] & b[lane])
    }
    #[inline(always)]
    fn or(self, a: Self::Mask, b: Self::Mask) -> Self::Mask {
        eight!(lane => a[lane] | b[lane])
    }
    #[inline(always)]
    fn select(self, mask: Self::Mask, a: Self::F32s, b: Self::F32s) -> Self::F32s {
        eight!(lane => if mask[lane] { a[lane] } else { b[lane] })
    }
    #[inline(always)]
    fn bits(self, mask: Self::Mask) -> u32 {
        bits_of(eight!(lane => u32::from(mask[lane])))
    }
    #[inline(always)]
    fn sign_bits(self, a: Self::F32s) -> u32 {
        bits_of(eight!(lane => a[lane].to_bits() >> 31))
    }
    #[inline(always)]
    fn transpose(self, rows: [Self::F32s; LANES]) -> [Self::F32s; LANES] {
        eight!(lane => eight!(row => rows[row][lane]))
    }
    #[inline(always)]
    fn widen(self, a: Self::F32s) -> [Self::F64s; 2] {
        [
            four!(lane => f64::from(a[lane])),
            four!(lane => f64::from(a[LANES / 2 + lane])),
        ]
    }
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "rounds to the nearest f32")]
    fn narrow(self, [low, high]: [Self::F64s; 2]) -> Self::F32s {
        self.halves(
            four!(lane => low[lane] as f32),
            four!(lane => high[lane] as f32),
        )
    }
    #[inline(always)]
    fn widen_four(self, numbers: [f32; LANES / 2]) -> Self::F64s {
        four!(lane => f64::from(numbers[lane]))
    }
    #[inline(always)]
    fn rotate_three(self, [x, y, z, rest]: Self::F64s) -> Self::F64s {
        [y, z, x, rest]
    }
    #[inline(always)]
    fn sums_of_three(self, rows: [Self::F64s; 4]) -> [f64; 4] {
        four!(row => rows[row][0] + rows[row][1] + rows[row][2])
    }
    #[inline(always)]
    fn sign_bits_f64(self, [low, high]: [Self::F64s; 2]) -> u32 {
        let [a, b, c, d] = four!(lane => u32::from(low[lane].is_sign_negative()));
        let [e, f, g, h] = four!(lane => u32::from(high[lane].is_sign_negative()));
        bits_of([a, b, c, d, e, f, g, h])
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
