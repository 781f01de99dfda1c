//! The surface at a hit, and rays that start on it.

use glam::{DVec3, Vec3};
use tahko_geometry::{Hit, Ray, Triangle};

use crate::scene::{Scene, barycentric_weights};

/// The point where a ray met a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SurfacePoint {
    pub(crate) position: DVec3,
    /// Unit normal of the triangle, on the side from which the ray came.
    pub(crate) normal: DVec3,
    /// Unit shading normal, on the same side as `normal` as seen by the ray.
    pub(crate) shading_normal: DVec3,
    /// Whether the ray met the front of the triangle.
    pub(crate) front: bool,
    /// How far a ray that starts here has to be lifted off the triangle.
    lift: f64,
}

impl SurfacePoint {
    /// The surface at a hit of a ray with a direction; `None` where the triangle has no normal, which hits exclude.
    pub(crate) fn new(scene: &Scene, hit: &Hit, direction: DVec3) -> Option<Self> {
        let triangle = scene.mesh().triangle(hit.primitive as usize);
        let front_normal = unit_normal(&triangle)?;
        let front = direction.dot(front_normal) < 0.0;
        let towards_viewer = |normal: DVec3| if front { normal } else { -normal };
        let normal = towards_viewer(front_normal);
        let shading_normal = scene
            .shading_normal(hit)
            .map(towards_viewer)
            .filter(|shading| shading.dot(direction) < 0.0)
            .unwrap_or(normal);
        let [a, b, c] = triangle.vertices().map(Vec3::as_dvec3);
        let [wa, wb, wc] = barycentric_weights(hit);
        let position = a * wa + b * wb + c * wc;
        Some(Self {
            position,
            normal,
            shading_normal,
            front,
            lift: lift(&triangle, position),
        })
    }

    /// The start of a ray that leaves towards `direction`: off the triangle, on the side to which it leads.
    pub(crate) fn start_towards(&self, direction: DVec3) -> Vec3 {
        let side = self.lift.copysign(direction.dot(self.normal));
        (self.position + self.normal * side).as_vec3()
    }

    /// A ray that leaves the surface.
    pub(crate) fn ray_towards(&self, direction: DVec3) -> Ray {
        Ray::new(self.start_towards(direction), direction.as_vec3())
    }
}

/// A distance from the plane of the triangle at which no kernel sees the triangle again, for a ray that leads away.
///
/// A kernel accepts a triangle at `t` only if the ray is then within `16 * 2^-24 * m` of it in each coordinate
/// (see `tahko_geometry::kernel`), where `m` is the distance to its farthest vertex, at most its extent plus the lift.
/// In the direction of the normal that is sqrt(3) times as much. Rounding the start to f32 moves it by at most `2^-24`
/// of its coordinates, times sqrt(3). Weights rounded to f32 move it within the plane only.
fn lift(triangle: &Triangle, position: DVec3) -> f64 {
    const UNIT_ROUNDOFF: f64 = 1.0 / (1u64 << 24) as f64;
    let extent = f64::from(triangle.aabb().extent().max_element());
    UNIT_ROUNDOFF * (32.0 * extent + 2.0 * position.abs().max_element())
}

fn unit_normal(triangle: &Triangle) -> Option<DVec3> {
    tahko_geometry::Plane::from_triangle(triangle).map(|plane| plane.normal)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use tahko_geometry::{BruteForce, Precision, RayQuery, TriangleMesh, test_support};

    use super::*;

    proptest! {
        /// A ray that leaves a triangle does not hit it again, however far from the origin and however large it is.
        #[test]
        fn a_ray_leaves_its_triangle(
            corners in prop::array::uniform3(test_support::point(1.0)),
            weights in (0.0f64..1.0, 0.0f64..1.0),
            direction in test_support::point(1.0),
            size in -20i32..20,
            place in test_support::point(1.0),
            distance in -20i32..20,
        ) {
            let corners = corners.map(|corner| corner * 2f32.powi(size) + place * 2f32.powi(distance));
            let mesh = TriangleMesh::new(corners.to_vec(), vec![[0, 1, 2]]).unwrap();
            let triangle = mesh.triangle(0);
            let Some(normal) = unit_normal(&triangle) else { return Ok(()) };
            let [a, b, c] = corners.map(Vec3::as_dvec3);
            let [u, v] = [weights.0, weights.1 * (1.0 - weights.0)];
            let position = a + (b - a) * u + (c - a) * v;
            let point = SurfacePoint {
                position,
                normal,
                shading_normal: normal,
                front: true,
                lift: lift(&triangle, position),
            };
            let ray = point.ray_towards(direction.as_dvec3());
            for precision in Precision::ALL {
                prop_assert!(!BruteForce::new(&mesh, precision).any_hit(&ray), "{precision:?} {ray:?}");
            }
        }
    }
}
