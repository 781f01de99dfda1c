//! Meshes: triangles from all primitive modes that make some.

use std::collections::HashMap;
use std::path::Path;

use glam::{Vec2, Vec3};
use gltf::json::Value;
use tahko_geometry::{MeshError, TriangleMesh};

use super::Document;
use super::accessor::Accessor;
use super::fault::{Fault, element_name, integer, items, reference};
use super::materials::{Look, Materials};
use super::nodes::PlacedNode;
use crate::load::{Import, LoadError, LoadReport};
use crate::scene::{MeshPart, SceneError};

const TRIANGLES: u64 = 4;
const TRIANGLE_STRIP: u64 = 5;
const TRIANGLE_FAN: u64 = 6;

/// A primitive that was read, in the coordinates of its mesh.
#[derive(Clone, Debug)]
struct Primitive {
    part: MeshPart,
    look: Look,
}

/// Adds the meshes of the nodes to the scene, in the order of the nodes.
///
/// # Errors
/// If a mesh that is shown has no positions, the scene has too many triangles, or an image is broken.
pub(super) fn read(
    document: &Document<'_>,
    nodes: &[PlacedNode<'_>],
    path: &Path,
    import: &mut Import,
) -> Result<(), Fault> {
    let uses = |placed: &PlacedNode<'_>| placed.node.mesh.map(|mesh| mesh.value());
    // How many nodes still need a mesh: the last one takes it without a copy.
    let mut needed: HashMap<usize, usize> = HashMap::new();
    for mesh in nodes.iter().filter_map(uses) {
        *needed.entry(mesh).or_default() += 1;
    }
    check_size(document, &needed)?;

    let mut materials = Materials::default();
    let mut read: HashMap<usize, Vec<Primitive>> = HashMap::new();
    for placed in nodes {
        let Some(mesh) = uses(placed) else {
            continue;
        };
        let primitives = match read.remove(&mesh) {
            Some(primitives) => primitives,
            None => read_mesh(document, mesh, &mut materials, import)?,
        };
        let left = needed.entry(mesh).or_default();
        *left = left.saturating_sub(1);
        if *left > 0 {
            read.insert(mesh, primitives.clone());
        }
        for Primitive { part, look } in primitives {
            let added = import.add_part(path, part, look.id, &placed.to_file);
            added.map_err(|error| scene_fault(error, placed.index))?;
        }
    }
    if import.material.is_none() {
        materials.check_other_images(document)?;
    }
    Ok(())
}

fn scene_fault(error: LoadError, node: usize) -> Fault {
    match error {
        LoadError::Scene { source, .. } => Fault::Scene(source),
        other => Fault::invalid(format!("node {node}"), other),
    }
}

/// Refuses scenes that are too large before they are put together: a small file can show a mesh any number of times.
fn check_size(document: &Document<'_>, needed: &HashMap<usize, usize>) -> Result<(), Fault> {
    let meshes = items(document.json, "meshes");
    let mut triangles = 0usize;
    for (mesh, uses) in needed {
        let primitives = meshes
            .get(*mesh)
            .map_or(&[][..], |m| items(m, "primitives"));
        let corners = primitives.iter().map(|primitive| {
            let attributes = primitive.get("attributes").unwrap_or(primitive);
            let list = reference(primitive, "indices").or(reference(attributes, "POSITION"));
            let list = list.and_then(|index| document.accessors.get(index));
            let count = list.map_or(0, |list| list.count);
            match integer(primitive, "mode").unwrap_or(TRIANGLES) {
                TRIANGLES => count / 3,
                TRIANGLE_STRIP | TRIANGLE_FAN => count.saturating_sub(2),
                _ => 0,
            }
        });
        let in_mesh = corners.fold(0, usize::saturating_add);
        triangles = triangles.saturating_add(in_mesh.saturating_mul(*uses));
    }
    if triangles > TriangleMesh::MAX_TRIANGLES {
        return Err(Fault::Scene(SceneError::Mesh {
            part: "whole scene".to_owned(),
            source: MeshError::TooManyTriangles { count: triangles },
        }));
    }
    Ok(())
}

fn read_mesh(
    document: &Document<'_>,
    index: usize,
    materials: &mut Materials,
    import: &mut Import,
) -> Result<Vec<Primitive>, Fault> {
    let Some(mesh) = items(document.json, "meshes").get(index) else {
        return Ok(Vec::new());
    };
    let mut read = Vec::new();
    for (number, json) in items(mesh, "primitives").iter().enumerate() {
        let name = format!("{}, primitive {number}", element_name("mesh", index, mesh));
        let source = PrimitiveSource {
            document,
            json,
            name,
        };
        let Some(triangles) = source.triangles(&mut import.report)? else {
            continue;
        };
        source.note_skipped(&mut import.report);
        let look = materials.look(document, reference(json, "material"), import)?;
        let part = source.part(triangles, &look)?;
        read.push(Primitive { part, look });
    }
    Ok(read)
}

/// A primitive to be read.
struct PrimitiveSource<'a> {
    document: &'a Document<'a>,
    json: &'a Value,
    name: String,
}

impl PrimitiveSource<'_> {
    fn attribute(&self, name: &str) -> Option<&Accessor<'_>> {
        let index = reference(self.json.get("attributes")?, name)?;
        self.document.accessors.get(index)
    }

    fn positions(&self) -> Result<&Accessor<'_>, Fault> {
        self.attribute("POSITION")
            .ok_or_else(|| Fault::invalid(&self.name, "it has no attribute POSITION"))
    }

    /// The vertex numbers of the triangles; `None` for points and lines, which are noted.
    fn triangles(&self, report: &mut LoadReport) -> Result<Option<Vec<[u32; 3]>>, Fault> {
        let positions = self.positions()?;
        let mode = integer(self.json, "mode").unwrap_or(TRIANGLES);
        let kind = match mode {
            0 => "points",
            1..=3 => "lines",
            _ => "",
        };
        if !kind.is_empty() {
            report.note(format!("{} is skipped: it consists of {kind}", self.name));
            return Ok(None);
        }
        let indices = reference(self.json, "indices");
        let corners: Vec<u32> = match indices.and_then(|at| self.document.accessors.get(at)) {
            Some(indices) => (0..indices.count).map(|at| indices.index(at)).collect(),
            None => {
                let count = u32::try_from(positions.count)
                    .map_err(|_| Fault::Scene(SceneError::TooManyVertices))?;
                (0..count).collect()
            }
        };
        if mode == TRIANGLES && !corners.len().is_multiple_of(3) {
            report.note(format!(
                "the last {} of {} vertices of {} are skipped: they do not make a triangle",
                corners.len() % 3,
                corners.len(),
                self.name
            ));
        }
        Ok(Some(assemble(mode, &corners)))
    }

    fn note_skipped(&self, report: &mut LoadReport) {
        let name = &self.name;
        if self.attribute("COLOR_0").is_some() {
            report.note(format!(
                "vertex colours of {name} are skipped: they are not supported"
            ));
        }
        if !items(self.json, "targets").is_empty() {
            report.note(format!(
                "morph targets of {name} are skipped: it is in its rest pose"
            ));
        }
    }

    /// Reads the attributes that the material needs, of the vertices that the triangles use.
    fn part(&self, triangles: Vec<[u32; 3]>, look: &Look) -> Result<MeshPart, Fault> {
        let positions = self.positions()?;
        let (vertices, indices) = used_vertices(triangles, positions.count);
        let normals = self.attribute("NORMAL").filter(|_| look.shaded);
        let coordinates = look.coordinates.as_ref();
        let coordinates = coordinates.and_then(|coordinates| {
            let set = self.attribute(&format!("TEXCOORD_{}", coordinates.set))?;
            Some((coordinates, set))
        });
        let vector = |accessor: &Accessor<'_>| {
            let vector = |vertex: &usize| Vec3::from(accessor.vector(*vertex));
            vertices.iter().map(vector).collect::<Vec<Vec3>>()
        };
        Ok(MeshPart {
            name: self.name.clone(),
            positions: vector(positions),
            indices,
            normals: normals.map(vector),
            texture_coordinates: coordinates.map(|(coordinates, set)| {
                let moved = |vertex: &usize| coordinates.apply(Vec2::from(set.vector(*vertex)));
                vertices.iter().map(moved).collect()
            }),
        })
    }
}

/// Triangles from a list of vertices. Each winds as the first one does; what does not fill a triangle is left out.
fn assemble(mode: u64, corners: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        TRIANGLE_STRIP => corners
            .windows(3)
            .enumerate()
            .filter_map(|(index, corners)| {
                let [a, b, c] = *corners.first_chunk()?;
                Some(if index % 2 == 0 { [a, b, c] } else { [a, c, b] })
            })
            .collect(),
        TRIANGLE_FAN => {
            let Some((center, rim)) = corners.split_first() else {
                return Vec::new();
            };
            let edges = rim.windows(2).filter_map(|edge| edge.first_chunk());
            edges.map(|&[a, b]| [a, b, *center]).collect()
        }
        _ => {
            let triples = corners.chunks_exact(3);
            triples
                .filter_map(|triple| triple.first_chunk().copied())
                .collect()
        }
    }
}

/// The vertices that triangles use, and the triangles with numbers in that list. All vertices are kept in their order
/// unless most of them are not used, as when many primitives share one array.
fn used_vertices(mut triangles: Vec<[u32; 3]>, vertex_count: usize) -> (Vec<usize>, Vec<[u32; 3]>) {
    if triangles.len().saturating_mul(3) >= vertex_count {
        return ((0..vertex_count).collect(), triangles);
    }
    let mut used: Vec<u32> = triangles.as_flattened().to_vec();
    used.sort_unstable();
    used.dedup();
    for corner in triangles.as_flattened_mut() {
        // Every corner is in the list, and the list is shorter than a u32 can count.
        let place = used.partition_point(|vertex| vertex < corner);
        *corner = u32::try_from(place).unwrap_or(u32::MAX);
    }
    let vertices = used.into_iter().map(|vertex| vertex as usize).collect();
    (vertices, triangles)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_wind_as_their_first_triangle() {
        let corners = [5, 6, 7, 8, 9];
        assert_eq!(
            assemble(TRIANGLE_STRIP, &corners),
            [[5, 6, 7], [6, 8, 7], [7, 8, 9]]
        );
        assert_eq!(
            assemble(TRIANGLE_FAN, &corners),
            [[6, 7, 5], [7, 8, 5], [8, 9, 5]]
        );
        assert_eq!(assemble(TRIANGLES, &corners), [[5, 6, 7]]);
        for mode in [TRIANGLES, TRIANGLE_STRIP, TRIANGLE_FAN] {
            assert!(assemble(mode, &[1, 2]).is_empty(), "mode {mode}");
            assert!(assemble(mode, &[]).is_empty(), "mode {mode}");
        }
    }

    #[test]
    fn a_few_triangles_take_only_their_vertices() {
        let (vertices, triangles) = used_vertices(vec![[90, 7, 8]], 100);
        assert_eq!((vertices, triangles), (vec![7, 8, 90], vec![[2, 0, 1]]));
        let (vertices, triangles) = used_vertices(vec![[2, 1, 0]], 3);
        assert_eq!((vertices, triangles), (vec![0, 1, 2], vec![[2, 1, 0]]));
    }
}
