//! parry3d: collision detection in Rust, with a binary BVH in its triangle mesh.

use anyhow::{Context, Result};
use parry3d::math::Vector;
use parry3d::query::{Ray as ParryRay, RayCast};
use parry3d::shape::{CompositeShapeRef, TriMesh};
use tahko_tracer::geometry::glam::Vec3;
use tahko_tracer::geometry::{Hit, Ray, TriangleMesh};

use super::moller_trumbore::weights;
use super::{RUST_SIMD, refuse_empty, single};
use crate::contender::{Built, Contender, Recipe};
use crate::report;

pub(super) fn recipes() -> Vec<Box<dyn Recipe>> {
    vec![Box::new(Parry)]
}

struct Parry;

impl Recipe for Parry {
    fn names(&self) -> Vec<report::Contender> {
        vec![single("parry3d", "bvh", "default", RUST_SIMD)]
    }

    fn build(&self, mesh: &TriangleMesh, _threads: usize) -> Result<Built> {
        refuse_empty(mesh)?;
        let vertices = mesh.vertices().iter().copied().map(vector).collect();
        let mesh =
            TriMesh::new(vertices, mesh.indices().to_vec()).context("parry3d refuses the mesh")?;
        let bytes = mesh.total_memory_size();
        Ok(Built {
            contenders: vec![Box::new(Traced(mesh))],
            bytes: Some(bytes),
            tree: None,
        })
    }
}

struct Traced(TriMesh);

impl Traced {
    /// The triangle and `t`. The library has no least `t`: only where that hides the answer, the triangles before it are left out one by one.
    fn closest(&self, ray: &Ray) -> Option<(u32, f32)> {
        let parry_ray = ParryRay::new(vector(ray.origin), vector(ray.direction));
        // Boxes that are missed count as entered at `f32::MAX`: a larger limit would let them all in.
        let t_max = ray.t_max.min(f32::MAX);
        let (triangle, t) = CompositeShapeRef(&self.0).cast_local_ray(&parry_ray, t_max, false)?;
        if t >= ray.t_min {
            return Some((triangle, t));
        }
        self.0.bvh().cast_ray(&parry_ray, t_max, |triangle, t_max| {
            let triangle = self.0.triangle(triangle);
            let t = triangle.cast_local_ray(&parry_ray, t_max, false)?;
            (t >= ray.t_min).then_some(t)
        })
    }
}

impl Contender for Traced {
    fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.closest(ray).map(|(primitive, t)| {
                let triangle = self.0.triangle(primitive);
                let vertices = [triangle.a, triangle.b, triangle.c].map(|v| v.to_array().into());
                let [u, v] = weights(ray.origin, ray.direction, vertices);
                Hit { t, u, v, primitive }
            });
        }
    }

    fn any_hits(&self, rays: &[Ray], found: &mut [bool]) {
        for (ray, found) in rays.iter().zip(found) {
            *found = self.closest(ray).is_some();
        }
    }
}

/// The library has another version of the same vectors.
fn vector(point: Vec3) -> Vector {
    Vector::from_array(point.to_array())
}
