//! Light sources without extent, as in `KHR_lights_punctual`.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};
use tahko_geometry::Aabb;

use super::Camera;

/// A light source without extent. Colours are linear RGB.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light {
    /// Shines from a point equally in all directions.
    Point {
        /// Where it is.
        position: DVec3,
        /// Radiant intensity: the irradiance at distance 1; falls off with the square of the distance.
        intensity: Vec3,
    },
    /// Shines along parallel rays from infinitely far away.
    Directional {
        /// The way the light travels, unit length.
        direction: DVec3,
        /// Irradiance on a surface that faces the light.
        irradiance: Vec3,
    },
    /// Shines from a point into a cone.
    Spot {
        /// Where it is.
        position: DVec3,
        /// The axis of the cone, the way the light travels, unit length.
        direction: DVec3,
        /// Radiant intensity inside the inner cone.
        intensity: Vec3,
        /// Cosine of the angle from the axis up to which the light has its full intensity.
        cos_inner: f64,
        /// Cosine of the angle from the axis beyond which there is no light; below `cos_inner`.
        cos_outer: f64,
    },
}

/// Light that arrives at a point from one source, if nothing is in between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Illumination {
    /// Unit vector from the point to the source.
    pub to_light: DVec3,
    /// Distance to the source; infinite for a directional light.
    pub distance: f64,
    /// Irradiance on a surface that faces the source.
    pub irradiance: Vec3,
}

impl Light {
    /// What reaches a point; `None` if nothing does, and at the very position of the source.
    #[must_use]
    pub fn illuminate(&self, point: DVec3) -> Option<Illumination> {
        match *self {
            Self::Point {
                position,
                intensity,
            } => from_position(point, position, intensity),
            Self::Directional {
                direction,
                irradiance,
            } => Some(Illumination {
                to_light: -direction,
                distance: f64::INFINITY,
                irradiance,
            }),
            Self::Spot {
                position,
                direction,
                intensity,
                cos_inner,
                cos_outer,
            } => {
                let light = from_position(point, position, intensity)?;
                let cos = -light.to_light.dot(direction);
                // The falloff of KHR_lights_punctual: linear in the cosine, then squared.
                let fraction = ((cos - cos_outer) / (cos_inner - cos_outer)).clamp(0.0, 1.0);
                #[expect(clippy::cast_possible_truncation, reason = "a factor between 0 and 1")]
                let falloff = (fraction * fraction) as f32;
                (falloff > 0.0).then_some(Illumination {
                    irradiance: light.irradiance * falloff,
                    ..light
                })
            }
        }
    }
}

fn from_position(point: DVec3, position: DVec3, intensity: Vec3) -> Option<Illumination> {
    let offset = position - point;
    let distance = offset.length();
    let to_light = offset.try_normalize()?;
    Some(Illumination {
        to_light,
        distance,
        irradiance: (intensity.as_dvec3() / (distance * distance)).as_vec3(),
    })
}

/// Light for a scene without any: a source and ambient light.
///
/// A camera outside the scene gets parallel light from behind it, from the left and above; a camera inside, where walls would
/// block that, a point light at its own place. A white surface that faces the light (at half the radius of the bounds, for
/// the point light) then has a radiance of about 1.
pub(super) fn default_lighting(camera: &Camera, bounds: &Aabb) -> (Light, Vec3) {
    let position = camera.position();
    if bounds.contains(position.as_vec3()) {
        let radius = 0.5 * (bounds.max.as_dvec3() - bounds.min.as_dvec3()).length();
        let intensity = DVec3::splat(0.6 * PI * (0.5 * radius).powi(2)).as_vec3();
        return (
            Light::Point {
                position,
                intensity,
            },
            Vec3::splat(0.3),
        );
    }
    let direction = camera.direction(DVec3::new(0.4, -0.6, -1.0));
    let light = Light::Directional {
        direction: direction.normalize_or(DVec3::NEG_Y),
        irradiance: DVec3::splat(PI).as_vec3(),
    };
    (light, Vec3::splat(0.15))
}

#[cfg(test)]
mod tests {
    use tahko_geometry::Transform;

    use super::*;
    use crate::scene::{FieldOfView, Projection};

    #[test]
    fn the_default_light_is_at_a_camera_inside_the_scene_and_behind_one_outside() {
        let camera_at = |position: DVec3| {
            let projection = Projection::Perspective(FieldOfView {
                degrees: 40.0,
                spans_shorter_side: false,
            });
            Camera::new(Transform::translation(position), projection).unwrap()
        };
        let bounds = Aabb::new(Vec3::NEG_ONE, Vec3::ONE);
        let (inside, _) = default_lighting(&camera_at(DVec3::splat(0.5)), &bounds);
        assert!(
            matches!(inside, Light::Point { position, .. } if position == DVec3::splat(0.5)),
            "{inside:?}"
        );
        let (outside, _) = default_lighting(&camera_at(DVec3::Z * 5.0), &bounds);
        let from_behind =
            matches!(outside, Light::Directional { direction, .. } if direction.z < 0.0);
        assert!(from_behind, "{outside:?}");
        let (nothing_to_see, _) = default_lighting(&camera_at(DVec3::ZERO), &Aabb::EMPTY);
        assert!(
            nothing_to_see.illuminate(DVec3::ONE).is_some(),
            "an empty scene"
        );
    }

    #[test]
    fn point_lights_fall_off_with_the_square_of_the_distance() {
        let light = Light::Point {
            position: DVec3::Z * 2.0,
            intensity: Vec3::splat(8.0),
        };
        let at_origin = light.illuminate(DVec3::ZERO).unwrap();
        assert_eq!(at_origin.irradiance, Vec3::splat(2.0));
        assert_eq!((at_origin.to_light, at_origin.distance), (DVec3::Z, 2.0));
        assert_eq!(light.illuminate(DVec3::Z * 2.0), None);
    }

    #[test]
    fn a_spot_is_full_inside_its_inner_cone_and_dark_outside_the_outer_one() {
        let light = Light::Spot {
            position: DVec3::ZERO,
            direction: DVec3::NEG_Z,
            intensity: Vec3::ONE,
            cos_inner: 0.9,
            cos_outer: 0.5,
        };
        assert_eq!(
            light.illuminate(DVec3::NEG_Z).unwrap().irradiance,
            Vec3::ONE
        );
        assert_eq!(light.illuminate(DVec3::X), None);
        let halfway = DVec3::new((1.0f64 - 0.7 * 0.7).sqrt(), 0.0, -0.7);
        let irradiance = light.illuminate(halfway).unwrap().irradiance.x;
        assert!((irradiance - 0.25).abs() < 1e-6, "{irradiance}");
    }
}
