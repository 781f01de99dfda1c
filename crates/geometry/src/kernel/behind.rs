//! Whether planes are behind the origin, in vectors of f32: what rays ask that start on a surface.
//!
//! Such an origin is a rounding off its triangle, which looks like a hit at a `t` around zero: sheared onto the ray, a coordinate loses as much as the origin is off. On which side
//! of the plane it is can be told without the shear, from differences of coordinates that are nearly exact.
//!
//! **Volume.** With `f` and `t` of vertices as in [`sheared`](super::sheared), let `p = (f.x, f.y, t)`. The plane is met at `t = p_A . (p_C x p_B) / determinant`, as the mean of the vertices' `t` by
//! their weights is the same with `f.x` and `f.y` in place of `X` and `Y`: adding one column of a determinant to others does not change it. So where volume and determinant have different signs, both certain, the
//! plane is met before the origin.
//!
//! **Error**, with `u = 2^-24`. `f` carries one rounding and `t` two, and that of the reciprocal, which all three have in common and which changes no sign. A product of three components carries five more: its two products,
//! a difference and two sums. Together the six products are off by less than `9.01 u` each, `54.1 u` of the product of the largest `|f.x|`, `|f.y|` and `|t|`. [`ERROR`] has a tenth more, for the roundings of the bound.
//! As it is a product by columns, it is small where a triangle is in a plane along axes: there all `f` have one component that is as small as the origin is off.
//!
//! **Range.** With `f` up to `2^30` and `t` up to `2^60` the volume is below `2^123`; its product with a determinant may become infinite, with the right sign. What underflows, `2^-150` of each `t`, product or sum, is multiplied by
//! at most two other components, and moves the volume and its bound by less than `2^-86` in all, which [`TINY`] covers.

use super::sheared::{Seen, Sight};
use crate::simd::Simd;

/// The bound of the volume, relative to the product of the largest components.
const ERROR: f32 = 60.0 / (1u32 << 24) as f32;
/// More than underflow can take from the volume.
const TINY: f32 = 1.0 / (1u128 << 84) as f32;

/// The lanes whose planes are certainly met before the origin.
#[inline(always)]
pub(super) fn behind<S: Simd>(simd: S, seen: &Seen<S>, sight: &impl Sight<S>) -> u32 {
    let a = vertex(seen, sight, 0);
    let b = vertex(seen, sight, 1);
    let c = vertex(seen, sight, 2);
    let largest_x = largest(simd, [a[0], b[0], c[0]]);
    let largest_y = largest(simd, [a[1], b[1], c[1]]);
    let product = simd.mul(simd.mul(largest_x, largest_y), seen.farthest_t);
    let error = simd.mul_add(product, simd.splat(ERROR), simd.splat(TINY));

    let volume = simd.mul(a[2], cross(simd, [c[0], c[1]], [b[0], b[1]]));
    let volume = simd.mul_add(a[1], cross(simd, [c[2], c[0]], [b[2], b[0]]), volume);
    let volume = simd.mul_add(a[0], cross(simd, [c[1], c[2]], [b[1], b[2]]), volume);
    let has_sign = simd.and(simd.lt(error, simd.abs(volume)), seen.is_sharp(simd));
    let product = simd.mul(volume, seen.determinant(simd));
    simd.bits(simd.and(has_sign, simd.lt(product, simd.splat(0.0))))
}

/// The way from a vertex to the origin across the shear, and its `t`.
#[inline(always)]
fn vertex<S: Simd>(seen: &Seen<S>, sight: &impl Sight<S>, number: usize) -> [S::F32s; 3] {
    let [x, y, _] = sight.axes();
    [
        sight.to_origin(number, x),
        sight.to_origin(number, y),
        seen.vertices[number].t,
    ]
}

/// The largest magnitude.
#[inline(always)]
fn largest<S: Simd>(simd: S, [a, b, c]: [S::F32s; 3]) -> S::F32s {
    simd.max(simd.max(simd.abs(a), simd.abs(b)), simd.abs(c))
}

/// The product of two vectors of two components that is zero where they are parallel.
#[inline(always)]
fn cross<S: Simd>(simd: S, p: [S::F32s; 2], q: [S::F32s; 2]) -> S::F32s {
    simd.mul_sub(p[0], q[1], simd.mul(p[1], q[0]))
}

#[cfg(test)]
pub(super) mod tests;
