//! From the statements of an OBJ file to parts of the scene.

use std::collections::HashMap;
use std::path::Path;

use glam::{Vec2, Vec3};
use tahko_geometry::Transform;

use super::material::Resolved;
use super::statements::{Corner, Document, Face, NONE, Run};
use crate::load::polygon::FanCutter;
use crate::load::{Import, LoadError};
use crate::scene::MeshPart;

/// Adds a part for each run of faces. `materials` are those of the document, in its order.
pub(super) fn add(
    path: &Path,
    document: &Document,
    materials: &[Resolved],
    import: &mut Import,
) -> Result<(), LoadError> {
    check_indices(document)
        .map_err(|(line, reason)| LoadError::invalid(path, format!("line {line}"), reason))?;
    let mut cutter = FanCutter::default();
    for run in &document.runs {
        let material = materials[run.material];
        let part = PartBuilder::new(document, run, material.is_textured).build(&mut cutter);
        import.add_part(path, part, material.id, &Transform::IDENTITY)?;
    }
    if let Some(note) = cutter.note() {
        import.note(path, &note);
    }
    Ok(())
}

/// The corners of a face.
fn corners(document: &Document, face: usize) -> &[Corner] {
    let end = |face: &Face| face.corners_end;
    let start = face
        .checked_sub(1)
        .map_or(0, |before| end(&document.faces[before]));
    &document.corners[start..end(&document.faces[face])]
}

fn check_indices(document: &Document) -> Result<(), (usize, String)> {
    for (index, face) in document.faces.iter().enumerate() {
        for corner in corners(document, index) {
            for (what, index, count) in [
                ("position", corner.position, document.positions.len()),
                (
                    "texture coordinate",
                    corner.texture_coordinates,
                    document.texture_coordinates.len(),
                ),
                ("normal", corner.normal, document.normals.len()),
            ] {
                if index != NONE && index as usize >= count {
                    let reason = format!(
                        "the face needs {what} {}, but the file has {count}",
                        u64::from(index) + 1
                    );
                    return Err((face.line, reason));
                }
            }
        }
    }
    Ok(())
}

struct PartBuilder<'a> {
    document: &'a Document,
    run: &'a Run,
    has_normals: bool,
    has_texture_coordinates: bool,
    part: MeshPart,
    numbers: HashMap<Corner, u32>,
}

impl<'a> PartBuilder<'a> {
    fn new(document: &'a Document, run: &'a Run, is_textured: bool) -> Self {
        let any = |given: fn(&Corner) -> bool| {
            run.faces
                .clone()
                .any(|face| corners(document, face).iter().any(given))
        };
        Self {
            document,
            run,
            has_normals: any(|corner| corner.normal != NONE),
            has_texture_coordinates: is_textured
                && any(|corner| corner.texture_coordinates != NONE),
            part: MeshPart::default(),
            numbers: HashMap::new(),
        }
    }

    fn build(mut self, cutter: &mut FanCutter) -> MeshPart {
        self.part.name.clone_from(&self.run.name);
        self.part.normals = self.has_normals.then(Vec::new);
        self.part.texture_coordinates = self.has_texture_coordinates.then(Vec::new);
        let mut polygon = Vec::new();
        for face in self.run.faces.clone() {
            polygon.clear();
            for corner in corners(self.document, face) {
                polygon.push(self.vertex(*corner));
            }
            cutter.cut(&polygon, &self.part.positions, &mut self.part.indices);
        }
        self.part
    }

    /// The vertex for a corner: corners with the same indices share one.
    fn vertex(&mut self, mut corner: Corner) -> u32 {
        if !self.has_texture_coordinates {
            corner.texture_coordinates = NONE;
        }
        let document = self.document;
        let part = &mut self.part;
        *self.numbers.entry(corner).or_insert_with(|| {
            part.positions
                .push(document.positions[corner.position as usize]);
            if let Some(normals) = &mut part.normals {
                // Corners without a normal, among others that have one, get the zero that stands for flat.
                let normal = document.normals.get(corner.normal as usize);
                normals.push(normal.copied().unwrap_or(Vec3::ZERO));
            }
            if let Some(coordinates) = &mut part.texture_coordinates {
                let given = document
                    .texture_coordinates
                    .get(corner.texture_coordinates as usize);
                coordinates.push(given.copied().unwrap_or(Vec2::ZERO));
            }
            // More positions than this are refused when the part is added.
            u32::try_from(part.positions.len() - 1).unwrap_or(u32::MAX)
        })
    }
}
