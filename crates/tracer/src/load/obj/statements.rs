//! The statements of an OBJ file, line by line.

use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap};
use std::ops::Range;
use std::str::SplitWhitespace;

use glam::{Vec2, Vec3};

use crate::load::text::{finite_number, number, numbered_lines, quoted};

/// Stands for an index that is not given.
pub(super) const NONE: u32 = u32::MAX;

/// Indices of a position, texture coordinates and a normal. Positive ones may point at what comes later in the
/// file, so that they are checked only when the file was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Corner {
    pub(super) position: u32,
    pub(super) texture_coordinates: u32,
    pub(super) normal: u32,
}

/// A polygon: where its corners end among all corners, and its line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    pub(super) corners_end: usize,
    pub(super) line: usize,
}

/// Faces in a row with the same object, group and material.
#[derive(Clone, Debug)]
pub(super) struct Run {
    pub(super) name: String,
    /// Index into [`Document::materials`].
    pub(super) material: usize,
    pub(super) faces: Range<usize>,
}

/// What an OBJ file says.
#[derive(Clone, Debug, Default)]
pub(super) struct Document {
    pub(super) positions: Vec<Vec3>,
    pub(super) texture_coordinates: Vec<Vec2>,
    pub(super) normals: Vec<Vec3>,
    pub(super) corners: Vec<Corner>,
    pub(super) faces: Vec<Face>,
    pub(super) runs: Vec<Run>,
    /// The names of the materials that faces have; `None` where no name was given.
    pub(super) materials: Vec<Option<String>>,
    /// What follows `mtllib`: a file name, which may hold spaces, or several.
    pub(super) libraries: Vec<String>,
    left_out: BTreeMap<String, LeftOut>,
}

#[derive(Clone, Copy, Debug)]
struct LeftOut {
    line: usize,
    count: usize,
}

/// A line number, and what is wrong there.
pub(super) type Fault = (usize, String);

/// Reads the statements of a file.
pub(super) fn parse(text: &str) -> Result<Document, Fault> {
    let mut reader = Reader::default();
    let mut lines = numbered_lines(text);
    while let Some((number, line)) = lines.next() {
        let line = joined(line, || lines.next().map(|(_, next)| next));
        reader
            .statement(&line, number)
            .map_err(|reason| (number, reason))?;
    }
    if !reader.any_known {
        let reason = "there is no statement of an OBJ file".to_owned();
        return Err((1, reason));
    }
    Ok(reader.document)
}

/// A line with those that continue it, after a backslash. Comments are not continued: paths of other systems end in `\`.
fn joined<'a>(line: &'a str, mut next: impl FnMut() -> Option<&'a str>) -> Cow<'a, str> {
    let unfinished = |line: &'a str| line.trim_end_matches('\r').strip_suffix('\\');
    let Some(start) = unfinished(line).filter(|start| !start.trim_start().starts_with('#')) else {
        return Cow::Borrowed(line);
    };
    let mut whole = start.to_owned();
    while let Some(line) = next() {
        whole.push(' ');
        let Some(more) = unfinished(line) else {
            whole.push_str(line);
            break;
        };
        whole.push_str(more);
    }
    Cow::Owned(whole)
}

#[derive(Default)]
struct Reader {
    document: Document,
    object: String,
    group: String,
    material: Option<String>,
    material_numbers: HashMap<Option<String>, usize>,
    /// Whether the object, group or material was set since the last face.
    changed: bool,
    any_known: bool,
}

impl Reader {
    fn statement(&mut self, line: &str, number: usize) -> Result<(), String> {
        if line.contains('\0') {
            return Err("there is a zero byte: this is no text file".to_owned());
        }
        let line = line.trim();
        let (keyword, names) = line
            .split_once(char::is_whitespace)
            .map_or((line, ""), |(keyword, rest)| (keyword, rest.trim()));
        if keyword.is_empty() || keyword.starts_with('#') {
            return Ok(());
        }
        let values = || names.split('#').next().unwrap_or("").split_whitespace();
        let document = &mut self.document;
        match keyword {
            "v" => {
                let position = position(values(), document, number)?;
                document.positions.push(position);
            }
            "vt" => {
                let coordinates = texture_coordinates(values())?;
                if !coordinates.is_finite() {
                    document.leave_out("texture coordinates that are not finite", number);
                }
                document.texture_coordinates.push(coordinates);
            }
            "vn" => {
                let normal = normal(values())?;
                if !normal.is_finite() {
                    document.leave_out("normals that are not finite", number);
                }
                // A normal of length zero stands for none.
                let normal = if normal.is_finite() {
                    normal
                } else {
                    Vec3::ZERO
                };
                document.normals.push(normal);
            }
            "f" | "fo" => self.face(values(), number)?,
            "o" => {
                names.clone_into(&mut self.object);
                self.changed = true;
            }
            "g" => {
                names.clone_into(&mut self.group);
                self.changed = true;
            }
            "usemtl" => {
                self.material = (!names.is_empty()).then(|| names.to_owned());
                self.changed = true;
            }
            "mtllib" if !names.is_empty() => document.libraries.push(names.to_owned()),
            "mtllib" => return Err("'mtllib' needs a file name".to_owned()),
            "l" => document.leave_out("lines", number),
            "p" => document.leave_out("points", number),
            "s" if matches!(names, "off" | "0" | "") => {}
            "s" => document.leave_out(SMOOTHING, number),
            unknown => {
                document.leave_out(&format!("{} statements", quoted(unknown)), number);
                return Ok(());
            }
        }
        self.any_known = true;
        Ok(())
    }

    fn face(&mut self, corners: SplitWhitespace<'_>, line: usize) -> Result<(), String> {
        let document = &mut self.document;
        let start = document.corners.len();
        for token in corners {
            let corner = corner(token, document)?;
            document.corners.push(corner);
        }
        let added = &document.corners[start..];
        if added.len() < 3 {
            return Err(format!("a face with {} corners is no surface", added.len()));
        }
        let given = |corner: &Corner| (corner.texture_coordinates != NONE, corner.normal != NONE);
        if added.iter().any(|corner| given(corner) != given(&added[0])) {
            return Err(
                "some corners of the face have texture coordinates or a normal, others not"
                    .to_owned(),
            );
        }
        let index = document.faces.len();
        document.faces.push(Face {
            corners_end: document.corners.len(),
            line,
        });
        if self.changed || document.runs.is_empty() {
            self.changed = false;
            self.start_run(index);
        }
        if let Some(run) = self.document.runs.last_mut() {
            run.faces.end = index + 1;
        }
        Ok(())
    }

    fn start_run(&mut self, face: usize) {
        let name = format!("{} {}", self.object, self.group).trim().to_owned();
        let document = &mut self.document;
        let material = match self.material_numbers.get(&self.material) {
            Some(number) => *number,
            None => {
                document.materials.push(self.material.clone());
                let number = document.materials.len() - 1;
                self.material_numbers.insert(self.material.clone(), number);
                number
            }
        };
        let same = |run: &Run| run.name == name && run.material == material;
        if !document.runs.last().is_some_and(same) {
            document.runs.push(Run {
                name,
                material,
                faces: face..face,
            });
        }
    }
}

const SMOOTHING: &str = "smoothing groups";
const COLORS: &str = "colours of vertices";
const WEIGHTS: &str = "weights of vertices";

impl Document {
    fn leave_out(&mut self, what: &str, line: usize) {
        if let Some(left_out) = self.left_out.get_mut(what) {
            left_out.count += 1;
        } else {
            self.left_out
                .insert(what.to_owned(), LeftOut { line, count: 1 });
        }
    }

    /// What the user should know.
    pub(super) fn notes(&self) -> Vec<String> {
        const LIMIT: usize = 20;
        // Normals do what smoothing groups ask for.
        let matters = |what: &str| what != SMOOTHING || self.normals.is_empty();
        let mut left_out: Vec<_> = self
            .left_out
            .iter()
            .filter(|(what, _)| matters(what))
            .collect();
        left_out.sort_by_key(|(_, left_out)| left_out.line);
        let mut notes: Vec<_> = left_out
            .iter()
            .take(LIMIT)
            .map(|(what, LeftOut { line, count })| {
                format!("{what} are left out ({count}, the first in line {line})")
            })
            .collect();
        if left_out.len() > LIMIT {
            notes.push(format!(
                "{} more kinds of statements are left out",
                left_out.len() - LIMIT
            ));
        }
        if self.faces.is_empty() {
            notes.push("there are no triangles".to_owned());
        }
        notes
    }
}

/// A position, after which a weight (of free-form surfaces) or a colour may stand.
fn position(
    mut values: SplitWhitespace<'_>,
    document: &mut Document,
    line: usize,
) -> Result<Vec3, String> {
    let mut coordinate = || finite_number(values.next().ok_or("a position needs 3 coordinates")?);
    let position = Vec3::new(coordinate()?, coordinate()?, coordinate()?);
    let mut more = [0.0; 4];
    let mut count = 0;
    for token in values {
        *more
            .get_mut(count)
            .ok_or("a position with a colour has at most 7 numbers")? = number(token)?;
        count += 1;
    }
    match count {
        0 => {}
        #[expect(clippy::float_cmp, reason = "a weight of exactly 1 changes nothing")]
        1 if more[0] == 1.0 => {}
        1 => document.leave_out(WEIGHTS, line),
        2 => return Err("a position has 3 coordinates, and then a weight or a colour".to_owned()),
        _ => document.leave_out(COLORS, line),
    }
    Ok(position)
}

/// From the lower left origin of OBJ to the upper left one of [`Texture`](crate::scene::Texture).
fn texture_coordinates(mut values: SplitWhitespace<'_>) -> Result<Vec2, String> {
    let u = number(values.next().ok_or("texture coordinates need a number")?)?;
    let v = values.next().map_or(Ok(0.0), number)?;
    Ok(Vec2::new(u, 1.0 - v))
}

fn normal(mut values: SplitWhitespace<'_>) -> Result<Vec3, String> {
    let mut component = || number(values.next().ok_or("a normal needs 3 numbers")?);
    Ok(Vec3::new(component()?, component()?, component()?))
}

/// A corner such as `1`, `1/2`, `1//3` or `1/2/3`.
fn corner(token: &str, document: &Document) -> Result<Corner, String> {
    let mut fields = token.split('/');
    let mut index = |what: &str, count: usize| match fields.next() {
        None | Some("") => Ok(NONE),
        Some(field) => absolute(field, count).ok_or_else(|| {
            format!(
                "{} in the corner {} is no index of a {what}; there are {count} so far",
                quoted(field),
                quoted(token)
            )
        }),
    };
    let corner = Corner {
        position: index("position", document.positions.len())?,
        texture_coordinates: index("texture coordinate", document.texture_coordinates.len())?,
        normal: index("normal", document.normals.len())?,
    };
    if corner.position == NONE || fields.next().is_some() {
        return Err(format!(
            "{} is not a corner like 1, 1/2, 1//3 or 1/2/3",
            quoted(token)
        ));
    }
    Ok(corner)
}

/// An index from 0. In the file they count from 1, or backwards from the newest, which is -1.
fn absolute(field: &str, count: usize) -> Option<u32> {
    let index: i64 = field.parse().ok()?;
    let absolute = if index < 0 {
        i64::try_from(count).ok()?.checked_add(index)?
    } else {
        index - 1
    };
    u32::try_from(absolute).ok().filter(|index| *index != NONE)
}
