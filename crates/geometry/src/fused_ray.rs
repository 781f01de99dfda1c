//! Box tests of one operation per plane that never lose a hit.
//!
//! The second way of [`conservative_ray`](crate::ConservativeRay), for nodes whose planes come in vectors: a plane at `p` is met at `p r + c`, with `r` the
//! reciprocal of the direction and `c = -(o + s) r` for near planes, `c = -(o - s) r` for far planes, where `s` shifts the origin in the direction of the ray.
//! It takes one operation instead of two and one constant less, and its errors, unlike those of the first way, do not shrink with the distance
//! of the plane: they are those of the coordinates themselves.
//!
//! **The shift.** Let `u = 2^-24` and `B` be the largest coordinate of the bounds. The sum `p r + c` has the relative error of `r`, which
//! is one rounding of the direction's reciprocal, and its own rounding: `2 u |p - o| |r|` together. The product, where it is not fused, is off by
//! `u |p r|`, and `c` by two roundings, `2 u |o r|`. With `|p| <= B` these are below `u (3 B + 4 |o|) |r|`: less than a
//! shift of the origin by `u (4 B + 8 |o|)` makes up for. The reach of a kernel is added to it. Nothing here needs more than one axis, so the way from a ray to its first node is
//! short.
//!
//! **Directions along a plane.** Components below `2^-94` are replaced by that size with their sign. With a largest component `d` of at least `2^-30` and an origin within
//! `2^40 B`, this moves the ray by at most `2^-64 (B + |o|) < 2^-23 B` inside the bounds, less than the shift. Divided by `2^-94` the shift
//! is more than the ray's way through the bounds, `2^41 B / d`: a ray in the face of a box is in the slab for every `t` that counts.
//!
//! **Extremes.** For directions outside `[2^-30, 2^30]`, origins beyond `2^40 B` and a `B` outside `[2^-60, 2^60]`, `c` is infinite and nothing is culled, every answer
//! stays right. Inside, what underflows is below `2^-148`, and divided by `r` below `2^-118`, which the shift covers. A product that overflows gives NaN, which the
//! vector maxima and minima drop.

use std::ops::RangeInclusive;

use glam::Vec4;

use crate::{Aabb, Ray, kernel};

/// A ray prepared for vector box tests that never lose a hit of a kernel. The fourth components mean nothing.
#[derive(Clone, Copy, Debug)]
pub struct FusedRay {
    /// Reciprocal of the direction, with zero clamped to a signed power of two.
    pub reciprocal: Vec4,
    /// What is added for the planes that the ray meets first.
    pub near: Vec4,
    /// What is added for the planes that the ray meets last.
    pub far: Vec4,
    /// Whether the direction is negative: bit `i` for axis `i`. Set for -0.0.
    pub negative: u32,
    /// No coordinate differs more between the origin and the bounds.
    pub farthest: f32,
}

/// Direction components are kept above this.
const SMALLEST_COMPONENT: f32 = 1.0 / (1u128 << 94) as f32;
/// The shift of the origin, relative to the sizes of the bounds.
const SHIFT: f32 = 4.0 / (1u32 << 24) as f32;
/// The size of the largest direction component with which boxes are culled.
const DIRECTIONS: RangeInclusive<f32> = 1.0 / (1u64 << 30) as f32..=(1u64 << 30) as f32;
/// The sizes of bounds with which boxes are culled.
const SIZES: RangeInclusive<f32> = 1.0 / (1u64 << 60) as f32..=(1u64 << 60) as f32;
/// The largest origin with which boxes are culled, in sizes of the bounds.
const FARTHEST_ORIGIN: f32 = (1u64 << 40) as f32;

/// The largest magnitude of a coordinate of a box that is not empty: what [`FusedRay::new`] wants to know of a structure.
#[must_use]
pub fn size_of_bounds(bounds: &Aabb) -> f32 {
    bounds.min.abs().max(bounds.max.abs()).max_element()
}

impl FusedRay {
    /// Prepares a valid ray for a structure whose bounds have the given [size](size_of_bounds) and a kernel with the given
    /// [`REACH`](crate::TriangleKernel::REACH).
    #[inline(always)]
    #[must_use]
    pub fn new(ray: &Ray, size: f32, reach: f32) -> Self {
        // All axes at a time; the fourth is harmless.
        let origin = ray.origin.extend(0.0);
        let direction = ray.direction.extend(0.0);
        let magnitudes = direction.abs();
        let reciprocal = magnitudes
            .max(Vec4::splat(SMALLEST_COMPONENT))
            .copysign(direction)
            .recip();
        let farthest = (size + origin.abs().max_element()) * (1.0 + SHIFT);
        let mut shift = origin.abs() * (2.0 * SHIFT) + Vec4::splat(size * SHIFT);
        if reach > 0.0 {
            #[expect(
                clippy::cast_possible_truncation,
                reason = "the factor covers the rounding"
            )]
            let reach = kernel::reach(reach, f64::from(farthest)) as f32;
            shift += reach * (1.0 + SHIFT);
        }
        // What is not in these ranges, NaN included, culls nothing.
        let culls = DIRECTIONS.contains(&magnitudes.max_element())
            && SIZES.contains(&size)
            && farthest <= size * FARTHEST_ORIGIN;
        if !culls {
            shift = Vec4::INFINITY;
        }
        let shift = shift.copysign(direction);
        Self {
            reciprocal,
            near: -(origin + shift) * reciprocal,
            far: -(origin - shift) * reciprocal,
            negative: direction.is_negative_bitmask() & 7,
            farthest,
        }
    }
}
