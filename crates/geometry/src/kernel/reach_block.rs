//! The filter of the kernels that decide within a reach, for eight triangles at a time.
//!
//! A kernel that accepts a triangle at `t` has a point of it within its reach `R` of the ray, in every coordinate (see [`kernel`](super)). In the terms of the
//! [filter of the exact kernels](super::exact_block): that point is projected to within `2 R` of zero in both coordinates, so no weight can have the wrong sign
//! by more than `8 P R`, and its parameter is within `R / |D.z|` of `t`. With `R` of `16 u` times the largest coordinate difference, which is at most `P + Z`, the
//! first is `128 u P (P + Z)`: the bound of the exact filter has to be `152 / 24` times as large. The second is `16 u (P + Z) / |D.z|`.
//!
//! What the filter lets through is tested by the kernel itself: its own decisions do not change.

use super::block::{BlockFilter, BlockVerdict};
use super::confirm;
use super::exact_block::ExactBlockFilter;
use crate::simd::Simd;
use crate::{FusedRay, Ray, TriangleBlock};

/// How much larger the bound of the weights is than that of the exact filter.
const ERROR_FACTOR: f32 = 7.0;
/// The bound of `t`, relative to the sizes of the triangle: its own rounding and the reach.
const T_ERROR: f32 = 40.0 / (1u32 << 24) as f32;
/// More than what underflows, and the constant part of the reach, can move a `t`.
const TINY_T: f32 = 1.0 / (1u128 << 110) as f32;

const _: () = assert!(confirm::REACH <= 16.0, "the factors are for this reach");

/// A ray prepared for the filter of the kernels with a reach.
#[derive(Clone, Copy, Debug)]
pub struct ReachBlockFilter(ExactBlockFilter);

impl BlockFilter for ReachBlockFilter {
    #[inline(always)]
    fn new(ray: &Ray, fused: &FusedRay) -> Self {
        Self(ExactBlockFilter::new(ray, fused))
    }

    #[inline(always)]
    fn test<S: Simd>(&self, simd: S, block: &TriangleBlock, t_max: f32) -> Option<BlockVerdict> {
        if !self.0.decides() {
            return BlockVerdict::undecided(block.used());
        }
        let seen = self.0.see(simd, block);
        let error = simd.mul(seen.error, simd.splat(ERROR_FACTOR));
        let below = simd.sub(simd.splat(0.0), error);
        // Positive comparisons: unused lanes have NaN.
        let is_inside = simd.or(simd.le(seen.largest, error), simd.le(below, seen.smallest));
        let sizes = simd.mul_add(seen.size, simd.splat(self.0.reciprocal()), seen.farthest_t);
        let margin = simd.mul_add(sizes, simd.splat(T_ERROR), simd.splat(TINY_T));
        let last = simd.splat(t_max + t_max.abs() * T_ERROR);
        let begins = simd.le(simd.sub(seen.first_t, margin), last);
        let t_min = self.0.t_min();
        let first = simd.splat(t_min - t_min.abs() * T_ERROR);
        let ends = simd.le(first, simd.add(seen.last_t, margin));
        BlockVerdict::undecided(simd.bits(simd.and(is_inside, simd.and(begins, ends))))
    }
}
