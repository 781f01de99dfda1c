//! PLY, text and binary.
//!
//! An own reader, because `ply-rs-bw` takes properties with equal names (legal, as in files with several
//! `gap` properties) for one and then reads shifted values without a word, and does not know numbers such as `.5` or `1.`.
//!
//! Read are the elements `vertex` (positions, normals), `face` (polygons) and `tristrips`. Colours are left out with a
//! note; whatever else is there does not change the picture. Texture coordinates are read where the
//! material comes from elsewhere, as PLY has no textures.

mod header;
mod mesh;
mod values;

use std::path::Path;

use tahko_geometry::Transform;

use self::header::{Encoding, HeaderError};
use self::mesh::Mesh;
use self::values::{BinaryValues, TextValues};
use super::text::decode;
use super::{Import, LoadError};

/// Reads a file as one part.
pub(super) fn read(path: &Path, import: &mut Import) -> Result<(), LoadError> {
    let bytes = std::fs::read(path).map_err(|source| LoadError::io(path, source))?;
    let header = header::parse(&bytes).map_err(|HeaderError { line, reason }| {
        LoadError::invalid(path, format!("line {line}"), reason)
    })?;
    let invalid = |(place, reason): Fault| LoadError::invalid(path, place, reason);
    let mut mesh = Mesh::new(&header, import.material.is_some()).map_err(invalid)?;

    let body = &bytes[header.size..];
    if header.encoding == Encoding::Text {
        let text = decode(body);
        let mut values = TextValues::new(&text, header.lines);
        mesh.read(&header, &mut values).map_err(invalid)?;
        if let Some(line) = values.next_line() {
            let reason = "there are more lines than the header announces";
            return Err(LoadError::invalid(path, format!("line {line}"), reason));
        }
    } else {
        let mut values = BinaryValues::new(body, header.encoding == Encoding::BigEndian);
        mesh.read(&header, &mut values).map_err(invalid)?;
        if values.rest() > 0 {
            let note = format!(
                "{} bytes after the last element are not read",
                values.rest()
            );
            import.note(path, &note);
        }
    }
    for note in mesh.notes(&header) {
        import.note(path, &note);
    }
    let material = import.material_or_default();
    import.add_part(path, mesh.into_part(), material, &Transform::IDENTITY)
}

/// Where something is wrong, and what.
type Fault = (String, String);

#[cfg(test)]
mod tests;
