//! Objects: shapes, the files and generators they name, and their place in the world.

use std::path::Path;

use glam::{DVec3, Vec3};
use tahko_geometry::{Polygon, Transform};

use super::description::{ObjectDescription, ShapeDescription, TransformStep, Triple};
use super::{LoadError, SceneReader, perspective};
use crate::generate::{self, GeneratedPart, GeneratedScene, Generator, UnitSphere};
use crate::scene::{Camera, CameraError, Light, Material, MeshPart};

impl SceneReader<'_> {
    pub(super) fn object(
        &mut self,
        place: &str,
        object: ObjectDescription,
    ) -> Result<(), LoadError> {
        let material = match object.material {
            None => None,
            Some(name) => match self.materials.get(&name) {
                Some(material) => Some(*material),
                None => return Err(self.invalid(place, format!("there is no material '{name}'"))),
            },
        };
        self.import.placement = self.transform(place, &object.transform)?;
        self.import.material = material;
        match object.shape {
            ShapeDescription::Mesh(file) => self.mesh_file(place, &file),
            ShapeDescription::Triangles { vertices, indices } => {
                let part = MeshPart {
                    name: place.to_owned(),
                    positions: vertices.into_iter().map(Vec3::from).collect(),
                    indices: indices.into_iter().map(|(a, b, c)| [a, b, c]).collect(),
                    ..MeshPart::default()
                };
                self.add(part)
            }
            ShapeDescription::Polygons(polygons) => {
                let part = self.polygons(place, polygons)?;
                self.add(part)
            }
            ShapeDescription::Sphere {
                center,
                surface_point,
                detail,
            } => {
                let part = self.sphere(place, center, surface_point, detail)?;
                self.add(part)
            }
            ShapeDescription::Generate {
                generator,
                size,
                seed,
            } => self.generate(place, generator, size, seed),
        }
    }

    fn transform(&self, place: &str, steps: &[TransformStep]) -> Result<Transform, LoadError> {
        steps
            .iter()
            .enumerate()
            .try_fold(Transform::IDENTITY, |transform, (index, step)| {
                let next = match *step {
                    TransformStep::Translate(x, y, z) => {
                        Some(Transform::translation(DVec3::new(x, y, z)))
                    }
                    TransformStep::Scale(x, y, z) => Transform::scaling(DVec3::new(x, y, z)),
                    TransformStep::Rotate { axis, degrees } => {
                        Transform::rotation(DVec3::from(axis), degrees)
                    }
                };
                let place = format!("{place}, transform {index}");
                let next =
                    next.ok_or_else(|| self.invalid(&place, format!("{step:?} cannot be undone")))?;
                Ok(transform.then(&next))
            })
    }

    /// Adds a part with the object's material, or a light grey.
    fn add(&mut self, part: MeshPart) -> Result<(), LoadError> {
        let material = match self.import.material {
            Some(material) => material,
            None => self.import.builder.add_material(Material::default()),
        };
        self.import
            .add_part(self.path, part, material, &Transform::IDENTITY)
    }

    fn mesh_file(&mut self, place: &str, file: &str) -> Result<(), LoadError> {
        let file = self.path.parent().unwrap_or(Path::new("")).join(file);
        if file
            .extension()
            .is_some_and(|extension| extension.eq_ignore_ascii_case("ron"))
        {
            return Err(self.invalid(
                place,
                "a scene inside a scene is not supported; name a mesh file",
            ));
        }
        self.import.file(&file)
    }

    fn polygons(
        &self,
        place: &str,
        polygons: Vec<Vec<Triple<f32>>>,
    ) -> Result<MeshPart, LoadError> {
        let mut part = MeshPart {
            name: place.to_owned(),
            ..MeshPart::default()
        };
        for (index, corners) in (0..).zip(polygons) {
            let place = format!("{place}, polygon {index}");
            let corners: Vec<Vec3> = corners.into_iter().map(Vec3::from).collect();
            let exact = corners.iter().map(|corner| corner.as_dvec3()).collect();
            Polygon::new(exact, index).map_err(|error| self.invalid(&place, error))?;
            let first = vertex_index(&part);
            let last = first + vertex_count(&corners) - 1;
            part.indices
                .extend((first + 1..last).map(|corner| [first, corner, corner + 1]));
            part.positions.extend(corners);
        }
        Ok(part)
    }

    fn sphere(
        &self,
        place: &str,
        center: Triple<f64>,
        surface_point: Triple<f64>,
        detail: u32,
    ) -> Result<MeshPart, LoadError> {
        if detail > 8 {
            return Err(self.invalid(
                place,
                format!("a detail of {detail} is not between 0 and 8"),
            ));
        }
        let center = self.finite(place, center)?;
        let radius = (self.finite(place, surface_point)? - center).length();
        if radius <= 0.0 {
            return Err(self.invalid(
                place,
                "the surface point is the centre; the radius would be 0",
            ));
        }
        let sphere = UnitSphere::new(detail);
        let position = |point: &Vec3| (center + radius * point.as_dvec3()).as_vec3();
        Ok(MeshPart {
            name: place.to_owned(),
            positions: sphere.points().iter().map(position).collect(),
            indices: sphere.triangles().to_vec(),
            normals: Some(sphere.points().to_vec()),
            texture_coordinates: None,
        })
    }

    fn generate(
        &mut self,
        place: &str,
        generator: Generator,
        size: Option<u32>,
        seed: u64,
    ) -> Result<(), LoadError> {
        let size = size.unwrap_or_else(|| generator.default_size());
        let GeneratedScene {
            parts,
            view,
            lights,
        } = generate::generate(generator, size, seed)
            .map_err(|error| self.invalid(place, error))?;
        for part in parts {
            let material = match self.import.material {
                Some(material) => material,
                None => self.import.builder.add_material(suggested_material(&part)),
            };
            let part = MeshPart {
                name: format!("{place}, {}", part.name),
                positions: part.positions,
                indices: part.indices,
                normals: part.normals,
                texture_coordinates: None,
            };
            self.import
                .add_part(self.path, part, material, &Transform::IDENTITY)?;
        }
        let placement = self.import.placement;
        let [eye, target, up] = [view.eye, view.target, view.up].map(Vec3::as_dvec3);
        if !self.import.builder.has_camera() {
            let projection = perspective(f64::from(view.vertical_fov_degrees));
            let camera = Transform::look_at(eye, target, up)
                .ok_or(CameraError::NoView)
                .and_then(|camera| Camera::new(camera.then(&placement), projection))
                .map_err(|error| self.invalid(place, error))?;
            self.import.builder.set_camera(camera);
        }
        if !self.import.builder.has_lights() {
            let share = std::f32::consts::PI / lights.len() as f32;
            for light in &lights {
                // Together they light a white surface that faces them at the target to a radiance of 1.
                let [position, target] =
                    [light.as_dvec3(), target].map(|point| placement.point(point));
                #[expect(
                    clippy::cast_possible_truncation,
                    reason = "a distance in an f32 scene"
                )]
                let intensity = Vec3::splat(share * position.distance_squared(target) as f32);
                self.import.builder.add_light(Light::Point {
                    position,
                    intensity,
                });
            }
        }
        Ok(())
    }
}

fn suggested_material(part: &GeneratedPart) -> Material {
    Material {
        name: part.name.to_owned(),
        color: part.color,
        mirror: part.mirror,
        transmission: if part.refractive_index.is_some() {
            0.95
        } else {
            0.0
        },
        ior: part.refractive_index.unwrap_or(1.5),
        ..Material::default()
    }
}

fn vertex_index(part: &MeshPart) -> u32 {
    vertex_count(&part.positions)
}

/// The number of vertices of a scene file, whose text could not hold more than a `u32` counts.
fn vertex_count(vertices: &[Vec3]) -> u32 {
    u32::try_from(vertices.len()).unwrap_or(u32::MAX)
}
