//! Exact arithmetic on sums of f64 numbers.
//!
//! An expansion is the exact sum of its components, which do not overlap strongly (Shewchuk's term): no two of them have bits of the
//! same value, and those that touch are powers of two. So the last one is larger than all others together. Sums and products of
//! expansions are exact as long as nothing over- or underflows.
//!
//! **Range.** Every finite f32 is a multiple of `2^-149` below `2^128`, so a product of `n` differences of f32 numbers is
//! a multiple of `2^(-149 n)`, and so is every component of its expansion; a sum of a few such products is
//! below `2^(129 n + 8)`. The longest products here have six factors (the order of two hits): between `2^-894` and `2^782`.
//! Splitting a number for an exact product multiplies it by `2^27 + 1`. All of it is inside f64, from `2^-1074` to `2^1024`.
//!
//! Source: Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates", 1997,
//! sections 2.2 to 2.8: Two-Sum, Split, Two-Product, Fast-Expansion-Sum, Scale-Expansion and Compress. All of them keep components
//! from overlapping strongly, given round-to-even. Differs in dropping zeros.

use smallvec::SmallVec;

use super::Sign;

/// An exact sum of f64 numbers that do not overlap: none of them zero, in the order of their magnitude.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Expansion {
    components: Components,
}

/// Compressed expansions of the products of ordinary coordinates have a few components.
type Components = SmallVec<[f64; 12]>;

/// So many components are not worth compressing.
const FEW: usize = 6;

impl Expansion {
    /// Zero.
    pub(crate) fn zero() -> Self {
        Self {
            components: Components::new(),
        }
    }

    /// The difference of two f32 numbers.
    pub(crate) fn difference(a: f32, b: f32) -> Self {
        let (sum, error) = two_sum(f64::from(a), -f64::from(b));
        let mut difference = Self::zero();
        difference.push(error);
        difference.push(sum);
        difference
    }

    /// A whole number below `2^126` in size, times a power of two that takes none of its bits out of the range.
    pub(crate) fn of_whole(value: i128, unit: f64) -> Self {
        let mut expansion = Self::zero();
        let mut parts = [0.0; 3];
        let mut rest = value;
        for part in &mut parts {
            #[expect(clippy::cast_precision_loss, reason = "the rest goes to the next part")]
            let nearest = rest as f64;
            *part = nearest * unit;
            #[expect(
                clippy::cast_possible_truncation,
                reason = "a whole number below 2^127"
            )]
            let taken = nearest as i128;
            // At most half a unit in the last place: below 2^73, then below 2^20.
            rest -= taken;
        }
        for part in parts.into_iter().rev() {
            expansion.push(part);
        }
        expansion
    }

    /// Appends a component beyond the others, unless it is zero.
    fn push(&mut self, component: f64) {
        if component != 0.0 {
            self.components.push(component);
        }
    }

    pub(crate) fn sign(&self) -> Sign {
        // The last component is larger than all others together.
        self.components.last().copied().map_or(Sign::Zero, Sign::of)
    }

    /// The value with a relative error below `2^-50`, and zero only if it is.
    ///
    /// From the smallest component up, each sum is below twice the lowest bit of the next one but one, so the roundings add
    /// up to no more than two of the last.
    pub(crate) fn approximation(&self) -> f64 {
        self.components.iter().sum()
    }

    /// The value as a rational number.
    #[cfg(test)]
    pub(crate) fn exact_value(&self) -> crate::oracle::RBig {
        use crate::oracle::RBig;
        let components = self.components.iter();
        components.fold(RBig::ZERO, |sum, component| {
            sum + RBig::try_from(*component).expect("finite")
        })
    }

    pub(crate) fn plus(&self, other: &Self) -> Self {
        self.plus_times(other, 1.0)
    }

    pub(crate) fn minus(&self, other: &Self) -> Self {
        self.plus_times(other, -1.0)
    }

    /// The sum with the other expansion times 1 or -1.
    fn plus_times(&self, other: &Self, sign: f64) -> Self {
        let mut sum = Self::zero();
        let (mut left, mut right) = (self.components.as_slice(), other.components.as_slice());
        let mut carry = 0.0;
        // All components in the order of their magnitude.
        loop {
            let next = match (left.split_first(), right.split_first()) {
                (Some((first, rest)), Some((other, _))) if first.abs() <= other.abs() => {
                    left = rest;
                    *first
                }
                (_, Some((first, rest))) => {
                    right = rest;
                    sign * first
                }
                (Some((first, rest)), None) => {
                    left = rest;
                    *first
                }
                (None, None) => break,
            };
            let (larger, error) = two_sum(carry, next);
            sum.push(error);
            carry = larger;
        }
        sum.push(carry);
        sum.compressed()
    }

    pub(crate) fn times(&self, other: &Self) -> Self {
        let mut parts = other.components.iter();
        let Some(first) = parts.next() else {
            return Self::zero();
        };
        let mut product = self.scaled(*first);
        for component in parts {
            product = product.plus(&self.scaled(*component));
        }
        product
    }

    /// The product with a number.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        let mut scaled = Self::zero();
        let mut carry = 0.0;
        for component in &self.components {
            let (product, error) = two_product(*component, factor);
            let (low_sum, low) = two_sum(carry, error);
            let (high_sum, high) = fast_two_sum(product, low_sum);
            scaled.push(low);
            scaled.push(high);
            carry = high_sum;
        }
        scaled.push(carry);
        scaled.compressed()
    }

    /// The same value in as few components as possible, where there are many.
    fn compressed(mut self) -> Self {
        let components = &mut self.components;
        let count = components.len();
        if count <= FEW {
            return self;
        }
        let mut carry = components[count - 1];
        // From the largest down, to the upper end of the same places.
        let mut bottom = count;
        for index in (0..count - 1).rev() {
            let (sum, error) = fast_two_sum(carry, components[index]);
            carry = sum;
            if error != 0.0 {
                bottom -= 1;
                components[bottom] = sum;
                carry = error;
            }
        }
        // And up again, to the lower end.
        let mut top = 0;
        for index in bottom..count {
            let (sum, error) = fast_two_sum(components[index], carry);
            carry = sum;
            if error != 0.0 {
                components[top] = error;
                top += 1;
            }
        }
        components.truncate(top);
        components.push(carry);
        self
    }
}

/// The rounded sum and its error.
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_part = sum - a;
    let a_part = sum - b_part;
    (sum, (a - a_part) + (b - b_part))
}

/// The rounded sum and its error, for `|a| >= |b|` or `a = 0`.
fn fast_two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    (sum, b - (sum - a))
}

/// The rounded product and its error, by Dekker's splitting, which needs no fused multiply-add.
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    let ((a_high, a_low), (b_high, b_low)) = (split(a), split(b));
    let error = product - a_high * b_high - a_low * b_high - a_high * b_low;
    (product, a_low * b_low - error)
}

/// A number as the sum of two with 26 bits each.
fn split(value: f64) -> (f64, f64) {
    const SPLITTER: f64 = ((1u64 << 27) + 1) as f64;
    let scaled = SPLITTER * value;
    let high = scaled - (scaled - value);
    (high, value - high)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::oracle::RBig;

    fn exact(value: f64) -> RBig {
        RBig::try_from(value).expect("finite")
    }

    /// The invariants of the module's documentation.
    fn assert_well_formed(expansion: &Expansion) {
        for pair in expansion.components.windows(2) {
            assert!(
                pair[0] != 0.0 && pair[0].abs() < pair[1].abs(),
                "{expansion:?}"
            );
            let unit = 2f64.powi(pair[1].to_bits().trailing_zeros().min(52).cast_signed() - 52);
            let exponent = f64::from_bits(pair[1].to_bits() & (0x7ff << 52)).abs();
            assert!(pair[0].abs() <= unit * exponent, "{expansion:?}");
        }
    }

    fn any_f32() -> impl Strategy<Value = f32> {
        let anything = any::<u32>()
            .prop_map(f32::from_bits)
            .prop_filter("finite", |value| value.is_finite());
        prop_oneof![anything, -4.0f32..4.0, (-3i8..=3).prop_map(f32::from)]
    }

    proptest! {
        #[test]
        fn sums_and_products_of_differences_are_exact(pairs in prop::collection::vec((any_f32(), any_f32()), 6)) {
            let parts: Vec<(Expansion, RBig)> = pairs
                .iter()
                .map(|(a, b)| {
                    let expected = exact(f64::from(*a)) - exact(f64::from(*b));
                    (Expansion::difference(*a, *b), expected)
                })
                .collect();
            // As many factors as in the order of two hits, and sums and differences on the way.
            let [mut product, mut other] = [0, 3].map(|index| parts[index].clone());
            for index in [1, 2] {
                product = (product.0.times(&parts[index].0), product.1 * &parts[index].1);
                other = (other.0.times(&parts[index + 3].0), other.1 * &parts[index + 3].1);
            }
            let product_of_all = (product.0.times(&other.0), &product.1 * &other.1);
            let cancelled = (
                product_of_all.0.minus(&other.0.times(&product.0)),
                RBig::ZERO,
            );
            let sum = (product.0.plus(&other.0), &product.1 + &other.1);
            let scaled = (sum.0.scaled(f64::from(pairs[0].0)), &sum.1 * exact(f64::from(pairs[0].0)));
            for (expansion, expected) in [product, other, product_of_all, cancelled, sum, scaled] {
                assert_well_formed(&expansion);
                prop_assert_eq!(expansion.exact_value(), expected.clone());
                prop_assert_eq!(expansion.sign() == Sign::Zero, expected == RBig::ZERO);
                let error = exact(expansion.approximation()) - &expected;
                let limit = &expected * exact(2f64.powi(-50));
                prop_assert!(error.clone() * &error <= limit.clone() * &limit);
            }
        }

        #[test]
        fn whole_numbers_are_exact(value in any::<i128>(), shift in 2u32..127, power in -500i32..300) {
            let (value, unit) = (value >> shift, 2f64.powi(power));
            let expansion = Expansion::of_whole(value, unit);
            assert_well_formed(&expansion);
            prop_assert_eq!(expansion.exact_value(), RBig::from(value) * exact(unit));
        }
    }
}
