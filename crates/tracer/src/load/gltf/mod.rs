//! glTF 2.0, as text (.gltf) or binary (.glb).
//!
//! The way of a file: it is taken apart ([`container`]), its JSON is checked against the specification
//! ([`validate`]), the buffers are read ([`buffers`]) and cut into arrays ([`accessor`]), and then the nodes of the
//! default scene are walked ([`nodes`]) for meshes ([`meshes`]) with their materials ([`materials`], [`textures`]),
//! lights ([`lights`]) and a camera ([`cameras`]). The `gltf` crate gives the typed model of the JSON; its readers of
//! binary data are not used, since they trust the file.
//!
//! Shown are triangles, strips and fans, flattened to world space where nodes share a mesh; base colours with
//! textures; metals of low roughness as mirrors; transmission, emission and unlit materials. Animations, skins and
//! morph targets are skipped, so that everything is in its rest pose. What is skipped is noted in the report.

mod accessor;
mod buffers;
mod cameras;
mod container;
mod fault;
mod layout;
mod lights;
mod materials;
mod meshes;
mod nodes;
mod notes;
mod textures;
mod uri;
mod validate;

#[cfg(test)]
mod tests;

use std::path::Path;

use gltf::json::{Root, Value};

use self::accessor::Accessor;
use self::buffers::View;
use self::fault::Fault;
use super::{Import, LoadError};

/// A checked file with its data.
#[derive(Debug)]
struct Document<'a> {
    /// The folder that relative file names start from.
    folder: &'a Path,
    /// All of the JSON. Meshes and images are read from it directly.
    json: &'a Value,
    /// The typed model of nodes, cameras, lights, materials, textures and samplers.
    root: Root,
    views: Vec<View<'a>>,
    accessors: Vec<Accessor<'a>>,
}

/// Reads a glTF file into a scene.
///
/// # Errors
/// If the file, or one that it refers to, cannot be read, breaks the rules of the format, or requires something that
/// is not supported.
pub(super) fn read(path: &Path, import: &mut Import) -> Result<(), LoadError> {
    let bytes = std::fs::read(path).map_err(|source| LoadError::io(path, source))?;
    let named_glb = path
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("glb"));
    read_bytes(&bytes, named_glb, path, import).map_err(|fault| fault.into_error(path))
}

fn read_bytes(
    bytes: &[u8],
    named_glb: bool,
    path: &Path,
    import: &mut Import,
) -> Result<(), Fault> {
    let container = container::open(bytes, named_glb)?;
    if container.trailing > 0 {
        let note = format!("{} bytes after the end are ignored", container.trailing);
        import.report.note(note);
    }
    let mut json: Value = gltf::json::deserialize::from_slice(container.json)
        .map_err(|error| Fault::invalid("JSON", error))?;
    validate::structure(&mut json)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let buffers = buffers::load(&json, container.binary, folder)?;
    let views = buffers::views(&json, &buffers)?;
    let accessors = accessor::accessors(&json, &views)?;
    validate::contents(&json, &accessors)?;
    let document = Document {
        folder,
        json: &json,
        root: typed(&json)?,
        views,
        accessors,
    };
    notes::add(&document, &mut import.report);
    let nodes = nodes::of_default_scene(&document, &mut import.report);
    meshes::read(&document, &nodes, path, import)?;
    cameras::read(&document, &nodes, import)?;
    lights::read(&document, &nodes, import);
    Ok(())
}

/// The typed model of what is read through it. The rest is left out, because the crate asks more of it than the
/// specification does.
fn typed(json: &Value) -> Result<Root, Fault> {
    const PARTS: [&str; 7] = [
        "asset",
        "cameras",
        "extensions",
        "materials",
        "nodes",
        "samplers",
        "textures",
    ];
    let parts = PARTS
        .into_iter()
        .filter_map(|name| Some((name.to_owned(), json.get(name)?.clone())))
        .collect();
    let mut parts = Value::Object(parts);
    let lights = parts.pointer_mut("/extensions/KHR_lights_punctual/lights");
    let lights = lights.and_then(Value::as_array_mut);
    for light in lights
        .into_iter()
        .flatten()
        .filter_map(Value::as_object_mut)
    {
        light.remove("extensions");
    }
    gltf::json::deserialize::from_value(parts).map_err(|error| Fault::invalid("JSON", error))
}
