use proptest::prelude::*;

use super::super::tests::{SPECIAL, are_equal, levels};
use super::*;
use crate::simd::{LANES, Lanes, WithSimd};

/// What the operations on f64 make of sums and products of two vectors, in which all digits of f64 are in use: bits of halves, and bits of lanes.
struct OnDoubles([Lanes; 2]);

/// The operations that are compared, for one number or four.
#[inline(always)]
fn doubles<D: Doubles>(numbers: D, a: D::F64s, b: D::F64s) -> [D::F64s; 6] {
    let c = numbers.mul_f64(a, numbers.splat_f64(1.0 / 3.0));
    [
        numbers.add_f64(c, b),
        numbers.sub_f64(c, b),
        numbers.mul_f64(c, b),
        numbers.div_f64(c, b),
        numbers.abs_f64(c),
        c,
    ]
}

impl WithSimd for OnDoubles {
    type Output = [(Lanes, u32); 6];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let [[a, b], [c, d]] = self.0.map(|lanes| simd.widen(simd.load(&lanes)));
        let (first, last) = (doubles(simd, a, c), doubles(simd, b, d));
        std::array::from_fn(|index| {
            let halves = [first[index], last[index]];
            (simd.store(simd.narrow(halves)), simd.sign_bits_f64(halves))
        })
    }
}

/// Digits that f32 has not: the difference to the rounded result, scaled up.
struct Remainders([Lanes; 2]);

impl WithSimd for Remainders {
    type Output = [Lanes; 6];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let [[a, b], [c, d]] = self.0.map(|lanes| simd.widen(simd.load(&lanes)));
        let (first, last) = (doubles(simd, a, c), doubles(simd, b, d));
        std::array::from_fn(|index| {
            let [low, high] = simd.widen(simd.narrow([first[index], last[index]]));
            let rest = [
                simd.sub_f64(first[index], low),
                simd.sub_f64(last[index], high),
            ];
            simd.store(simd.narrow(rest))
        })
    }
}

#[expect(clippy::cast_possible_truncation, reason = "rounds to the nearest f32")]
fn check_doubles(vectors: [Lanes; 2]) {
    for level in levels() {
        let results = level.dispatch(OnDoubles(vectors));
        let remainders = level.dispatch(Remainders(vectors));
        for lane in 0..LANES {
            let [a, b] = vectors.map(|vector| vector.0[lane]);
            let expected = doubles(Scalar, f64::from(a), f64::from(b));
            for (index, expected) in expected.into_iter().enumerate() {
                let (numbers, signs) = &results[index];
                let rest = expected - f64::from(expected as f32);
                for (found, expected) in [(numbers, expected), (&remainders[index], rest)] {
                    assert!(
                        are_equal("", found.0[lane].to_bits(), (expected as f32).to_bits()),
                        "operation {index} on {a} and {b} at {:?}: {found:?}",
                        level.level()
                    );
                }
                // Which sign a NaN has is not defined.
                let sign = u32::from(expected.is_sign_negative());
                assert!(
                    expected.is_nan() || signs >> lane & 1 == sign,
                    "sign of {expected}"
                );
            }
        }
    }
}

#[test]
fn operations_on_doubles_are_the_same_for_one_and_four_special_numbers() {
    for a in SPECIAL {
        for start in [0, LANES] {
            let others = Lanes(std::array::from_fn(|lane| SPECIAL[start + lane]));
            check_doubles([Lanes::splat(a), others]);
        }
    }
}

proptest! {
    #[test]
    fn operations_on_doubles_are_the_same_for_one_and_four(
        bits in prop::array::uniform2(prop::array::uniform8(any::<u32>())),
        ordinary in prop::array::uniform2(prop::array::uniform8(-10.0f32..10.0)),
    ) {
        check_doubles(bits.map(|lanes| Lanes(lanes.map(f32::from_bits))));
        check_doubles(ordinary.map(Lanes));
    }
}

/// A lane for each axis: the sums of the first three numbers of each row, of the rows as they are and rotated.
struct OfThree([[f32; 4]; 4]);

impl WithSimd for OfThree {
    type Output = [[f64; 4]; 2];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> [[f64; 4]; 2] {
        let third = simd.splat_f64(1.0 / 3.0);
        // All digits of f64 are in use.
        let rows = self.0.map(|row| simd.mul_f64(simd.widen_four(row), third));
        [
            simd.sums_of_three(rows),
            simd.sums_of_three(rows.map(|row| simd.rotate_three(row))),
        ]
    }
}

proptest! {
    #[test]
    fn three_of_four_numbers_are_rotated_and_summed(
        rows in prop::array::uniform4(prop::array::uniform4(-10.0f32..10.0)),
    ) {
        let sum = |a: f32, b: f32, c: f32| {
            let [a, b, c] = [a, b, c].map(|number| f64::from(number) * (1.0 / 3.0));
            a + b + c
        };
        let expected = [
            rows.map(|[x, y, z, _]| sum(x, y, z)),
            rows.map(|[x, y, z, _]| sum(y, z, x)),
        ];
        for level in levels() {
            prop_assert_eq!(level.dispatch(OfThree(rows)), expected, "{:?}", level.level());
        }
    }
}
