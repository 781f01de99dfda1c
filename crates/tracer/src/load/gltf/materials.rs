//! Materials: from metallic-roughness to diffuse, mirror and glass.

use std::collections::HashMap;

use glam::{Mat2, Vec2, Vec3};
use gltf::json::material::{AlphaMode, Material as Source};
use gltf::json::texture::Info;
use gltf::json::validation::Checked;

use super::Document;
use super::fault::{Fault, named};
use super::textures::Textures;
use crate::load::{Import, LoadReport};
use crate::scene::{Material, MaterialId};

/// Up to this roughness a metal reflects a picture that the eye takes for sharp; it becomes a mirror. Rougher metals
/// become diffuse, with the same colour.
const MIRROR_ROUGHNESS: f32 = 0.2;

/// The materials that were needed so far.
#[derive(Debug, Default)]
pub(super) struct Materials {
    /// `None` is the material of primitives that name none.
    looks: HashMap<Option<usize>, Look>,
    textures: Textures,
}

/// A material, and what it asks of the meshes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Look {
    pub(super) id: MaterialId,
    /// Whether shading normals matter.
    pub(super) shaded: bool,
    /// Which texture coordinates are needed, if any.
    pub(super) coordinates: Option<TextureCoordinates>,
}

/// A set of texture coordinates, and how they are moved (`KHR_texture_transform`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TextureCoordinates {
    pub(super) set: u32,
    matrix: Mat2,
    offset: Vec2,
}

impl TextureCoordinates {
    /// Moves coordinates as the material asks.
    pub(super) fn apply(&self, coordinates: Vec2) -> Vec2 {
        self.matrix * coordinates + self.offset
    }

    fn new(info: &Info) -> Self {
        let plain = Self {
            set: info.tex_coord,
            matrix: Mat2::IDENTITY,
            offset: Vec2::ZERO,
        };
        let extensions = info.extensions.as_ref();
        let Some(transform) = extensions.and_then(|e| e.texture_transform.as_ref()) else {
            return plain;
        };
        // Counter-clockwise as seen with v upwards; here v runs down.
        let rotation = Mat2::from_angle(-transform.rotation.0);
        Self {
            set: transform.tex_coord.unwrap_or(info.tex_coord),
            matrix: rotation * Mat2::from_diagonal(Vec2::from(transform.scale.0)),
            offset: Vec2::from(transform.offset.0),
        }
    }
}

impl Materials {
    /// The look of a primitive that names a material, or none.
    ///
    /// Where the import gives a material, that takes the place of all in the file.
    ///
    /// # Errors
    /// If the image of the base colour cannot be decoded.
    pub(super) fn look(
        &mut self,
        document: &Document<'_>,
        index: Option<usize>,
        import: &mut Import,
    ) -> Result<Look, Fault> {
        if let Some(id) = import.material {
            return Ok(Look {
                id,
                shaded: true,
                coordinates: None,
            });
        }
        if let Some(look) = self.looks.get(&index) {
            return Ok(*look);
        }
        let default = Source::default();
        let source = index.and_then(|index| document.root.materials.get(index));
        let source = source.unwrap_or(&default);
        let name = index.map_or_else(
            || "default".to_owned(),
            |index| named("material", index, source.name.as_deref()),
        );
        note_skipped(source, &name, &mut import.report);
        let mut material = convert(source, name);
        let info = source.pbr_metallic_roughness.base_color_texture.as_ref();
        if let Some(info) = info {
            material.texture = self.textures.load(document, info.index.value(), import)?;
        }
        let coordinates = info
            .filter(|_| material.texture.is_some())
            .map(TextureCoordinates::new);
        let look = Look {
            shaded: !material.unlit,
            coordinates,
            id: import.builder.add_material(material),
        };
        self.looks.insert(index, look);
        Ok(look)
    }

    /// Checks the images that no material read.
    ///
    /// # Errors
    /// If an image is missing or is not one.
    pub(super) fn check_other_images(&self, document: &Document<'_>) -> Result<(), Fault> {
        self.textures.check_other_images(document)
    }
}

/// Maps a material: metals of a roughness up to [`MIRROR_ROUGHNESS`] become mirrors in their colour to the part that
/// they are metallic, all else diffuse in the base colour. Transmission becomes refraction with the index that is
/// given, or 1.5. Textures other than that of the base colour are not read, and an emission that one of them would
/// shape is left out.
fn convert(source: &Source, name: String) -> Material {
    let surface = &source.pbr_metallic_roughness;
    let [red, green, blue, _] = surface.base_color_factor.0;
    let is_smooth = surface.metallic_roughness_texture.is_none()
        && surface.roughness_factor.0 <= MIRROR_ROUGHNESS;
    let mirror = if is_smooth {
        surface.metallic_factor.0
    } else {
        0.0
    };
    let extensions = source.extensions.clone().unwrap_or_default();
    let strength = extensions.emissive_strength;
    let strength = strength.map_or(1.0, |strength| strength.emissive_strength.0);
    let emission = if source.emissive_texture.is_none() {
        Vec3::from(source.emissive_factor.0) * strength
    } else {
        Vec3::ZERO
    };
    let default = Material::default();
    Material {
        name,
        color: Vec3::new(red, green, blue),
        mirror,
        metallic: mirror > 0.0,
        transmission: extensions
            .transmission
            .map_or(0.0, |transmission| transmission.transmission_factor.0),
        ior: extensions.ior.map_or(default.ior, |ior| ior.ior.0.max(1.0)),
        emission,
        unlit: extensions.unlit.is_some(),
        ..default
    }
}

fn note_skipped(source: &Source, name: &str, report: &mut LoadReport) {
    let surface = &source.pbr_metallic_roughness;
    let extensions = source.extensions.as_ref();
    let transmission = extensions.and_then(|e| e.transmission.as_ref());
    let textures = [
        ("normal", source.normal_texture.is_some()),
        ("occlusion", source.occlusion_texture.is_some()),
        ("emissive", source.emissive_texture.is_some()),
        (
            "metallic-roughness",
            surface.metallic_roughness_texture.is_some(),
        ),
        (
            "transmission",
            transmission.is_some_and(|t| t.transmission_texture.is_some()),
        ),
    ];
    for (kind, _) in textures.iter().filter(|(_, exists)| *exists) {
        report.note(format!(
            "{kind} texture of {name} is skipped: only base colour textures are supported"
        ));
    }
    let mode = match source.alpha_mode {
        Checked::Valid(AlphaMode::Mask) => "MASK",
        Checked::Valid(AlphaMode::Blend) => "BLEND",
        _ => return,
    };
    report.note(format!(
        "alpha mode {mode} of {name} is skipped: surfaces are opaque"
    ));
}
