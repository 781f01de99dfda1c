//! The order of triangles along a space-filling curve.
//!
//! Source: Morton, "A computer oriented geodetic data base", 1966; Lauterbach and others, "Fast BVH construction on
//! GPUs", 2009.

use tahko_geometry::{TriangleMesh, glam::Vec4, glam::Vec4Swizzles};

use super::binned::ROUNDING;
use super::reference::{Bounds, CentroidScale};
use super::{TriangleNumber, radix};
use crate::parallel::{collect, reduce_range};

/// The most bits per axis of a place on the curve.
const MAX_AXIS_BITS: u32 = 14;
const _: () = assert!(MAX_AXIS_BITS <= 14, "as many as are spread");

/// The numbers of a mesh's triangles in the order of their centroids along the curve, equal ones in their order in
/// the mesh; and the scale of the centroids.
///
/// Cost: O(n) time, 20 bytes per triangle at most, 4 of which stay.
pub(super) fn order(mesh: &TriangleMesh) -> (Vec<TriangleNumber>, CentroidScale) {
    let box_of = |number: usize| Bounds::of_points(mesh.triangle(number).vertices());
    let bounds = reduce_range(
        0..mesh.len(),
        &|range| range.fold(Bounds::EMPTY, |bounds, number| bounds.union(box_of(number))),
        &Bounds::union,
    );
    let scale = CentroidScale::new(&bounds.to_aabb());
    // A key holds the place on the curve, and below it the number.
    let number_bits = mesh.len().next_power_of_two().trailing_zeros();
    let axis_bits = ((u64::BITS - number_bits) / 3).min(MAX_AXIS_BITS);
    let grid = Grid::new(&bounds, scale, axis_bits);
    let keys = collect(mesh.len(), |number| {
        grid.place(&box_of(number)) << number_bits | number as u64
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
    fn place(&self, bounds: &Bounds) -> u64 {
        let position = (self.scale.middle_of(bounds) - self.origin) * self.factor;
        // The last bits of the sum are the nearest whole number.
        let cells = position.min(Vec4::splat(self.last)) + Vec4::splat(ROUNDING);
        let [x, y, z, _] = cells.to_array().map(|cell| spread(cell.to_bits()));
        x << 2 | y << 1 | z
    }
}

/// Puts two zeros between any two of the lower 14 bits.
#[inline]
fn spread(bits: u32) -> u64 {
    let half = |shift: u32| u64::from(SPREAD[(bits >> shift & 127) as usize]);
    half(7) << 21 | half(0)
}

/// Numbers of seven bits with two zeros between any two bits.
const SPREAD: [u32; 128] = {
    let mut table = [0; 128];
    let mut number = 0u32;
    while number < 128 {
        let mut bit = 0;
        while bit < 7 {
            table[number as usize] |= (number >> bit & 1) << (3 * bit);
            bit += 1;
        }
        number += 1;
    }
    table
};

#[cfg(test)]
mod tests {
    use tahko_geometry::glam::Vec3;
    use tahko_geometry::test_support::soup;

    use super::*;

    #[test]
    fn bits_are_spread_with_two_zeros_between() {
        for number in 0..1u32 << MAX_AXIS_BITS {
            let bits = (0..MAX_AXIS_BITS).filter(|bit| number >> bit & 1 == 1);
            let expected: u64 = bits.map(|bit| 1u64 << (3 * bit)).sum();
            assert_eq!(spread(number), expected, "{number}");
        }
    }

    /// On a grid of cubes the order is that of the interleaved bits of the coordinates, wherever the grid lies and however large it is.
    #[test]
    fn triangles_are_ordered_along_the_curve() {
        let cells = |index: u32| [0, 1, 2].map(|axis| index >> (3 * axis) & 7);
        let interleaved = |index: u32| {
            let [x, y, z] = cells(index).map(spread);
            x << 2 | y << 1 | z
        };
        for (size, origin) in [(1.0, 0.0), (1e-30, 0.0), (1e30, -4e30), (1.0, 100.0)] {
            let triangles = (0..512).map(|index| {
                let corner = Vec3::from(cells(index).map(|cell| cell as f32)) * size + origin;
                [
                    corner,
                    corner + Vec3::X * (size / 4.0),
                    corner + Vec3::Y * (size / 4.0),
                ]
            });
            let (numbers, _) = order(&soup(triangles.collect()));
            let mut expected: Vec<u32> = (0..512).collect();
            expected.sort_by_key(|index| interleaved(*index));
            assert!(
                numbers.iter().map(|number| number.number()).eq(expected),
                "{size}"
            );
        }
    }
}
