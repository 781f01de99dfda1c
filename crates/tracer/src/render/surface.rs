//! The surface at a hit: its place, its normals, and its sides.

use glam::DVec3;
use tahko_geometry::predicate::{Sign, direction_side};
use tahko_geometry::{Hit, Plane, Precision, Ray, SurfacePoint};

use crate::scene::Scene;

/// The surface where a ray met a triangle, as seen by the ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surface {
    /// Where it is, and where the rays start that leave it.
    pub(crate) point: SurfacePoint,
    /// Unit normal of the triangle, on the side from which the ray came.
    pub(crate) normal: DVec3,
    /// Unit shading normal, on the same side as `normal` as seen by the ray.
    pub(crate) shading_normal: DVec3,
    /// Whether the ray met the front of the triangle.
    pub(crate) front: bool,
}

impl Surface {
    /// The surface at a hit of a ray; `None` where the triangle has no normal, which hits exclude.
    pub(crate) fn new(scene: &Scene, hit: &Hit, ray: &Ray, precision: Precision) -> Option<Self> {
        let triangle = scene.mesh().triangle(hit.primitive as usize);
        let front_normal = Plane::from_triangle(&triangle)?.normal;
        // Exact, so that a grazing ray does not mistake entering glass for leaving it.
        let front = direction_side(ray.direction, &triangle) == Sign::Negative;
        let direction = ray.direction.as_dvec3();
        let towards_viewer = |normal: DVec3| if front { normal } else { -normal };
        let normal = towards_viewer(front_normal);
        let shading_normal = scene
            .shading_normal(hit)
            .map(towards_viewer)
            .filter(|shading| shading.dot(direction) < 0.0)
            .unwrap_or(normal);
        Some(Self {
            point: SurfacePoint::new(hit, &triangle, precision),
            normal,
            shading_normal,
            front,
        })
    }
}
