//! Checks a file against the rules of glTF 2.0, beyond what is read from it, so that a broken file is refused rather
//! than half shown.
//!
//! Some rules are deliberately not enforced, because files that break them are common and harmless here: normals need
//! not be of unit length, vertex data need not be aligned to four bytes, views shared by attributes need not give a
//! stride, and the numbers of attribute sets may have gaps.

mod animations;
mod data;
mod elements;
mod extension_tables;
mod graph;
mod primitives;
mod schema;
mod skins;
mod tables;

use std::collections::BTreeMap;

use gltf::json::Value;

use self::graph::Graph;
use self::schema::{Kind, Place, Schema};
use super::accessor::Accessor;
use super::fault::{Fault, items, require};

/// The extensions that a file may require.
const SUPPORTED_EXTENSIONS: [&str; 7] = [
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

/// Whether what an extension adds is read.
pub(super) fn is_supported(extension: &str) -> bool {
    SUPPORTED_EXTENSIONS.contains(&extension)
}

/// Checks all that can be checked without the data in buffers. Integers written with a fraction of zero become
/// integers.
///
/// # Errors
/// If a rule is broken, or an unknown extension or version is required.
pub(super) fn structure(json: &mut Value) -> Result<(), Fault> {
    check_version(json)?;
    let declared = names(json, "extensionsUsed");
    let required = names(json, "extensionsRequired");
    if let Some(name) = required.iter().find(|name| !is_supported(name)) {
        return Err(Fault::Unsupported(format!("the required extension {name}")));
    }
    if let Some(name) = required.iter().find(|name| !declared.contains(name)) {
        let reason = format!("{name} is not listed in extensionsUsed");
        return Err(Fault::invalid("extensionsRequired", reason));
    }
    let schema = Schema {
        lengths: lengths(json),
        declared,
        known: extension_tables::KNOWN,
    };
    schema.check(json, &Kind::Object(&tables::ROOT), Place::Root)?;
    elements::check(json)?;
    primitives::check_morph_weights(json)?;
    let graph = Graph::new(json)?;
    graph.check_scenes(json)?;
    skins::check(json, &graph)
}

/// Checks what depends on the data in buffers.
///
/// # Errors
/// If a rule is broken.
pub(super) fn contents(json: &Value, accessors: &[Accessor<'_>]) -> Result<(), Fault> {
    data::check(accessors)?;
    primitives::check(json, accessors)?;
    animations::check(json, accessors)?;
    skins::check_matrices(json, accessors)
}

/// The version must be 2.x. A later 2.x than 2.0 is read as far as it is known, unless the file forbids that.
fn check_version(json: &Value) -> Result<(), Fault> {
    let text = |name: &str| {
        let asset = json.get("asset")?;
        asset.get(name).and_then(Value::as_str)
    };
    let version = text("version").ok_or_else(|| {
        Fault::invalid(
            "asset",
            "there is no version, so this is not a glTF 2.0 file",
        )
    })?;
    let number = |text: &str| -> Option<(u32, u32)> {
        let (major, minor) = text.split_once('.')?;
        Some((major.parse().ok()?, minor.parse().ok()?))
    };
    let parsed = number(version).ok_or_else(|| {
        let reason = format!("'{version}' is not a version number");
        Fault::invalid("asset.version", reason)
    })?;
    if parsed.0 != 2 {
        return Err(Fault::Unsupported(format!("glTF version {version}")));
    }
    let Some(minimum) = text("minVersion") else {
        return Ok(());
    };
    match number(minimum) {
        Some((2, 0)) => Ok(()),
        Some(minimum_number) => {
            require(minimum_number <= parsed, "asset.minVersion", || {
                format!("{minimum} is later than the version {version}")
            })?;
            Err(Fault::Unsupported(format!("glTF version {minimum}")))
        }
        None => Err(Fault::invalid(
            "asset.minVersion",
            format!("'{minimum}' is not a version number"),
        )),
    }
}

fn names(json: &Value, list: &str) -> Vec<String> {
    let names = items(json, list).iter().filter_map(Value::as_str);
    names.map(str::to_owned).collect()
}

/// The lengths of all arrays that indices refer to.
fn lengths(json: &Value) -> BTreeMap<&'static str, usize> {
    const ARRAYS: [&str; 13] = [
        "accessors",
        "animations",
        "buffers",
        "bufferViews",
        "cameras",
        "images",
        "materials",
        "meshes",
        "nodes",
        "samplers",
        "scenes",
        "skins",
        "textures",
    ];
    let mut lengths: BTreeMap<&'static str, usize> = ARRAYS
        .into_iter()
        .map(|name| (name, items(json, name).len()))
        .collect();
    let inner = |pointer: &str| {
        json.pointer(pointer)
            .and_then(Value::as_array)
            .map_or(0, Vec::len)
    };
    lengths.insert("lights", inner("/extensions/KHR_lights_punctual/lights"));
    lengths.insert(
        "variants",
        inner("/extensions/KHR_materials_variants/variants"),
    );
    lengths
}
