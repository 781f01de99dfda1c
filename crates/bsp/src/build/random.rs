//! Random choices that depend on a node's place in the tree alone.

/// The state of the random choices at a node.
///
/// Children's seeds are derived from their parent's, so the order in which nodes are built cannot show. Source of
/// the generator: Steele, Lea, Flood, "Fast splittable pseudorandom number generators", 2014 (`SplitMix64`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Seed(u64);

const GOLDEN_GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;

impl Seed {
    pub(super) const fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The seed of a child: [`FRONT`](crate::node::FRONT) or [`BACK`](crate::node::BACK).
    pub(super) fn child(self, side: usize) -> Self {
        Self(mix(self.0.wrapping_add(GOLDEN_GAMMA)).wrapping_add(side as u64))
    }

    /// At most `count` indices below `length`, ascending: one from each of `count` equal parts of the range, or all.
    pub(super) fn sample(self, count: usize, length: usize) -> impl Iterator<Item = usize> {
        let count = count.min(length);
        let begin = move |part: usize| (part as u128 * length as u128 / count as u128) as usize;
        (0..count).map(move |part| {
            let (first, end) = (begin(part), begin(part + 1));
            first + self.pick(part, end - first)
        })
    }

    /// A random index below `length`, which is not 0; another one for each `draw`.
    pub(super) fn pick(self, draw: usize, length: usize) -> usize {
        let step = (draw as u64).wrapping_add(2).wrapping_mul(GOLDEN_GAMMA);
        #[expect(
            clippy::cast_possible_truncation,
            reason = "a remainder of a usize is one"
        )]
        let index = (mix(self.0.wrapping_add(step)) % length as u64) as usize;
        index
    }
}

fn mix(state: u64) -> u64 {
    let state = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let state = (state ^ (state >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    state ^ (state >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_distinct_ascending_and_in_range() {
        for seed in 0..100 {
            let sample: Vec<usize> = Seed::new(seed).sample(7, 20).collect();
            assert_eq!(sample.len(), 7);
            assert!(
                sample.windows(2).all(|pair| pair[0] < pair[1]),
                "{sample:?}"
            );
            assert!(sample[6] < 20, "{sample:?}");
        }
        let all: Vec<usize> = Seed::new(3).sample(9, 4).collect();
        assert_eq!(all, [0, 1, 2, 3]);
    }

    #[test]
    fn children_and_seeds_choose_differently() {
        let first =
            |seed: Seed| -> Vec<usize> { (0..4).map(|draw| seed.pick(draw, 1 << 30)).collect() };
        let root = Seed::new(1);
        let all = [root, root.child(0), root.child(1), Seed::new(2)].map(first);
        for (index, choice) in all.iter().enumerate() {
            assert!(!all[..index].contains(choice), "{all:?}");
        }
    }
}
