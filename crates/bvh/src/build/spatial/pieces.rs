//! The pieces into which the planes between bins cut a triangle.

use std::ops::Range;

use tahko_geometry::glam::Vec4;

use super::bins::Grid;
use crate::build::reference::Bounds;

/// Adds the pieces of the part of a triangle in a box to the bins between whose planes they lie.
///
/// The box of a piece is that of the points where the planes and the ends of the box on this axis cut the edges, and of the vertices between, as far as it is in
/// the box. Masks stand for branches, which nobody could predict.
#[inline(always)]
pub(super) fn add<const AXIS: usize, const N: usize>(
    bins: &mut [Bounds; N],
    corners: &[Vec4; 3],
    bounds: &Bounds,
    grid: &Grid<N>,
    span: Range<usize>,
) {
    let triangle = Edges::<AXIS>::new(corners);
    let (start, end) = (bounds.lower()[AXIS], bounds.upper()[AXIS]);
    let [least, most] = triangle.ends();
    let mut low = start;
    let mut before = if least < start {
        triangle.cut(start)
    } else {
        Bounds::EMPTY
    };
    for bin in span.clone() {
        let is_last = bin + 1 == span.end;
        let high = if is_last {
            end
        } else {
            grid.plane(AXIS, bin + 1)
        };
        let after = if is_last && most <= end {
            Bounds::EMPTY
        } else {
            triangle.cut(high)
        };
        let vertices = triangle.vertices_between(low, high);
        let piece = before.union(after).union(vertices).intersection(*bounds);
        if !piece.is_empty() {
            bins[bin] = bins[bin].union(piece);
        }
        (low, before) = (high, after);
    }
}

/// A triangle that is cut by planes across an axis.
struct Edges<'a, const AXIS: usize> {
    corners: &'a [Vec4; 3],
    /// The coordinates of the corners on the axis, in all lanes.
    positions: [Vec4; 3],
    /// From each corner to the next, for a step of one along the axis; not finite for edges across it.
    slopes: [Vec4; 3],
}

impl<'a, const AXIS: usize> Edges<'a, AXIS> {
    #[inline(always)]
    fn new(corners: &'a [Vec4; 3]) -> Self {
        let [a, b, c] = *corners;
        let edges = [b - a, c - b, a - c];
        // No closures: they would not be compiled for the instructions of the caller.
        Self {
            corners,
            positions: [
                Vec4::splat(a[AXIS]),
                Vec4::splat(b[AXIS]),
                Vec4::splat(c[AXIS]),
            ],
            slopes: [
                edges[0] / edges[0][AXIS],
                edges[1] / edges[1][AXIS],
                edges[2] / edges[2][AXIS],
            ],
        }
    }

    /// The smallest and the largest coordinate on the axis.
    #[inline(always)]
    fn ends(&self) -> [f32; 2] {
        let [a, b, c] = self.positions;
        [a.min(b).min(c).x, a.max(b).max(c).x]
    }

    /// The box of the points where a plane cuts edges.
    #[inline(always)]
    fn cut(&self, plane: f32) -> Bounds {
        let plane = Vec4::splat(plane);
        let [a, b, c] = self.positions;
        let is_before = [a.cmplt(plane), b.cmplt(plane), c.cmplt(plane)];
        let mut cut = Bounds::EMPTY;
        for edge in 0..3 {
            let crosses = is_before[edge] ^ is_before[(edge + 1) % 3];
            let step = plane - self.positions[edge];
            cut.add_point_if(crosses, self.corners[edge] + self.slopes[edge] * step);
        }
        cut
    }

    /// The box of the corners between two planes or in one of them.
    #[inline(always)]
    fn vertices_between(&self, low: f32, high: f32) -> Bounds {
        let (low, high) = (Vec4::splat(low), Vec4::splat(high));
        let mut vertices = Bounds::EMPTY;
        for (corner, position) in self.corners.iter().zip(self.positions) {
            let is_between = position.cmpge(low) & position.cmple(high);
            vertices.add_point_if(is_between, *corner);
        }
        vertices
    }
}
