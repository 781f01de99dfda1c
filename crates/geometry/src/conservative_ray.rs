//! Box and plane tests that never lose a hit.
//!
//! **What has to hold.** A kernel accepts a triangle with a value `t` such that a point of the triangle
//! lies within `REACH * 2^-24 * m` of `P = O + tD` in every coordinate (see [`kernel`](crate::kernel)). Let
//! `M >= m` be the largest coordinate difference between the origin and the corners of the bounds of the
//! whole structure. If the triangle lies in a box or in the half-space of a plane, `P` lies within
//! `REACH * 2^-24 * M` of it. A test is conservative if it accepts every `P` that lies that close.
//!
//! **The margin.** For each axis the value where the ray meets a plane at `p` is computed as
//! `fl(fl(p - o) * r)` with `r = fl(1 / d)`. With three roundings its error is below `3.01 * 2^-24 |p - o| |r|`,
//! that is, below `3.01 * 2^-24 M` in units of length. Components of the direction that are smaller than
//! `2^-32` of the largest are replaced by that size, keeping their sign (that of -0.0 too): along the way
//! through the bounds this moves the ray by at most `2^-32 M`. Adding the margin in lengths of `t` rounds twice
//! more, relative to sums that the margin dominates or that are covered by one more `2^-24 M`. Taken together
//! `E = (REACH + 8) * 2^-24 * M` covers the reach and all roundings, and `E |r|` is added on the far side
//! and subtracted on the near side of every plane. `E` is at least `2^-100`, so that underflow is inside it.
//!
//! **Rounded t.** The intervals are f32 numbers that enclose the real `t`; rounding is monotone, so they also
//! enclose the `t` that the kernel returns, rounded to f32. Comparing a node's entry with the best `t` so far is safe.
//!
//! **Extremes.** For directions outside `[2^-60, 2^60]` and bounds beyond `2^60` the margin is infinite: nothing
//! is culled, every answer stays right. A comparison with NaN (infinity minus infinity) never culls.

use glam::Vec3;

use crate::{Aabb, Axis, Ray};

/// A closed interval of ray parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Where the interval begins.
    pub start: f32,
    /// Where it ends, not below `start`.
    pub end: f32,
}

/// A ray prepared for box and plane tests that never lose a hit of a kernel.
#[derive(Clone, Copy, Debug)]
pub struct ConservativeRay {
    origin: Vec3,
    /// Reciprocal of the direction, with zero clamped to a signed power of two.
    reciprocal: Vec3,
    /// The margin in lengths of t: `margin * |reciprocal|`.
    slack: Vec3,
    /// Whether the direction is negative, for each axis; -0.0 counts as negative.
    negative: [bool; 3],
    margin: f64,
}

const UNIT_ROUNDOFF: f64 = 1.0 / (1u64 << 24) as f64;
/// Direction components are kept above this part of the largest one.
const SMALLEST_COMPONENT: f64 = 1.0 / (1u64 << 32) as f64;
const SMALLEST_MARGIN: f64 = 1.0 / (1u128 << 100) as f64;
/// Beyond this size of a direction or a distance, or below its reciprocal, nothing is culled.
const EXTREME: f64 = (1u64 << 60) as f64;

impl ConservativeRay {
    /// Prepares a valid ray for a structure with the given bounds and a kernel with the given
    /// [`REACH`](crate::TriangleKernel::REACH).
    #[must_use]
    pub fn new(ray: &Ray, bounds: &Aabb, reach: f32) -> Self {
        let origin = ray.origin.as_dvec3();
        let direction = ray.direction.as_dvec3();
        let farthest = (bounds.min.as_dvec3() - origin)
            .abs()
            .max((bounds.max.as_dvec3() - origin).abs())
            .max_element();
        let largest = direction.abs().max_element();
        let is_extreme = !(1.0 / EXTREME..=EXTREME).contains(&largest) || farthest > EXTREME;
        let margin = if is_extreme || bounds.is_empty() {
            f64::INFINITY
        } else {
            ((f64::from(reach) + 8.0) * UNIT_ROUNDOFF * farthest).max(SMALLEST_MARGIN)
        };
        let clamped = direction
            .abs()
            .max(glam::DVec3::splat(largest * SMALLEST_COMPONENT))
            .copysign(direction);
        let reciprocal = clamped.recip().as_vec3();
        Self {
            origin: ray.origin,
            reciprocal,
            slack: (margin * reciprocal.abs().as_dvec3()).as_vec3(),
            negative: direction.to_array().map(f64::is_sign_negative),
            margin,
        }
    }

    /// How far from the ray, in each coordinate, whatever a kernel may accept can lie.
    ///
    /// For planes that are not parallel to an axis: the distance in the direction of a normal `n` is at most
    /// the margin times `|n.x| + |n.y| + |n.z|`.
    #[must_use]
    pub const fn margin(&self) -> f64 {
        self.margin
    }

    /// Whether the ray runs towards smaller coordinates along an axis; true for -0.0.
    #[inline]
    #[must_use]
    pub const fn is_negative(&self, axis: Axis) -> bool {
        self.negative[axis as usize]
    }

    /// The part of `interval` in which the ray is in the box or within the margin of it.
    #[inline]
    #[must_use]
    pub fn clip(&self, bounds: &Aabb, interval: Interval) -> Option<Interval> {
        let to_min = (bounds.min - self.origin) * self.reciprocal;
        let to_max = (bounds.max - self.origin) * self.reciprocal;
        let Interval { mut start, mut end } = interval;
        for axis in 0..3 {
            let (near, far) = if self.negative[axis] {
                (to_max[axis], to_min[axis])
            } else {
                (to_min[axis], to_max[axis])
            };
            start = larger(near - self.slack[axis], start);
            end = smaller(far + self.slack[axis], end);
        }
        (start <= end).then_some(Interval { start, end })
    }

    /// The interval in which the ray is within the margin of the plane where the coordinate of `axis` equals
    /// `position`: before it the ray is certainly on its first side, after it certainly on the other.
    ///
    /// Bounds may be infinite; a bound that overflowed to NaN is returned as the infinity that does not cull.
    #[inline]
    #[must_use]
    pub fn crossing(&self, axis: Axis, position: f32) -> Interval {
        let axis = axis as usize;
        let t = (position - self.origin[axis]) * self.reciprocal[axis];
        Interval {
            start: f32::NEG_INFINITY.max(t - self.slack[axis]),
            end: f32::INFINITY.min(t + self.slack[axis]),
        }
    }
}

/// The larger number; the second one if the first is NaN, which so never culls. In contrast to `f32::max` this
/// is one instruction.
#[inline]
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The smaller number; the second one if the first is NaN.
#[inline]
fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: Interval = Interval {
        start: 0.0,
        end: f32::INFINITY,
    };

    fn unit_box() -> Aabb {
        Aabb::new(Vec3::ZERO, Vec3::ONE)
    }

    #[test]
    fn a_ray_in_a_face_of_a_box_visits_it_whatever_the_sign_of_zero() {
        for x in [0.0, 1.0] {
            for zero in [0.0, -0.0] {
                let ray = Ray::new(Vec3::new(x, 0.5, -1.0), Vec3::new(zero, zero, 1.0));
                let conservative = ConservativeRay::new(&ray, &unit_box(), 0.0);
                let clipped = conservative.clip(&unit_box(), ALL);
                assert!(clipped.is_some(), "x = {x}, direction {zero:?}");
            }
        }
    }

    #[test]
    fn parallel_rays_well_outside_a_box_are_culled() {
        for zero in [0.0, -0.0] {
            for x in [-0.5, 1.5] {
                let ray = Ray::new(Vec3::new(x, 0.5, -1.0), Vec3::new(zero, 0.0, 1.0));
                let conservative = ConservativeRay::new(&ray, &unit_box(), 8.0);
                assert_eq!(conservative.clip(&unit_box(), ALL), None, "x = {x}");
            }
        }
    }

    #[test]
    fn a_box_behind_the_interval_is_culled() {
        let ray = Ray::new(Vec3::new(0.5, 0.5, 3.0), Vec3::Z);
        let conservative = ConservativeRay::new(&ray, &unit_box(), 8.0);
        assert_eq!(conservative.clip(&unit_box(), ALL), None);
        let backward = Interval {
            start: -10.0,
            end: 0.0,
        };
        assert!(
            conservative.clip(&unit_box(), backward).is_some(),
            "t may be negative"
        );
    }

    #[test]
    fn a_ray_in_a_plane_crosses_it_all_along_the_bounds() {
        let ray = Ray::new(Vec3::new(0.5, 0.5, -3.0), Vec3::Z);
        let conservative = ConservativeRay::new(&ray, &unit_box(), 8.0);
        let crossing = conservative.crossing(Axis::X, 0.5);
        assert!(crossing.start <= 0.0 && crossing.end >= 4.0, "{crossing:?}");
    }

    #[test]
    fn extremes_cull_nothing() {
        let far = Aabb::new(Vec3::splat(-3.0e38), Vec3::splat(3.0e38));
        for direction in [Vec3::X * 1e-40, Vec3::X * 1e38, Vec3::new(1e-45, 0.0, 0.0)] {
            let ray = Ray::new(Vec3::ZERO, direction);
            let conservative = ConservativeRay::new(&ray, &far, 8.0);
            for bounds in [unit_box(), far] {
                assert!(conservative.clip(&bounds, ALL).is_some(), "{direction}");
            }
        }
    }
}
