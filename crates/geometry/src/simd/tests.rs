use proptest::prelude::*;

use super::*;

/// What every operation makes of three vectors: by name, as bits of lanes or of masks.
struct Operations([Lanes; 3]);

type Results = Vec<(&'static str, [u32; LANES])>;

impl WithSimd for Operations {
    type Output = Results;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Results {
        let [a, b, c] = self.0;
        let [x, y, z] = [simd.load(&a), simd.load(&b), simd.load(&c)];
        let lanes = |value: S::F32s| simd.store(value).0.map(f32::to_bits);
        let mask = |mask: S::Mask| {
            let bits = simd.bits(mask);
            std::array::from_fn(|lane| bits >> lane)
        };
        let (less, not_more) = (simd.lt(x, y), simd.le(y, z));
        vec![
            ("load and store", lanes(x)),
            ("splat", lanes(simd.splat(a.0[0]))),
            ("add", lanes(simd.add(x, y))),
            ("sub", lanes(simd.sub(x, y))),
            ("mul", lanes(simd.mul(x, y))),
            ("div", lanes(simd.div(x, y))),
            ("min", lanes(simd.min(x, y))),
            ("max", lanes(simd.max(x, y))),
            ("abs", lanes(simd.abs(x))),
            ("select", lanes(simd.select(less, y, z))),
            ("lt", mask(less)),
            ("le", mask(simd.le(x, y))),
            ("and", mask(simd.and(less, not_more))),
            ("or", mask(simd.or(less, not_more))),
            (
                "sign",
                std::array::from_fn(|lane| simd.sign_bits(x) >> lane),
            ),
        ]
    }
}

/// `a * b + c`, `a * b - c` and `c - a * b`.
struct Fused([Lanes; 3]);

impl WithSimd for Fused {
    type Output = [Lanes; 3];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> [Lanes; 3] {
        let [a, b, c] = self.0;
        let [x, y, z] = [simd.load(&a), simd.load(&b), simd.load(&c)];
        [
            simd.store(simd.mul_add(x, y, z)),
            simd.store(simd.mul_sub(x, y, z)),
            simd.store(simd.neg_mul_add(x, y, z)),
        ]
    }
}

/// The halves of a vector in the other order.
struct Swapped(Lanes);

impl WithSimd for Swapped {
    type Output = Lanes;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Lanes {
        let [lower, upper] = simd.to_halves(simd.load(&self.0));
        simd.store(simd.halves(upper, lower))
    }
}

pub(super) fn levels() -> impl Iterator<Item = AvailableSimd> {
    SimdLevel::ALL.into_iter().filter_map(SimdLevel::available)
}

/// Equal bits; NaN equals any NaN, as which one an operation gives is not defined.
pub(super) fn are_equal(name: &str, found: u32, expected: u32) -> bool {
    let is_number = !matches!(name, "lt" | "le" | "and" | "or" | "sign");
    found == expected
        || is_number && f32::from_bits(found).is_nan() && f32::from_bits(expected).is_nan()
}

/// Every operation as the trait defines it, number by number.
fn by_definition([a, b, c]: [f32; 3], first: f32) -> [u32; 15] {
    let (less, not_more) = (a < b, b <= c);
    let numbers = [
        a,
        first,
        a + b,
        a - b,
        a * b,
        a / b,
        if a < b { a } else { b },
        if a > b { a } else { b },
        f32::from_bits(a.to_bits() & (u32::MAX >> 1)),
        if less { b } else { c },
    ];
    let truths = [
        less,
        a <= b,
        less && not_more,
        less || not_more,
        a.is_sign_negative(),
    ];
    let mut all = numbers
        .map(f32::to_bits)
        .into_iter()
        .chain(truths.map(u32::from));
    std::array::from_fn(|_| all.next().expect("ten numbers and five truth values"))
}

fn check(vectors: [Lanes; 3]) {
    for level in levels() {
        let results = level.dispatch(Operations(vectors));
        for lane in 0..LANES {
            let of_lane = vectors.map(|vector| vector.0[lane]);
            let expected = by_definition(of_lane, vectors[0].0[0]);
            for ((name, lanes), expected) in results.iter().zip(expected) {
                let is_mask = matches!(*name, "lt" | "le" | "and" | "or" | "sign");
                let found = if is_mask {
                    lanes[lane] & 1
                } else {
                    lanes[lane]
                };
                assert!(
                    are_equal(name, found, expected),
                    "{name} at {:?} of {of_lane:?}: {found:#x} instead of {expected:#x}",
                    level.level()
                );
            }
        }
        check_fused(level, vectors);
    }
}

/// Rounded once or twice: nothing else is promised.
fn check_fused(level: AvailableSimd, vectors: [Lanes; 3]) {
    let results = level.dispatch(Fused(vectors));
    for lane in 0..LANES {
        let [a, b, c] = vectors.map(|vector| vector.0[lane]);
        let expected = [
            (a.mul_add(b, c), a * b + c),
            (a.mul_add(b, -c), a * b - c),
            ((-a).mul_add(b, c), c - a * b),
        ];
        for (found, (once, twice)) in results.iter().map(|lanes| lanes.0[lane]).zip(expected) {
            let is_one_of_them = [once, twice]
                .into_iter()
                .any(|one| are_equal("", found.to_bits(), one.to_bits()));
            assert!(
                is_one_of_them,
                "{a} * {b}, {c} at {:?}: {found}, neither {once} nor {twice}",
                level.level()
            );
        }
    }
}

/// Numbers at which operations differ where they are not the same.
pub(super) const SPECIAL: [f32; 16] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    f32::NAN,
    -f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::MAX,
    f32::MIN,
    f32::MIN_POSITIVE,
    -f32::MIN_POSITIVE,
    f32::from_bits(1),
    -f32::from_bits(1),
    1.5e-40,
    3.0,
];

#[test]
fn every_operation_is_the_same_at_every_level_for_special_numbers() {
    for a in SPECIAL {
        for b in SPECIAL {
            let [first, second] =
                [0, LANES].map(|start| Lanes(std::array::from_fn(|lane| SPECIAL[start + lane])));
            let rotated = Lanes(std::array::from_fn(
                |lane| if lane % 3 == 0 { a } else { b },
            ));
            for c in [first, second] {
                check([Lanes::splat(a), Lanes::splat(b), c]);
                check([c, rotated, Lanes::splat(b)]);
                check([rotated, c, c]);
            }
        }
    }
}

proptest! {
    #[test]
    fn every_operation_is_the_same_at_every_level(
        bits in prop::array::uniform3(prop::array::uniform8(any::<u32>())),
        ordinary in prop::array::uniform3(prop::array::uniform8(-10.0f32..10.0)),
    ) {
        check(bits.map(|lanes| Lanes(lanes.map(f32::from_bits))));
        check(ordinary.map(Lanes));
    }
}

/// Bytes as numbers.
struct Bytes([u8; LANES]);

impl WithSimd for Bytes {
    type Output = Lanes;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Lanes {
        simd.store(simd.load_u8(&self.0))
    }
}

#[test]
fn every_byte_is_the_same_number_in_every_lane_at_every_level() {
    for level in levels() {
        for first in 0..=u8::MAX {
            // Different in every lane, on both sides of where a sign would be.
            let bytes = [0, 37, 74, 111, 148, 185, 222, 3].map(|more| first.wrapping_add(more));
            let found = level.dispatch(Bytes(bytes)).0;
            assert_eq!(found, bytes.map(f32::from), "{:?}", level.level());
        }
    }
}

/// Rows as columns.
struct Transposed([Lanes; LANES]);

impl WithSimd for Transposed {
    type Output = [Lanes; LANES];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let rows = self.0.each_ref().map(|row| simd.load(row));
        simd.transpose(rows).map(|column| simd.store(column))
    }
}

#[test]
fn rows_become_columns() {
    let number = |row: usize, column: usize| (10 * row + column) as f32;
    let rows = std::array::from_fn(|row| Lanes(std::array::from_fn(|lane| number(row, lane))));
    let columns = std::array::from_fn(|lane| Lanes(std::array::from_fn(|row| number(row, lane))));
    for level in levels() {
        assert_eq!(
            level.dispatch(Transposed(rows)),
            columns,
            "{:?}",
            level.level()
        );
    }
}

/// Whether a part of an algorithm runs with the same level.
struct Outlined(Lanes);

impl WithSimd for Outlined {
    type Output = Lanes;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Lanes {
        simd.prefetch(std::ptr::from_ref(&self.0).cast(), size_of::<Lanes>());
        simd.outline(Doubled(self.0))
    }
}

struct Doubled(Lanes);

impl WithSimd for Doubled {
    type Output = Lanes;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Lanes {
        let value = simd.load(&self.0);
        simd.store(simd.add(value, value))
    }
}

#[test]
fn a_part_in_a_function_of_its_own_gives_the_same() {
    for level in levels() {
        let lanes = Lanes(std::array::from_fn(|lane| lane as f32));
        let doubled = level.dispatch(Outlined(lanes)).0;
        assert_eq!(doubled, [0.0, 2.0, 4.0, 6.0, 8.0, 10.0, 12.0, 14.0]);
    }
}

#[test]
fn the_best_level_is_the_last_one_that_is_available() {
    assert!(SimdLevel::Portable.is_available(), "on every processor");
    let mut available = SimdLevel::ALL
        .into_iter()
        .filter(|level| level.is_available());
    assert_eq!(available.next_back(), Some(AvailableSimd::best().level()));
    for level in SimdLevel::ALL {
        let available = level.available().map(AvailableSimd::level);
        assert!(
            available.is_none_or(|found| found == level),
            "{}",
            level.name()
        );
    }
}

#[test]
fn halves_are_the_lower_and_the_upper_lanes() {
    let vector = Lanes([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]);
    for level in levels() {
        let swapped = level.dispatch(Swapped(vector));
        let expected = [5.0, 6.0, 7.0, 8.0, 1.0, 2.0, 3.0, 4.0];
        assert_eq!(swapped.0, expected, "{level:?}");
    }
}
