//! Lights: `KHR_lights_punctual`.

use std::f32::consts::PI;

use glam::{DVec3, Vec3};
use gltf::json::extensions::scene::khr_lights_punctual::{Light as Source, Type};
use gltf::json::validation::Checked;
use tahko_geometry::Transform;

use super::Document;
use super::fault::named;
use super::nodes::PlacedNode;
use crate::load::Import;
use crate::scene::Light;

/// Adds the lights of the nodes, and sets the exposure by them.
///
/// glTF gives intensities in candela and lux, of which a sunlit scene has a hundred thousand. They are kept, and the
/// exposure is set so that a white surface at the middle of the scene that faces each of the lights, none of them in
/// shadow, would get the display value 1 in its brightest channel. For this a spot light counts as if it pointed
/// there.
pub(super) fn read(document: &Document<'_>, nodes: &[PlacedNode<'_>], import: &mut Import) {
    let sources = document.root.extensions.as_ref();
    let sources = sources.and_then(|extensions| extensions.khr_lights_punctual.as_ref());
    let mut lights = Vec::new();
    for placed in nodes {
        let extension = placed.node.extensions.as_ref();
        let index = extension.and_then(|extensions| extensions.khr_lights_punctual.as_ref());
        let Some(index) = index.map(|extension| extension.light.value()) else {
            continue;
        };
        let Some(source) = sources.and_then(|sources| sources.lights.get(index)) else {
            continue;
        };
        let name = named("light", index, source.name.as_deref());
        if source.range.is_some() {
            let note =
                format!("range of {name} is skipped: light falls off with the distance alone");
            import.report.note(note);
        }
        let to_world = placed.to_file.then(&import.placement);
        match light(source, &to_world) {
            Some(light) => lights.push(light),
            None => import
                .report
                .note(format!("{name} is skipped: it has no direction")),
        }
    }
    if lights.is_empty() {
        return;
    }
    match exposure(&lights, import.builder.center()) {
        Some(exposure) => import.builder.set_exposure(exposure),
        None => import.report.note(
            "the exposure is not set by the lights: they do not light the middle of the scene",
        ),
    }
    for light in lights {
        import.builder.add_light(light);
    }
}

fn light(source: &Source, to_world: &Transform) -> Option<Light> {
    let strength = Vec3::from(source.color) * source.intensity;
    let position = to_world.point(DVec3::ZERO);
    let direction = to_world.vector(DVec3::NEG_Z).try_normalize();
    Some(match source.type_ {
        Checked::Valid(Type::Directional) => Light::Directional {
            direction: direction?,
            irradiance: strength,
        },
        Checked::Valid(Type::Spot) => {
            let spot = source.spot.clone().unwrap_or_default();
            Light::Spot {
                position,
                direction: direction?,
                intensity: strength,
                cos_inner: f64::from(spot.inner_cone_angle).cos(),
                cos_outer: f64::from(spot.outer_cone_angle).cos(),
            }
        }
        Checked::Valid(Type::Point) | Checked::Invalid => Light::Point {
            position,
            intensity: strength,
        },
    })
}

/// The factor that brings the light at a place to the display value 1; `None` if there is no light, or it is too
/// bright or dark for an f32.
fn exposure(lights: &[Light], center: DVec3) -> Option<f32> {
    let irradiance: Vec3 = lights
        .iter()
        .map(|light| match *light {
            Light::Spot {
                position,
                intensity,
                ..
            } => Light::Point {
                position,
                intensity,
            },
            other => other,
        })
        .filter_map(|light| light.illuminate(center))
        .map(|arriving| arriving.irradiance)
        .sum();
    let exposure = PI / irradiance.max_element();
    (exposure.is_normal() && exposure > 0.0).then_some(exposure)
}
