//! The f32 rung of the exact kernels for eight triangles at a time, and for [eight rays](super::rays) at a time.
//!
//! [`sheared`](super::sheared) has how a triangle is seen from a ray, with the bound of the weights and of the vertices' `t`.
//!
//! **Certain hits.** Where the weights have one sign for certain and their sum is `16` times the error `e` of one of them, `t` lies within
//! `3 e / (sum - 3 e)` of the triangle's range in `t`, less than `4 e / sum` of it, of the exact mean, and the roundings of `t` and of the
//! mean are below `13 u` of the largest `t`. In small triangles the products of weights and `t` underflow, by up to `2^-149` each: [`TINY_SUM`] more of their sum.
//!
//! **Rays that start on a surface** are too close to it for f32: their start is a rounding off the triangle, which looks like a hit at a `t` around zero. So
//! what is left to doubt is looked at in f64 at once, before a kernel is made: whether the plane is behind the ray.

use super::block::{BlockFilter, BlockVerdict};
use super::lanes::certainly_behind;
use super::rays::{RaysAlongAxis, RaysFilter};
use super::sheared::{DIRECTIONS, FARTHEST, Limits, Seen, Shear, T_ERROR, TINY_T, first_t};
use super::terms::is_certainly_behind;
use crate::simd::{LANES, Simd};
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
    reciprocal: f32,
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
            reciprocal: reciprocal[z as usize],
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
        verdict(simd, self.see(simd, block), &self.limits(simd, t_max))
    }

    #[inline(always)]
    fn possible_in_f64<S: Simd>(
        &self,
        simd: S,
        ray: &Ray,
        block: &TriangleBlock,
        lanes: u32,
    ) -> u32 {
        if self.t_min < 0.0 {
            return lanes;
        }
        // Of the ray, not of the filter, which may have been written a moment ago in other widths than it would be read in.
        let (origin, direction) = (ray.origin.to_array(), ray.direction.to_array());
        if lanes.is_power_of_two() {
            let triangle = block.coordinates(lanes.trailing_zeros() as usize % LANES);
            return unless_behind(lanes, is_certainly_behind(origin, direction, triangle));
        }
        let splat = |[x, y, z]: [f32; 3]| [simd.splat(x), simd.splat(y), simd.splat(z)];
        let vertex = |vertex: usize| {
            let load = |axis: Axis| block.load(simd, vertex, axis);
            [load(Axis::X), load(Axis::Y), load(Axis::Z)]
        };
        let (origin, direction) = (splat(origin), splat(direction));
        let vectors = [origin, direction, vertex(0), vertex(1), vertex(2)];
        lanes & !certainly_behind(simd, vectors, lanes)
    }
}

/// The lane of a triangle, unless it is behind.
#[inline(always)]
const fn unless_behind(lane: u32, is_behind: bool) -> u32 {
    if is_behind { 0 } else { lane }
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
            reciprocal: prepared.reciprocal.0[lane],
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
            t_min: simd.splat(self.t_min),
            first_t: simd.splat(self.first_t),
            t_max: simd.splat(t_max),
            end: simd.splat(self.t_max),
        }
    }

    /// The size of what one divides by to get from a depth to a `t`, reciprocal.
    #[inline(always)]
    pub(super) const fn reciprocal(&self) -> f32 {
        self.reciprocal.abs()
    }

    /// The triangles of a block as the ray sees them.
    #[inline(always)]
    pub(super) fn see<S: Simd>(&self, simd: S, block: &TriangleBlock) -> Seen<S> {
        let axes = self.z.around();
        let [x, y, _] = axes;
        let shear = Shear {
            x: simd.splat(self.direction[x as usize]),
            y: simd.splat(self.direction[y as usize]),
            reciprocal: simd.splat(self.reciprocal),
            along: simd.splat(self.along),
        };
        let distance = |vertex: usize, axis: Axis| {
            let origin = simd.splat(self.origin[axis as usize]);
            simd.sub(block.load(simd, vertex, axis), origin)
        };
        Seen::new(simd, &shear, axes, distance)
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
        let seen = self.0.see(simd, rays, block, triangle);
        verdict(simd, seen, &self.0.limits(simd, rays))
    }

    #[inline(always)]
    fn possible_in_f64<S: Simd>(
        &self,
        simd: S,
        rays: &RayLanes,
        block: &TriangleBlock,
        triangle: usize,
        lanes: u32,
    ) -> u32 {
        let [a, b, c] = block.coordinates(triangle);
        if lanes.is_power_of_two() {
            let lane = lanes.trailing_zeros() as usize % LANES;
            let is_behind = is_certainly_behind(rays.origin(lane), rays.direction(lane), [a, b, c]);
            return unless_behind(lanes, is_behind);
        }
        let splat = |[x, y, z]: [f32; 3]| [simd.splat(x), simd.splat(y), simd.splat(z)];
        let (origins, directions) = (rays.origins(simd), rays.directions(simd));
        let vectors = [origins, directions, splat(a), splat(b), splat(c)];
        lanes & !certainly_behind(simd, vectors, lanes)
    }

    #[inline(always)]
    fn of_lane(&self, rays: &RayLanes, lane: usize) -> ExactBlockFilter {
        ExactBlockFilter::of_lane(&self.0, rays, lane)
    }
}

/// What the exact kernels make of triangles as they are seen.
#[inline(always)]
fn verdict<S: Simd>(simd: S, seen: Seen<S>, limits: &Limits<S>) -> Option<BlockVerdict> {
    let Seen {
        vertices: [a, b, c],
        weights: [of_a, of_b, of_c],
        smallest,
        largest,
        first_t,
        last_t,
        farthest_t,
        size: _,
        error,
    } = seen;
    let below = simd.sub(simd.splat(0.0), error);

    // Positive comparisons: unused lanes have NaN.
    let is_inside = simd.or(simd.le(largest, error), simd.le(below, smallest));
    let t_max = limits.t_max;
    let margin = simd.mul_add(simd.abs(t_max), simd.splat(T_ERROR), simd.splat(TINY_T));
    let begins = simd.le(first_t, simd.add(t_max, margin));
    let ends = simd.le(limits.first_t, last_t);
    let possible = simd.bits(simd.and(is_inside, simd.and(begins, ends)));
    if possible == 0 {
        return None;
    }

    let determinant = simd.add(simd.add(of_a, of_b), of_c);
    let has_sign = simd.or(simd.lt(error, smallest), simd.lt(largest, below));
    let magnitude = simd.abs(determinant);
    let is_sharp = simd.lt(simd.mul(error, simd.splat(16.0)), magnitude);
    let sum = simd.mul(of_a, a.t);
    let sum = simd.mul_add(of_b, b.t, sum);
    let sum = simd.mul_add(of_c, c.t, sum);
    // One division, whose sign the second use does not want.
    let reciprocal = simd.div(simd.splat(1.0), determinant);
    let t = simd.mul(sum, reciprocal);
    let spread = simd.mul_add(
        simd.mul(error, simd.splat(4.0)),
        simd.sub(last_t, first_t),
        simd.splat(TINY_SUM),
    );
    let spread = simd.mul(spread, simd.abs(reciprocal));
    let rounding = simd.mul_add(farthest_t, simd.splat(T_ERROR), simd.splat(TINY_T));
    let margin = simd.add(rounding, spread);
    let (start, end) = (simd.sub(t, margin), simd.add(t, margin));
    let is_certain = simd.and(has_sign, is_sharp);
    let is_outside = simd.or(simd.lt(end, limits.t_min), simd.lt(t_max, start));
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
