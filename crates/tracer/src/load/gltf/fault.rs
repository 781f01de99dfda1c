//! What can be wrong with a glTF file, before it is known as an error of the whole loader.

use std::fmt::Display;
use std::path::Path;

use gltf::json::Value;

use crate::load::LoadError;
use crate::scene::SceneError;

/// Why a file is refused.
#[derive(Debug)]
pub(super) enum Fault {
    /// The file breaks a rule of the format.
    Invalid { place: String, reason: String },
    /// The file needs something that is not supported.
    Unsupported(String),
    /// What was read does not make a scene.
    Scene(SceneError),
}

impl Fault {
    pub(super) fn invalid(place: impl Display, reason: impl Display) -> Self {
        Self::Invalid {
            place: place.to_string(),
            reason: reason.to_string().trim_end().to_owned(),
        }
    }

    pub(super) fn into_error(self, path: &Path) -> LoadError {
        match self {
            Self::Invalid { place, reason } => LoadError::invalid(path, place, reason),
            Self::Unsupported(feature) => LoadError::unsupported(path, feature),
            Self::Scene(source) => LoadError::scene(path, source),
        }
    }
}

/// Fails with a reason unless a rule holds. The reason is only put together where it fails.
pub(super) fn require<R: Display>(
    holds: bool,
    place: impl Display,
    reason: impl FnOnce() -> R,
) -> Result<(), Fault> {
    if holds {
        return Ok(());
    }
    Err(Fault::invalid(place, reason()))
}

/// The name of an element for messages: its kind, its number, and its name in the file where it has one.
pub(super) fn named(kind: &str, index: usize, name: Option<&str>) -> String {
    match name {
        Some(name) if !name.is_empty() => format!("{kind} {index} '{name}'"),
        _ => format!("{kind} {index}"),
    }
}

/// The elements of an array of an object; none where it is absent.
pub(super) fn items<'a>(object: &'a Value, name: &str) -> &'a [Value] {
    object
        .get(name)
        .and_then(Value::as_array)
        .map_or(&[], Vec::as_slice)
}

/// A number of an object that counts or refers to something.
pub(super) fn integer(object: &Value, name: &str) -> Option<u64> {
    object.get(name).and_then(Value::as_u64)
}

/// A reference of an object to an element of an array of the file.
pub(super) fn reference(object: &Value, name: &str) -> Option<usize> {
    integer(object, name).and_then(|index| usize::try_from(index).ok())
}

/// The references in an array of an object.
pub(super) fn references<'a>(object: &'a Value, name: &str) -> impl Iterator<Item = usize> + 'a {
    items(object, name)
        .iter()
        .filter_map(|index| usize::try_from(index.as_u64()?).ok())
}

/// The message name of an element of one of the arrays of a file.
pub(super) fn element_name(kind: &str, index: usize, element: &Value) -> String {
    named(kind, index, element.get("name").and_then(Value::as_str))
}
