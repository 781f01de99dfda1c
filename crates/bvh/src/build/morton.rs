//! The order of triangles along a space-filling curve.
//!
//! Source: Morton, "A computer oriented geodetic data base", 1966; Lauterbach and others, "Fast BVH construction on
//! GPUs", 2009.

use tahko_geometry::{TriangleMesh, glam::Vec4, glam::Vec4Swizzles};

use super::reference::{Bounds, CentroidScale, Reference};
use super::{TriangleNumber, radix};
use crate::parallel::{collect, reduce_range};

/// The most bits per axis of a place on the curve.
const MAX_AXIS_BITS: u32 = 14;
const _: () = assert!(MAX_AXIS_BITS <= 16, "as many as are spread");

/// The numbers of a mesh's triangles in the order of their centroids along the curve, equal ones in their order in
/// the mesh; and the scale of the centroids.
///
/// Cost: O(n) time, 20 bytes per triangle at most, 4 of which stay.
pub(super) fn order(mesh: &TriangleMesh) -> (Vec<TriangleNumber>, CentroidScale) {
    let bounds = reduce_range(
        0..mesh.len(),
        &|range| {
            range.fold(Bounds::EMPTY, |mut bounds, number| {
                bounds.add(&Reference::new(mesh, number));
                bounds
            })
        },
        &Bounds::union,
    );
    let scale = CentroidScale::new(&bounds.to_aabb());
    // A key holds the place on the curve, and below it the number.
    let number_bits = mesh.len().next_power_of_two().trailing_zeros();
    let axis_bits = ((u64::BITS - number_bits) / 3).min(MAX_AXIS_BITS);
    let grid = Grid::new(&bounds, scale, axis_bits);
    let keys = collect(mesh.len(), |number| {
        grid.place(&Reference::new(mesh, number)) << number_bits | number as u64
    });
    let keys = radix::sort(keys, number_bits, number_bits + 3 * axis_bits);
    let mask = (1 << number_bits) - 1;
    #[expect(
        clippy::cast_possible_truncation,
        reason = "meshes have at most 2^29 triangles"
    )]
    let numbers = collect(keys.len(), |index| {
        TriangleNumber((keys[index] & mask) as u32)
    });
    (numbers, scale)
}

/// Cubes of equal size that cover the centroids.
struct Grid {
    scale: CentroidScale,
    origin: Vec4,
    factor: f32,
    last: f32,
}

impl Grid {
    /// Cubes, not boxes of the shape of the bounds: then clusters of neighbours are compact, too.
    fn new(bounds: &Bounds, scale: CentroidScale, axis_bits: u32) -> Self {
        let [origin, end] = scale.centroids_of(bounds);
        let cells = f32::from(1u16 << axis_bits);
        Self {
            scale,
            origin,
            // Centroids that coincide are all at the origin, whatever the factor.
            factor: (cells / (end - origin).xyz().max_element()).min(f32::MAX),
            last: cells - 1.0,
        }
    }

    #[inline]
    fn place(&self, reference: &Reference) -> u64 {
        let position = (self.scale.centroid(reference) - self.origin) * self.factor;
        let [x, y, z, _] = position.min(Vec4::splat(self.last)).to_array();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "from 0 to the last cell"
        )]
        let [x, y, z] = [x, y, z].map(|position| spread(position as i32 as u32));
        x << 2 | y << 1 | z
    }
}

/// Puts two zeros between any two of the lower 16 bits.
#[inline]
fn spread(bits: u32) -> u64 {
    let mut spread = u64::from(bits) & 0xffff;
    for (shift, mask) in [
        (16, 0x0000_0000_ff00_00ff),
        (8, 0x0000_00f0_0f00_f00f),
        (4, 0x0000_0c30_c30c_30c3),
        (2, 0x0000_2492_4924_9249),
    ] {
        spread = (spread | spread << shift) & mask;
    }
    spread
}
