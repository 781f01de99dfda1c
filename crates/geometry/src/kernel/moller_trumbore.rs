//! The fast kernel.

use glam::Vec3;

use super::confirm;
use crate::{Ray, TraversalCounter, Triangle, TriangleHit, TriangleKernel};

/// The ray/triangle test of Möller and Trumbore: the fast kernel.
///
/// The filter in f32 may lose a ray that passes close to an edge (within about `2^-22` of the distance
/// between origin and triangle, more where the triangle is a needle seen at a grazing angle), so rays
/// can slip between neighbouring triangles. Triangles that pass are confirmed by the same test in f64,
/// which throws out what the rounding of the filter let through; `t` is correct to about one f32 ulp.
/// Where the products of the direction and two edges leave the range of f32, hits are lost.
/// Triangles so thin or so grazing that their determinant cancels by more than 30 bits are not hit.
///
/// Source: Möller and Trumbore, "Fast, minimum storage ray/triangle intersection", 1997; without its
/// absolute epsilon and with the division last.
#[derive(Clone, Copy, Debug)]
pub struct MollerTrumbore {
    origin: Vec3,
    direction: Vec3,
    t_min: f32,
}

impl TriangleKernel for MollerTrumbore {
    const REACH: f32 = confirm::REACH;

    type Block = super::ReachBlockFilter;

    fn new(ray: &Ray) -> Self {
        Self {
            origin: ray.origin,
            direction: ray.direction,
            t_min: ray.t_min,
        }
    }

    #[inline]
    fn intersect<C: TraversalCounter>(
        &self,
        triangle: &Triangle,
        t_max: f32,
        _counter: &mut C,
    ) -> Option<TriangleHit> {
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
        // No look at `t` here: rounded to f32 it is too uncertain on needles, and what it threw out would depend
        // on the order in which triangles are tested.
        self.confirm(triangle, t_max)
    }
}

impl MollerTrumbore {
    #[inline(never)]
    fn confirm(&self, triangle: &Triangle, t_max: f32) -> Option<TriangleHit> {
        let [t, u, v] = confirm::intersect(self.origin, self.direction, triangle)?;
        TriangleHit::rounded(t, u, v, self.t_min, t_max)
    }
}
