//! Triangles in blocks of eight, as vector kernels test them.

use glam::{Mat4, Vec3, Vec3A, Vec4};

use crate::simd::{LANES, Lanes, Simd};
use crate::{Axis, Triangle, TriangleMesh};

/// Up to eight triangles with their numbers, coordinate by coordinate: 320 bytes, five cache lines.
///
/// Unused lanes have NaN for coordinates, which no kernel takes for a hit.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct TriangleBlock {
    /// By vertex, then by axis.
    vertices: [[Lanes; 3]; 3],
    /// The triangles' numbers, [`UNUSED`] for unused lanes; with [`CONTINUES`] in the first lane.
    numbers: [u32; LANES],
}

/// The number of an unused lane.
const UNUSED: u32 = NUMBER_MASK;
const NUMBER_MASK: u32 = (1 << 30) - 1;
/// Another block of the same list follows.
const CONTINUES: u32 = 1 << 31;
const _: () = assert!(
    TriangleMesh::MAX_TRIANGLES < UNUSED as usize,
    "numbers leave room for the marks"
);
const _: () = assert!(size_of::<TriangleBlock>() == 320, "five cache lines");

impl TriangleBlock {
    /// A block without triangles.
    pub const EMPTY: Self = Self {
        vertices: [[Lanes::splat(f32::NAN); 3]; 3],
        numbers: [UNUSED; LANES],
    };

    /// A block of the first eight triangles of a list, or fewer if there are fewer.
    #[must_use]
    pub fn new(triangles: impl IntoIterator<Item = (u32, Triangle)>) -> Self {
        let mut block = Self::EMPTY;
        for (lane, (number, triangle)) in triangles.into_iter().take(LANES).enumerate() {
            block.set(lane, number, &triangle);
        }
        block
    }

    /// A block of up to eight triangles by their numbers and the places of their vertices in a list: faster than one by one.
    ///
    /// # Panics
    /// If there are more than eight, or a place is beyond the list.
    #[must_use]
    #[inline]
    pub fn of_corners(numbers: &[u32], corners: &[[u32; 3]], vertices: &[Vec3]) -> Self {
        let mut points = [[Vec4::NAN; LANES]; 3];
        for (lane, corners) in corners.iter().enumerate() {
            for (points, place) in points.iter_mut().zip(corners) {
                points[lane] = vertices[*place as usize].extend(0.0);
            }
        }
        let mut block = Self::EMPTY;
        for (axes, points) in block.vertices.iter_mut().zip(&points) {
            for half in 0..2 {
                let [a, b, c, d] = [0, 1, 2, 3].map(|lane| points[4 * half + lane]);
                let by_axis = Mat4::from_cols(a, b, c, d).transpose();
                for (lanes, coordinates) in
                    axes.iter_mut()
                        .zip([by_axis.x_axis, by_axis.y_axis, by_axis.z_axis])
                {
                    coordinates.write_to_slice(&mut lanes.0[4 * half..]);
                }
            }
        }
        block.numbers[..numbers.len()].copy_from_slice(numbers);
        block
    }

    /// Puts a triangle into a lane of a block that is not marked as [continued](Self::continued).
    ///
    /// # Panics
    /// If there is no such lane.
    #[inline]
    pub fn set(&mut self, lane: usize, number: u32, triangle: &Triangle) {
        self.numbers[lane] = number;
        for ([x, y, z], vertex) in self.vertices.iter_mut().zip(triangle.vertices()) {
            x.0[lane] = vertex.x;
            y.0[lane] = vertex.y;
            z.0[lane] = vertex.z;
        }
    }

    /// The same block, marked as one that is followed by another of the same list.
    #[must_use]
    pub const fn continued(mut self) -> Self {
        self.set_continued();
        self
    }

    /// Marks the block as one that is followed by another of the same list.
    pub const fn set_continued(&mut self) {
        self.numbers[0] |= CONTINUES;
    }

    /// Whether another block of the same list follows.
    #[inline]
    #[must_use]
    pub const fn continues(&self) -> bool {
        self.numbers[0] & CONTINUES != 0
    }

    /// The number of a lane's triangle; `None` for an unused lane.
    ///
    /// # Panics
    /// If there is no such lane.
    #[inline]
    #[must_use]
    pub const fn number(&self, lane: usize) -> Option<u32> {
        match self.numbers[lane] & NUMBER_MASK {
            UNUSED => None,
            number => Some(number),
        }
    }

    /// The number of a lane that is used.
    #[inline(always)]
    pub(crate) const fn used_number(&self, lane: usize) -> u32 {
        self.numbers[lane] & NUMBER_MASK
    }

    /// The triangle of a lane; its coordinates are NaN for an unused lane.
    ///
    /// # Panics
    /// If there is no such lane.
    #[inline]
    #[must_use]
    pub const fn triangle(&self, lane: usize) -> Triangle {
        let [a, b, c] = &self.vertices;
        Triangle::new(vertex(a, lane), vertex(b, lane), vertex(c, lane))
    }

    /// The vertices of a lane's triangle.
    #[inline(always)]
    pub(crate) fn vertices(&self, lane: usize) -> [Vec3A; 3] {
        let [a, b, c] = &self.vertices;
        let vertex =
            |axes: &[Lanes; 3]| Vec3A::new(axes[0].0[lane], axes[1].0[lane], axes[2].0[lane]);
        [vertex(a), vertex(b), vertex(c)]
    }

    /// The boxes of the triangles: by axis the smallest coordinates, then the largest. Those of unused lanes mean nothing.
    #[inline(always)]
    pub fn bounds<S: Simd>(&self, simd: S) -> [[S::F32s; 2]; 3] {
        [
            self.bounds_across(simd, Axis::X),
            self.bounds_across(simd, Axis::Y),
            self.bounds_across(simd, Axis::Z),
        ]
    }

    #[inline(always)]
    fn bounds_across<S: Simd>(&self, simd: S, axis: Axis) -> [S::F32s; 2] {
        let a = self.load(simd, 0, axis);
        let b = self.load(simd, 1, axis);
        let c = self.load(simd, 2, axis);
        [simd.min(simd.min(a, b), c), simd.max(simd.max(a, b), c)]
    }

    /// A coordinate of a lane's triangle.
    #[inline(always)]
    pub(crate) fn coordinate(&self, lane: usize, vertex: usize, axis: Axis) -> f32 {
        self.vertices[vertex][axis as usize].0[lane]
    }

    /// The triangles with their numbers.
    pub fn triangles(&self) -> impl Iterator<Item = (u32, Triangle)> + '_ {
        (0..LANES).filter_map(|lane| Some((self.number(lane)?, self.triangle(lane))))
    }

    /// One bit for each lane that is used.
    #[inline]
    #[must_use]
    pub fn used(&self) -> u32 {
        let lanes = (0..LANES).filter(|lane| self.number(*lane).is_some());
        lanes.fold(0, |bits, lane| bits | 1 << lane)
    }

    /// A coordinate of all first, second or third vertices.
    #[inline(always)]
    pub(crate) fn load<S: Simd>(&self, simd: S, vertex: usize, axis: Axis) -> S::F32s {
        simd.load(&self.vertices[vertex][axis as usize])
    }
}

#[inline]
const fn vertex(axes: &[Lanes; 3], lane: usize) -> Vec3 {
    Vec3::new(axes[0].0[lane], axes[1].0[lane], axes[2].0[lane])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::{SimdLevel, WithSimd};

    fn triangle(number: u32) -> Triangle {
        let corner = |index: u32| {
            let first = (9 * number + 3 * index) as f32;
            Vec3::new(first, first + 1.0, first + 2.0)
        };
        Triangle::new(corner(0), corner(1), corner(2))
    }

    /// Triangles whose numbers are those of their lanes plus 100.
    fn block(count: u32) -> TriangleBlock {
        TriangleBlock::new((100..100 + count).map(|number| (number, triangle(number))))
    }

    #[test]
    fn a_block_holds_the_triangles_that_it_is_made_of() {
        for count in 0..=8u32 {
            let block = block(count);
            assert_eq!(block.used(), (1 << count) - 1);
            assert!(!block.continues(), "as made");
            let expected = (100..100 + count).map(|number| (number, triangle(number)));
            assert!(block.triangles().eq(expected), "{count} triangles");
            for lane in 0..LANES {
                let number = (100..100 + count).nth(lane);
                assert_eq!(block.number(lane), number);
                assert_eq!(block.triangle(lane).a.is_nan(), number.is_none(), "{lane}");
                let vertices = block.vertices(lane).map(Vec3::from);
                if number.is_some() {
                    assert_eq!(vertices, block.triangle(lane).vertices());
                }
            }
        }
        assert_eq!(TriangleBlock::EMPTY.used(), 0);
    }

    #[test]
    fn a_block_made_of_corners_is_the_same_as_one_of_triangles() {
        let triangles: Vec<Triangle> = (0..8).map(triangle).collect();
        let vertices: Vec<Vec3> = triangles
            .iter()
            .rev()
            .flat_map(Triangle::vertices)
            .collect();
        let numbers: Vec<u32> = (100..108).collect();
        let corners: Vec<[u32; 3]> = (0..8u32)
            .map(|number| [0, 1, 2].map(|vertex| 3 * (7 - number) + vertex))
            .collect();
        for count in 0..=8usize {
            let block = TriangleBlock::of_corners(&numbers[..count], &corners[..count], &vertices);
            let expected = TriangleBlock::new((100..).zip(triangles[..count].iter().copied()));
            assert!(
                block.triangles().eq(expected.triangles()),
                "{count} triangles"
            );
            assert_eq!(block.used(), (1 << count) - 1);
            assert!(!block.continues(), "as made");
            for lane in count..LANES {
                let [a, b, c] = block.triangle(lane).vertices();
                assert!(
                    a.is_nan_mask().all() && b.is_nan_mask().all() && c.is_nan_mask().all(),
                    "{lane}"
                );
            }
        }
    }

    #[test]
    fn what_does_not_fit_is_left() {
        let block = block(12);
        assert_eq!(block.triangles().count(), LANES);
        assert_eq!(block.number(LANES - 1), Some(107));
    }

    #[test]
    fn the_mark_of_a_continued_block_is_not_a_part_of_a_number() {
        let largest = u32::try_from(TriangleMesh::MAX_TRIANGLES - 1).expect("in range");
        for number in [0, 1, largest] {
            let block = TriangleBlock::new([(number, triangle(0))]).continued();
            assert!(block.continues(), "marked");
            assert_eq!(
                (block.number(0), block.used_number(0)),
                (Some(number), number)
            );
            assert_eq!(block.used(), 1);
        }
        let empty = TriangleBlock::EMPTY.continued();
        assert_eq!((empty.used(), empty.continues()), (0, true));
    }

    struct Load<'a>(&'a TriangleBlock, usize, Axis);

    impl WithSimd for Load<'_> {
        type Output = [f32; LANES];

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) -> [f32; LANES] {
            let Self(block, vertex, axis) = self;
            simd.store(block.load(simd, vertex, axis)).0
        }
    }

    #[test]
    fn coordinates_are_loaded_by_vertex_and_axis() {
        let block = block(8);
        for level in SimdLevel::ALL.into_iter().filter_map(SimdLevel::available) {
            for vertex in 0..3 {
                for axis in Axis::ALL {
                    let loaded = level.dispatch(Load(&block, vertex, axis));
                    let expected = std::array::from_fn(|lane| {
                        block.triangle(lane).vertices()[vertex][axis as usize]
                    });
                    assert_eq!(loaded, expected, "{:?}", level.level());
                }
            }
        }
    }
}
