//! Puts a scene together from parts in their own coordinates.

use glam::{DVec3, Vec2, Vec3};
use tahko_geometry::{MeshError, Transform, TriangleMesh};
use thiserror::Error;

use super::light::default_lighting;
use super::{Camera, CameraError, Light, Material, Part, Scene, Texture};

/// Names a material of a [`SceneBuilder`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct MaterialId(pub(crate) usize);

/// Names a texture of a [`SceneBuilder`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct TextureId(pub(crate) usize);

/// Triangles with one material, in their own coordinates.
#[derive(Clone, Debug, Default)]
pub struct MeshPart {
    /// A name for messages, such as the name of the object in its file.
    pub name: String,
    /// Vertex positions.
    pub positions: Vec<Vec3>,
    /// Triples of indices into `positions`, counter-clockwise seen from the front.
    pub indices: Vec<[u32; 3]>,
    /// A shading normal per position, of any length; none for flat surfaces.
    pub normals: Option<Vec<Vec3>>,
    /// Texture coordinates per position, (0, 0) at the upper left; only kept where the material has a texture.
    pub texture_coordinates: Option<Vec<Vec2>>,
}

/// Why a scene cannot be put together.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The triangles of a part are not a mesh.
    #[error("part '{part}': {source}")]
    Mesh {
        /// The part's name.
        part: String,
        /// What is wrong.
        source: MeshError,
    },
    /// Normals or texture coordinates do not match the positions.
    #[error("part '{part}' has {count} {attribute} for {positions} positions")]
    AttributeCount {
        /// The part's name.
        part: String,
        /// `normals` or `texture coordinates`.
        attribute: &'static str,
        /// How many there are.
        count: usize,
        /// How many positions there are.
        positions: usize,
    },
    /// More vertices than a `u32` can number.
    #[error("the scene has more than 2^32 vertices")]
    TooManyVertices,
    /// The default camera cannot be made.
    #[error(transparent)]
    Camera(#[from] CameraError),
}

/// Collects the parts of a scene.
///
/// What is not given gets a default: a camera that frames the whole scene, and a light at or behind the camera.
#[derive(Clone, Debug, Default)]
pub struct SceneBuilder {
    vertices: Vec<Vec3>,
    indices: Vec<[u32; 3]>,
    parts: Vec<Part>,
    materials: Vec<Material>,
    textures: Vec<Texture>,
    lights: Vec<Light>,
    camera: Option<Camera>,
    background: Option<Vec3>,
    ambient: Option<Vec3>,
    exposure: Option<f32>,
}

impl SceneBuilder {
    /// An empty scene.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a material.
    pub fn add_material(&mut self, material: Material) -> MaterialId {
        self.materials.push(material);
        MaterialId(self.materials.len() - 1)
    }

    /// Adds a texture.
    pub fn add_texture(&mut self, texture: Texture) -> TextureId {
        self.textures.push(texture);
        TextureId(self.textures.len() - 1)
    }

    /// Adds a light.
    pub fn add_light(&mut self, light: Light) {
        self.lights.push(light);
    }

    /// Whether a light was added.
    #[must_use]
    pub fn has_lights(&self) -> bool {
        !self.lights.is_empty()
    }

    /// The lights that were added.
    #[must_use]
    pub fn lights(&self) -> &[Light] {
        &self.lights
    }

    /// Sets the camera, replacing an earlier one.
    pub fn set_camera(&mut self, camera: Camera) {
        self.camera = Some(camera);
    }

    /// Whether a camera was set.
    #[must_use]
    pub const fn has_camera(&self) -> bool {
        self.camera.is_some()
    }

    /// Sets the radiance of rays that hit nothing.
    pub fn set_background(&mut self, radiance: Vec3) {
        self.background = Some(radiance);
    }

    /// Sets the light that arrives everywhere: the irradiance divided by pi.
    pub fn set_ambient(&mut self, radiance: Vec3) {
        self.ambient = Some(radiance);
    }

    /// Sets the factor from radiance to display values.
    pub fn set_exposure(&mut self, exposure: f32) {
        self.exposure = Some(exposure);
    }

    /// The number of triangles so far.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.indices.len()
    }

    /// The middle of the box around all vertices so far.
    #[must_use]
    pub fn center(&self) -> DVec3 {
        tahko_geometry::Aabb::from_points(self.vertices.iter().copied())
            .center()
            .as_dvec3()
    }

    /// Adds triangles. A mirroring transform turns their winding around, so that fronts stay fronts. Normals
    /// with a length of zero fall back to flat shading; texture coordinates are dropped where nothing reads them.
    ///
    /// # Errors
    /// If the part is not a valid mesh, also after the transform, or its attributes do not match its positions.
    ///
    /// # Panics
    /// If `material` comes from another builder.
    pub fn add_part(
        &mut self,
        part: MeshPart,
        material: MaterialId,
        local_to_world: &Transform,
    ) -> Result<(), SceneError> {
        check_attributes(&part)?;
        let first_vertex = self.vertices.len();
        let offset = u32::try_from(first_vertex).map_err(|_| SceneError::TooManyVertices)?;
        if u32::try_from(first_vertex + part.positions.len()).is_err() {
            return Err(SceneError::TooManyVertices);
        }
        let world = |position: &Vec3| local_to_world.point_f32(*position);
        let positions = if *local_to_world == Transform::IDENTITY {
            part.positions
        } else {
            part.positions.iter().map(world).collect()
        };
        let mesh =
            TriangleMesh::new(positions, part.indices).map_err(|source| SceneError::Mesh {
                part: part.name,
                source,
            })?;

        let first_triangle = self.indices.len();
        let flips = local_to_world.flips_winding();
        self.vertices.extend_from_slice(mesh.vertices());
        self.indices.extend(mesh.indices().iter().map(|corners| {
            let [a, b, c] = corners.map(|corner| corner + offset);
            if flips { [a, c, b] } else { [a, b, c] }
        }));
        let to_world_normal = |normal: Vec3| {
            local_to_world
                .normal(normal.as_dvec3())
                .normalize_or_zero()
                .as_vec3()
        };
        let has_texture = self.materials[material.0].texture.is_some();
        self.parts.push(Part {
            triangles: first_triangle..self.indices.len(),
            first_vertex,
            material,
            normals: part
                .normals
                .map(|normals| normals.into_iter().map(to_world_normal).collect()),
            texture_coordinates: part.texture_coordinates.filter(|_| has_texture),
        });
        Ok(())
    }

    /// The triangles alone.
    ///
    /// # Errors
    /// If there are too many triangles.
    pub fn finish_mesh(self) -> Result<TriangleMesh, SceneError> {
        TriangleMesh::new(self.vertices, self.indices).map_err(|source| SceneError::Mesh {
            part: "whole scene".to_owned(),
            source,
        })
    }

    /// The finished scene.
    ///
    /// # Errors
    /// If there are too many triangles, or no camera was set and none can frame the scene.
    pub fn finish(self) -> Result<Scene, SceneError> {
        let mesh =
            TriangleMesh::new(self.vertices, self.indices).map_err(|source| SceneError::Mesh {
                part: "whole scene".to_owned(),
                source,
            })?;
        let camera = match self.camera {
            Some(camera) => camera,
            None => Camera::framing(&mesh.aabb())?,
        };
        let mut lights = self.lights;
        let mut ambient = self.ambient.unwrap_or(Vec3::ZERO);
        if lights.is_empty() {
            let (light, default_ambient) = default_lighting(&camera, &mesh.aabb());
            lights.push(light);
            ambient = self.ambient.unwrap_or(default_ambient);
        }
        Ok(Scene {
            mesh,
            parts: self.parts,
            materials: self.materials,
            textures: self.textures,
            camera,
            lights,
            background: self.background.unwrap_or(DEFAULT_BACKGROUND),
            ambient,
            exposure: self.exposure.unwrap_or(1.0),
        })
    }
}

const DEFAULT_BACKGROUND: Vec3 = Vec3::new(0.2, 0.25, 0.3);

fn check_attributes(part: &MeshPart) -> Result<(), SceneError> {
    let counts = [
        ("normals", part.normals.as_ref().map(Vec::len)),
        (
            "texture coordinates",
            part.texture_coordinates.as_ref().map(Vec::len),
        ),
    ];
    for (attribute, count) in counts {
        if let Some(count) = count.filter(|count| *count != part.positions.len()) {
            return Err(SceneError::AttributeCount {
                part: part.name.clone(),
                attribute,
                count,
                positions: part.positions.len(),
            });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle() -> MeshPart {
        MeshPart {
            name: "triangle".to_owned(),
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            indices: vec![[0, 1, 2]],
            ..MeshPart::default()
        }
    }

    #[test]
    fn parts_follow_each_other_in_one_mesh_and_mirrors_keep_fronts() {
        let mut builder = SceneBuilder::new();
        let [red, blue] = [Vec3::X, Vec3::Z].map(|color| Material {
            color,
            ..Material::default()
        });
        let red = builder.add_material(red);
        let blue = builder.add_material(blue);
        let mirror = Transform::scaling(DVec3::new(-1.0, 1.0, 1.0)).unwrap();
        builder
            .add_part(triangle(), red, &Transform::IDENTITY)
            .unwrap();
        builder.add_part(triangle(), blue, &mirror).unwrap();
        let scene = builder.finish().unwrap();
        assert_eq!(scene.mesh().indices(), [[0, 1, 2], [3, 5, 4]]);
        assert!(
            scene.mesh().triangles().all(|t| t.scaled_normal().z > 0.0),
            "fronts stay fronts"
        );
        let hit = |primitive| tahko_geometry::Hit {
            t: 1.0,
            u: 0.2,
            v: 0.3,
            primitive,
        };
        assert_eq!([0, 1].map(|i| scene.color_at(&hit(i))), [Vec3::X, Vec3::Z]);
        assert_eq!(scene.lights().len(), 1);
    }

    #[test]
    fn faults_name_the_part() {
        let mut builder = SceneBuilder::new();
        let material = builder.add_material(Material::default());
        let broken = MeshPart {
            indices: vec![[0, 1, 3]],
            ..triangle()
        };
        let error = builder
            .add_part(broken, material, &Transform::IDENTITY)
            .unwrap_err();
        assert!(error.to_string().contains("part 'triangle'"), "{error}");
        let short = MeshPart {
            normals: Some(vec![Vec3::Z]),
            ..triangle()
        };
        let error = builder
            .add_part(short, material, &Transform::IDENTITY)
            .unwrap_err();
        assert!(
            error.to_string().contains("1 normals for 3 positions"),
            "{error}"
        );
        let far = Transform::translation(DVec3::splat(1e300));
        let error = builder.add_part(triangle(), material, &far).unwrap_err();
        assert!(matches!(error, SceneError::Mesh { .. }), "{error}");
    }
}
