//! The fast kernel.

use glam::{DVec3, Vec3};

use crate::{Ray, Triangle, TriangleHit, TriangleKernel};

/// The ray/triangle test of Möller and Trumbore: the fast kernel.
///
/// The filter in f32 may lose a ray that passes close to an edge (within about `2^-22` of the distance
/// between origin and triangle, more where the triangle is a needle seen at a grazing angle), so rays
/// can slip between neighbouring triangles. Triangles that pass are confirmed by the same test in f64,
/// which throws out what the rounding of the filter let through; `t` is correct to about one f32 ulp.
/// Triangles so thin or so grazing that their determinant cancels by more than 30 bits are not hit.
///
/// Source: Möller and Trumbore, "Fast, minimum storage ray/triangle intersection", 1997; without its
/// absolute epsilon and with the division last.
#[derive(Clone, Copy, Debug)]
pub struct MollerTrumbore {
    origin: Vec3,
    direction: Vec3,
}

/// A determinant below this part of the sum of its terms' magnitudes is noise: see [`MollerTrumbore`].
/// At `2^-30` the f64 determinant still has 20 correct bits, and `u`, `v`, `t` with it.
const CANCELLATION_LIMIT: f64 = 1.0 / (1u64 << 30) as f64;

impl TriangleKernel for MollerTrumbore {
    // The f64 confirmation places a hit within 2^-50 / CANCELLATION_LIMIT = 2^-20 of the triangle's size
    // at worst.
    const REACH: f32 = 16.0;

    fn new(ray: &Ray) -> Self {
        Self {
            origin: ray.origin,
            direction: ray.direction,
        }
    }

    #[inline]
    fn intersect(&self, triangle: &Triangle, t_min: f32, t_max: f32) -> Option<TriangleHit> {
        let edge1 = triangle.b - triangle.a;
        let edge2 = triangle.c - triangle.a;
        let p = self.direction.cross(edge2);
        let determinant = edge1.dot(p);
        let from_a = self.origin - triangle.a;
        let u = from_a.dot(p);
        let q = from_a.cross(edge1);
        let v = self.direction.dot(q);
        // Positive comparisons, so that NaN is a miss.
        let inside = if determinant > 0.0 {
            u >= 0.0 && v >= 0.0 && u + v <= determinant
        } else if determinant < 0.0 {
            u <= 0.0 && v <= 0.0 && u + v >= determinant
        } else {
            false
        };
        if !inside {
            return None;
        }
        // Most candidates behind the best hit so far end here; a relative slack of 2^-10 keeps the
        // rounded comparison from deciding what the confirmation should.
        let t = edge2.dot(q) / determinant;
        if t > t_max + t_max.abs() * (1.0 / 1024.0) {
            return None;
        }
        self.confirm(triangle, t_min, t_max)
    }
}

impl MollerTrumbore {
    /// The same test in f64.
    #[inline(never)]
    fn confirm(&self, triangle: &Triangle, t_min: f32, t_max: f32) -> Option<TriangleHit> {
        let [a, b, c] = triangle.vertices().map(Vec3::as_dvec3);
        let direction = self.direction.as_dvec3();
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
        let from_a = self.origin.as_dvec3() - a;
        let u = from_a.dot(p) / determinant;
        let q = from_a.cross(edge1);
        let v = direction.dot(q) / determinant;
        if !(u >= 0.0 && v >= 0.0 && u + v <= 1.0) {
            return None;
        }
        TriangleHit::rounded(edge2.dot(q) / determinant, u, v, t_min, t_max)
    }
}

/// The cross product with sums for differences: the magnitude that its rounding is relative to.
fn cross_of_magnitudes(a: DVec3, b: DVec3) -> DVec3 {
    DVec3::new(
        a.y * b.z + a.z * b.y,
        a.z * b.x + a.x * b.z,
        a.x * b.y + a.y * b.x,
    )
}
