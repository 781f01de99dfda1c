//! A triangle test for libraries that have none that fits.

use tahko_tracer::geometry::glam::Vec3;

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Meeting {
    pub(super) t: f32,
    pub(super) u: f32,
    pub(super) v: f32,
}

/// The plain test, in f32, of both sides of a triangle; `t` is not limited.
///
/// Source: Möller, Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", Journal of Graphics Tools 2(1), 1997.
#[inline]
pub(super) fn meet(origin: Vec3, direction: Vec3, [a, b, c]: [Vec3; 3]) -> Option<Meeting> {
    let (ab, ac) = (b - a, c - a);
    let p = direction.cross(ac);
    let determinant = ab.dot(p);
    if determinant == 0.0 {
        return None;
    }
    let reciprocal = 1.0 / determinant;
    let from_a = origin - a;
    let u = from_a.dot(p) * reciprocal;
    let q = from_a.cross(ab);
    let v = direction.dot(q) * reciprocal;
    let is_inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
    is_inside.then(|| Meeting {
        t: ac.dot(q) * reciprocal,
        u,
        v,
    })
}

/// The weights of the second and the third vertex where the ray meets the triangle's plane: for libraries that give only `t`.
pub(super) fn weights(origin: Vec3, direction: Vec3, [a, b, c]: [Vec3; 3]) -> [f32; 2] {
    let (ab, ac) = (b - a, c - a);
    let p = direction.cross(ac);
    let reciprocal = 1.0 / ab.dot(p);
    let from_a = origin - a;
    let u = from_a.dot(p) * reciprocal;
    let v = direction.dot(from_a.cross(ab)) * reciprocal;
    [u, v]
}
