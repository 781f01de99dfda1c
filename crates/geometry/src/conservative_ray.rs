//! Box and plane tests that never lose a hit.
//!
//! **What has to hold.** A kernel accepts a triangle with a value `t` such that a point of the triangle lies
//! within its reach `R = REACH * (2^-24 M + 2^-149)` of `P = O + tD` in every coordinate (see [`kernel`](crate::kernel)), with `M`
//! the largest coordinate difference between the origin and the corners of the bounds of the whole
//! structure. If the triangle lies in a box or in the half-space of a plane, `P` lies within `R` of it. A test is conservative if
//! it accepts every `P` that lies that close. For the exact kernels `R` is zero: `P` itself is in the box.
//!
//! **Shifted origins.** The box is widened by `R` without touching it: the ray comes to the near planes of the widened box where a
//! ray whose origin is shifted forward by `R` comes to those of the box, and to the far planes where one shifted backward does. So each
//! axis has two origins, rounded outward, and the widening costs nothing per box. With `R = 0` both are the origin.
//!
//! **Rounding is relative.** The place of a plane at `p` is computed as `fl(fl(p - o) * r)` with `r = fl(1 / d)`: three roundings, off
//! by less than `3.01 u` of itself with `u = 2^-24`. There is no cancellation behind the first subtraction, so the bound holds however
//! near the plane is to the origin and however far both are from the origin of coordinates. The interval is widened by `8 u` of its
//! ends, which also covers the roundings of the widening. What underflow takes, less than `2^-145`, is covered by
//! `2^-140`.
//!
//! So an origin in a plane gives exactly `t = 0` for it, a far origin a `t` that is right to the same number of digits as a near
//! one, and a denormal coordinate a difference without any error.
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
//! **Extremes.** For directions outside `[2^-60, 2^60]` and bounds beyond `2^60` the widening is infinite: nothing
//! is culled, every answer stays right. A comparison with NaN (infinity minus infinity) never culls.

use glam::{DVec3, Vec3};

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
    /// The origin shifted forward by the reach, for near planes.
    near_origin: Vec3,
    /// The origin shifted backward by the reach, for far planes.
    far_origin: Vec3,
    /// Reciprocal of the direction, with zero clamped to a signed power of two.
    reciprocal: Vec3,
    /// Whether the direction is negative, for each axis; -0.0 counts as negative.
    negative: [bool; 3],
    /// How much an interval is widened in `t`, beyond [`RELATIVE_WIDENING`]; infinite where nothing may be culled.
    widening: f32,
    reach: f64,
}

/// How much an interval is widened relative to its ends.
const RELATIVE_WIDENING: f32 = 8.0 / (1u32 << 24) as f32;
/// More than underflow can take.
const SMALLEST_WIDENING: f32 = 1.0 / (1u128 << 127) as f32 / (1u32 << 13) as f32;
/// Direction components are kept above this part of the largest one.
const SMALLEST_COMPONENT: f64 = 1.0 / (1u128 << 64) as f64;
/// How far the origins of a clamped axis are apart, as a part of the largest distance.
const CLAMPED_SHIFT: f64 = 1.0 / (1u64 << 60) as f64;
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
        let culls = !is_extreme && !bounds.is_empty();
        let reach = if culls {
            kernel::reach(reach, farthest)
        } else {
            f64::INFINITY
        };
        let smallest = DVec3::splat(largest * SMALLEST_COMPONENT);
        let is_clamped = direction.abs().cmplt(smallest);
        let clamped = direction.abs().max(smallest).copysign(direction);
        let shift = if culls {
            DVec3::select(
                is_clamped,
                DVec3::splat(reach + farthest * CLAMPED_SHIFT),
                DVec3::splat(reach),
            )
        } else {
            DVec3::ZERO
        };
        let forward = shift.copysign(direction);
        Self {
            near_origin: shifted(ray.origin, forward),
            far_origin: shifted(ray.origin, -forward),
            reciprocal: clamped.recip().as_vec3(),
            negative: direction.to_array().map(f64::is_sign_negative),
            widening: if culls {
                SMALLEST_WIDENING
            } else {
                f32::INFINITY
            },
            reach,
        }
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
            enter[axis] = (near - self.near_origin[axis]) * self.reciprocal[axis];
            leave[axis] = (far - self.far_origin[axis]) * self.reciprocal[axis];
        }
        let enter = larger(enter[0], larger(enter[1], enter[2]));
        let leave = smaller(leave[0], smaller(leave[1], leave[2]));
        let start = larger(self.before(enter), interval.start);
        let end = smaller(self.after(leave), interval.end);
        (start <= end).then_some(Interval { start, end })
    }

    /// The interval in which the ray is within reach of the plane where the coordinate of `axis` equals
    /// `position`: before it the ray is certainly on its first side, after it certainly on the other.
    ///
    /// Bounds may be infinite; a bound that overflowed to NaN is returned as the infinity that does not cull.
    #[inline]
    #[must_use]
    pub fn crossing(&self, axis: Axis, position: f32) -> Interval {
        let axis = axis as usize;
        let enter = (position - self.near_origin[axis]) * self.reciprocal[axis];
        let leave = (position - self.far_origin[axis]) * self.reciprocal[axis];
        Interval {
            start: f32::NEG_INFINITY.max(self.before(enter)),
            end: f32::INFINITY.min(self.after(leave)),
        }
    }

    /// A number certainly below an entry that was computed.
    #[inline]
    fn before(&self, enter: f32) -> f32 {
        enter - (enter.abs() * RELATIVE_WIDENING + self.widening)
    }

    /// A number certainly above an exit that was computed.
    #[inline]
    fn after(&self, leave: f32) -> f32 {
        leave + (leave.abs() * RELATIVE_WIDENING + self.widening)
    }
}

/// A point moved by `shift` and rounded on in its direction: by at least `shift` in each coordinate.
fn shifted(point: Vec3, shift: DVec3) -> Vec3 {
    let moved = point.as_dvec3() + shift;
    let mut rounded = moved.as_vec3();
    for axis in 0..3 {
        // The sum may have been rounded too: anything but an exact zero shift goes one step further.
        if shift[axis] > 0.0 {
            rounded[axis] = rounded[axis].next_up();
        } else if shift[axis] < 0.0 {
            rounded[axis] = rounded[axis].next_down();
        }
    }
    rounded
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
