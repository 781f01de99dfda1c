//! Finds the radiance along a ray: direct light, and Whitted's mirror reflection and refraction.

use std::f32::consts::PI;

use glam::{DVec3, Vec3};
use tahko_geometry::{Hit, Ray};

use super::caster::RayCaster;
use super::surface::Surface;
use crate::scene::{Material, Scene};

/// How the radiance along a ray is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Integrator {
    /// The nearest surface, lit by each light that a shadow ray reaches, by the cosine law. Mirrors and glass
    /// show their diffuse colour.
    #[default]
    Direct,
    /// Direct light, plus mirror reflection and refraction.
    ///
    /// Source: Whitted, "An improved illumination model for shaded display", CACM 1980; with Fresnel's equations.
    Whitted {
        /// How many times a ray may be reflected or refracted.
        max_depth: u32,
    },
}

/// The usual depth limit of [`Integrator::Whitted`].
pub const DEFAULT_DEPTH: u32 = 8;

/// A reflected or refracted ray that adds less than this part to a pixel is not followed: a quarter of the
/// finest step of an 8-bit picture.
const SMALLEST_WEIGHT: f32 = 1.0 / 1024.0;

/// A ray still to be followed.
struct Pending {
    ray: Ray,
    hit: Option<Hit>,
    /// The part of its radiance that reaches the pixel.
    weight: Vec3,
    depth: u32,
}

impl Integrator {
    /// The radiance that arrives along a ray whose closest hit is known.
    pub(super) fn radiance(
        self,
        scene: &Scene,
        caster: &mut RayCaster<'_>,
        ray: &Ray,
        hit: Option<&Hit>,
    ) -> Vec3 {
        let max_depth = match self {
            Self::Direct => 0,
            Self::Whitted { max_depth } => max_depth,
        };
        let mut pending = vec![Pending {
            ray: *ray,
            hit: hit.copied(),
            weight: Vec3::ONE,
            depth: 0,
        }];
        let mut radiance = Vec3::ZERO;
        while let Some(Pending {
            ray,
            hit,
            weight,
            depth,
        }) = pending.pop()
        {
            let direction = ray.direction.as_dvec3().normalize_or_zero();
            let Some(hit) = hit else {
                radiance += weight * scene.background;
                continue;
            };
            let Some(surface) = Surface::new(scene, &hit, &ray, caster.precision()) else {
                continue;
            };
            let material = scene.material_of(&hit);
            let color = scene.color_at(&hit);
            let follow = depth < max_depth;
            let scattering = Scattering::of(material, color, &surface, direction, follow);
            radiance += weight * material.emission;
            if material.unlit {
                radiance += weight * color;
            } else if scattering.diffuse != Vec3::ZERO {
                radiance += weight * scattering.diffuse * irradiance(scene, caster, &surface) / PI;
            }
            for (part, direction) in scattering.rays.into_iter().flatten() {
                let weight = weight * part;
                if weight.max_element() >= SMALLEST_WEIGHT {
                    let ray = surface.point.spawn_ray(direction.as_vec3());
                    let hit = caster.secondary_hit(&ray);
                    pending.push(Pending {
                        ray,
                        hit,
                        weight,
                        depth: depth + 1,
                    });
                }
            }
        }
        radiance
    }
}

/// Irradiance on the side of the surface that is seen: of each light that is not blocked, by the cosine law, and
/// the ambient light.
fn irradiance(scene: &Scene, caster: &mut RayCaster<'_>, surface: &Surface) -> Vec3 {
    let mut sum = scene.ambient * PI;
    let position = surface.point.position().as_dvec3();
    for light in &scene.lights {
        let Some(arriving) = light.illuminate(position) else {
            continue;
        };
        let cosine = arriving.to_light.dot(surface.shading_normal);
        // The light must be on the seen side of the triangle and of its shading normal.
        if cosine <= 0.0 || arriving.to_light.dot(surface.normal) <= 0.0 {
            continue;
        }
        // The triangle itself need not be ignored: the ray starts on the light's side of it and stays there. And its
        // neighbours must not be: at a valley they do cast a shadow on it.
        let shadow_ray = if arriving.distance.is_finite() {
            let light_position = position + arriving.to_light * arriving.distance;
            surface.point.spawn_ray_to(light_position.as_vec3())
        } else {
            surface.point.spawn_ray(arriving.to_light.as_vec3())
        };
        if !caster.is_blocked(&shadow_ray) {
            #[expect(clippy::cast_possible_truncation, reason = "a cosine")]
            let cosine = cosine as f32;
            sum += arriving.irradiance * cosine;
        }
    }
    sum
}

/// What becomes of light at a surface, seen backwards from the viewer.
struct Scattering {
    /// Diffuse reflectance.
    diffuse: Vec3,
    /// Up to two rays that go on: their part of the radiance, and their direction.
    rays: [Option<(Vec3, DVec3)>; 2],
}

impl Scattering {
    fn of(
        material: &Material,
        color: Vec3,
        surface: &Surface,
        direction: DVec3,
        follow: bool,
    ) -> Self {
        if !follow || (material.transmission <= 0.0 && material.mirror <= 0.0) {
            return Self {
                diffuse: color,
                rays: [None; 2],
            };
        }
        let tint = if material.metallic { color } else { Vec3::ONE };
        let opaque = 1.0 - material.transmission;
        let mirrored = tint * (opaque * material.mirror);
        let diffuse = color * (opaque * (1.0 - material.mirror));
        let reflected = reflect(direction, surface);
        if material.transmission <= 0.0 {
            return Self {
                diffuse,
                rays: [Some((mirrored, reflected)), None],
            };
        }
        let ior = f64::from(material.ior);
        let eta = if surface.front { 1.0 / ior } else { ior };
        let (fresnel, refracted) = refract(direction, surface.shading_normal, eta);
        let glass = material.transmission;
        let refracted_part = color * (glass * (1.0 - fresnel));
        Self {
            diffuse,
            rays: [
                Some((mirrored + Vec3::splat(glass * fresnel), reflected)),
                refracted.map(|direction| (refracted_part, direction)),
            ],
        }
    }
}

/// The mirror direction, by the shading normal unless that leads below the surface.
fn reflect(direction: DVec3, surface: &Surface) -> DVec3 {
    let by = |normal: DVec3| direction - normal * (2.0 * direction.dot(normal));
    let reflected = by(surface.shading_normal);
    if reflected.dot(surface.normal) > 0.0 {
        reflected
    } else {
        by(surface.normal)
    }
}

/// Fresnel reflectance for unpolarised light and the refracted direction, which is `None` at total reflection. `eta`
/// is the index of refraction on the side of the viewer divided by that on the other side.
fn refract(direction: DVec3, normal: DVec3, eta: f64) -> (f32, Option<DVec3>) {
    let cos_in = -direction.dot(normal);
    let sin2_out = eta * eta * (1.0 - cos_in * cos_in);
    if sin2_out >= 1.0 {
        return (1.0, None);
    }
    let cos_out = (1.0 - sin2_out).sqrt();
    let perpendicular = (eta * cos_in - cos_out) / (eta * cos_in + cos_out);
    let parallel = (cos_in - eta * cos_out) / (cos_in + eta * cos_out);
    #[expect(clippy::cast_possible_truncation, reason = "a value between 0 and 1")]
    let fresnel = (0.5 * (perpendicular * perpendicular + parallel * parallel)) as f32;
    let refracted = direction * eta + normal * (eta * cos_in - cos_out);
    (fresnel, refracted.try_normalize())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refraction_bends_by_snells_law() {
        let incoming = DVec3::new(0.6, -0.8, 0.0);
        let (_, refracted) = refract(incoming, DVec3::Y, 1.0 / 1.5);
        let refracted = refracted.unwrap();
        assert!(
            (refracted.x - 0.4).abs() < 1e-12 && refracted.y < 0.0,
            "{refracted}"
        );
        let (fresnel, refracted) = refract(incoming, DVec3::Y, 1.0);
        assert_eq!(fresnel, 0.0);
        assert!(
            (refracted.unwrap() - incoming).length() < 1e-12,
            "no interface, no bend"
        );
    }

    #[test]
    fn fresnel_is_four_percent_for_glass_seen_straight_on_and_one_at_total_reflection() {
        let (fresnel, _) = refract(DVec3::NEG_Y, DVec3::Y, 1.0 / 1.5);
        assert!((fresnel - 0.04).abs() < 1e-6, "{fresnel}");
        let grazing = DVec3::new(0.9, -(1.0f64 - 0.81).sqrt(), 0.0);
        assert_eq!(refract(grazing, DVec3::Y, 1.5), (1.0, None));
    }
}
