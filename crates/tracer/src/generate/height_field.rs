//! Surfaces over a square grid.

use glam::Vec3;

use super::mesh_builder::MeshBuilder;

/// The number of triangles of [`height_field`].
pub(super) const fn height_field_triangle_count(cells: u32) -> u64 {
    2 * cells as u64 * cells as u64
}

/// A smooth surface over the square `[-half_width, half_width]` of x and z, facing up.
///
/// `height(i, j)` is asked for `0 <= i, j <= cells`, where i runs along x and j along z.
pub(super) fn height_field(
    cells: u32,
    half_width: f32,
    height: impl Fn(u32, u32) -> f32,
) -> MeshBuilder {
    let mut mesh = MeshBuilder::default();
    let coordinate = |i: u32| half_width * (2.0 * i as f32 / cells as f32 - 1.0);
    for j in 0..=cells {
        for i in 0..=cells {
            mesh.vertex(Vec3::new(coordinate(i), height(i, j), coordinate(j)));
        }
    }
    let index = |i: u32, j: u32| j * (cells + 1) + i;
    for j in 0..cells {
        for i in 0..cells {
            mesh.quad([
                index(i, j),
                index(i, j + 1),
                index(i + 1, j + 1),
                index(i + 1, j),
            ]);
        }
    }
    mesh.smooth()
}
