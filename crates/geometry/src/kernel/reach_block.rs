//! The filter of the kernels that decide within a reach, for eight triangles at a time.
//!
//! A kernel that accepts a triangle at `t` has a point of it within its reach `R` of the ray, in every coordinate (see [`kernel`](super)). In the terms of the
//! [filter of the exact kernels](super::exact_block): that point is projected to within `2 R` of zero in both coordinates, so no weight can have the wrong sign
//! by more than `8 P R`, and its parameter is within `R / |D.z|` of `t`. With `R` of `16 u` times the largest coordinate difference, which is at most `P + Z`, the
//! first is `128 u P (P + Z)`: the bound of the exact filter has to be `152 / 24` times as large. The second is `16 u (P + Z) / |D.z|`.
//!
//! Where [eight rays](super::rays) are sheared onto a common axis, `D.z` may be half of the largest component. Then that point is projected to within `3 R`, which makes it
//! `192 u P (P + Z)` and the bound `216 / 24` times as large; and the parameter is within `16 u (P / |D.z| + 2 |t|)`, which [`T_ERROR`] has room for.
//!
//! What the filter lets through is tested by the kernel itself: its own decisions do not change.

use super::block::{BlockFilter, BlockTest, BlockVerdict, Candidates};
use super::confirm;
use super::exact_block::ExactBlockFilter;
use super::one_ray::{BeforeRay, RayAlongAxis, limits};
use super::rays::{RayOfLane, RaysAlongAxis, RaysFilter};
use super::sheared::{Limits, Seen};
use crate::simd::Simd;
use crate::{Axis, FusedRay, Ray, RayLanes, TriangleBlock};

/// How much larger the bound of the weights is than that of the exact filter, also for rays that are sheared onto a common axis.
const ERROR_FACTOR: f32 = 9.5;
/// The bound of `t`, relative to the sizes of the triangle: its own rounding and the reach.
const T_ERROR: f32 = 40.0 / (1u32 << 24) as f32;
/// More than what underflows, and the constant part of the reach, can move a `t`.
const TINY_T: f32 = 1.0 / (1u128 << 110) as f32;

const _: () = assert!(confirm::REACH <= 16.0, "the factors are for this reach");

/// A ray prepared for the filter of the kernels with a reach: [alone](ReachBlockFilter), or with others.
#[derive(Clone, Copy, Debug)]
pub struct WithinReach<R>(R);

/// A ray prepared alone for the filter of the kernels with a reach.
pub type ReachBlockFilter = WithinReach<ExactBlockFilter>;

impl BlockFilter for ReachBlockFilter {
    type Rays = ReachRaysFilter;

    #[inline(always)]
    fn new(ray: &Ray, fused: &FusedRay) -> Self {
        Self(ExactBlockFilter::new(ray, fused))
    }
}

impl<R: RayAlongAxis> BlockTest for WithinReach<R> {
    #[inline(always)]
    fn test<S: Simd>(&self, simd: S, block: &TriangleBlock, t_max: f32) -> Option<BlockVerdict> {
        BlockVerdict::undecided(self.possible(simd, block, t_max))
    }

    #[inline(always)]
    fn candidates<S: Simd>(&self, simd: S, block: &TriangleBlock, t_max: f32) -> Candidates {
        let Self(ray) = self;
        if !ray.decides() {
            return Candidates::undecided(block.used());
        }
        let reciprocal = simd.splat(ray.minus_reciprocal().abs());
        let seen = Seen::new(simd, &BeforeRay::new(simd, ray, block));
        Candidates::undecided(possible(simd, &seen, reciprocal, &limits(simd, ray, t_max)))
    }

    #[inline(always)]
    fn judge<S: Simd>(
        &self,
        _simd: S,
        _block: &TriangleBlock,
        _t_max: f32,
        possible: u32,
    ) -> Option<BlockVerdict> {
        BlockVerdict::undecided(possible)
    }
}

/// Eight rays prepared for the filter of the kernels with a reach.
#[derive(Clone, Copy, Debug)]
pub struct ReachRaysFilter(RaysAlongAxis);

impl RaysFilter for ReachRaysFilter {
    type OneRay<'a> = WithinReach<RayOfLane<'a>>;

    const EMPTY: Self = Self(RaysAlongAxis::EMPTY);

    #[inline(always)]
    fn prepare<S: Simd>(&mut self, simd: S, rays: &RayLanes, axis: Axis, size: f32) -> bool {
        self.0.prepare(simd, rays, axis, size)
    }

    #[inline(always)]
    fn test<S: Simd>(
        &self,
        simd: S,
        rays: &RayLanes,
        block: &TriangleBlock,
        triangle: usize,
    ) -> Option<BlockVerdict> {
        let Self(prepared) = self;
        let reciprocal = simd.abs(simd.load(&prepared.minus_reciprocal));
        let limits = prepared.limits(simd, rays);
        let seen = Seen::new(simd, &prepared.before(simd, rays, block, triangle));
        BlockVerdict::undecided(possible(simd, &seen, reciprocal, &limits))
    }

    #[inline(always)]
    fn of_lane<'a>(&'a self, rays: &'a RayLanes, lane: usize) -> WithinReach<RayOfLane<'a>> {
        WithinReach(self.0.of_lane(rays, lane))
    }
}

/// The lanes that kernels may accept. The reciprocal is that of the size of the direction component along the axis.
#[inline(always)]
fn possible<S: Simd>(simd: S, seen: &Seen<S>, reciprocal: S::F32s, limits: &Limits<S>) -> u32 {
    let error = simd.mul(seen.error, simd.splat(ERROR_FACTOR));
    let below = simd.sub(simd.splat(0.0), error);
    // Positive comparisons: unused lanes have NaN.
    let is_inside = simd.or(simd.le(seen.largest, error), simd.le(below, seen.smallest));
    let sizes = simd.mul_add(seen.size, reciprocal, seen.farthest_t);
    let margin = simd.mul_add(sizes, simd.splat(T_ERROR), simd.splat(TINY_T));
    let t_error = simd.splat(T_ERROR);
    let last = simd.mul_add(simd.abs(limits.t_max), t_error, limits.t_max);
    let first = simd.neg_mul_add(simd.abs(limits.t_min), t_error, limits.t_min);
    let begins = simd.le(simd.sub(seen.first_t, margin), last);
    let ends = simd.le(first, simd.add(seen.last_t, margin));
    simd.bits(simd.and(is_inside, simd.and(begins, ends)))
}
