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

use std::hint::black_box;

use super::behind::behind;
use super::block::{BlockFilter, BlockVerdict};
use super::rays::{RaysAlongAxis, RaysFilter};
use super::sheared::{DIRECTIONS, FARTHEST, Limits, Seen, Shear, Sight, T_ERROR, TINY_T, first_t};
use crate::simd::Simd;
use crate::{Axis, FusedRay, Ray, RayLanes, TriangleBlock};

/// More than underflow can take from a sum of weighted `t`, which is `2^-144`, and not a denormal number, with which some processors are slow.
const TINY_SUM: f32 = f32::MIN_POSITIVE;

/// A ray prepared for the filter of the exact kernels.
#[derive(Clone, Copy, Debug)]
pub struct ExactBlockFilter {
    /// What it is sheared onto: the axis of the largest direction component, but of rays that were prepared with others.
    z: Axis,
    // Arrays: an index into a vector would be a branch, and often mispredicted.
    origin: [f32; 3],
    direction: [f32; 3],
    minus_reciprocal: f32,
    /// The size of the largest direction component, and some roundings.
    along: f32,
    t_min: f32,
    /// What a computed `t` may be for an exact one from `t_min` on.
    first_t: f32,
    t_max: f32,
    decides: bool,
}

impl BlockFilter for ExactBlockFilter {
    type Rays = ExactRaysFilter;

    #[inline(always)]
    fn new(ray: &Ray, fused: &FusedRay) -> Self {
        let z = Axis::dominant(ray.direction);
        let direction: &[f32; 3] = ray.direction.as_ref();
        let reciprocal: &[f32; 4] = fused.reciprocal.as_ref();
        let along = fused.largest;
        Self {
            z,
            origin: *ray.origin.as_ref(),
            direction: *direction,
            // The largest component is not clamped.
            minus_reciprocal: -reciprocal[z as usize],
            along: along * (1.0 + T_ERROR),
            t_min: ray.t_min,
            first_t: first_t(ray.t_min),
            t_max: ray.t_max,
            decides: DIRECTIONS.contains(&along) && fused.farthest <= FARTHEST,
        }
    }

    #[inline(always)]
    fn test<S: Simd>(&self, simd: S, block: &TriangleBlock, t_max: f32) -> Option<BlockVerdict> {
        if !self.decides {
            return BlockVerdict::undecided(block.used());
        }
        verdict(simd, &self.before(simd, block), &self.limits(simd, t_max))
    }
}

impl ExactBlockFilter {
    /// Whether the filter says anything of triangles.
    #[inline(always)]
    pub(super) const fn decides(&self) -> bool {
        self.decides
    }

    /// That of a ray that was prepared with others.
    #[inline(always)]
    pub(super) fn of_lane(prepared: &RaysAlongAxis, rays: &RayLanes, lane: usize) -> Self {
        Self {
            z: prepared.axis,
            origin: rays.origin(lane),
            direction: rays.direction(lane),
            minus_reciprocal: prepared.minus_reciprocal.0[lane],
            along: prepared.along.0[lane],
            t_min: rays.t_min.0[lane],
            first_t: prepared.first_t.0[lane],
            t_max: prepared.end.0[lane],
            decides: true,
        }
    }

    /// The interval of the ray.
    #[inline(always)]
    pub(super) fn limits<S: Simd>(&self, simd: S, t_max: f32) -> Limits<S> {
        Limits {
            is_ahead: self.t_min >= 0.0,
            t_min: simd.splat(self.t_min),
            first_t: simd.splat(self.first_t),
            t_max: simd.splat(t_max),
            end: simd.splat(self.t_max),
        }
    }

    /// The size of what one divides by to get from a depth to a `t`, reciprocal.
    #[inline(always)]
    pub(super) const fn reciprocal(&self) -> f32 {
        self.minus_reciprocal.abs()
    }

    /// The triangles of a block before the ray.
    #[inline(always)]
    pub(super) const fn before<'a, S: Simd>(
        &'a self,
        simd: S,
        block: &'a TriangleBlock,
    ) -> BeforeRay<'a, S> {
        BeforeRay {
            simd,
            axes: self.z.around(),
            ray: self,
            block,
        }
    }
}

/// The triangles of a block before a ray.
#[derive(Clone, Copy)]
pub(super) struct BeforeRay<'a, S> {
    simd: S,
    axes: [Axis; 3],
    ray: &'a ExactBlockFilter,
    block: &'a TriangleBlock,
}

impl<S: Simd> Sight<S> for BeforeRay<'_, S> {
    #[inline(always)]
    fn axes(&self) -> [Axis; 3] {
        self.axes
    }

    #[inline(always)]
    fn shear(&self) -> Shear<S> {
        let Self {
            simd, axes, ray, ..
        } = *self;
        let [x, y, _] = axes;
        Shear {
            x: simd.splat(ray.direction[x as usize]),
            y: simd.splat(ray.direction[y as usize]),
            minus_reciprocal: simd.splat(ray.minus_reciprocal),
            along: simd.splat(ray.along),
        }
    }

    #[inline(always)]
    fn to_origin(&self, vertex: usize, axis: Axis) -> S::F32s {
        let origin = self.simd.splat(self.ray.origin[axis as usize]);
        self.simd
            .sub(origin, self.block.load(self.simd, vertex, axis))
    }

    #[inline(always)]
    fn anew(self) -> Self {
        Self {
            block: black_box(self.block),
            ..self
        }
    }
}

/// Eight rays prepared for the filter of the exact kernels.
#[derive(Clone, Copy, Debug)]
pub struct ExactRaysFilter(RaysAlongAxis);

impl RaysFilter for ExactRaysFilter {
    type Block = ExactBlockFilter;

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
    fn of_lane(&self, rays: &RayLanes, lane: usize) -> ExactBlockFilter {
        ExactBlockFilter::of_lane(&self.0, rays, lane)
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
    let below = simd.sub(simd.splat(0.0), error);
    let has_sign = simd.or(simd.lt(error, seen.smallest), simd.lt(seen.largest, below));
    let is_certain = simd.and(has_sign, seen.is_sharp(simd));
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
