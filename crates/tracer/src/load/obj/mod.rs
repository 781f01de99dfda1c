//! Wavefront OBJ with its material libraries.
//!
//! An own reader, because `tobj` reports no line, panics on a colour with two numbers, gives texture coordinates and
//! normals to the wrong vertices where only some corners have them, and cannot read UTF-16 or continued lines.
//!
//! Objects, groups and changes of material start new parts. Lines, points, curves and free-form surfaces are left out with a note.

mod material;
mod mtl;
mod parts;
mod statements;
mod texture;

use std::path::Path;

use self::material::Resolved;
use super::text::decode;
use super::{Import, LoadError};

/// Reads a file, and the material libraries it names unless the material comes from elsewhere.
pub(super) fn read(path: &Path, import: &mut Import) -> Result<(), LoadError> {
    let bytes = std::fs::read(path).map_err(|source| LoadError::io(path, source))?;
    let document = statements::parse(&decode(&bytes))
        .map_err(|(line, reason)| LoadError::invalid(path, format!("line {line}"), reason))?;
    drop(bytes);
    for note in document.notes() {
        import.note(path, &note);
    }
    let materials = match import.material {
        Some(id) => {
            let is_textured = true; // Perhaps: the scene drops texture coordinates that it does not need.
            vec![Resolved { id, is_textured }; document.materials.len()]
        }
        None => material::resolve(path, &document, import)?,
    };
    parts::add(path, &document, &materials, import)
}

#[cfg(test)]
mod tests;
