//! Exact decisions about rays, triangles and points with f32 coordinates.
//!
//! Each predicate is a ladder: f64 arithmetic with a proven error bound decides nearly always; where it cannot, exact arithmetic does: on whole numbers where the
//! coordinates are of similar sizes, and on expansions (Shewchuk 1997) for all others. Nothing here overflows or underflows, for any finite f32 coordinates, from denormals to the
//! largest ones. The ladder of ray/triangle tests has one more rung below these, in f32: see [`Exact`](crate::Exact).
//!
//! **The bound of the f64 rung.** Each value is a sum of products of differences of f32 numbers. A difference is rounded once,
//! if at all; with the products and sums that follow no term carries more than 8 roundings. A sum of six terms of at most `m`
//! is therefore off by at most `8.01 * 6 u m < 64 u m`, with `u = 2^-53` and `m` the product of the largest components of the factors.
//! The largest magnitude that occurs is below `2^400`, the smallest error above `2^-500`: both far inside f64.
//!
//! **Terms.** For a ray `O + tD` and a triangle with vertices `A`, `B`, `C` and the normal `N = (B - A) x (C - A)`:
//! - the [side of an edge](edge_side) from `P` to `Q` is the sign of `D . ((P - O) x (Q - O))`: positive where the ray passes on the right of
//!   the edge, seen along the ray's direction;
//! - the three edges of a triangle sum up to the determinant `D . N`, and weigh the opposite vertices;
//! - the ray meets the plane at `t = (A - O) . N / (D . N)`.

mod expansion;
mod ray_triangle;
mod whole;

use std::cmp::Ordering;

use glam::{DVec3, Vec3};

pub(crate) use expansion::Expansion;
pub(crate) use ray_triangle::{
    EdgeRule, intersect_exactly, order_of_planes, passes_edges, quotient,
};

use crate::{Ray, Triangle};

/// The sign of an exact value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Sign {
    /// Below zero.
    Negative,
    /// Zero, exactly.
    Zero,
    /// Above zero.
    Positive,
}

impl Sign {
    /// The sign of a number; zero for NaN.
    #[must_use]
    pub fn of(value: f64) -> Self {
        if value > 0.0 {
            Self::Positive
        } else if value < 0.0 {
            Self::Negative
        } else {
            Self::Zero
        }
    }

    fn of_whole(value: i128) -> Self {
        match value.cmp(&0) {
            Ordering::Less => Self::Negative,
            Ordering::Equal => Self::Zero,
            Ordering::Greater => Self::Positive,
        }
    }

    /// The sign of a value that was computed with an error of at most `error`, if that is certain.
    pub(crate) fn certain(value: f64, error: f64) -> Option<Self> {
        (value.abs() > error).then(|| Self::of(value))
    }

    /// The sign of minus the value.
    #[must_use]
    pub const fn flipped(self) -> Self {
        match self {
            Self::Negative => Self::Positive,
            Self::Zero => Self::Zero,
            Self::Positive => Self::Negative,
        }
    }

    /// How a value of this sign compares with zero.
    #[must_use]
    pub const fn compared_with_zero(self) -> Ordering {
        match self {
            Self::Negative => Ordering::Less,
            Self::Zero => Ordering::Equal,
            Self::Positive => Ordering::Greater,
        }
    }
}

/// What settled a decision.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Rung {
    /// Arithmetic in f32 with an error bound.
    F32,
    /// Arithmetic in f64 with an error bound.
    F64,
    /// Exact arithmetic, on whole numbers or expansions.
    Exact,
}

/// The bound of the f64 rung in the module's documentation, relative to the product of the largest factors.
pub(crate) const F64_ERROR: f64 = 64.0 * (f64::EPSILON / 2.0);

/// The side on which a ray's line passes an edge: the sign of `D . ((from - O) x (to - O))`.
///
/// Positive if the line passes on the right of the edge, seen along the ray's direction with the edge pointing up; zero if it meets the edge's
/// line, or is parallel to it. Depends on the line alone, not on the ray's interval. Coordinates must be finite.
///
/// ```
/// use tahko_geometry::{Ray, glam::Vec3, predicate::{Sign, edge_side}};
///
/// let ray = Ray::new(Vec3::ZERO, Vec3::NEG_Z);
/// let side = |x: f32| edge_side(&ray, Vec3::new(x, -1.0, -5.0), Vec3::new(x, 1.0, -5.0));
/// assert_eq!([side(-1e-45), side(0.0), side(1e-45)], [Sign::Positive, Sign::Zero, Sign::Negative]);
/// ```
#[must_use]
pub fn edge_side(ray: &Ray, from: Vec3, to: Vec3) -> Sign {
    let [origin, direction] = [ray.origin, ray.direction].map(Vec3::as_dvec3);
    let [from_origin, edge] = [from.as_dvec3() - origin, to.as_dvec3() - from.as_dvec3()];
    certain_triple_product(direction, from_origin, edge)
        .unwrap_or_else(|| ray_triangle::edge_side(ray, from, to))
}

/// The side of a triangle's plane to which a direction leads: the sign of `direction . N`, with `N` on the triangle's front.
///
/// Zero if the direction is in the plane, and for triangles without area. Coordinates must be finite.
#[must_use]
pub fn direction_side(direction: Vec3, triangle: &Triangle) -> Sign {
    let [a, b, c] = triangle.vertices().map(Vec3::as_dvec3);
    certain_triple_product(direction.as_dvec3(), b - a, c - a)
        .unwrap_or_else(|| ray_triangle::direction_side(direction, triangle))
}

/// The side of a triangle's plane on which a point lies: positive in front, zero in the plane, and for triangles without area.
///
/// Coordinates must be finite.
#[must_use]
pub fn point_side(point: Vec3, triangle: &Triangle) -> Sign {
    let [a, b, c] = triangle.vertices().map(Vec3::as_dvec3);
    certain_triple_product(point.as_dvec3() - a, b - a, c - a)
        .unwrap_or_else(|| ray_triangle::point_side(point, triangle))
}

/// Compares the `t` where a ray's line meets the plane of a triangle with a number.
///
/// `None` if the line is parallel to the plane or the triangle has no area. Coordinates must be finite; `t` may be infinite.
#[must_use]
pub fn compare_t(ray: &Ray, triangle: &Triangle, t: f32) -> Option<Ordering> {
    ray_triangle::compare_t(ray, triangle, t)
}

/// The order in which a ray's line meets the planes of two triangles.
///
/// `None` if the line is parallel to one of them or one has no area. Coordinates must be finite.
#[must_use]
pub fn compare_hits(ray: &Ray, first: &Triangle, second: &Triangle) -> Option<Ordering> {
    let is_parallel = |triangle| direction_side(ray.direction, triangle) == Sign::Zero;
    (!is_parallel(first) && !is_parallel(second)).then(|| order_of_planes(ray, first, second).0)
}

/// Whether the vertices of a triangle lie on a line.
pub(crate) fn are_collinear(triangle: &Triangle) -> bool {
    let (normal, error) = approximate_normal(triangle);
    normal.abs().max_element() <= error && exact_normal(triangle) == DVec3::ZERO
}

/// The normal of a triangle, twice its area long, with an error of at most `2^-40` of its length.
pub(crate) fn normal(triangle: &Triangle) -> DVec3 {
    const ENOUGH: f64 = (1u64 << 40) as f64;
    let (normal, error) = approximate_normal(triangle);
    if normal.abs().max_element() > ENOUGH * error {
        normal
    } else {
        exact_normal(triangle)
    }
}

/// The normal and a bound of the error of its components.
fn approximate_normal(triangle: &Triangle) -> (DVec3, f64) {
    let [a, b, c] = triangle.vertices().map(Vec3::as_dvec3);
    let (edge1, edge2) = (b - a, c - a);
    // Two terms with four roundings each: well inside the bound for six.
    let error = F64_ERROR * edge1.abs().max_element() * edge2.abs().max_element();
    (edge1.cross(edge2), error)
}

/// The normal with each component rounded from its exact value.
#[cold]
fn exact_normal(triangle: &Triangle) -> DVec3 {
    let normal = ray_triangle::normal(triangle);
    DVec3::from(normal.each_ref().map(Expansion::approximation))
}

/// The sign of `a . (b x c)` for vectors of rounded differences of f32 numbers, if f64 can tell.
fn certain_triple_product(a: DVec3, b: DVec3, c: DVec3) -> Option<Sign> {
    let largest = |vector: DVec3| vector.abs().max_element();
    let error = F64_ERROR * largest(a) * largest(b) * largest(c);
    Sign::certain(a.dot(b.cross(c)), error)
}
