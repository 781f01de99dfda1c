//! A ray and a triangle in f64: the terms of the [exact kernel](super::Exact), with bounds of their errors.
//!
//! The bounds are those of [`predicate`](crate::predicate), relative to the product of the largest components of the factors. Where a test has to be quick, the sums of components take
//! the place of the largest ones, which are not larger: compilers make branches of maxima, and which component is the largest is anyone's guess.

use glam::{DVec3, Vec3};

use crate::predicate::{F64_ERROR, quotient};
use crate::{Ray, Triangle, TriangleHit};

/// Weights are taken from the f64 rung if their error is below this.
pub(crate) const WEIGHT_ERROR: f64 = 1.0 / (1u64 << 26) as f64;
/// [`F64_ERROR`], and the roundings of bounds: a hit that is certain by this one is so by the other one.
const CERTAIN_ERROR: f64 = F64_ERROR * (1.0 + 1.0 / (1u64 << 40) as f64);

/// The terms of a ray and a triangle in f64, with bounds of their errors.
#[derive(Clone, Copy)]
pub(super) struct Terms {
    pub(super) of_b: f64,
    pub(super) of_c: f64,
    pub(super) determinant: f64,
    depth: f64,
    pub(super) error_b: f64,
    pub(super) error_c: f64,
    determinant_error: f64,
    depth_error: f64,
}

impl Terms {
    #[inline(always)]
    pub(super) fn new(ray: &Ray, triangle: &Triangle) -> Self {
        let [origin, direction] = [ray.origin, ray.direction].map(Vec3::as_dvec3);
        let [a, b, c] = triangle.vertices().map(Vec3::as_dvec3);
        let (from_origin, edge1, edge2) = (a - origin, b - a, c - a);
        let normal = edge1.cross(edge2);
        let moment = direction.cross(from_origin);
        let [d, f, e1, e2] = [direction, from_origin, edge1, edge2].map(largest_component_f64);
        Self {
            of_b: -edge2.dot(moment),
            of_c: edge1.dot(moment),
            determinant: direction.dot(normal),
            depth: from_origin.dot(normal),
            error_b: F64_ERROR * d * f * e2,
            error_c: F64_ERROR * d * f * e1,
            determinant_error: F64_ERROR * d * e1 * e2,
            depth_error: F64_ERROR * f * e1 * e2,
        }
    }

    /// Whether the triangle's plane is certainly met before the origin.
    #[inline(always)]
    pub(super) fn are_behind(&self) -> bool {
        let depth = self.depth * 1f64.copysign(self.determinant);
        depth < -self.depth_error && self.determinant.abs() > self.determinant_error
    }

    /// The weight of the first vertex and the bound of its error.
    #[inline(always)]
    pub(super) fn of_a(&self) -> (f64, f64) {
        (
            self.determinant - self.of_b - self.of_c,
            self.determinant_error + self.error_b + self.error_c,
        )
    }

    /// `t` and the bound of its error; `None` if it or the weights are too uncertain.
    #[inline(always)]
    pub(super) fn t(&self) -> Option<(f64, f64)> {
        let (_, error_a) = self.of_a();
        let is_well_conditioned = error_a <= WEIGHT_ERROR * self.determinant.abs();
        let t = quotient(
            self.depth,
            self.depth_error,
            self.determinant,
            self.determinant_error,
        );
        t.filter(|_| is_well_conditioned)
    }

    /// The hit at a `t` that is certain.
    #[inline(always)]
    pub(super) fn hit(&self, t: f32) -> TriangleHit {
        let reciprocal = 1.0 / self.determinant;
        TriangleHit::new(t, self.of_b * reciprocal, self.of_c * reciprocal)
    }
}

/// The largest magnitude of a component.
#[inline(always)]
fn largest_component_f64(vector: DVec3) -> f64 {
    let larger = |a: f64, b: f64| if a > b { a } else { b };
    larger(vector.x.abs(), larger(vector.y.abs(), vector.z.abs()))
}

/// The hit of a triangle that the ray certainly hits: the f64 rung without its decisions; `None` if that is not sure of `t` and the weights.
///
/// The bounds are those of the rung with the sums of components in place of the largest ones, of which the compiler makes branches. That the
/// determinant is certain follows from the weights; and as the exact `t` is in the ray's interval, so is the rounded one.
#[inline(always)]
pub(super) fn certain_hit(ray: &Ray, triangle: &Triangle) -> Option<TriangleHit> {
    let vectors = [
        ray.origin,
        ray.direction,
        triangle.a,
        triangle.b,
        triangle.c,
    ];
    let [origin, d, a, b, c] = vectors.map(|vector| wide(vector.to_array()));
    let (f, e1, e2) = (minus(a, origin), minus(b, a), minus(c, a));
    let (normal, moment) = (cross(e1, e2), cross(d, f));
    let determinant = dot(d, normal);
    let (of_b, of_c) = (-dot(e2, moment), dot(e1, moment));
    let depth = dot(f, normal);

    let [of_d, of_f, of_e1, of_e2] = [d, f, e1, e2].map(length);
    let area_error = CERTAIN_ERROR * of_e1 * of_e2;
    let determinant_error = area_error * of_d;
    let error_of_a = determinant_error + CERTAIN_ERROR * of_d * of_f * (of_e1 + of_e2);
    // As `quotient`.
    let reciprocal = 1.0 / determinant;
    let t = depth * reciprocal;
    let error = 2.0 * (area_error * of_f + t.abs() * determinant_error) * reciprocal.abs()
        + t.abs() * (2.0 * f64::EPSILON);
    #[expect(clippy::cast_possible_truncation, reason = "rounds to the nearest f32")]
    let [low, high] = [t - error, t + error].map(|t| t as f32);
    let is_certain = (error_of_a <= WEIGHT_ERROR * determinant.abs())
        & (low == high)
        & (low.abs() < f32::INFINITY);
    is_certain.then(|| TriangleHit::new(low, of_b * reciprocal, of_c * reciprocal))
}

/// Whether a triangle's plane is certainly met before the origin.
#[inline(always)]
pub(super) fn is_certainly_behind(
    origin: [f32; 3],
    direction: [f32; 3],
    [a, b, c]: [[f32; 3]; 3],
) -> bool {
    let [origin, direction, a, b, c] = [origin, direction, a, b, c].map(wide);
    let (f, e1, e2) = (minus(a, origin), minus(b, a), minus(c, a));
    let normal = cross(e1, e2);
    let (depth, determinant) = (dot(f, normal), dot(direction, normal));
    let error = F64_ERROR * length(e1) * length(e2);
    // Without branches between: the signs are as unpredictable.
    (depth.abs() > error * length(f))
        & (determinant.abs() > error * length(direction))
        & (depth * determinant < 0.0)
}

#[inline(always)]
fn wide(vector: [f32; 3]) -> [f64; 3] {
    vector.map(f64::from)
}

#[inline(always)]
fn minus(p: [f64; 3], q: [f64; 3]) -> [f64; 3] {
    [p[0] - q[0], p[1] - q[1], p[2] - q[2]]
}

#[inline(always)]
fn dot(p: [f64; 3], q: [f64; 3]) -> f64 {
    p[0] * q[0] + p[1] * q[1] + p[2] * q[2]
}

#[inline(always)]
fn cross(p: [f64; 3], q: [f64; 3]) -> [f64; 3] {
    [
        p[1] * q[2] - p[2] * q[1],
        p[2] * q[0] - p[0] * q[2],
        p[0] * q[1] - p[1] * q[0],
    ]
}

/// The sum of the magnitudes of components.
#[inline(always)]
fn length(vector: [f64; 3]) -> f64 {
    vector[0].abs() + vector[1].abs() + vector[2].abs()
}
