//! Box tests of one operation per plane that never lose a hit.
//!
//! The second way of [`conservative_ray`](crate::ConservativeRay), for nodes whose planes come in vectors: a plane at `p` is met at `p r + c`, with `r` the
//! reciprocal of the direction and `c = -(o + s) r` for near planes, `c = -(o - s) r` for far planes, where `s` shifts the origin in the direction of the ray.
//! It takes one operation instead of two and one constant less, and its errors, unlike those of the first way, do not shrink with the distance
//! of the plane: they are those of the coordinates themselves.
//!
//! **The shift.** Let `u = 2^-24` and `M` be the largest coordinate difference between the origin and a plane. The sum `p r + c` has the relative error of `r`, which
//! is one rounding of the direction's reciprocal, and its own rounding: `2 u M |r|` together. The product, where it is not fused, is off by
//! `u |p r|`, and `c` by two roundings, `2 u |o r|`. With `|p| <= M + |o|` these are below `3 u (M + |o|) |r|`: less than a
//! shift of the origin by `4 u (M + |o|)` makes up for. The reach of a kernel is added to it, and `2^-110`, which is more than what
//! underflows in directions up to `2^30`.
//!
//! **Directions along a plane** are replaced as there: by at least `2^-64` of the largest component. Divided by that, the shift is more than the ray's way
//! through the bounds.
//!
//! **Extremes** are those of the first way. Then `c` is infinite and nothing is culled. A product that overflows gives NaN, which the vector maxima and minima drop.

use glam::Vec3;

use crate::{Aabb, Ray, kernel};

/// A ray prepared for vector box tests that never lose a hit of a kernel.
#[derive(Clone, Copy, Debug)]
pub struct FusedRay {
    /// Reciprocal of the direction, with zero clamped to a signed power of two.
    pub reciprocal: Vec3,
    /// What is added for the planes that the ray meets first.
    pub near: Vec3,
    /// What is added for the planes that the ray meets last.
    pub far: Vec3,
    /// Whether the direction is negative, for each axis; -0.0 counts as negative.
    pub negative: [bool; 3],
    /// The largest difference of a coordinate between the origin and the bounds.
    pub farthest: f32,
}

/// Direction components are kept above this part of the largest one.
const SMALLEST_COMPONENT: f32 = 1.0 / (1u128 << 64) as f32;
/// The shift of the origin, relative to the sizes of the coordinates.
const SHIFT: f32 = 4.0 / (1u32 << 24) as f32;
/// The least shift of the origin.
const SMALLEST_SHIFT: f32 = 1.0 / (1u128 << 110) as f32;
/// Beyond this size of the distances, and below its reciprocal for the direction, nothing is culled.
const EXTREME: f32 = (1u64 << 60) as f32;
/// Beyond this size of the direction nothing is culled.
const LARGEST_DIRECTION: f32 = (1u64 << 30) as f32;

impl FusedRay {
    /// Prepares a valid ray for a structure with the given bounds, which are not empty, and a kernel with the given
    /// [`REACH`](crate::TriangleKernel::REACH).
    #[inline(always)]
    #[must_use]
    pub fn new(ray: &Ray, bounds: &Aabb, reach: f32) -> Self {
        let Ray {
            origin, direction, ..
        } = *ray;
        // Rounded twice: the difference, and the factor.
        let farthest = (bounds.min - origin)
            .abs()
            .max((bounds.max - origin).abs())
            .max_element()
            * (1.0 + SHIFT);
        let magnitudes = direction.abs();
        let largest = magnitudes.max_element();
        let smallest = Vec3::splat(largest * SMALLEST_COMPONENT);
        let reciprocal = magnitudes.max(smallest).copysign(direction).recip();
        let mut shift =
            (Vec3::splat(farthest) + origin.abs()) * SHIFT + Vec3::splat(SMALLEST_SHIFT);
        if reach > 0.0 {
            #[expect(
                clippy::cast_possible_truncation,
                reason = "the factor covers the rounding"
            )]
            let reach = kernel::reach(reach, f64::from(farthest)) as f32;
            shift += reach * (1.0 + SHIFT);
        }
        // Positive comparisons: what overflowed culls nothing.
        let culls = (1.0 / EXTREME..=LARGEST_DIRECTION).contains(&largest) && farthest <= EXTREME;
        let shift = if culls { shift } else { Vec3::INFINITY };
        let shift = shift.copysign(direction);
        Self {
            reciprocal,
            near: -(origin + shift) * reciprocal,
            far: -(origin - shift) * reciprocal,
            negative: direction.to_array().map(f32::is_sign_negative),
            farthest,
        }
    }
}
