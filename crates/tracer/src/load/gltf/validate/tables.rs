//! What the glTF 2.0 specification says may stand where, as tables (without extensions).
//!
//! Source: Khronos Group, glTF 2.0 Specification, 2021, section 5 "Properties Reference".

use super::extension_tables as ext;
use super::schema::{Kind, List, Property, Range, Shape};

pub(super) const fn required(name: &'static str, kind: Kind) -> Property {
    Property {
        name,
        required: true,
        kind,
    }
}

pub(super) const fn optional(name: &'static str, kind: Kind) -> Property {
    Property {
        name,
        required: false,
        kind,
    }
}

pub(super) const fn shape(properties: &'static [Property]) -> Shape {
    Shape {
        properties,
        extensions: &[],
    }
}

const fn range(min: f64, max: f64, above_min: bool) -> Kind {
    Kind::Number(Range {
        min,
        max,
        above_min,
    })
}

pub(super) const fn between(min: f64, max: f64) -> Kind {
    range(min, max, false)
}

const fn list(of: &'static Kind, min: usize, max: usize, unique: bool) -> Kind {
    Kind::List(List {
        of,
        min,
        max,
        unique,
    })
}

pub(super) const fn at_least_one(of: &'static Kind) -> Kind {
    list(of, 1, usize::MAX, false)
}

pub(super) const fn unique(of: &'static Kind) -> Kind {
    list(of, 1, usize::MAX, true)
}

pub(super) const fn exactly(count: usize, of: &'static Kind) -> Kind {
    list(of, count, count, false)
}

pub(super) const ANY_NUMBER: Kind = range(f64::NEG_INFINITY, f64::INFINITY, false);
/// Factors up to 1, which a few roundings to f32 may exceed.
pub(super) const UNIT: Kind = range(0.0, 1.0 + 4.0 * f32::EPSILON as f64, false);
pub(super) const NOT_NEGATIVE: Kind = range(0.0, f64::INFINITY, false);
pub(super) const POSITIVE: Kind = range(0.0, f64::INFINITY, true);
pub(super) const COUNT: Kind = Kind::Integer(1, u64::MAX);
pub(super) const OFFSET: Kind = Kind::Integer(0, u64::MAX);
/// Numbers of texture coordinate sets are kept as u32.
pub(super) const SET: Kind = Kind::Integer(0, u32::MAX as u64);

const NAME: Property = optional("name", Kind::String);

pub(super) static ROOT: Shape = Shape {
    properties: &[
        required("asset", Kind::Object(&ASSET)),
        optional("extensionsUsed", unique(&Kind::String)),
        optional("extensionsRequired", unique(&Kind::String)),
        optional("buffers", at_least_one(&Kind::Object(&BUFFER))),
        optional("bufferViews", at_least_one(&Kind::Object(&BUFFER_VIEW))),
        optional("accessors", at_least_one(&Kind::Object(&ACCESSOR))),
        optional("cameras", at_least_one(&Kind::Object(&CAMERA))),
        optional("images", at_least_one(&Kind::Object(&IMAGE))),
        optional("samplers", at_least_one(&Kind::Object(&SAMPLER))),
        optional("textures", at_least_one(&Kind::Object(&TEXTURE))),
        optional("materials", at_least_one(&Kind::Object(&MATERIAL))),
        optional("meshes", at_least_one(&Kind::Object(&MESH))),
        optional("skins", at_least_one(&Kind::Object(&SKIN))),
        optional("nodes", at_least_one(&Kind::Object(&NODE))),
        optional("animations", at_least_one(&Kind::Object(&ANIMATION))),
        optional("scenes", at_least_one(&Kind::Object(&SCENE))),
        optional("scene", Kind::Index("scenes")),
    ],
    extensions: &[
        ("KHR_lights_punctual", &ext::LIGHTS),
        ("KHR_materials_variants", &ext::VARIANTS),
    ],
};

static ASSET: Shape = shape(&[
    required("version", Kind::String),
    optional("minVersion", Kind::String),
    optional("generator", Kind::String),
    optional("copyright", Kind::String),
]);

static BUFFER: Shape = shape(&[
    NAME,
    required("byteLength", OFFSET),
    optional("uri", Kind::String),
]);

static BUFFER_VIEW: Shape = shape(&[
    NAME,
    required("buffer", Kind::Index("buffers")),
    optional("byteOffset", OFFSET),
    required("byteLength", OFFSET),
    optional("byteStride", Kind::Integer(4, 252)),
    optional("target", Kind::Code(&[34962, 34963])),
]);

const TYPES: &[&str] = &["SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"];

static ACCESSOR: Shape = shape(&[
    NAME,
    optional("bufferView", Kind::Index("bufferViews")),
    optional("byteOffset", OFFSET),
    required(
        "componentType",
        Kind::Code(&[5120, 5121, 5122, 5123, 5125, 5126]),
    ),
    optional("normalized", Kind::Bool),
    required("count", OFFSET),
    required("type", Kind::Word(TYPES)),
    optional("min", list(&ANY_NUMBER, 1, 16, false)),
    optional("max", list(&ANY_NUMBER, 1, 16, false)),
    optional("sparse", Kind::Object(&SPARSE)),
]);

static SPARSE: Shape = shape(&[
    required("count", COUNT),
    required("indices", Kind::Object(&SPARSE_INDICES)),
    required("values", Kind::Object(&SPARSE_VALUES)),
]);

static SPARSE_INDICES: Shape = shape(&[
    required("bufferView", Kind::Index("bufferViews")),
    optional("byteOffset", OFFSET),
    required("componentType", Kind::Code(&[5121, 5123, 5125])),
]);

static SPARSE_VALUES: Shape = shape(&[
    required("bufferView", Kind::Index("bufferViews")),
    optional("byteOffset", OFFSET),
]);

static CAMERA: Shape = shape(&[
    NAME,
    required("type", Kind::Word(&["perspective", "orthographic"])),
    optional("perspective", Kind::Object(&PERSPECTIVE)),
    optional("orthographic", Kind::Object(&ORTHOGRAPHIC)),
]);

static PERSPECTIVE: Shape = shape(&[
    optional("aspectRatio", POSITIVE),
    required("yfov", POSITIVE),
    required("znear", POSITIVE),
    optional("zfar", POSITIVE),
]);

static ORTHOGRAPHIC: Shape = shape(&[
    required("xmag", ANY_NUMBER),
    required("ymag", ANY_NUMBER),
    required("znear", NOT_NEGATIVE),
    required("zfar", POSITIVE),
]);

static IMAGE: Shape = shape(&[
    NAME,
    optional("uri", Kind::String),
    optional("mimeType", Kind::String),
    optional("bufferView", Kind::Index("bufferViews")),
]);

const WRAP: Kind = Kind::Code(&[33071, 33648, 10497]);

static SAMPLER: Shape = shape(&[
    NAME,
    optional("magFilter", Kind::Code(&[9728, 9729])),
    optional(
        "minFilter",
        Kind::Code(&[9728, 9729, 9984, 9985, 9986, 9987]),
    ),
    optional("wrapS", WRAP),
    optional("wrapT", WRAP),
]);

static TEXTURE: Shape = Shape {
    properties: &[
        NAME,
        optional("sampler", Kind::Index("samplers")),
        optional("source", Kind::Index("images")),
    ],
    extensions: &[
        ("EXT_texture_webp", &ext::IMAGE_SOURCE),
        ("KHR_texture_basisu", &ext::IMAGE_SOURCE),
        ("MSFT_texture_dds", &ext::IMAGE_SOURCE),
    ],
};

static TEXTURE_INFO: Shape = Shape {
    properties: &[
        required("index", Kind::Index("textures")),
        optional("texCoord", SET),
        // Of normal and occlusion textures.
        optional("scale", ANY_NUMBER),
        optional("strength", UNIT),
    ],
    extensions: &[("KHR_texture_transform", &ext::TEXTURE_TRANSFORM)],
};
pub(super) const TEXTURE_REFERENCE: Kind = Kind::Object(&TEXTURE_INFO);

static MATERIAL: Shape = Shape {
    properties: &[
        NAME,
        optional("pbrMetallicRoughness", Kind::Object(&METALLIC_ROUGHNESS)),
        optional("normalTexture", TEXTURE_REFERENCE),
        optional("occlusionTexture", TEXTURE_REFERENCE),
        optional("emissiveTexture", TEXTURE_REFERENCE),
        optional("emissiveFactor", exactly(3, &UNIT)),
        optional("alphaMode", Kind::Word(&["OPAQUE", "MASK", "BLEND"])),
        optional("alphaCutoff", NOT_NEGATIVE),
        optional("doubleSided", Kind::Bool),
    ],
    extensions: ext::MATERIAL_EXTENSIONS,
};

static METALLIC_ROUGHNESS: Shape = shape(&[
    optional("baseColorFactor", exactly(4, &UNIT)),
    optional("baseColorTexture", TEXTURE_REFERENCE),
    optional("metallicFactor", UNIT),
    optional("roughnessFactor", UNIT),
    optional("metallicRoughnessTexture", TEXTURE_REFERENCE),
]);

const WEIGHTS: Property = optional("weights", at_least_one(&ANY_NUMBER));

static MESH: Shape = shape(&[
    NAME,
    required("primitives", at_least_one(&Kind::Object(&PRIMITIVE))),
    WEIGHTS,
]);

const ATTRIBUTES: Kind = Kind::Map(&Kind::Index("accessors"));

static PRIMITIVE: Shape = Shape {
    properties: &[
        required("attributes", ATTRIBUTES),
        optional("indices", Kind::Index("accessors")),
        optional("material", Kind::Index("materials")),
        optional("mode", Kind::Code(&[0, 1, 2, 3, 4, 5, 6])),
        optional("targets", at_least_one(&ATTRIBUTES)),
    ],
    extensions: &[("KHR_materials_variants", &ext::VARIANT_MAPPINGS)],
};

static SKIN: Shape = shape(&[
    NAME,
    optional("inverseBindMatrices", Kind::Index("accessors")),
    optional("skeleton", Kind::Index("nodes")),
    required("joints", unique(&Kind::Index("nodes"))),
]);

static NODE: Shape = Shape {
    properties: &[
        NAME,
        optional("camera", Kind::Index("cameras")),
        optional("children", unique(&Kind::Index("nodes"))),
        optional("skin", Kind::Index("skins")),
        optional("mesh", Kind::Index("meshes")),
        optional("matrix", exactly(16, &ANY_NUMBER)),
        optional("rotation", exactly(4, &ANY_NUMBER)),
        optional("scale", exactly(3, &ANY_NUMBER)),
        optional("translation", exactly(3, &ANY_NUMBER)),
        WEIGHTS,
    ],
    extensions: &[
        ("KHR_lights_punctual", &ext::LIGHT_REFERENCE),
        ("KHR_node_visibility", &ext::VISIBILITY),
    ],
};

static ANIMATION: Shape = shape(&[
    NAME,
    required("channels", at_least_one(&Kind::Object(&CHANNEL))),
    required("samplers", at_least_one(&Kind::Object(&ANIMATION_SAMPLER))),
]);

static CHANNEL: Shape = shape(&[
    required("sampler", OFFSET),
    required("target", Kind::Object(&CHANNEL_TARGET)),
]);

static CHANNEL_TARGET: Shape = shape(&[
    optional("node", Kind::Index("nodes")),
    required("path", Kind::String),
]);

static ANIMATION_SAMPLER: Shape = shape(&[
    required("input", Kind::Index("accessors")),
    required("output", Kind::Index("accessors")),
    optional(
        "interpolation",
        Kind::Word(&["LINEAR", "STEP", "CUBICSPLINE"]),
    ),
]);

static SCENE: Shape = shape(&[NAME, optional("nodes", unique(&Kind::Index("nodes")))]);
