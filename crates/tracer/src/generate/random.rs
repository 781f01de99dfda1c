//! A small deterministic random number generator.

use glam::Vec3;

/// `SplitMix64`: a counter, scrambled. Not for secrets.
///
/// Source: G. Steele, D. Lea, C. Flood, "Fast Splittable Pseudorandom Number Generators", OOPSLA 2014.
#[derive(Clone, Debug)]
pub(super) struct Random {
    state: u64,
}

const GOLDEN_GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;

impl Random {
    pub(super) const fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    pub(super) const fn next_u64(&mut self) -> u64 {
        self.state = self.state.wrapping_add(GOLDEN_GAMMA);
        scramble(self.state)
    }

    /// A number in `[0, 1)`, one of the multiples of 2^-24.
    pub(super) fn unit(&mut self) -> f32 {
        (self.next_u64() >> 40) as f32 / (1u32 << 24) as f32
    }

    /// A number between two others.
    pub(super) fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    /// A vector with coordinates in `[-1, 1)`.
    pub(super) fn in_cube(&mut self) -> Vec3 {
        let mut coordinate = || self.between(-1.0, 1.0);
        Vec3::new(coordinate(), coordinate(), coordinate())
    }
}

/// A number that looks random, for a grid point.
pub(super) const fn hash_grid_point(seed: u64, x: u32, y: u32) -> u64 {
    let point = ((x as u64) << 32) | y as u64;
    scramble(scramble(seed.wrapping_add(GOLDEN_GAMMA)) ^ point.wrapping_mul(GOLDEN_GAMMA))
}

const fn scramble(value: u64) -> u64 {
    let value = (value ^ (value >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let value = (value ^ (value >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    value ^ (value >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_sequence_comes_out() {
        let mut random = Random::new(1_234_567);
        let first = [(); 3].map(|()| random.next_u64());
        assert_eq!(
            first,
            [
                6_457_827_717_110_365_317,
                3_203_168_211_198_807_973,
                9_817_491_932_198_370_423
            ]
        );
    }

    #[test]
    fn units_fill_their_interval_evenly() {
        let mut random = Random::new(7);
        let mut counts = [0u32; 8];
        for _ in 0..8000 {
            let unit = random.unit();
            assert!((0.0..1.0).contains(&unit), "{unit}");
            let eighth = (1..8u8).filter(|&i| unit * 8.0 >= f32::from(i)).count();
            counts[eighth] += 1;
        }
        // Ten standard deviations of a binomial count around its mean of 1000.
        assert!(
            counts.iter().all(|count| count.abs_diff(1000) < 300),
            "{counts:?}"
        );
    }
}
