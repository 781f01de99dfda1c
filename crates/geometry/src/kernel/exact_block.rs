//! The f32 rung of the exact kernels for eight triangles at a time, and for [eight rays](super::rays) at a time.
//!
//! [`sheared`](super::sheared) has how a triangle is seen from a ray, with the bound of the weights and of the vertices' `t`.
//!
//! **Certain hits.** Where the weights have one sign for certain and their sum is `16` times the error `e` of one of them, `t` lies within
//! `3 e / (sum - 3 e)` of the triangle's range in `t`, less than `4 e / sum` of it, of the exact mean, and the roundings of `t` and of the
//! mean are below `13 u` of the largest `t`. In small triangles the products of weights and `t` underflow, by up to `2^-149` each: [`TINY_SUM`] more of their sum.
//!
//! **Rays that start on a surface** are so close to it that its triangle looks like a hit at a `t` around zero. Where such a triangle may be hit, it is seen first whether its
//! [plane is behind](super::behind).

use glam::Vec3;

use super::behind::behind;
use super::block::{BlockFilter, BlockTest, BlockVerdict, Candidates};
use super::one_ray::{BeforeRay, RayAlongAxis, limits};
use super::rays::{RayOfLane, RaysAlongAxis, RaysFilter};
use super::sheared::{Limits, Seen, Sight, T_ERROR, TINY_T, first_t};
use crate::simd::Simd;
use crate::{Axis, FusedRay, Ray, RayLanes, TriangleBlock};

/// More than underflow can take from a sum of weighted `t`, which is `2^-144`, and not a denormal number, with which some processors are slow.
const TINY_SUM: f32 = f32::MIN_POSITIVE;

/// A ray prepared for the filter of the exact kernels: it is sheared onto the axis of its largest direction component.
#[derive(Clone, Copy, Debug)]
pub struct ExactBlockFilter {
    /// Copied as it is: numbers that are written one by one and copied as a vector would be waited for.
    ray: Ray,
    /// What it is sheared onto.
    z: Axis,
    minus_reciprocal: f32,
    /// The size of the largest direction component, and some roundings.
    along: f32,
    /// What a computed `t` may be for an exact one from `t_min` on.
    first_t: f32,
    decides: bool,
}

impl BlockFilter for ExactBlockFilter {
    type Rays = ExactRaysFilter;

    #[inline(always)]
    fn new(ray: &Ray, fused: &FusedRay) -> Self {
        let reciprocal: &[f32; 4] = fused.reciprocal.as_ref();
        Self {
            ray: *ray,
            z: fused.axis,
            // The largest component is not clamped.
            minus_reciprocal: -reciprocal[fused.axis as usize],
            along: fused.largest * (1.0 + T_ERROR),
            first_t: first_t(ray.t_min),
            decides: fused.filters_decide,
        }
    }
}

impl RayAlongAxis for ExactBlockFilter {
    #[inline(always)]
    fn decides(&self) -> bool {
        self.decides
    }

    #[inline(always)]
    fn axes(&self) -> [Axis; 3] {
        self.z.around()
    }

    #[inline(always)]
    fn origin(&self, axis: Axis) -> f32 {
        component(&self.ray.origin, axis)
    }

    #[inline(always)]
    fn direction(&self, axis: Axis) -> f32 {
        component(&self.ray.direction, axis)
    }

    #[inline(always)]
    fn minus_reciprocal(&self) -> f32 {
        self.minus_reciprocal
    }

    #[inline(always)]
    fn along(&self) -> f32 {
        self.along
    }

    #[inline(always)]
    fn t_min(&self) -> f32 {
        self.ray.t_min
    }

    #[inline(always)]
    fn first_t(&self) -> f32 {
        self.first_t
    }

    #[inline(always)]
    fn t_max(&self) -> f32 {
        self.ray.t_max
    }
}

/// As of an array: an index into a vector is a branch, and often mispredicted.
#[inline(always)]
fn component(vector: &Vec3, axis: Axis) -> f32 {
    let components: &[f32; 3] = vector.as_ref();
    components[axis as usize]
}

/// A ray is tested the same way whether it was prepared alone or with others.
impl<R: RayAlongAxis> BlockTest for R {
    #[inline(always)]
    fn test<S: Simd>(&self, simd: S, block: &TriangleBlock, t_max: f32) -> Option<BlockVerdict> {
        if !self.decides() {
            return BlockVerdict::undecided(block.used());
        }
        let sight = BeforeRay::new(simd, self, block);
        verdict(simd, &sight, &limits(simd, self, t_max))
    }

    #[inline(always)]
    fn candidates<S: Simd>(&self, simd: S, block: &TriangleBlock, t_max: f32) -> Candidates {
        if !self.decides() {
            return Candidates::undecided(block.used());
        }
        let sight = BeforeRay::new(simd, self, block);
        ahead(simd, &sight, &limits(simd, self, t_max))
    }

    #[inline(always)]
    fn judge<S: Simd>(
        &self,
        simd: S,
        block: &TriangleBlock,
        t_max: f32,
        possible: u32,
    ) -> Option<BlockVerdict> {
        if !self.decides() {
            return BlockVerdict::undecided(possible);
        }
        let seen = Seen::new(simd, &BeforeRay::new(simd, self, block));
        decided(simd, &seen, &limits(simd, self, t_max), possible)
    }
}

/// Eight rays prepared for the filter of the exact kernels.
#[derive(Clone, Copy, Debug)]
pub struct ExactRaysFilter(RaysAlongAxis);

impl RaysFilter for ExactRaysFilter {
    type OneRay<'a> = RayOfLane<'a>;

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
        let sight = self.0.before(simd, rays, block, triangle);
        verdict(simd, &sight, &self.0.limits(simd, rays))
    }

    #[inline(always)]
    fn of_lane<'a>(&'a self, rays: &'a RayLanes, lane: usize) -> RayOfLane<'a> {
        self.0.of_lane(rays, lane)
    }
}

/// What the exact kernels make of triangles.
#[inline(always)]
fn verdict<S: Simd>(simd: S, sight: &impl Sight<S>, limits: &Limits<S>) -> Option<BlockVerdict> {
    let seen = Seen::new(simd, sight);
    let possible = possible(simd, &seen, limits);
    if possible == 0 {
        return None;
    }
    let beyond = simd.bits(is_beyond_origin(simd, &seen));
    if !limits.is_ahead || possible & !beyond == 0 {
        return decided(simd, &seen, limits, possible);
    }
    // The triangle that the ray starts on, which is behind it, and mostly nothing else. So what the rest wants is not kept, and not stored for each block, but found anew.
    let sight = sight.anew();
    let possible = possible & !behind(simd, &seen, &sight);
    if possible == 0 {
        return None;
    }
    decided(simd, &Seen::new(simd, &sight), limits, possible)
}

/// The lanes that may be hit in the interval, and of which the plane is not behind a ray that begins at its origin or later. Without a branch on what is found.
#[inline(always)]
fn ahead<S: Simd>(simd: S, sight: &impl Sight<S>, limits: &Limits<S>) -> Candidates {
    let seen = Seen::new(simd, sight);
    let mut possible = possible(simd, &seen, limits);
    if limits.is_ahead {
        possible &= !behind(simd, &seen, sight);
    }
    Candidates {
        possible,
        met: simd.bits(is_met(simd, &seen)),
    }
}

/// The lanes whose triangles the line of the ray meets for certain: all weights have one sign.
#[inline(always)]
fn is_met<S: Simd>(simd: S, seen: &Seen<S>) -> S::Mask {
    let below = simd.sub(simd.splat(0.0), seen.error);
    let has_sign = simd.or(
        simd.lt(seen.error, seen.smallest),
        simd.lt(seen.largest, below),
    );
    simd.and(has_sign, seen.is_sharp(simd))
}

/// The lanes that may be hit in the interval.
#[inline(always)]
fn possible<S: Simd>(simd: S, seen: &Seen<S>, limits: &Limits<S>) -> u32 {
    let below = simd.sub(simd.splat(0.0), seen.error);
    // Positive comparisons: unused lanes have NaN.
    let is_inside = simd.or(
        simd.le(seen.largest, seen.error),
        simd.le(below, seen.smallest),
    );
    let t_max = limits.t_max;
    let margin = simd.mul_add(simd.abs(t_max), simd.splat(T_ERROR), simd.splat(TINY_T));
    let begins = simd.le(seen.first_t, simd.add(t_max, margin));
    let ends = simd.le(limits.first_t, seen.last_t);
    simd.bits(simd.and(is_inside, simd.and(begins, ends)))
}

/// Where the plane is met ahead of the origin, by more than `t` may be off: nothing depends on it but whether it is worth a closer look.
#[inline(always)]
fn is_beyond_origin<S: Simd>(simd: S, seen: &Seen<S>) -> S::Mask {
    let determinant = seen.determinant(simd);
    let error = simd.mul(simd.mul(seen.error, simd.splat(4.0)), seen.farthest_t);
    let error = simd.mul(error, simd.abs(determinant));
    simd.lt(error, simd.mul(seen.weighted_t(simd), determinant))
}

/// What is said of lanes that may be hit; `None` if they are not.
#[inline(always)]
fn decided<S: Simd>(
    simd: S,
    seen: &Seen<S>,
    limits: &Limits<S>,
    possible: u32,
) -> Option<BlockVerdict> {
    let error = seen.error;
    let is_certain = is_met(simd, seen);
    // One division, whose sign the second use does not want.
    let reciprocal = simd.div(simd.splat(1.0), seen.determinant(simd));
    let t = simd.mul(seen.weighted_t(simd), reciprocal);
    let spread = simd.mul_add(
        simd.mul(error, simd.splat(4.0)),
        simd.sub(seen.last_t, seen.first_t),
        simd.splat(TINY_SUM),
    );
    let spread = simd.mul(spread, simd.abs(reciprocal));
    let rounding = simd.mul_add(seen.farthest_t, simd.splat(T_ERROR), simd.splat(TINY_T));
    let margin = simd.add(rounding, spread);
    let (start, end) = (simd.sub(t, margin), simd.add(t, margin));
    let is_outside = simd.or(simd.lt(end, limits.t_min), simd.lt(limits.t_max, start));
    let is_in_interval = simd.and(simd.lt(limits.t_min, start), simd.lt(end, limits.end));
    let possible = possible & !simd.bits(simd.and(is_certain, is_outside));
    (possible != 0).then_some(BlockVerdict {
        possible,
        certain: simd.bits(simd.and(is_certain, is_in_interval)) & possible,
        starts: simd.store(start),
        ends: simd.store(end),
    })
}

#[cfg(test)]
pub(super) mod tests;
