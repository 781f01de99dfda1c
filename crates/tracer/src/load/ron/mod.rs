//! Reads scenes in RON.
//!
//! The format is described in `docs/scene-format.md`; its types are in [`description`].

mod description;
mod object;

use std::collections::HashMap;
use std::fs;
use std::path::Path;

use glam::{DVec3, Vec3};
use ron::extensions::Extensions;

use self::description::{
    CameraDescription, LightDescription, MaterialDescription, SceneDescription, Triple,
};
use super::{Import, LoadError};
use crate::scene::{Camera, CameraError, FieldOfView, Light, Material, MaterialId, Projection};

/// Reads a scene file into the scene.
pub(super) fn read(path: &Path, import: &mut Import) -> Result<(), LoadError> {
    let text = fs::read_to_string(path).map_err(|source| LoadError::io(path, source))?;
    let scene: SceneDescription = ron::Options::default()
        .with_default_extension(Extensions::IMPLICIT_SOME)
        .from_str(&text)
        .map_err(|error| LoadError::invalid(path, error.span.to_string(), error.code))?;
    let mut reader = SceneReader {
        path,
        import,
        materials: HashMap::new(),
    };
    reader.read(scene)
}

/// Turns a description into a scene; knows the file for messages.
struct SceneReader<'a> {
    path: &'a Path,
    import: &'a mut Import,
    materials: HashMap<String, MaterialId>,
}

impl SceneReader<'_> {
    fn read(&mut self, scene: SceneDescription) -> Result<(), LoadError> {
        for (name, material) in scene.materials {
            let material = self.material(&name, &material)?;
            let id = self.import.builder.add_material(material);
            self.materials.insert(name, id);
        }
        for (index, light) in scene.lights.into_iter().enumerate() {
            let light = self.light(&format!("light {index}"), &light)?;
            self.import.builder.add_light(light);
        }
        if let Some(background) = scene.background {
            let background = self.non_negative("background", background)?;
            self.import.builder.set_background(background);
        }
        if let Some(ambient) = scene.ambient {
            let ambient = self.non_negative("ambient", ambient)?;
            self.import.builder.set_ambient(ambient);
        }
        // Before the objects, whose files may bring cameras and an exposure of their own.
        if let Some(camera) = scene.camera {
            let camera = camera_from(&camera).map_err(|error| self.invalid("camera", error))?;
            self.import.builder.set_camera(camera);
        }
        for (index, object) in scene.objects.into_iter().enumerate() {
            self.object(&format!("object {index}"), object)?;
        }
        if let Some(exposure) = scene.exposure {
            self.in_range("exposure", exposure, 0.0..=f32::MAX)?;
            self.import.builder.set_exposure(exposure);
        }
        Ok(())
    }

    fn invalid(&self, place: &str, reason: impl ToString) -> LoadError {
        LoadError::invalid(self.path, place, reason)
    }

    fn in_range(
        &self,
        place: &str,
        value: f32,
        range: std::ops::RangeInclusive<f32>,
    ) -> Result<(), LoadError> {
        if range.contains(&value) {
            return Ok(());
        }
        let (start, end) = (range.start(), range.end());
        Err(self.invalid(place, format!("{value} is not between {start} and {end}")))
    }

    fn non_negative(&self, place: &str, color: Triple<f32>) -> Result<Vec3, LoadError> {
        let color = Vec3::from(color);
        if color.is_finite() && color.min_element() >= 0.0 {
            return Ok(color);
        }
        Err(self.invalid(
            place,
            format!("the colour {color} has a component that is negative or not finite"),
        ))
    }

    fn material(&self, name: &str, material: &MaterialDescription) -> Result<Material, LoadError> {
        let place = format!("material '{name}'");
        let color = self.non_negative(&place, material.color)?;
        for (field, value) in [
            ("color", color.max_element()),
            ("mirror", material.mirror),
            ("transmission", material.transmission),
        ] {
            self.in_range(&format!("{place}, {field}"), value, 0.0..=1.0)?;
        }
        self.in_range(&format!("{place}, ior"), material.ior, 1.0..=10.0)?;
        Ok(Material {
            name: name.to_owned(),
            color,
            mirror: material.mirror,
            metallic: material.metallic,
            transmission: material.transmission,
            ior: material.ior,
            emission: self.non_negative(&place, material.emission)?,
            ..Material::default()
        })
    }

    fn light(&self, place: &str, light: &LightDescription) -> Result<Light, LoadError> {
        match *light {
            LightDescription::Point {
                position,
                intensity,
            } => Ok(Light::Point {
                position: self.finite(place, position)?,
                intensity: self.non_negative(place, intensity)?,
            }),
            LightDescription::Directional {
                direction,
                irradiance,
            } => Ok(Light::Directional {
                direction: self.unit(place, "direction", DVec3::from(direction))?,
                irradiance: self.non_negative(place, irradiance)?,
            }),
            LightDescription::Spot {
                position,
                target,
                intensity,
                inner_angle,
                outer_angle,
            } => {
                if !(0.0 <= inner_angle && inner_angle < outer_angle && outer_angle <= 90.0) {
                    let reason = format!(
                        "inner_angle {inner_angle} and outer_angle {outer_angle} must rise from 0 to at most 90"
                    );
                    return Err(self.invalid(place, reason));
                }
                let position = self.finite(place, position)?;
                let direction = self.unit(
                    place,
                    "target minus position",
                    DVec3::from(target) - position,
                )?;
                Ok(Light::Spot {
                    position,
                    direction,
                    intensity: self.non_negative(place, intensity)?,
                    cos_inner: inner_angle.to_radians().cos(),
                    cos_outer: outer_angle.to_radians().cos(),
                })
            }
        }
    }

    fn finite(&self, place: &str, point: Triple<f64>) -> Result<DVec3, LoadError> {
        let point = DVec3::from(point);
        if point.is_finite() {
            return Ok(point);
        }
        Err(self.invalid(place, format!("{point} is not finite")))
    }

    fn unit(&self, place: &str, what: &str, vector: DVec3) -> Result<DVec3, LoadError> {
        vector
            .try_normalize()
            .ok_or_else(|| self.invalid(place, format!("{what} {vector} has no direction")))
    }
}

fn perspective(degrees: f64) -> Projection {
    Projection::Perspective(FieldOfView {
        degrees,
        spans_shorter_side: false,
    })
}

fn camera_from(camera: &CameraDescription) -> Result<Camera, CameraError> {
    let (eye, target, up, projection) = match *camera {
        CameraDescription::Perspective {
            eye,
            target,
            up,
            vertical_fov,
        } => (eye, target, up, perspective(vertical_fov)),
        CameraDescription::Orthographic {
            eye,
            target,
            up,
            height,
        } => (eye, target, up, Projection::Orthographic { height }),
    };
    Camera::look_at(
        DVec3::from(eye),
        DVec3::from(target),
        DVec3::from(up),
        projection,
    )
}

#[cfg(test)]
mod tests;
