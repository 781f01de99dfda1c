//! The ways that a collapse chose for a node of the binary tree.

use tahko_geometry::simd::LANES;

/// What becomes of a subtree: as one tree, and as a forest of at most `k`, for each `k` up to eight. 32 bits:
///
/// - 3 for each `k` from 2 on: how many of `k` trees the first child gets; 0 if fewer trees than `k` cost as little;
/// - 1: whether the cheapest tree is a leaf;
/// - 10: the references below, [`MANY`](Self::MANY) if there are more.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Choice(u32);

const SHARE_BITS: u32 = 3;
/// Where the shares end.
const LEAF_SHIFT: u32 = Choice::shift(LANES) + SHARE_BITS;
const COUNT_SHIFT: u32 = LEAF_SHIFT + 1;

impl Choice {
    /// Counts are not told apart from here on.
    pub(super) const MANY: u32 = (1 << (u32::BITS - COUNT_SHIFT)) - 1;

    /// A subtree of some references that is split nowhere yet.
    pub(super) const fn new(is_leaf: bool, count: u32) -> Self {
        let count = if count < Self::MANY {
            count
        } else {
            Self::MANY
        };
        Self((is_leaf as u32) << LEAF_SHIFT | count << COUNT_SHIFT)
    }

    /// Gives the first child a share of `k` trees, less than `k`; told once for each `k`.
    #[expect(clippy::cast_possible_truncation, reason = "below eight")]
    pub(super) const fn set_share(&mut self, k: usize, share: usize) {
        self.0 |= (share as u32) << Self::shift(k);
    }

    #[expect(clippy::cast_possible_truncation, reason = "at most nine")]
    const fn shift(k: usize) -> u32 {
        SHARE_BITS * (k as u32 - 2)
    }

    /// The cheapest forest of at most `k` trees: how many trees it has, the fewest at that cost, and the share of the first child; `None` if
    /// that is one tree.
    #[inline]
    pub(super) const fn forest(self, k: usize) -> Option<(usize, usize)> {
        let shares = self.0 & ((1 << Self::shift(k + 1)) - 1);
        match shares.checked_ilog2() {
            Some(highest) => {
                let place = highest / SHARE_BITS;
                let share = shares >> (place * SHARE_BITS);
                Some((place as usize + 2, share as usize))
            }
            None => None,
        }
    }

    /// Whether the cheapest tree is a leaf.
    #[inline]
    pub(super) const fn is_leaf(self) -> bool {
        self.0 >> LEAF_SHIFT & 1 != 0
    }

    /// References below, or [`MANY`](Self::MANY).
    #[inline]
    pub(super) const fn count(self) -> u32 {
        self.0 >> COUNT_SHIFT
    }

    pub(super) const fn bits(self) -> u32 {
        self.0
    }

    pub(super) const fn from_bits(bits: u32) -> Self {
        Self(bits)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_forest_has_the_fewest_trees_that_cost_as_little() {
        let mut choice = Choice::new(true, 5);
        for (k, share) in [(3, 1), (5, 4), (8, 7)] {
            choice.set_share(k, share);
        }
        let forests = [1, 2, 3, 4, 5, 6, 7, 8].map(|k| choice.forest(k));
        let [three, five, eight] = [(3, 1), (5, 4), (8, 7)].map(Some);
        let expected = [None, None, three, three, five, five, five, eight];
        assert_eq!(forests, expected);
        assert!(choice.is_leaf(), "shares leave it");
        assert_eq!(choice.count(), 5);
        assert_eq!(Choice::from_bits(choice.bits()), choice);
    }

    #[test]
    fn counts_are_exact_up_to_the_largest_leaf_and_end_somewhere() {
        let largest = u32::try_from(crate::BvhOptions::MAX_LEAF_SIZE).expect("small");
        for count in [1, 8, largest] {
            assert_eq!(Choice::new(false, count).count(), count);
        }
        for count in [Choice::MANY, Choice::MANY + 1, u32::MAX] {
            let choice = Choice::new(false, count);
            assert_eq!((choice.count(), choice.is_leaf()), (Choice::MANY, false));
        }
        assert!(largest < Choice::MANY, "leaves are told apart from more");
    }
}
