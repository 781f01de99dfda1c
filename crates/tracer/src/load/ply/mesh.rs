//! The mesh of a PLY file, filled element by element.

use glam::{Vec2, Vec3};

use super::Fault;
use super::header::{Element, Header, Kind, Property};
use super::values::Values;
use crate::load::polygon::FanCutter;
use crate::scene::MeshPart;

/// What a property is read for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Role {
    Skip,
    /// A component of a position, normal or texture coordinate, by its place in [`COLUMNS`].
    Column(usize),
    Polygon,
    Strip,
}

/// The names of the properties of vertices that are read: positions, normals, texture coordinates.
const COLUMNS: [&[&str]; 8] = [
    &["x"],
    &["y"],
    &["z"],
    &["nx"],
    &["ny"],
    &["nz"],
    &["u", "s", "texture_u"],
    &["v", "t", "texture_v"],
];

fn role(element: &Element, property: &Property) -> Role {
    let is_list = matches!(property.kind, Kind::List { .. });
    let name = property.name.as_str();
    match (element.name.as_str(), is_list) {
        ("vertex", false) => COLUMNS
            .iter()
            .position(|names| names.contains(&name))
            .map_or(Role::Skip, Role::Column),
        ("face", true) if matches!(name, "vertex_indices" | "vertex_index") => Role::Polygon,
        ("tristrips", true) if matches!(name, "vertex_indices" | "vertex_index") => Role::Strip,
        _ => Role::Skip,
    }
}

/// A property as it is read.
#[derive(Clone, Copy)]
struct Step {
    role: Role,
    kind: Kind,
}

#[derive(Default)]
pub(super) struct Mesh {
    vertex_count: u32,
    has_normals: bool,
    has_texture_coordinates: bool,
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    texture_coordinates: Vec<Vec2>,
    /// The corners of all polygons, and where each polygon ends among them. They are cut into triangles at
    /// the end, because the vertices may come later in the file.
    corners: Vec<u32>,
    polygon_ends: Vec<usize>,
    triangles: Vec<[u32; 3]>,
    cutter: FanCutter,
    non_finite_attributes: usize,
}

impl Mesh {
    /// An empty mesh, if the header has what a mesh needs.
    pub(super) fn new(header: &Header, wants_texture_coordinates: bool) -> Result<Self, Fault> {
        let fault = |reason: String| Err(("header".to_owned(), reason));
        for name in ["vertex", "face", "tristrips"] {
            let mut found = header
                .elements
                .iter()
                .filter(|element| element.name == name);
            let Some(element) = found.next() else {
                continue;
            };
            if found.next().is_some() {
                return fault(format!("the element '{name}' is there twice"));
            }
            let lists = |property: &&Property| {
                matches!(role(element, property), Role::Polygon | Role::Strip)
            };
            if name != "vertex"
                && element.count > 0
                && element.properties.iter().filter(lists).count() != 1
            {
                return fault(format!(
                    "the element '{name}' needs one list 'vertex_indices'"
                ));
            }
        }
        let Some(vertex) = header
            .elements
            .iter()
            .find(|element| element.name == "vertex")
        else {
            return fault("there is no element 'vertex'".to_owned());
        };
        let mut found = [0; COLUMNS.len()];
        for property in &vertex.properties {
            if let Role::Column(column) = role(vertex, property) {
                found[column] += 1;
            }
        }
        let once = |columns: &[usize]| columns.iter().all(|count| *count == 1);
        let has_normals = found[3..6] != [0; 3];
        if !once(&found[..3]) {
            return fault("the vertices need the properties x, y and z once each".to_owned());
        }
        if has_normals && !once(&found[3..6]) {
            return fault("the vertices need all of nx, ny and nz once each, or none".to_owned());
        }
        Ok(Self {
            vertex_count: vertex.count,
            has_normals,
            has_texture_coordinates: wants_texture_coordinates && once(&found[6..]),
            ..Self::default()
        })
    }

    /// Reads all elements.
    pub(super) fn read(&mut self, header: &Header, values: &mut impl Values) -> Result<(), Fault> {
        for element in &header.elements {
            // An element without properties takes no room in the file.
            if !element.properties.is_empty() {
                self.read_element(element, values)?;
            }
        }
        let ends = std::mem::take(&mut self.polygon_ends);
        self.triangles.reserve(self.corners.len() - 2 * ends.len());
        let mut start = 0;
        for end in ends {
            self.cutter.cut(
                &self.corners[start..end],
                &self.positions,
                &mut self.triangles,
            );
            start = end;
        }
        Ok(())
    }

    fn read_element(&mut self, element: &Element, values: &mut impl Values) -> Result<(), Fault> {
        let wanted = |role| match role {
            Role::Column(6..) if !self.has_texture_coordinates => Role::Skip,
            role => role,
        };
        let plan: Vec<_> = element
            .properties
            .iter()
            .map(|property| Step {
                role: wanted(role(element, property)),
                kind: property.kind,
            })
            .collect();
        self.reserve(element, &plan, values)?;
        for index in 0..element.count {
            self.read_one(&plan, values).map_err(|reason| {
                (
                    format!("{}{} {index}", values.place(), element.name),
                    reason,
                )
            })?;
        }
        Ok(())
    }

    /// Sets memory aside, but only if the file is long enough for what its header announces.
    fn reserve(
        &mut self,
        element: &Element,
        plan: &[Step],
        values: &impl Values,
    ) -> Result<(), Fault> {
        let smallest: usize = plan
            .iter()
            .map(|step| match (step.kind, step.role) {
                (Kind::One(scalar), _) => values.smallest(scalar),
                (Kind::List { count, item }, Role::Polygon) => {
                    values.smallest(count) + 3 * values.smallest(item)
                }
                (Kind::List { count, .. }, _) => values.smallest(count),
            })
            .sum();
        let count = element.count as usize;
        if count
            .checked_mul(smallest)
            .is_none_or(|size| size > values.available())
        {
            let reason = format!(
                "the header announces {count} of at least {smallest} bytes, but no more than {} bytes follow",
                values.available()
            );
            return Err((format!("element '{}'", element.name), reason));
        }
        if element.name == "vertex" {
            self.positions.reserve(count);
            self.normals
                .reserve(if self.has_normals { count } else { 0 });
        } else if element.name == "face" {
            self.polygon_ends.reserve(count);
            self.corners.reserve(3 * count);
        }
        Ok(())
    }

    fn read_one(&mut self, plan: &[Step], values: &mut impl Values) -> Result<(), String> {
        values.start_element()?;
        let mut columns = [0.0; COLUMNS.len()];
        let mut is_vertex = false;
        for step in plan {
            match (step.kind, step.role) {
                (Kind::One(scalar), Role::Column(column)) => {
                    columns[column] = values.real(scalar)?;
                    is_vertex = true;
                }
                (Kind::One(scalar), _) => values.skip(scalar, 1)?,
                (Kind::List { count, item }, role) => {
                    let length = values.integer(count)?;
                    let length = usize::try_from(length)
                        .map_err(|_| format!("a list cannot have the length {length}"))?;
                    match role {
                        Role::Polygon => self.read_polygon(length, || values.integer(item))?,
                        Role::Strip => self.read_strips(length, || values.integer(item))?,
                        Role::Column(_) | Role::Skip => values.skip(item, length)?,
                    }
                }
            }
        }
        if is_vertex {
            self.add_vertex(columns)?;
        }
        values.finish_element()
    }

    fn add_vertex(&mut self, columns: [f32; 8]) -> Result<(), String> {
        let [x, y, z, nx, ny, nz, u, v] = columns;
        let position = Vec3::new(x, y, z);
        if !position.is_finite() {
            return Err(format!("a coordinate is not a finite f32: {position}"));
        }
        self.positions.push(position);
        if self.has_normals {
            let normal = Vec3::new(nx, ny, nz);
            self.non_finite_attributes += usize::from(!normal.is_finite());
            // A normal of length zero stands for none.
            self.normals.push(if normal.is_finite() {
                normal
            } else {
                Vec3::ZERO
            });
        }
        if self.has_texture_coordinates {
            self.texture_coordinates.push(Vec2::new(u, 1.0 - v));
        }
        Ok(())
    }

    fn vertex(&self, index: i64) -> Result<u32, String> {
        u32::try_from(index)
            .ok()
            .filter(|index| *index < self.vertex_count)
            .ok_or_else(|| {
                format!(
                    "vertex {index} is not among the {} vertices",
                    self.vertex_count
                )
            })
    }

    fn read_polygon(
        &mut self,
        length: usize,
        mut index: impl FnMut() -> Result<i64, String>,
    ) -> Result<(), String> {
        if length < 3 {
            return Err(format!("a polygon with {length} corners is no surface"));
        }
        for _ in 0..length {
            let corner = self.vertex(index()?)?;
            self.corners.push(corner);
        }
        self.polygon_ends.push(self.corners.len());
        Ok(())
    }

    /// Strips stand in one list, each but the last followed by -1. Every second triangle of a strip is turned around.
    fn read_strips(
        &mut self,
        length: usize,
        mut index: impl FnMut() -> Result<i64, String>,
    ) -> Result<(), String> {
        let mut strip = Vec::new();
        for _ in 0..length {
            match index()? {
                -1 => strip.clear(),
                corner => strip.push(self.vertex(corner)?),
            }
            if let Some([a, b, c]) = strip.last_chunk() {
                let triangle = if strip.len() % 2 == 1 {
                    [*a, *b, *c]
                } else {
                    [*b, *a, *c]
                };
                self.corners.extend(triangle);
                self.polygon_ends.push(self.corners.len());
            }
        }
        Ok(())
    }

    /// What the user should know.
    pub(super) fn notes(&self, header: &Header) -> Vec<String> {
        let mut notes = Vec::new();
        if self.triangles.is_empty() {
            notes.push(format!(
                "there are no triangles, only {} points, which are left out",
                self.positions.len()
            ));
        }
        let is_color =
            |property: &Property| matches!(property.name.as_str(), "red" | "diffuse_red");
        let colored =
            |element: &&Element| element.count > 0 && element.properties.iter().any(is_color);
        for element in header.elements.iter().filter(colored) {
            notes.push(format!(
                "the colours of the element '{}' are left out",
                element.name
            ));
        }
        if self.non_finite_attributes > 0 {
            notes.push(format!(
                "{} normals are not finite, and left out",
                self.non_finite_attributes
            ));
        }
        notes.extend(self.cutter.note());
        notes
    }

    /// The finished part. Points that make no surface are dropped.
    pub(super) fn into_part(self) -> MeshPart {
        if self.triangles.is_empty() {
            return MeshPart::default();
        }
        MeshPart {
            name: "mesh".to_owned(),
            positions: self.positions,
            indices: self.triangles,
            normals: self.has_normals.then_some(self.normals),
            texture_coordinates: self
                .has_texture_coordinates
                .then_some(self.texture_coordinates),
        }
    }
}
