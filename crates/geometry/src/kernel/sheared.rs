//! Triangles as rays see them, in vectors of f32: what the filters of the kernels begin with.
//!
//! A ray is sheared onto an axis `z` (Woop, Benthin, Wald 2013). A vertex `V`, with `f = O - V`, has
//! the parameter `t = -f.z / D.z` and is projected to `X = f.x + D.x t`, `Y = f.y + D.y t`. The edge functions of the projected triangle,
//! `U = C.X B.Y - C.Y B.X` and so on in turn, weigh the opposite vertices; the ray hits the closed triangle where no two of them have opposite signs and their
//! sum is not zero, at the mean of the vertices' `t` by these weights. (The way from the vertex to the origin and not the other one, as processors subtract a number in memory in one
//! instruction: nine loads less for a block. It turns the projection by half a turn, which edge functions do not see.)
//!
//! A lane is a triangle of one ray, or a ray of one triangle. A ray alone is sheared onto the axis of its largest direction component; eight rays onto a common axis, along which each of them
//! has at least half of its largest component.
//!
//! **Errors**, with `u = 2^-24`, `P` the largest `|X|` and `|Y|` that were computed, `d` the largest component of `D` and `Z` the largest `d |t|`, which `|f.z|`, `|D.x t|` and `|D.y t|` are not
//! above. `f` carries one rounding, `t` three (of `f.z`, the reciprocal and the product), and `X` two more. As `|f.x| <= |X| + |D.x t|`, a coordinate is off by at most
//! `u (|X| + Z) + 4 u Z + u |X| <= u (2 P + 5 Z)`. An edge function is the difference of two products of at most `P^2`, so it is off by at most `4 P` times that,
//! and `4 u P^2` for its own three roundings (two if products are fused): together below `20.1 u P (P + Z)`. [`ERROR`] has a fifth more.
//!
//! **Range.** With `D.z` from `2^-30` on, `d` up to `2^20` and to `2 |D.z|`, and `f` up to `2^30`, coordinates are below `2^31.6`, edge functions below `2^64.2`, the sum of three products with a `t` below
//! `2^126`, and nothing overflows: a sum that did
//! would look like a `t` beyond all others. What underflows, `2^-149` of a `t`, a product or a coordinate, moves an edge function by at
//! most `2^-126 (P + 1)`, which [`TINY`] covers. For other rays the filters say nothing.
//!
//! **The interval.** All points of a triangle have a `t` between the smallest and the largest of its vertices. Those are off by `3.01 u` of themselves, and their signs are exact.

use std::ops::RangeInclusive;

use crate::Axis;
use crate::simd::Simd;

/// The bound of the edge functions, relative to `P (P + Z)`.
const ERROR: f32 = 24.0 / (1u32 << 24) as f32;
/// More than underflow can take from an edge function, if times `P + 1`.
const TINY: f32 = 1.0 / (1u128 << 120) as f32;
/// More than the error of a `t`, relative to the largest one of a triangle; also some roundings.
pub(super) const T_ERROR: f32 = 16.0 / (1u32 << 24) as f32;
/// More than underflow can take from a `t`, which is `2^-140`, and not a denormal number, with which some processors are slow.
pub(super) const TINY_T: f32 = 1.0 / (1u128 << 120) as f32;
/// The range of the direction components in which filters decide: of that along the axis from the one on, of the largest up to the other.
pub(crate) const DIRECTIONS: RangeInclusive<f32> = 1.0 / (1u32 << 30) as f32..=(1u32 << 20) as f32;
/// The largest distance at which filters decide.
pub(crate) const FARTHEST: f32 = (1u32 << 30) as f32;

/// What vertices are projected with.
pub(super) struct Shear<S: Simd> {
    /// The direction's other components, in cyclic order.
    pub(super) x: S::F32s,
    pub(super) y: S::F32s,
    /// Minus the reciprocal of the component along the axis.
    pub(super) minus_reciprocal: S::F32s,
    /// The size of the largest component, and some roundings.
    pub(super) along: S::F32s,
}

/// The interval of a ray.
pub(super) struct Limits<S: Simd> {
    /// Whether it begins at the origin or later.
    pub(super) is_ahead: bool,
    pub(super) t_min: S::F32s,
    /// What a computed `t` may be for an exact one from `t_min` on.
    pub(super) first_t: S::F32s,
    /// The largest `t` that still matters.
    pub(super) t_max: S::F32s,
    /// The end of the interval.
    pub(super) end: S::F32s,
}

/// What a computed `t` may be for an exact one from `t_min` on.
#[inline(always)]
pub(super) fn first_t(t_min: f32) -> f32 {
    t_min - (t_min.abs() * T_ERROR + TINY_T)
}

/// Triangles before a ray, or a triangle before rays.
pub(super) trait Sight<S: Simd>: Copy {
    /// The axes in cyclic order, that of the shear last.
    fn axes(&self) -> [Axis; 3];

    /// What vertices are projected with.
    fn shear(&self) -> Shear<S>;

    /// The way from a vertex to the origin along an axis.
    fn to_origin(&self, vertex: usize, axis: Axis) -> S::F32s;

    /// The same, to be read from memory again: so what is seldom wanted twice is not kept.
    fn anew(self) -> Self;
}

/// A vertex of each triangle: where its depth is on the ray, and where it is seen from it.
pub(super) struct Projected<S: Simd> {
    pub(super) t: S::F32s,
    x: S::F32s,
    y: S::F32s,
}

impl<S: Simd> Projected<S> {
    /// Projects a vertex, given the way from it to the origin: along the other axes, in cyclic order, and along that of the shear.
    #[inline(always)]
    fn new(simd: S, shear: &Shear<S>, [x, y, z]: [S::F32s; 3]) -> Self {
        let t = simd.mul(z, shear.minus_reciprocal);
        Self {
            t,
            x: simd.mul_add(shear.x, t, x),
            y: simd.mul_add(shear.y, t, y),
        }
    }

    /// The larger coordinate.
    #[inline(always)]
    fn size(&self, simd: S) -> S::F32s {
        simd.max(simd.abs(self.x), simd.abs(self.y))
    }
}

/// Triangles as a ray sees them, or a triangle as rays see it.
pub(super) struct Seen<S: Simd> {
    pub(super) vertices: [Projected<S>; 3],
    /// The edge functions, which weigh the opposite vertices.
    pub(super) weights: [S::F32s; 3],
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

impl<S: Simd> Seen<S> {
    /// Projects the vertices.
    #[inline(always)]
    pub(super) fn new(simd: S, sight: &impl Sight<S>) -> Self {
        let shear = sight.shear();
        let a = Projected::new(simd, &shear, to_origin(sight, 0));
        let b = Projected::new(simd, &shear, to_origin(sight, 1));
        let c = Projected::new(simd, &shear, to_origin(sight, 2));
        let of_a = edge_function(simd, &c, &b);
        let of_b = edge_function(simd, &a, &c);
        let of_c = edge_function(simd, &b, &a);
        let first_t = simd.min(simd.min(a.t, b.t), c.t);
        let last_t = simd.max(simd.max(a.t, b.t), c.t);
        let farthest_t = simd.max(simd.abs(first_t), simd.abs(last_t));
        let size = simd.max(simd.max(a.size(simd), b.size(simd)), c.size(simd));
        let extent = simd.mul_add(farthest_t, shear.along, size);
        let tiny = simd.splat(TINY);
        let scale = simd.mul_add(extent, simd.splat(ERROR), tiny);
        Self {
            smallest: simd.min(simd.min(of_a, of_b), of_c),
            largest: simd.max(simd.max(of_a, of_b), of_c),
            error: simd.mul_add(size, scale, tiny),
            vertices: [a, b, c],
            weights: [of_a, of_b, of_c],
            first_t,
            last_t,
            farthest_t,
            size,
        }
    }
}

impl<S: Simd> Seen<S> {
    /// The sum of the weights.
    #[inline(always)]
    pub(super) fn determinant(&self, simd: S) -> S::F32s {
        let [of_a, of_b, of_c] = self.weights;
        simd.add(simd.add(of_a, of_b), of_c)
    }

    /// The sum of the vertices' `t`, weighted: by the determinant it is the `t` of the plane.
    #[inline(always)]
    pub(super) fn weighted_t(&self, simd: S) -> S::F32s {
        let ([a, b, c], [of_a, of_b, of_c]) = (&self.vertices, self.weights);
        let sum = simd.mul(of_a, a.t);
        let sum = simd.mul_add(of_b, b.t, sum);
        simd.mul_add(of_c, c.t, sum)
    }

    /// Where the determinant is 16 times the bound of the error of a weight: more than five times that of its own.
    #[inline(always)]
    pub(super) fn is_sharp(&self, simd: S) -> S::Mask {
        let error = simd.mul(self.error, simd.splat(16.0));
        simd.lt(error, simd.abs(self.determinant(simd)))
    }
}

/// The way from a vertex to the origin along all axes.
#[inline(always)]
fn to_origin<S: Simd>(sight: &impl Sight<S>, vertex: usize) -> [S::F32s; 3] {
    let [x, y, z] = sight.axes();
    [
        sight.to_origin(vertex, x),
        sight.to_origin(vertex, y),
        sight.to_origin(vertex, z),
    ]
}

/// Twice the signed area of the triangle of the origin and two projected vertices.
#[inline(always)]
fn edge_function<S: Simd>(simd: S, from: &Projected<S>, to: &Projected<S>) -> S::F32s {
    simd.mul_sub(from.x, to.y, simd.mul(from.y, to.x))
}
