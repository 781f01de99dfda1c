//! Points of triangles that were hit, with a bound of their error, and rays that start there.
//!
//! **The position** is `A + u e1 + v e2` with `e1 = B - A` and `e2 = C - A`, computed in f64, rounded to f32 and kept inside the bounds of the
//! triangle. With `e = |e1| + |e2|`, its error in each coordinate has two parts:
//! - *Rounding*: how far the position is from the point with the weights `u` and `v`, which is a point of the triangle, as the returned weights
//!   are never negative and never sum up to more than 1. This is measured, not bounded: the difference is computed in f64, with roundings of less than
//!   `8 * 2^-53 e`, for which `2^-48 e` is added. It also covers the last roundings of the bound itself.
//! - *Weights*: a weight from the f64 rung of the [exact kernel](crate::kernel::Exact) is off by at most `2^-26`, one from the last rung by less. Rounded to
//!   f32 it is off by `2^-25` more. Keeping `u + v <= 1` moves the smaller one no farther than to where the exact sum could be.
//!   So the point with the returned weights is within `3 * 2^-26 e` of the exact hit.
//!
//! **The origin of a ray** that leaves is the position, moved along the dominant axis of the triangle's normal `N`: the other coordinates stay as
//! they are and round nothing. It is moved until
//!
//! ```text
//! (origin - A) . N >= clearance * (|N.x| + |N.y| + |N.z|)
//! ```
//!
//! with `N` turned to the side that the direction leads to. Then every point within `clearance` of the origin in each
//! coordinate is on that side. The clearance is the larger part of the rounding above, plus the [reach](crate::kernel) of the kernel, which is zero
//! for the exact one. So the lift of an exact ray is a few units in the last place of the position, however large the triangle.
//!
//! **It does not meet its triangle again.** At [`Exact`](Precision::Exact): the origin is checked to be strictly on its side, by
//! [`point_side`], and moved on if the arithmetic above fell short. The direction leads away from the plane or along it, by
//! [`direction_side`]. So `(O + tD - A) . N` is positive for every `t >= 0`: the ray does not come to the plane.
//!
//! At the other precisions write `n` for `|N.x| + |N.y| + |N.z|`, `c` for the rounding of the position, `x` for the largest extent of the triangle and
//! `R(m)` for the reach. A kernel accepts the triangle at `t` only if one of its points is within `R(m)` of `O + tD` in each coordinate,
//! `m` being the largest distance between the origin and a vertex along an axis; then `(O + tD - A) . N <= n R(m)`. But for `t >= 0` the left side is at least
//! `n (c + R(x) + R(x) / 16)`, plus `n d / 3` if rounding outward moved the origin by `d` more. And `m` is at most `x` plus the lift, which is at most
//! `6 c + 54 * 2^-24 x + d`; so `R(m)` is at most `R(x) + 2^-20 (6 c + 54 * 2^-24 x + d)`. That is less by nearly `R(x) / 16`, which is left for the error of `N`,
//! `2^-40` of its length, and the roundings of the arithmetic above.
//!
//! Source: for the position, Pharr, Jakob and Humphreys, "Physically based rendering", 4th edition, section 6.8, "Managing rounding error". Differs in that
//! rounding is measured, in that the origin is moved along an axis, and in that the side is decided exactly.

use glam::{DVec3, Vec3};

use crate::kernel::{self, MollerTrumbore, Woop};
use crate::predicate::{Sign, direction_side, point_side};
use crate::{Axis, Hit, Precision, Ray, Triangle, TriangleKernel};

/// The point where a ray hit a triangle: its position with a bound of the error, and the start of rays that leave it.
///
/// ```
/// use tahko_geometry::{BruteForce, Precision, Ray, RayQuery, SurfacePoint, TriangleMesh, glam::Vec3};
///
/// let mesh = TriangleMesh::new(vec![Vec3::ZERO, Vec3::new(3.0, 0.0, 1.0), Vec3::Y], vec![[0, 1, 2]])?;
/// let structure = BruteForce::new(&mesh, Precision::Exact);
/// let ray = Ray::new(Vec3::new(0.3, 0.2, 5.0), Vec3::new(0.1, 0.0, -1.0));
/// let hit = structure.closest_hit(&ray).expect("the triangle is below");
///
/// let triangle = mesh.triangle(hit.primitive as usize);
/// let point = SurfacePoint::new(&hit, &triangle, Precision::Exact);
/// assert!(point.error().max_element() < 3e-7);
/// // Up, down, and to a light: neither meets the triangle again.
/// let light = Vec3::new(1.0, 1.0, 8.0);
/// for ray in [point.spawn_ray(Vec3::Z), point.spawn_ray(Vec3::NEG_Z), point.spawn_ray_to(light)] {
///     assert!(!structure.any_hit(&ray));
/// }
/// # Ok::<(), tahko_geometry::MeshError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    position: Vec3,
    error: Vec3,
    /// How far from the triangle the position may be, in each coordinate.
    rounding: f64,
    triangle: Triangle,
    precision: Precision,
}

/// The error of a weight of the exact kernel: of its rungs, and of rounding to f32.
const WEIGHT_ERROR: f64 = kernel::WEIGHT_ERROR + 1.0 / (1u64 << 25) as f64;
/// More than the roundings in f64, relative to the extents of the edges.
const ARITHMETIC_ERROR: f64 = 1.0 / (1u64 << 48) as f64;
/// How much farther than the reach of a kernel rays start.
const REACH_MARGIN: f64 = 1.0 + 1.0 / 16.0;

impl SurfacePoint {
    /// The point of a hit on its triangle, by a structure of a precision.
    ///
    /// A hit that no structure gave, with weights outside the triangle, has no meaning here, but does no harm either.
    #[must_use]
    pub fn new(hit: &Hit, triangle: &Triangle, precision: Precision) -> Self {
        let [a, b, c] = triangle.vertices().map(Vec3::as_dvec3);
        let (edge1, edge2) = (b - a, c - a);
        let from_a = edge1 * f64::from(hit.u) + edge2 * f64::from(hit.v);
        let bounds = triangle.aabb();
        let position = (a + from_a).as_vec3().clamp(bounds.min, bounds.max);
        let moved = (a - position.as_dvec3()) + from_a;
        let extent = edge1.abs() + edge2.abs();
        let rounding = moved.abs() + extent * ARITHMETIC_ERROR;
        let error = rounding + extent * WEIGHT_ERROR;
        Self {
            position,
            error: error.to_array().map(rounded_up).into(),
            rounding: rounding.max_element(),
            triangle: *triangle,
            precision,
        }
    }

    /// The position, inside the bounds of the triangle.
    #[must_use]
    pub const fn position(&self) -> Vec3 {
        self.position
    }

    /// How far the position may be from the exact hit, in each coordinate.
    ///
    /// A rigorous bound for hits at [`Precision::Exact`]; on random triangles near the origin the error is a quarter of it in the median, and up to all of it. At the other
    /// precisions the position is within the bound of the triangle, but the place in its plane is as uncertain as what those kernels return.
    #[must_use]
    pub const fn error(&self) -> Vec3 {
        self.error
    }

    /// A ray from here: on the side of the triangle to which the direction leads, and so close to it as the precision allows.
    ///
    /// **Guarantee.** It does not meet this triangle again, with a structure of the precision that was given, for triangles of every size, and
    /// every direction. A direction in the plane of the triangle starts in front of it. A direction that is zero or not finite makes a ray that is not
    /// [valid](Ray::is_valid), and so does a triangle at the end of the range of f32, if beyond it there is no number to start from.
    ///
    /// **Lift.** At [`Precision::Exact`] the origin is moved, along one axis, by at most six times the rounding of the position, two units in the last
    /// place and `2^-36` of the triangle's extent; at the others by `54 * 2^-24` of the extent more.
    ///
    /// **Neighbours.** Where the triangle meets another one at a valley, a ray that starts within rounding of the edge may start behind the
    /// neighbour. At [`Precision::Exact`] it does not as long as the neighbour rises by less than 14 degrees (the tangent of which is a quarter): rounding and lift
    /// move the origin along the triangle by no more than four times as far as off it. Needles are excepted, whose normal is less certain. To see
    /// past a steeper neighbour that is known, there is [`closest_hit_ignoring`](crate::RayQuery::closest_hit_ignoring).
    #[must_use]
    pub fn spawn_ray(&self, direction: Vec3) -> Ray {
        Ray::new(self.origin_towards(direction), direction)
    }

    /// A ray from here to a point, where `t` is 1: for shadow rays.
    ///
    /// It is [`spawn_ray`](Self::spawn_ray) in the direction from the position to the target, with the same guarantee. As the origin is moved and
    /// the direction is not, it ends as far beside the target.
    #[must_use]
    pub fn spawn_ray_to(&self, target: Vec3) -> Ray {
        Ray {
            t_max: 1.0,
            ..self.spawn_ray(target - self.position)
        }
    }

    /// The origin of a ray that leaves in a direction.
    fn origin_towards(&self, direction: Vec3) -> Vec3 {
        let normal = self.triangle.scaled_normal();
        if !direction.is_finite() || normal == DVec3::ZERO {
            // Such a ray hits nothing, and such a triangle is not hit.
            return self.position;
        }
        match direction_side(direction, &self.triangle) {
            Sign::Negative => self.origin_beyond(Sign::Negative, -normal),
            Sign::Zero | Sign::Positive => self.origin_beyond(Sign::Positive, normal),
        }
    }

    /// The origin on a side of the triangle, with the normal towards that side.
    fn origin_beyond(&self, side: Sign, normal: DVec3) -> Vec3 {
        let magnitude = normal.abs();
        let axis = Axis::dominant((magnitude / magnitude.max_element()).as_vec3()) as usize;
        let outward = normal[axis].signum();
        let height = normal.dot(self.position.as_dvec3() - self.triangle.a.as_dvec3());
        let wanted = self.clearance() * magnitude.element_sum();
        let lift = ((wanted - height) / magnitude[axis]).max(0.0);
        let start = f64::from(self.position[axis]);
        let mut origin = self.position;
        origin[axis] = rounded_outward(start + outward * lift, outward);
        // Rounding fell short, where the triangle is large and the position near zero. Doubled steps come to the other side soon.
        let mut step = f64::from(rounding_step(origin[axis]));
        while origin[axis].is_finite() && point_side(origin, &self.triangle) != side {
            origin[axis] = rounded_outward(f64::from(origin[axis]) + outward * step, outward);
            step *= 2.0;
        }
        origin
    }

    /// How far in each coordinate everything is on the side of the origin.
    fn clearance(&self) -> f64 {
        let reach = match self.precision {
            Precision::Fast => MollerTrumbore::REACH,
            Precision::Watertight => Woop::REACH,
            Precision::Exact => kernel::Exact::REACH,
        };
        let bounds = self.triangle.aabb();
        let extent = bounds.max.as_dvec3() - bounds.min.as_dvec3();
        self.rounding + REACH_MARGIN * kernel::reach(reach, extent.max_element())
    }
}

/// The smallest f32 that is not below a value.
fn rounded_up(value: f64) -> f32 {
    rounded_outward(value, 1.0)
}

/// The next f32 that is not before a value in the direction of a sign.
fn rounded_outward(value: f64, outward: f64) -> f32 {
    #[expect(clippy::cast_possible_truncation, reason = "rounds, mended below")]
    let nearest = value as f32;
    if (f64::from(nearest) - value) * outward >= 0.0 {
        nearest
    } else if outward > 0.0 {
        nearest.next_up()
    } else {
        nearest.next_down()
    }
}

/// The distance to the next number of larger magnitude.
fn rounding_step(value: f32) -> f32 {
    value.abs().next_up() - value.abs()
}
