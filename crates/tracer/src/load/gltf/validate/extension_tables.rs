//! What the extensions of the Khronos registry say may stand where, as tables. Extensions that are not read are here
//! too, so that a file that breaks their rules is not taken for a sound one.

use super::schema::{Kind, Property, Shape};
use super::tables::{
    ANY_NUMBER, NOT_NEGATIVE, POSITIVE, SET, TEXTURE_REFERENCE, UNIT, at_least_one, between,
    exactly, optional, required, shape, unique,
};

/// The extensions that have a place in a table.
pub(super) const KNOWN: &[&str] = &[
    "EXT_texture_webp",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_node_visibility",
    "KHR_texture_basisu",
    "KHR_texture_transform",
    "MSFT_texture_dds",
];

pub(super) static LIGHTS: Shape = shape(&[required("lights", at_least_one(&Kind::Object(&LIGHT)))]);

static LIGHT: Shape = shape(&[
    optional("name", Kind::String),
    required("type", Kind::Word(&["directional", "point", "spot"])),
    optional("color", exactly(3, &UNIT)),
    optional("intensity", NOT_NEGATIVE),
    optional("range", POSITIVE),
    optional("spot", Kind::Object(&SPOT)),
]);

/// Angles are at most a right angle, which decimals may exceed in the seventh digit.
const RIGHT_ANGLE: f64 = std::f64::consts::FRAC_PI_2 * (1.0 + f32::EPSILON as f64);

static SPOT: Shape = shape(&[
    optional("innerConeAngle", between(0.0, RIGHT_ANGLE)),
    optional("outerConeAngle", between(0.0, RIGHT_ANGLE)),
]);

pub(super) static LIGHT_REFERENCE: Shape = shape(&[required("light", Kind::Index("lights"))]);

pub(super) static VISIBILITY: Shape = shape(&[optional("visible", Kind::Bool)]);

pub(super) static VARIANTS: Shape =
    shape(&[required("variants", at_least_one(&Kind::Object(&VARIANT)))]);

static VARIANT: Shape = shape(&[required("name", Kind::String)]);

pub(super) static VARIANT_MAPPINGS: Shape =
    shape(&[required("mappings", at_least_one(&Kind::Object(&MAPPING)))]);

static MAPPING: Shape = shape(&[
    required("material", Kind::Index("materials")),
    required("variants", unique(&Kind::Index("variants"))),
]);

pub(super) static IMAGE_SOURCE: Shape = shape(&[optional("source", Kind::Index("images"))]);

pub(super) static TEXTURE_TRANSFORM: Shape = shape(&[
    optional("offset", exactly(2, &ANY_NUMBER)),
    optional("rotation", ANY_NUMBER),
    optional("scale", exactly(2, &ANY_NUMBER)),
    optional("texCoord", SET),
]);

pub(super) static MATERIAL_EXTENSIONS: &[(&str, &Shape)] = &[
    ("KHR_materials_anisotropy", &ANISOTROPY),
    ("KHR_materials_clearcoat", &CLEARCOAT),
    ("KHR_materials_dispersion", &DISPERSION),
    ("KHR_materials_emissive_strength", &EMISSIVE_STRENGTH),
    ("KHR_materials_ior", &IOR),
    ("KHR_materials_iridescence", &IRIDESCENCE),
    ("KHR_materials_pbrSpecularGlossiness", &SPECULAR_GLOSSINESS),
    ("KHR_materials_sheen", &SHEEN),
    ("KHR_materials_specular", &SPECULAR),
    ("KHR_materials_transmission", &TRANSMISSION),
    ("KHR_materials_unlit", &UNLIT),
    ("KHR_materials_volume", &VOLUME),
];

const fn texture(name: &'static str) -> Property {
    optional(name, TEXTURE_REFERENCE)
}

static ANISOTROPY: Shape = shape(&[
    optional("anisotropyStrength", UNIT),
    optional("anisotropyRotation", ANY_NUMBER),
    texture("anisotropyTexture"),
]);

static CLEARCOAT: Shape = shape(&[
    optional("clearcoatFactor", UNIT),
    texture("clearcoatTexture"),
    optional("clearcoatRoughnessFactor", UNIT),
    texture("clearcoatRoughnessTexture"),
    texture("clearcoatNormalTexture"),
]);

static DISPERSION: Shape = shape(&[optional("dispersion", NOT_NEGATIVE)]);

static EMISSIVE_STRENGTH: Shape = shape(&[optional("emissiveStrength", NOT_NEGATIVE)]);

static IOR: Shape = shape(&[optional("ior", NOT_NEGATIVE)]);

static IRIDESCENCE: Shape = shape(&[
    optional("iridescenceFactor", UNIT),
    texture("iridescenceTexture"),
    optional("iridescenceIor", NOT_NEGATIVE),
    optional("iridescenceThicknessMinimum", NOT_NEGATIVE),
    optional("iridescenceThicknessMaximum", NOT_NEGATIVE),
    texture("iridescenceThicknessTexture"),
]);

static SPECULAR_GLOSSINESS: Shape = shape(&[
    optional("diffuseFactor", exactly(4, &UNIT)),
    texture("diffuseTexture"),
    optional("specularFactor", exactly(3, &UNIT)),
    optional("glossinessFactor", UNIT),
    texture("specularGlossinessTexture"),
]);

static SHEEN: Shape = shape(&[
    optional("sheenColorFactor", exactly(3, &UNIT)),
    texture("sheenColorTexture"),
    optional("sheenRoughnessFactor", UNIT),
    texture("sheenRoughnessTexture"),
]);

static SPECULAR: Shape = shape(&[
    optional("specularFactor", UNIT),
    texture("specularTexture"),
    optional("specularColorFactor", exactly(3, &NOT_NEGATIVE)),
    texture("specularColorTexture"),
]);

static TRANSMISSION: Shape = shape(&[
    optional("transmissionFactor", UNIT),
    texture("transmissionTexture"),
]);

static UNLIT: Shape = shape(&[]);

static VOLUME: Shape = shape(&[
    optional("thicknessFactor", NOT_NEGATIVE),
    texture("thicknessTexture"),
    optional("attenuationDistance", POSITIVE),
    optional("attenuationColor", exactly(3, &UNIT)),
]);
