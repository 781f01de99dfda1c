//! Deterministic random numbers.

use tahko_tracer::geometry::{Aabb, glam::Vec3};

/// `SplitMix64` (Steele, Lea, Flood 2014): the same numbers for the same seed, on every machine.
#[derive(Clone, Debug)]
pub struct Random {
    state: u64,
}

impl Random {
    /// A sequence of its own for each seed.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// 64 random bits.
    pub const fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let value = (self.state ^ self.state >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let value = (value ^ value >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        value ^ value >> 31
    }

    /// From 0 to 1, with 24 bits.
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1u32 << 24) as f32
    }

    /// From 0 to `count - 1`.
    ///
    /// # Panics
    /// If `count` is 0.
    #[expect(clippy::cast_possible_truncation, reason = "below a length")]
    pub const fn below(&mut self, count: usize) -> usize {
        (self.bits() % count as u64) as usize
    }

    /// A point in a box that is not empty.
    pub fn point_in(&mut self, bounds: &Aabb) -> Vec3 {
        let weights = Vec3::new(self.unit(), self.unit(), self.unit());
        bounds.min * (Vec3::ONE - weights) + bounds.max * weights
    }
}
