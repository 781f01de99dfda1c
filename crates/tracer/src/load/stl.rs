//! STL, text and binary.
//!
//! An own reader, because `stl_io` stops at the end of the first solid without a word, takes every file that starts
//! with `solid ` for text, and reports no line. Corners with bit-equal positions become one vertex, solid by
//! solid: half the memory of loose triangles. Facet normals are not read: they are often wrong, and the winding says the same.

use std::collections::HashMap;
use std::path::Path;

use glam::Vec3;
use tahko_geometry::Transform;

use super::text::{decode, finite_number, numbered_lines, quoted};
use super::{Import, LoadError};
use crate::scene::MeshPart;

/// Reads the solids of a file, each as a part.
pub(super) fn read(path: &Path, import: &mut Import) -> Result<(), LoadError> {
    let bytes = std::fs::read(path).map_err(|source| LoadError::io(path, source))?;
    let solids = if is_binary(&bytes) {
        vec![read_binary(path, &bytes, import)?]
    } else {
        read_text(path, &bytes)?
    };
    let material = import.material_or_default();
    if solids.iter().all(|solid| solid.triangles.is_empty()) {
        import.note(path, "there are no triangles");
    }
    for solid in solids {
        import.add_part(path, solid.into_part(), material, &Transform::IDENTITY)?;
    }
    Ok(())
}

const HEADER: usize = 84;
const FACET: usize = 50;

/// The number of facets that a binary file announces, and the bytes after its header.
fn binary_parts(bytes: &[u8]) -> Option<(usize, &[u8])> {
    let (header, facets) = bytes.split_at_checked(HEADER)?;
    let (_, count) = header.split_last_chunk::<4>()?;
    Some((u32::from_le_bytes(*count) as usize, facets))
}

/// Binary headers may start with `solid`, so the size decides; where it does not fit either, text has no zero bytes.
fn is_binary(bytes: &[u8]) -> bool {
    let Some((count, facets)) = binary_parts(bytes) else {
        return false;
    };
    count.checked_mul(FACET) == Some(facets.len())
        || !starts_like_text(bytes)
        || (bytes.contains(&0)
            && !bytes.starts_with(&[0xFF, 0xFE])
            && !bytes.starts_with(&[0xFE, 0xFF]))
}

fn starts_like_text(bytes: &[u8]) -> bool {
    let start = decode(&bytes[..bytes.len().min(1024)]);
    let start = start.trim_start().as_bytes();
    start.len() >= 5 && start[..5].eq_ignore_ascii_case(b"solid")
}

fn read_binary(path: &Path, bytes: &[u8], import: &mut Import) -> Result<Solid, LoadError> {
    let (count, facets) = binary_parts(bytes).unwrap_or_default();
    let (facets, _) = facets.as_chunks::<FACET>();
    let Some(used) = facets.get(..count) else {
        let reason = format!(
            "the header announces {count} facets, but the file ends after {}",
            facets.len()
        );
        return Err(LoadError::invalid(
            path,
            format!("facet {}", facets.len()),
            reason,
        ));
    };
    let rest = bytes.len() - HEADER - FACET * count;
    if rest > 0 && count == 0 {
        let reason = format!("the header announces no facets, but {rest} bytes follow it");
        return Err(LoadError::invalid(path, "header", reason));
    }
    if rest > 0 {
        import.note(
            path,
            &format!("{rest} bytes after the last facet are not read"),
        );
    }
    let mut solid = Solid::default();
    for (index, facet) in used.iter().enumerate() {
        let (floats, _) = facet.as_chunks::<4>();
        let coordinate = |i: usize| f32::from_le_bytes(floats[i]);
        let corners =
            [3, 6, 9].map(|i| Vec3::new(coordinate(i), coordinate(i + 1), coordinate(i + 2)));
        if let Some(corner) = corners.iter().find(|corner| !corner.is_finite()) {
            let reason = format!("a coordinate is not finite: {corner}");
            return Err(LoadError::invalid(path, format!("facet {index}"), reason));
        }
        solid.push(corners);
    }
    Ok(solid)
}

fn read_text(path: &Path, bytes: &[u8]) -> Result<Vec<Solid>, LoadError> {
    if !starts_like_text(bytes) {
        let reason = "neither text that starts with 'solid' nor a binary header of 84 bytes";
        return Err(LoadError::invalid(path, "start of the file", reason));
    }
    let text = decode(bytes);
    let mut reader = TextReader::default();
    let mut last_line = 0;
    for (number, line) in numbered_lines(&text) {
        last_line = number;
        let mut tokens = line.split_whitespace();
        if let Some(keyword) = tokens.next() {
            let arguments: Vec<_> = tokens.collect();
            reader
                .statement(&keyword.to_ascii_lowercase(), &arguments)
                .map_err(|reason| LoadError::invalid(path, format!("line {number}"), reason))?;
        }
    }
    if reader.place != Place::Outside {
        let reason = format!("the file ends {}", reader.place.name());
        return Err(LoadError::invalid(
            path,
            format!("line {last_line}"),
            reason,
        ));
    }
    Ok(reader.solids)
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Place {
    #[default]
    Outside,
    Solid,
    Facet,
    Loop,
    AfterLoop,
}

impl Place {
    const fn name(self) -> &'static str {
        match self {
            Self::Outside => "outside a solid",
            Self::Solid => "inside a solid, between facets (is 'endsolid' missing?)",
            Self::Facet => "inside a facet, before 'outer loop'",
            Self::Loop => "inside the loop of a facet",
            Self::AfterLoop => "inside a facet, after 'endloop'",
        }
    }
}

#[derive(Default)]
struct TextReader {
    place: Place,
    corners: Vec<Vec3>,
    solids: Vec<Solid>,
}

impl TextReader {
    fn statement(&mut self, keyword: &str, arguments: &[&str]) -> Result<(), String> {
        match (self.place, keyword) {
            (Place::Outside, "solid") => {
                self.solids.push(Solid {
                    name: arguments.join(" "),
                    ..Solid::default()
                });
                self.place = Place::Solid;
            }
            (Place::Solid, "facet") => self.place = Place::Facet,
            (Place::Facet, "outer") => self.place = Place::Loop,
            (Place::Loop, "vertex") => self.corners.push(position(arguments)?),
            (Place::Loop, "endloop") => self.finish_triangle()?,
            (Place::AfterLoop, "endfacet") => self.place = Place::Solid,
            (Place::Solid, "endsolid") => self.place = Place::Outside,
            (place, _) => {
                return Err(format!("{} cannot stand {}", quoted(keyword), place.name()));
            }
        }
        Ok(())
    }

    fn finish_triangle(&mut self) -> Result<(), String> {
        let corners = <[Vec3; 3]>::try_from(self.corners.as_slice())
            .map_err(|_| format!("the facet has {} corners instead of 3", self.corners.len()))?;
        self.corners.clear();
        self.place = Place::AfterLoop;
        if let Some(solid) = self.solids.last_mut() {
            solid.push(corners);
        }
        Ok(())
    }
}

fn position(arguments: &[&str]) -> Result<Vec3, String> {
    let [x, y, z] = arguments else {
        return Err(format!(
            "'vertex' needs 3 coordinates, not {}",
            arguments.len()
        ));
    };
    Ok(Vec3::new(
        finite_number(x)?,
        finite_number(y)?,
        finite_number(z)?,
    ))
}

#[derive(Default)]
struct Solid {
    name: String,
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    numbers: HashMap<[u32; 3], u32>,
}

impl Solid {
    fn push(&mut self, corners: [Vec3; 3]) {
        let triangle = corners.map(|corner| {
            *self
                .numbers
                .entry(corner.to_array().map(f32::to_bits))
                .or_insert_with(|| {
                    self.positions.push(corner);
                    // More positions than this are refused when the part is added.
                    u32::try_from(self.positions.len() - 1).unwrap_or(u32::MAX)
                })
        });
        self.triangles.push(triangle);
    }

    fn into_part(self) -> MeshPart {
        MeshPart {
            name: self.name,
            positions: self.positions,
            indices: self.triangles,
            ..MeshPart::default()
        }
    }
}

#[cfg(test)]
mod tests;
