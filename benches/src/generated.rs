//! Generated scenes of about a wanted size.

use std::f32::consts::PI;

use anyhow::Result;
use tahko_tracer::generate::{self, GeneratedPart, GeneratedScene, Generator};
use tahko_tracer::geometry::{Transform, TriangleMesh, glam::Vec3};
use tahko_tracer::scene::{
    Camera, FieldOfView, Light, Material, MeshPart, Projection, Scene, SceneBuilder,
};

/// The generator's sizes whose triangle counts come nearest to those wanted, by ratio; each size once. Some generators grow tenfold from a
/// size to the next.
pub(crate) fn sizes(generator: Generator, wanted: &[u32]) -> Result<Vec<u32>> {
    let mut sizes = Vec::new();
    for count in wanted {
        let above = generator.size_for_triangles(u64::from(*count))?;
        let below = above.saturating_sub(1).max(*generator.sizes().start());
        let ratio = |size| -> Result<f64> {
            let ratio = generator.triangle_count(size)? as f64 / f64::from(*count);
            Ok(ratio.max(1.0 / ratio))
        };
        let nearest = if ratio(below)? < ratio(above)? {
            below
        } else {
            above
        };
        if !sizes.contains(&nearest) {
            sizes.push(nearest);
        }
    }
    Ok(sizes)
}

/// The triangles of a generated scene.
pub(crate) fn mesh(generator: Generator, size: u32) -> Result<TriangleMesh> {
    let GeneratedScene { parts, .. } = generate::generate(generator, size, SEED)?;
    let mut builder = SceneBuilder::new();
    add(parts, &mut builder)?;
    Ok(builder.finish_mesh()?)
}

/// A generated scene with the view, lights and materials that the generator suggests.
pub(crate) fn scene(generator: Generator, size: u32) -> Result<Scene> {
    let GeneratedScene {
        parts,
        view,
        lights,
    } = generate::generate(generator, size, SEED)?;
    let mut builder = SceneBuilder::new();
    add(parts, &mut builder)?;
    let [eye, target, up] = [view.eye, view.target, view.up].map(Vec3::as_dvec3);
    let projection = Projection::Perspective(FieldOfView {
        degrees: f64::from(view.vertical_fov_degrees),
        spans_shorter_side: false,
    });
    builder.set_camera(Camera::look_at(eye, target, up, projection)?);
    let share = PI / lights.len() as f32;
    for light in lights {
        // Together they light a white surface that faces them at the target to a radiance of 1.
        let intensity = Vec3::splat(share * light.distance_squared(view.target));
        builder.add_light(Light::Point {
            position: light.as_dvec3(),
            intensity,
        });
    }
    Ok(builder.finish()?)
}

const SEED: u64 = 1;

fn add(parts: Vec<GeneratedPart>, builder: &mut SceneBuilder) -> Result<()> {
    for part in parts {
        let material = builder.add_material(material(&part));
        let part = MeshPart {
            name: part.name.to_owned(),
            positions: part.positions,
            indices: part.indices,
            normals: part.normals,
            texture_coordinates: None,
        };
        builder.add_part(part, material, &Transform::IDENTITY)?;
    }
    Ok(())
}

fn material(part: &GeneratedPart) -> Material {
    Material {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_the_nearest_ones_and_none_comes_twice() {
        let sizes = sizes(Generator::Tetra, &[4, 60, 70, 1000]).unwrap();
        assert_eq!(sizes, [1, 3, 5], "4, 64 and 1024 triangles");
    }

    #[test]
    fn the_scene_has_the_triangles_of_the_mesh() {
        for generator in Generator::ALL {
            let size = *generator.sizes().start();
            let scene = scene(generator, size).unwrap();
            let mesh = mesh(generator, size).unwrap();
            assert_eq!(scene.mesh().len(), mesh.len(), "{generator}");
        }
    }
}
