//! Indexed triangle meshes.

use glam::Vec3;
use thiserror::Error;

use crate::{Aabb, Triangle};

/// An indexed triangle mesh whose vertices are finite and whose indices are in range.
///
/// Triangles are numbered by their place in the index list. Degenerate triangles (zero area, repeated
/// vertices) are kept, so that numbers stay, and are never hit. A mesh without triangles is valid.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleMesh {
    vertices: Vec<Vec3>,
    indices: Vec<[u32; 3]>,
}

/// Why a list of vertices and indices is not a mesh.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MeshError {
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} has a coordinate that is not finite: {position}")]
    NonFiniteVertex {
        /// Index of the vertex.
        vertex: usize,
        /// The vertex as given.
        position: Vec3,
    },
    /// A triangle names a vertex that does not exist.
    #[error(
        "triangle {triangle} refers to vertex {index}, but there are only {vertex_count} vertices"
    )]
    IndexOutOfRange {
        /// Index of the triangle.
        triangle: usize,
        /// The vertex index as given.
        index: u32,
        /// The number of vertices.
        vertex_count: usize,
    },
    /// More triangles than a `u32` can number.
    #[error("{count} triangles are more than the limit of {limit}", limit = TriangleMesh::MAX_TRIANGLES)]
    TooManyTriangles {
        /// The number of triangles given.
        count: usize,
    },
}

/// A triangle that [`TriangleMesh::new_dropping_invalid`] left out.
#[derive(Clone, Debug, PartialEq)]
pub struct DroppedTriangle {
    /// Its index in the list as given.
    pub triangle: usize,
    /// What is wrong with it.
    pub reason: MeshError,
}

impl TriangleMesh {
    /// The largest number of triangles: structures keep the upper bits of a triangle's number for themselves.
    pub const MAX_TRIANGLES: usize = 1 << 29;

    /// A mesh from vertices and triples of vertex indices.
    ///
    /// # Errors
    /// If a vertex is not finite, an index is out of range, or there are too many triangles.
    pub fn new(vertices: Vec<Vec3>, indices: Vec<[u32; 3]>) -> Result<Self, MeshError> {
        check_count(indices.len())?;
        if let Some(vertex) = vertices.iter().position(|vertex| !vertex.is_finite()) {
            return Err(MeshError::NonFiniteVertex {
                vertex,
                position: vertices[vertex],
            });
        }
        for (triangle, corners) in indices.iter().enumerate() {
            check_triangle(triangle, *corners, &vertices)?;
        }
        Ok(Self { vertices, indices })
    }

    /// A mesh from the triangles that are valid, and the list of those that are not.
    ///
    /// The triangles that stay are renumbered without gaps, in their order. Vertices that are not finite
    /// become the origin, where no triangle uses them any more.
    ///
    /// # Errors
    /// If there are too many triangles.
    pub fn new_dropping_invalid(
        mut vertices: Vec<Vec3>,
        mut indices: Vec<[u32; 3]>,
    ) -> Result<(Self, Vec<DroppedTriangle>), MeshError> {
        check_count(indices.len())?;
        let mut dropped = Vec::new();
        let mut triangle = 0;
        indices.retain(|corners| {
            let check = check_triangle(triangle, *corners, &vertices);
            let valid = check.is_ok();
            dropped.extend(
                check
                    .err()
                    .map(|reason| DroppedTriangle { triangle, reason }),
            );
            triangle += 1;
            valid
        });
        for vertex in &mut vertices {
            if !vertex.is_finite() {
                *vertex = Vec3::ZERO;
            }
        }
        Ok((Self { vertices, indices }, dropped))
    }

    /// The vertices.
    #[must_use]
    pub fn vertices(&self) -> &[Vec3] {
        &self.vertices
    }

    /// The vertex indices of each triangle.
    #[must_use]
    pub fn indices(&self) -> &[[u32; 3]] {
        &self.indices
    }

    /// The number of triangles.
    #[must_use]
    pub fn len(&self) -> usize {
        self.indices.len()
    }

    /// Whether there are no triangles.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.indices.is_empty()
    }

    /// The triangle with a number.
    ///
    /// # Panics
    /// If `index` is not below [`len`](Self::len).
    #[must_use]
    pub fn triangle(&self, index: usize) -> Triangle {
        let [a, b, c] = self.indices[index].map(|vertex| self.vertices[vertex as usize]);
        Triangle { a, b, c }
    }

    /// All triangles in order.
    #[must_use]
    pub fn triangles(&self) -> impl ExactSizeIterator<Item = Triangle> + '_ {
        (0..self.len()).map(|index| self.triangle(index))
    }

    /// The smallest box around all triangles (vertices that no triangle uses do not count).
    #[must_use]
    pub fn aabb(&self) -> Aabb {
        self.triangles().fold(Aabb::EMPTY, |bounds, triangle| {
            bounds.union(triangle.aabb())
        })
    }
}

fn check_count(count: usize) -> Result<(), MeshError> {
    if count > TriangleMesh::MAX_TRIANGLES {
        return Err(MeshError::TooManyTriangles { count });
    }
    Ok(())
}

fn check_triangle(triangle: usize, corners: [u32; 3], vertices: &[Vec3]) -> Result<(), MeshError> {
    for index in corners {
        let Some(position) = vertices.get(index as usize) else {
            return Err(MeshError::IndexOutOfRange {
                triangle,
                index,
                vertex_count: vertices.len(),
            });
        };
        if !position.is_finite() {
            return Err(MeshError::NonFiniteVertex {
                vertex: index as usize,
                position: *position,
            });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corners() -> Vec<Vec3> {
        vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z]
    }

    #[test]
    fn an_index_out_of_range_is_named() {
        let error = TriangleMesh::new(corners(), vec![[0, 1, 2], [0, 1, 4]]).unwrap_err();
        assert_eq!(
            error,
            MeshError::IndexOutOfRange {
                triangle: 1,
                index: 4,
                vertex_count: 4
            }
        );
    }

    #[test]
    fn a_vertex_that_is_not_finite_is_named() {
        let mut vertices = corners();
        vertices[3].y = f32::NAN;
        let error = TriangleMesh::new(vertices, vec![[0, 1, 2]]).unwrap_err();
        assert!(
            matches!(error, MeshError::NonFiniteVertex { vertex: 3, .. }),
            "{error}"
        );
    }

    #[test]
    fn dropping_keeps_the_valid_triangles_and_reports_the_others() {
        let mut vertices = corners();
        vertices[3].y = f32::INFINITY;
        let indices = vec![[0, 1, 3], [0, 1, 2], [0, 9, 2]];
        let (mesh, dropped) = TriangleMesh::new_dropping_invalid(vertices, indices).unwrap();
        assert_eq!(mesh.indices(), [[0, 1, 2]]);
        assert_eq!(mesh.aabb(), Aabb::new(Vec3::ZERO, Vec3::new(1.0, 1.0, 0.0)));
        let numbers: Vec<usize> = dropped.iter().map(|drop| drop.triangle).collect();
        assert_eq!(numbers, [0, 2]);
    }

    #[test]
    fn a_mesh_without_triangles_is_valid_and_has_an_empty_box() {
        let mesh = TriangleMesh::new(corners(), Vec::new()).unwrap();
        assert!(mesh.aabb().is_empty(), "unused vertices do not count");
    }
}
