//! Where a ray crosses a splitting plane, so that no hit is lost.
//!
//! **What has to hold.** A kernel accepts a triangle with a value `t`, and a point `p` of the triangle is within
//! `REACH * (2^-24 M + 2^-149)` of `P = O + tD` in every coordinate, with `M` the largest coordinate difference between the
//! origin and the corners of the bounds (see [`tahko_geometry::kernel`]). A part of the triangle near `p` is listed in
//! some cell. For each plane on the way there, `t` must be in the interval in which the traversal visits that side, or the
//! plane itself for a triangle that is listed there.
//!
//! **In front of a plane with the unit normal `n`** the listed part is, by the [build](crate::build), where the
//! distance is at least `-(84 + 16 k) u S`, with `u = 2^-53`, `k` cuts and `S` the largest coordinate.
//! Hence the distance of `P` is at least `-(|n.x| + |n.y| + |n.z|) reach - (84 + 16 k) u S`. The traversal computes it as
//! `s_o + t s_d` with `s_o = n . O + offset` and `s_d = n . D` in f64: the first is off by at most `14 u (|O| + S)`, the
//! second by `7 u |D|`, in the norm of the largest coordinate, where `t |D|` is about the distance from `O` to `P`,
//! at most `|O| + S` within the reach. Taken together, with `|n.x| + |n.y| + |n.z| <= sqrt(3)`,
//!
//! `E = sqrt(3) * reach + 32 (k + 8) u (|O| + S)`,
//!
//! with [`ConservativeRay::reach`], zero for the exact kernels, covers all of it twice over: `s_o + t s_d >= -E`
//! for what is in front, `<= E` for what is behind, and both for what is in the plane. `k` is at most the tree's depth.
//!
//! **In lengths of `t`**, with the ray turned so that `s_d >= 0`: the side that the ray comes from is visited up to
//! `(E - s_o) / s_d`, the other one from `(-E - s_o) / s_d`, and the plane between. Both are computed in f64 and widened by `2^-23` of
//! themselves before they are rounded to f32, which covers the rounding of both and of the `t` that the kernel returns.
//!
//! **Rays along the plane.** For `s_d = 0` the bounds are infinities of the right sign where the origin is beyond `E`, and
//! enclose everything where it is nearer: the ray visits one side, or both. Zero over zero is NaN, which the
//! traversal's `min` and `max` ignore: it does not cull. An infinite reach (extreme coordinates) gives
//! infinite bounds. The sign of a zero speed only says which of the two sides is called near.
//!
//! **Rays nearly along the plane.** A small `s_d` makes the interval long: its quotient by `s_d` is as uncertain as it looks, and the
//! ray visits both sides where it may be on either.
//!
//! **Wedges.** Planes that meet at a small angle are crossed at places that rounding may exchange. No order is assumed: the
//! interval of a node is the intersection of intervals that each contain every `t` accepted on that side, so it contains them too. If it is
//! empty, nothing is accepted there. A sliver of a cell whose exact interval has no length still has one of the widenings.
//!
//! **Origins on a plane** have `s_o` within `E` of zero, and both bounds enclose `t = 0`. **Far origins** enter `E` by `|O|`: the bound
//! is relative to the larger of the origin's and the scene's coordinates, in f64. **Denormals** are numbers like others in
//! f64: the smallest product of two f32 numbers is `2^-298`.

use tahko_geometry::{Aabb, ConservativeRay, Plane, Ray, glam::DVec3};

use crate::node::{BACK, FRONT};
use crate::tree::largest_coordinates;

/// A ray prepared for crossing many planes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlaneCrosser {
    origin: DVec3,
    direction: DVec3,
    /// `E` of the module's documentation.
    widening: f64,
}

/// Where a ray is near a plane: before `start` it is certainly on one side, after `end` certainly on the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Crossing {
    /// The side that the ray comes from: [`FRONT`] or [`BACK`].
    pub(crate) near: usize,
    pub(crate) start: f32,
    pub(crate) end: f32,
}

const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;

/// The smallest f32 above zero.
const SMALLEST: f64 = 1.0 / (1u128 << 100) as f64 / (1u64 << 49) as f64;

impl PlaneCrosser {
    /// Prepares a ray for a tree with the given depth and bounds.
    pub(crate) fn new(
        ray: &Ray,
        conservative: &ConservativeRay,
        depth: usize,
        bounds: &Aabb,
    ) -> Self {
        let origin = ray.origin.as_dvec3();
        let size = origin.abs().max_element() + largest_coordinates(bounds).max_element();
        let rounding = 32.0 * (depth as f64 + 8.0) * UNIT_ROUNDOFF * size;
        Self {
            origin,
            direction: ray.direction.as_dvec3(),
            widening: 3.0f64.sqrt() * conservative.reach() + rounding,
        }
    }

    /// Where the ray crosses a plane.
    #[inline]
    pub(crate) fn cross(&self, plane: &Plane) -> Crossing {
        let distance = plane.signed_distance(self.origin);
        let speed = plane.normal.dot(self.direction);
        let (near, distance) = if speed < 0.0 {
            (FRONT, -distance)
        } else {
            (BACK, distance)
        };
        let reciprocal = 1.0 / speed.abs();
        let start = (-self.widening - distance) * reciprocal;
        let end = (self.widening - distance) * reciprocal;
        #[expect(
            clippy::cast_possible_truncation,
            reason = "widened by more than the rounding"
        )]
        Crossing {
            near,
            start: (start - widening_of(start)) as f32,
            end: (end + widening_of(end)) as f32,
        }
    }
}

/// Twice the largest error of rounding to f32. Infinities need none, and would become NaN by it.
#[inline]
fn widening_of(value: f64) -> f64 {
    if value.is_finite() {
        value.abs() * f64::from(f32::EPSILON) + SMALLEST
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tahko_geometry::glam::Vec3;

    fn cross(origin: Vec3, direction: Vec3, plane: &Plane, size: f32) -> Crossing {
        let bounds = Aabb::new(Vec3::splat(-size), Vec3::splat(size));
        let ray = Ray::new(origin, direction);
        let conservative = ConservativeRay::new(&ray, &bounds, 8.0);
        PlaneCrosser::new(&ray, &conservative, 20, &bounds).cross(plane)
    }

    /// The points with x = 0.5.
    fn wall() -> Plane {
        Plane::from_point_normal(DVec3::splat(0.5), DVec3::X).expect("a plane")
    }

    #[test]
    fn the_crossing_is_narrow_and_around_the_exact_place() {
        for (direction, near) in [(Vec3::X, BACK), (Vec3::new(4.0, 1.0, 0.0), BACK)] {
            let crossing = cross(Vec3::NEG_X, direction, &wall(), 1.0);
            let exact = 1.5 / direction.x;
            assert_eq!(crossing.near, near);
            assert!(
                crossing.start < exact && exact < crossing.end,
                "{crossing:?}"
            );
            assert!(crossing.end - crossing.start < 2e-5, "{crossing:?}");
        }
        let back = cross(Vec3::X, Vec3::NEG_X, &wall(), 1.0);
        assert_eq!(back.near, FRONT);
        assert!(back.start < 0.5 && 0.5 < back.end, "{back:?}");
    }

    #[test]
    fn rays_along_a_plane_stay_on_their_side_or_visit_both() {
        for zero in [0.0, -0.0] {
            let along = Vec3::new(zero, 1.0, 0.0);
            // In front, behind: nothing but that side.
            let crossing = cross(Vec3::X, along, &wall(), 1.0);
            assert_eq!((crossing.near, crossing.end), (BACK, f32::NEG_INFINITY));
            let crossing = cross(Vec3::ZERO, along, &wall(), 1.0);
            assert_eq!((crossing.near, crossing.start), (BACK, f32::INFINITY));
            // Within rounding of it: both, all the way.
            for x in [0.5, 0.5f32.next_up(), 0.5f32.next_down()] {
                let crossing = cross(Vec3::new(x, 0.0, 0.0), along, &wall(), 1.0);
                let all = (f32::NEG_INFINITY, f32::INFINITY);
                assert_eq!((crossing.start, crossing.end), all, "x = {x}");
            }
        }
    }

    #[test]
    fn extreme_coordinates_and_directions_cull_nothing() {
        let all = (f32::NEG_INFINITY, f32::INFINITY);
        for (direction, size) in [(Vec3::X, f32::MAX), (Vec3::X * 1e-40, 1.0), (Vec3::Y, 1e30)] {
            let crossing = cross(Vec3::ZERO, direction, &wall(), size);
            assert_eq!((crossing.start, crossing.end), all, "{direction} {size}");
        }
    }
}
