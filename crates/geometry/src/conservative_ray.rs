//! Box and plane tests that never lose a hit, for one box or plane at a time; [`FusedRay`](crate::FusedRay) is for vectors of boxes.
//!
//! **What has to hold.** A kernel accepts a triangle with a value `t` such that a point of the triangle lies
//! within its reach `R = REACH * (2^-24 M + 2^-149)` of `P = O + tD` in every coordinate (see [`kernel`](crate::kernel)), with `M`
//! the largest coordinate difference between the origin and the corners of the bounds of the whole
//! structure. If the triangle lies in a box or in the half-space of a plane, `P` lies within `R` of it. A test is conservative if
//! it accepts every `P` that lies that close. For the exact kernels `R` is zero: `P` itself is in the box.
//!
//! **Shifted origins.** A box is widened by `R` without touching it: the ray comes to the near planes of the widened box where a
//! ray whose origin is shifted forward by `R` comes to those of the box, and to the far planes where one shifted backward does. So each
//! axis has two origins, rounded outward, and the widening costs nothing per box. With `R = 0` both are the origin.
//!
//! **Rounding is relative.** The place of a plane at `p` is computed as `fl(fl(p - o) * r)`, with `r` the reciprocal of the direction times
//! `1 - 8u` for near planes and `1 + 8u` for far planes, where `u = 2^-24`. There are four roundings: of the difference, the reciprocal, its factor and the
//! product, together below `4.01 u`. So what is computed for a near plane in front of the origin is below the truth, and for a far plane above it,
//! however near the plane is to the origin and however far both are from the origin of coordinates: there is no cancellation behind the
//! first subtraction. The widening is paid once per ray.
//!
//! So an origin in a plane gives exactly `t = 0` for it, a far origin a `t` that is right to the same number of digits as a near
//! one, and a denormal coordinate a difference without any error.
//!
//! **Behind the origin** the factors move both ends towards zero, but the sign stays: where `t_min` is not negative, that is all that counts. For
//! rays with a negative `t_min` the origins are shifted by `16 u M` more, which covers both factors for all planes within the bounds.
//!
//! **Underflow.** A product can be off by `2^-149` where it is below `2^-126`. With directions of at most `2^30` that takes a difference
//! below `2^-96`, other than zero, and so an origin below `2^-72`. The origins of such an axis are shifted by `2^-110`, which is more than `2^-149 * 2^30`.
//!
//! **Directions along a plane.** Components below `2^-64` of the largest, among them zero and -0.0, are replaced by that size with their
//! sign. Where the ray is inside the bounds, `|t| <= M / |D|` in the norm of the largest component, so this moves it by at most `2^-64 M`. The
//! origins of such an axis are shifted by `2^-60 M` more, at least to the neighbouring f32. Divided by the replaced component that
//! is `16 M / |D|`: a ray in the face of a box, or nearer to it than that, is in the slab for every `t` that counts, on both
//! sides of the origin. A ray that is farther away leaves the interval empty.
//!
//! **Rounded t.** The intervals are f32 numbers that enclose the real `t`; rounding is monotone, so they also
//! enclose the `t` that the kernel returns, rounded to f32. Comparing a node's entry with the best `t` so far is safe: what begins beyond
//! it is rounded to a larger `t` than the best one. At the same rounded `t` it is visited.
//!
//! **Extremes.** For directions outside `[2^-60, 2^30]` and bounds beyond `2^60` the origins are infinite, and so are the intervals: nothing
//! is culled, every answer stays right. A comparison with NaN (infinity minus infinity) never culls.

use glam::{BVec3, Vec3};

use crate::{Aabb, Axis, Ray, kernel};

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
    near: Slabs,
    far: Slabs,
    /// Whether the direction is negative, for each axis; -0.0 counts as negative.
    negative: [bool; 3],
    reach: f64,
}

/// What the `t` of near planes, or of far planes, is computed with: `(position - origin) * reciprocal` on each axis.
#[derive(Clone, Copy, Debug)]
pub struct Slabs {
    /// The origin, shifted forward for near planes and backward for far planes.
    pub origin: Vec3,
    /// The reciprocal of the direction, a little smaller for near planes and larger for far planes.
    pub reciprocal: Vec3,
}

/// How much reciprocals are smaller or larger than they are.
const RELATIVE_WIDENING: f32 = 8.0 / (1u32 << 24) as f32;
/// How much the origins are shifted for a negative `t_min`, relative to the largest distance.
const SHIFT_BEHIND: f32 = 2.0 * RELATIVE_WIDENING;
/// Direction components are kept above this part of the largest one.
const SMALLEST_COMPONENT: f32 = 1.0 / (1u128 << 64) as f32;
/// How far the origins of a clamped axis are apart, as a part of the largest distance.
const CLAMPED_SHIFT: f32 = 1.0 / (1u64 << 60) as f32;
/// Origins below this may see products underflow.
const TINY_ORIGIN: f32 = 1.0 / (1u128 << 72) as f32;
/// More than underflow can move a plane.
const TINY_SHIFT: f32 = 1.0 / (1u128 << 110) as f32;
/// More than the rounding of a shifted origin, relative to it.
const ROUNDING_OF_SHIFT: f32 = 4.0 / (1u32 << 24) as f32;
/// Beyond this size of the distances, and below its reciprocal for the direction, nothing is culled.
const EXTREME: f32 = (1u64 << 60) as f32;
/// Beyond this size of the direction nothing is culled.
const LARGEST_DIRECTION: f32 = (1u64 << 30) as f32;

impl ConservativeRay {
    /// Prepares a valid ray for a structure with the given bounds and a kernel with the given
    /// [`REACH`](crate::TriangleKernel::REACH).
    #[inline]
    #[must_use]
    pub fn new(ray: &Ray, bounds: &Aabb, reach: f32) -> Self {
        let Ray {
            origin, direction, ..
        } = *ray;
        // Two roundings: of the difference, and of the factor.
        let farthest = (bounds.min - origin)
            .abs()
            .max((bounds.max - origin).abs())
            .max_element()
            * (1.0 + ROUNDING_OF_SHIFT);
        let largest = direction.abs().max_element();
        let negative = direction.to_array().map(f32::is_sign_negative);
        // Positive comparisons: an empty box, and what overflowed, culls nothing.
        let culls = (1.0 / EXTREME..=LARGEST_DIRECTION).contains(&largest)
            && farthest <= EXTREME
            && !bounds.is_empty();
        if !culls {
            return Self::culling_nothing(direction, negative);
        }
        let smallest = Vec3::splat(largest * SMALLEST_COMPONENT);
        let is_clamped = direction.abs().cmplt(smallest);
        let is_tiny = origin.abs().cmplt(Vec3::splat(TINY_ORIGIN));
        let clamped = direction.abs().max(smallest).copysign(direction);
        let reach = if reach > 0.0 {
            kernel::reach(reach, f64::from(farthest))
        } else {
            0.0
        };
        // For all axes alike.
        #[expect(clippy::cast_possible_truncation, reason = "what rounds it is covered")]
        let mut shift = reach as f32;
        if ray.t_min < 0.0 {
            shift += SHIFT_BEHIND * farthest;
        }
        let is_shifted = BVec3::splat(shift > 0.0) | is_clamped | is_tiny;
        let shift = Vec3::splat(shift)
            + Vec3::select(
                is_clamped,
                Vec3::splat(farthest * CLAMPED_SHIFT),
                Vec3::ZERO,
            )
            + Vec3::select(is_tiny, Vec3::splat(TINY_SHIFT), Vec3::ZERO);
        let shift = shift * (1.0 + ROUNDING_OF_SHIFT) + origin.abs() * ROUNDING_OF_SHIFT;
        let forward = Vec3::select(is_shifted, shift, Vec3::ZERO).copysign(direction);
        let reciprocal = clamped.recip();
        Self {
            near: Slabs {
                origin: origin + forward,
                reciprocal: reciprocal * (1.0 - RELATIVE_WIDENING),
            },
            far: Slabs {
                origin: origin - forward,
                reciprocal: reciprocal * (1.0 + RELATIVE_WIDENING),
            },
            negative,
            reach,
        }
    }

    /// Near planes at minus infinity, far planes at infinity.
    #[cold]
    fn culling_nothing(direction: Vec3, negative: [bool; 3]) -> Self {
        let infinite = Vec3::INFINITY.copysign(direction);
        let reciprocal = Vec3::ONE.copysign(direction);
        Self {
            near: Slabs {
                origin: infinite,
                reciprocal,
            },
            far: Slabs {
                origin: -infinite,
                reciprocal,
            },
            negative,
            reach: f64::INFINITY,
        }
    }

    /// What the entry of boxes is computed with: on each axis the plane that the ray meets first.
    #[inline]
    #[must_use]
    pub const fn near(&self) -> &Slabs {
        &self.near
    }

    /// What the exit of boxes is computed with.
    #[inline]
    #[must_use]
    pub const fn far(&self) -> &Slabs {
        &self.far
    }

    /// How far from the ray, in each coordinate, whatever a kernel may accept can lie: zero for the exact kernels, infinite where
    /// nothing may be culled.
    ///
    /// For planes that are not parallel to an axis: the distance in the direction of a normal `n` is at most
    /// the reach times `|n.x| + |n.y| + |n.z|`.
    #[must_use]
    pub const fn reach(&self) -> f64 {
        self.reach
    }

    /// Whether the ray runs towards smaller coordinates along an axis; true for -0.0.
    #[inline]
    #[must_use]
    pub const fn is_negative(&self, axis: Axis) -> bool {
        self.negative[axis as usize]
    }

    /// The part of `interval` in which the ray is in the box or within reach of it.
    #[inline]
    #[must_use]
    pub fn clip(&self, bounds: &Aabb, interval: Interval) -> Option<Interval> {
        let mut enter = [0.0; 3];
        let mut leave = [0.0; 3];
        for axis in 0..3 {
            let (near, far) = if self.negative[axis] {
                (bounds.max[axis], bounds.min[axis])
            } else {
                (bounds.min[axis], bounds.max[axis])
            };
            enter[axis] = self.near.t(axis, near);
            leave[axis] = self.far.t(axis, far);
        }
        let enter = larger(enter[0], larger(enter[1], enter[2]));
        let leave = smaller(leave[0], smaller(leave[1], leave[2]));
        let start = larger(enter, interval.start);
        let end = smaller(leave, interval.end);
        (start <= end).then_some(Interval { start, end })
    }

    /// The interval in which the ray is within reach of the plane where the coordinate of `axis` equals
    /// `position`: before it the ray is certainly on its first side, after it certainly on the other. What of it is before the
    /// ray's `t_min` is not to be relied on.
    ///
    /// Bounds may be infinite; a bound that overflowed to NaN is returned as the infinity that does not cull.
    #[inline]
    #[must_use]
    pub fn crossing(&self, axis: Axis, position: f32) -> Interval {
        let axis = axis as usize;
        Interval {
            start: f32::NEG_INFINITY.max(self.near.t(axis, position)),
            end: f32::INFINITY.min(self.far.t(axis, position)),
        }
    }
}

impl Slabs {
    #[inline]
    fn t(&self, axis: usize, position: f32) -> f32 {
        (position - self.origin[axis]) * self.reciprocal[axis]
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
