//! The f32 rung of the exact kernels for eight triangles at a time.
//!
//! The ray is sheared onto the axis `z` of its largest direction component (Woop, Benthin, Wald 2013). A vertex at `f` from the origin has
//! the parameter `t = f.z / D.z` and is projected to `X = f.x - D.x t`, `Y = f.y - D.y t`. The edge functions of the projected triangle,
//! `U = C.X B.Y - C.Y B.X` and so on in turn, weigh the opposite vertices; the ray hits the closed triangle where no two of them have opposite signs and their
//! sum is not zero, at the mean of the vertices' `t` by these weights.
//!
//! **Errors**, with `u = 2^-24`, `P` the largest `|X|` and `|Y|` that were computed and `Z` the largest `|f.z|`. `f` carries one rounding, `t` three (of
//! `f.z`, the reciprocal and the product), and `X` two more. As `|D.x t| <= |f.z|` and `|f.x| <= |X| + |f.z|`, a coordinate is off by at most
//! `u (|X| + |f.z|) + 4 u |f.z| + u |X| <= u (2 P + 5 Z)`. An edge function is the difference of two products of at most `P^2`, so it is off by at most `4 P` times that,
//! and `4 u P^2` for its own three roundings (two if products are fused): together below `20.1 u P (P + Z)`. [`ERROR`] has a fifth more.
//!
//! **Range.** With `D.z` in `[2^-30, 2^20]` and `f` up to `2^30`, edge functions are below `2^64`, their products with a `t` below `2^124`, and nothing overflows: a sum that did
//! would look like a `t` beyond all others. What underflows, `2^-149` of a `t`, a product or a coordinate, moves an edge function by at
//! most `2^-126 (P + 1)`, which [`TINY`] covers. For other rays the filter says nothing.
//!
//! **The interval.** All points of a triangle have a `t` between the smallest and the largest of its vertices. Those are off by `3.01 u` of themselves, and their signs are exact.
//!
//! **Certain hits.** Where the weights have one sign for certain and their sum is `16` times the error `e` of one of them, `t` lies within
//! `3 e / (sum - 3 e)` of the triangle's range in `t`, less than `4 e / sum` of it, of the exact mean, and the roundings of `t` and of the
//! mean are below `13 u` of the largest `t`. In small triangles the products of weights and `t` underflow, by up to `2^-149` each: [`TINY_SUM`] more of their sum.
//!
//! **Rays that start on a surface** are too close to it for f32: their start is a rounding off the triangle, which looks like a hit at a `t` around zero. So
//! what is left to doubt is looked at in f64 at once, lane by lane, before a kernel is made: whether the plane is behind the ray.

use super::block::{BlockFilter, BlockVerdict};
use super::terms::is_certainly_behind;
use crate::simd::{Simd, lanes_of};
use crate::{Axis, FusedRay, Ray, TriangleBlock};

/// The bound of the edge functions, relative to `P (P + Z)`.
const ERROR: f32 = 24.0 / (1u32 << 24) as f32;
/// More than underflow can take from an edge function, if times `P + 1`.
const TINY: f32 = 1.0 / (1u128 << 120) as f32;
/// More than the error of a `t`, relative to the largest one of a triangle.
const T_ERROR: f32 = 16.0 / (1u32 << 24) as f32;
/// More than underflow can take from a `t`, which is `2^-140`, and not a denormal number, with which some processors are slow.
const TINY_T: f32 = 1.0 / (1u128 << 120) as f32;
/// More than underflow can take from a sum of weighted `t`, which is `2^-144`, and not a denormal number either.
const TINY_SUM: f32 = f32::MIN_POSITIVE;
/// The range of the largest direction component in which the filter decides.
const DIRECTIONS: std::ops::RangeInclusive<f32> = 1.0 / (1u32 << 30) as f32..=(1u32 << 20) as f32;
/// The largest distance at which the filter decides.
const FARTHEST: f32 = (1u32 << 30) as f32;

/// A ray prepared for the filter of the exact kernels.
#[derive(Clone, Copy, Debug)]
pub struct ExactBlockFilter {
    /// The axis of the largest direction component.
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

/// A vertex of each triangle: where its depth is on the ray, and where it is seen from it.
pub(super) struct Projected<S: Simd> {
    t: S::F32s,
    x: S::F32s,
    y: S::F32s,
}

/// Triangles as a ray sees them.
pub(super) struct Seen<S: Simd> {
    vertices: [Projected<S>; 3],
    /// The edge functions, which weigh the opposite vertices.
    weights: [S::F32s; 3],
    /// The smallest and the largest of the weights.
    pub(super) smallest: S::F32s,
    pub(super) largest: S::F32s,
    /// The smallest and the largest `t` of the vertices.
    pub(super) first_t: S::F32s,
    pub(super) last_t: S::F32s,
    /// The larger magnitude of these.
    pub(super) farthest_t: S::F32s,
    /// The largest coordinate of the projected vertices.
    pub(super) size: S::F32s,
    /// The bound of the error of the weights.
    pub(super) error: S::F32s,
}

impl BlockFilter for ExactBlockFilter {
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
            first_t: ray.t_min - (ray.t_min.abs() * T_ERROR + TINY_T),
            t_max: ray.t_max,
            decides: DIRECTIONS.contains(&along) && fused.farthest <= FARTHEST,
        }
    }

    #[inline(always)]
    fn test<S: Simd>(&self, simd: S, block: &TriangleBlock, t_max: f32) -> Option<BlockVerdict> {
        if !self.decides {
            return BlockVerdict::undecided(block.used());
        }
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
        } = self.see(simd, block);
        let below = simd.sub(simd.splat(0.0), error);

        // Positive comparisons: unused lanes have NaN.
        let is_inside = simd.or(simd.le(largest, error), simd.le(below, smallest));
        let margin = t_max.abs() * T_ERROR + TINY_T;
        let begins = simd.le(first_t, simd.splat(t_max + margin));
        let ends = simd.le(simd.splat(self.first_t), last_t);
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
        let is_outside = simd.or(
            simd.lt(end, simd.splat(self.t_min)),
            simd.lt(simd.splat(t_max), start),
        );
        let is_in_interval = simd.and(
            simd.lt(simd.splat(self.t_min), start),
            simd.lt(end, simd.splat(self.t_max)),
        );
        let possible = possible & !simd.bits(simd.and(is_certain, is_outside));
        (possible != 0).then_some(BlockVerdict {
            possible,
            certain: simd.bits(simd.and(is_certain, is_in_interval)) & possible,
            starts: simd.store(start),
            ends: simd.store(end),
        })
    }

    #[inline(always)]
    fn possible_in_f64(&self, ray: &Ray, block: &TriangleBlock, lanes: u32) -> u32 {
        if self.t_min < 0.0 {
            return lanes;
        }
        // Of the ray, not of the filter, which may have been written a moment ago in other widths than it would be read in.
        let (origin, direction) = (ray.origin.to_array(), ray.direction.to_array());
        let mut possible = lanes;
        for lane in lanes_of(lanes) {
            let triangle = block.coordinates(lane);
            let is_behind = is_certainly_behind(origin, direction, triangle);
            possible &= !(u32::from(is_behind) << lane);
        }
        possible
    }
}

impl ExactBlockFilter {
    /// Whether the filter says anything of triangles.
    #[inline(always)]
    pub(super) const fn decides(&self) -> bool {
        self.decides
    }

    #[inline(always)]
    pub(super) const fn t_min(&self) -> f32 {
        self.t_min
    }

    /// The size of what one divides by to get from a depth to a `t`, reciprocal.
    #[inline(always)]
    pub(super) const fn reciprocal(&self) -> f32 {
        self.reciprocal.abs()
    }

    /// The triangles of a block as the ray sees them.
    #[inline(always)]
    pub(super) fn see<S: Simd>(&self, simd: S, block: &TriangleBlock) -> Seen<S> {
        let a = self.project(simd, block, 0);
        let b = self.project(simd, block, 1);
        let c = self.project(simd, block, 2);
        let of_a = edge_function(simd, &c, &b);
        let of_b = edge_function(simd, &a, &c);
        let of_c = edge_function(simd, &b, &a);
        let first_t = simd.min(simd.min(a.t, b.t), c.t);
        let last_t = simd.max(simd.max(a.t, b.t), c.t);
        let farthest_t = simd.max(simd.abs(first_t), simd.abs(last_t));
        let size = simd.max(simd.max(size(simd, &a), size(simd, &b)), size(simd, &c));
        Seen {
            smallest: simd.min(simd.min(of_a, of_b), of_c),
            largest: simd.max(simd.max(of_a, of_b), of_c),
            error: self.error(simd, size, farthest_t),
            vertices: [a, b, c],
            weights: [of_a, of_b, of_c],
            first_t,
            last_t,
            farthest_t,
            size,
        }
    }

    #[inline(always)]
    fn project<S: Simd>(&self, simd: S, block: &TriangleBlock, vertex: usize) -> Projected<S> {
        let (x, y) = (self.z.next(), self.z.next().next());
        let t = simd.mul(
            self.difference_to_origin(simd, block, vertex, self.z),
            simd.splat(self.reciprocal),
        );
        let direction_x = simd.splat(self.direction[x as usize]);
        let direction_y = simd.splat(self.direction[y as usize]);
        Projected {
            t,
            x: simd.neg_mul_add(
                direction_x,
                t,
                self.difference_to_origin(simd, block, vertex, x),
            ),
            y: simd.neg_mul_add(
                direction_y,
                t,
                self.difference_to_origin(simd, block, vertex, y),
            ),
        }
    }

    #[inline(always)]
    fn difference_to_origin<S: Simd>(
        &self,
        simd: S,
        block: &TriangleBlock,
        vertex: usize,
        axis: Axis,
    ) -> S::F32s {
        let origin = simd.splat(self.origin[axis as usize]);
        simd.sub(block.load(simd, vertex, axis), origin)
    }

    /// The bound of the error of the edge functions.
    #[inline(always)]
    fn error<S: Simd>(&self, simd: S, size: S::F32s, farthest_t: S::F32s) -> S::F32s {
        let extent = simd.mul_add(farthest_t, simd.splat(self.along), size);
        let tiny = simd.splat(TINY);
        let scale = simd.mul_add(extent, simd.splat(ERROR), tiny);
        simd.mul_add(size, scale, tiny)
    }
}

/// Twice the signed area of the triangle of the origin and two projected vertices.
#[inline(always)]
fn edge_function<S: Simd>(simd: S, from: &Projected<S>, to: &Projected<S>) -> S::F32s {
    simd.mul_sub(from.x, to.y, simd.mul(from.y, to.x))
}

/// The larger coordinate of a projected vertex.
#[inline(always)]
fn size<S: Simd>(simd: S, vertex: &Projected<S>) -> S::F32s {
    simd.max(simd.abs(vertex.x), simd.abs(vertex.y))
}

#[cfg(test)]
mod tests;
