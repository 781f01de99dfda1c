//! The confirmation in f64: whether a ray meets a triangle, and where, correct to about one f32 ulp.

use glam::{DVec3, Vec3};

use crate::Triangle;

/// A determinant below this part of the sum of its terms' magnitudes is noise. At `2^-30` the f64
/// determinant still has 20 correct bits, and `t`, `u`, `v` with it.
const CANCELLATION_LIMIT: f64 = 1.0 / (1u64 << 30) as f64;

/// The point at a confirmed `t` is within `2^-50 / CANCELLATION_LIMIT = 2^-20` of the largest distance between the origin and a
/// vertex from the triangle: 16 in units of `2^-24`.
pub(super) const REACH: f32 = 16.0;

/// `[t, u, v]` by the test of Möller and Trumbore in f64; `None` for a miss, and where too much cancels: in
/// triangles without area, and in those that are too thin or seen at too grazing an angle.
pub(super) fn intersect(origin: Vec3, direction: Vec3, triangle: &Triangle) -> Option<[f64; 3]> {
    let [a, b, c] = triangle.vertices().map(Vec3::as_dvec3);
    let direction = direction.as_dvec3();
    let edge1 = b - a;
    let edge2 = c - a;
    let p = direction.cross(edge2);
    let determinant = edge1.dot(p);
    let magnitude = edge1
        .abs()
        .dot(cross_of_magnitudes(direction.abs(), edge2.abs()));
    if determinant.abs() <= CANCELLATION_LIMIT * magnitude || triangle.is_degenerate() {
        return None;
    }
    let from_a = origin.as_dvec3() - a;
    let u = from_a.dot(p) / determinant;
    let q = from_a.cross(edge1);
    let v = direction.dot(q) / determinant;
    // A positive comparison, so that NaN is a miss.
    let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
    inside.then(|| [edge2.dot(q) / determinant, u, v])
}

/// The cross product with sums for differences: the magnitude that its rounding is relative to.
fn cross_of_magnitudes(a: DVec3, b: DVec3) -> DVec3 {
    DVec3::new(
        a.y * b.z + a.z * b.y,
        a.z * b.x + a.x * b.z,
        a.x * b.y + a.y * b.x,
    )
}
