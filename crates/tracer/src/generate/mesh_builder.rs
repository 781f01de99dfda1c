//! Gathers vertices and triangles into a part.

use glam::Vec3;

use super::GeneratedPart;

/// A part in the making. Its vertices either all have normals or none has.
#[derive(Debug, Default)]
pub(super) struct MeshBuilder {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    indices: Vec<[u32; 3]>,
}

impl MeshBuilder {
    /// Adds a vertex of a faceted surface.
    pub(super) fn vertex(&mut self, position: Vec3) -> u32 {
        let index = u32::try_from(self.positions.len())
            .expect("the sizes of all generators keep vertex counts far below 2^32");
        self.positions.push(position);
        index
    }

    /// Adds a vertex with a unit shading normal.
    pub(super) fn smooth_vertex(&mut self, position: Vec3, normal: Vec3) -> u32 {
        self.normals.push(normal);
        self.vertex(position)
    }

    /// Adds a triangle, counter-clockwise as seen from outside.
    pub(super) fn triangle(&mut self, corners: [u32; 3]) {
        self.indices.push(corners);
    }

    /// Adds two triangles, cut from the first corner to the third.
    pub(super) fn quad(&mut self, [a, b, c, d]: [u32; 4]) {
        self.triangle([a, b, c]);
        self.triangle([a, c, d]);
    }

    /// Gives every vertex the mean of the normals of its triangles, weighted by their angles there.
    ///
    /// Source: G. Thürmer, C. Wüthrich, "Computing Vertex Normals from Polygonal Facets", 1998.
    pub(super) fn smooth(mut self) -> Self {
        let mut sums = vec![Vec3::ZERO; self.positions.len()];
        for corners in &self.indices {
            let points = corners.map(|index| self.positions[index as usize]);
            let normal = (points[1] - points[0]).cross(points[2] - points[0]);
            let normal = normal.normalize_or_zero();
            for corner in 0..3 {
                let to_next = points[(corner + 1) % 3] - points[corner];
                let to_previous = points[(corner + 2) % 3] - points[corner];
                sums[corners[corner] as usize] += normal * to_next.angle_between(to_previous);
            }
        }
        self.normals = sums
            .into_iter()
            .map(|sum| sum.try_normalize().unwrap_or(Vec3::Y))
            .collect();
        self
    }

    /// The part, matt and opaque.
    pub(super) fn into_part(self, name: &'static str, color: [f32; 3]) -> GeneratedPart {
        debug_assert!(
            self.normals.is_empty() || self.normals.len() == self.positions.len(),
            "all vertices have normals or none has"
        );
        GeneratedPart {
            name,
            positions: self.positions,
            indices: self.indices,
            normals: (!self.normals.is_empty()).then_some(self.normals),
            color: Vec3::from(color),
            mirror: 0.0,
            refractive_index: None,
        }
    }
}
