//! The scene model: what a picture is made from, in world space.
//!
//! A scene holds one triangle mesh over which a structure is built, and *parts*: runs of its triangles with
//! a material and, only where the material or the shape asks for them, shading normals and texture coordinates.

mod builder;
mod camera;
mod light;
mod material;

pub use builder::{MaterialId, MeshPart, SceneBuilder, SceneError, TextureId};
pub use camera::{Camera, CameraError, FieldOfView, Projection};
pub use light::{Illumination, Light};
pub use material::{Material, Texture, TextureError, Wrap, srgb_to_linear};

use std::ops::Range;

use glam::{DVec3, Vec2, Vec3};
use tahko_geometry::{Hit, TriangleMesh};

/// Everything that is needed to render: geometry in world space, materials, lights and a camera.
#[derive(Clone, Debug)]
pub struct Scene {
    pub(crate) mesh: TriangleMesh,
    /// In the order of their triangles; together they cover the mesh.
    pub(crate) parts: Vec<Part>,
    pub(crate) materials: Vec<Material>,
    pub(crate) textures: Vec<Texture>,
    pub(crate) camera: Camera,
    pub(crate) lights: Vec<Light>,
    pub(crate) background: Vec3,
    pub(crate) ambient: Vec3,
    pub(crate) exposure: f32,
}

/// A run of triangles with a common look.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    pub(crate) triangles: Range<usize>,
    /// The mesh vertex that the first entry of `normals` and `texture_coordinates` belongs to.
    pub(crate) first_vertex: usize,
    pub(crate) material: MaterialId,
    pub(crate) normals: Option<Vec<Vec3>>,
    pub(crate) texture_coordinates: Option<Vec<Vec2>>,
}

impl Scene {
    /// All triangles, in world space.
    #[must_use]
    pub const fn mesh(&self) -> &TriangleMesh {
        &self.mesh
    }

    /// The camera.
    #[must_use]
    pub const fn camera(&self) -> &Camera {
        &self.camera
    }

    /// The light sources.
    #[must_use]
    pub fn lights(&self) -> &[Light] {
        &self.lights
    }

    /// The materials.
    #[must_use]
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// The factor from scene radiance to display values: 1 unless the scene says otherwise.
    #[must_use]
    pub const fn exposure(&self) -> f32 {
        self.exposure
    }

    fn part_of(&self, triangle: usize) -> &Part {
        let index = self
            .parts
            .partition_point(|part| part.triangles.end <= triangle);
        &self.parts[index]
    }

    pub(crate) fn material_of(&self, hit: &Hit) -> &Material {
        &self.materials[self.part_of(hit.primitive as usize).material.0]
    }

    /// The interpolated shading normal, unit length, or `None` where the surface is flat.
    pub(crate) fn shading_normal(&self, hit: &Hit) -> Option<DVec3> {
        let part = self.part_of(hit.primitive as usize);
        let normals = part.normals.as_ref()?;
        let [a, b, c] = self
            .corners(hit, part.first_vertex)
            .map(|corner| normals[corner].as_dvec3());
        let [wa, wb, wc] = barycentric_weights(hit);
        (a * wa + b * wb + c * wc).try_normalize()
    }

    /// The diffuse colour at a hit: the material's, times its texture where it has one.
    pub(crate) fn color_at(&self, hit: &Hit) -> Vec3 {
        let part = self.part_of(hit.primitive as usize);
        let material = &self.materials[part.material.0];
        let (Some(texture), Some(coordinates)) = (material.texture, &part.texture_coordinates)
        else {
            return material.color;
        };
        let [a, b, c] = self
            .corners(hit, part.first_vertex)
            .map(|corner| coordinates[corner]);
        #[expect(clippy::cast_possible_truncation, reason = "weights are f32 values")]
        let [wa, wb, wc] = barycentric_weights(hit).map(|weight| weight as f32);
        material.color * self.textures[texture.0].sample(a * wa + b * wb + c * wc)
    }

    fn corners(&self, hit: &Hit, first_vertex: usize) -> [usize; 3] {
        self.mesh.indices()[hit.primitive as usize].map(|vertex| vertex as usize - first_vertex)
    }
}

/// The weights of the three vertices at a hit.
fn barycentric_weights(hit: &Hit) -> [f64; 3] {
    let [u, v] = [hit.u, hit.v].map(f64::from);
    [1.0 - u - v, u, v]
}
