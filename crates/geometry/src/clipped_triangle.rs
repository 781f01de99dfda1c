//! The part of a triangle in a box.

use glam::DVec3;

use crate::Triangle;

/// The part of a triangle in closed boxes, in f64: a convex polygon, or nothing (Sutherland and Hodgman).
///
/// Only boxes cut it, and no memory is allocated; a [`Polygon`](crate::Polygon) is cut by any plane and keeps both parts.
///
/// **Error of a cut point.** For one coordinate let `M` be the largest magnitude among the vertices, and `u = 2^-53`. The
/// distances of two vertices from a plane have a relative error of `u` each and opposite signs, so the weight `d1 / (d1 - d2)` has
/// a relative error of `4u`, and the point `a + weight (b - a)` an error below `14 u M`, whatever the angle between edge and
/// plane. The six planes of a box make at most `84 u M`, as much again each further box. In the direction of a plane's normal the point
/// lies in the plane exactly.
///
/// **Number of vertices.** Around a triangle each coordinate rises once and falls once. A cut point lies between the ends of
/// its edge in every coordinate (it is held there against rounding), and a cut replaces neighbouring vertices by at most two cut
/// points, so this stays true: a plane cuts off vertices that are neighbours. Hence a cut makes one new edge, in the plane, and only shortens
/// or removes others. A second cut from the same side along the same axis, further in, removes the edge that the first one made: its ends
/// have exactly the coordinate of the first plane. So there are never more edges than the triangle's and one for each of six sides: nine, for any
/// number of boxes.
///
/// ```
/// use tahko_geometry::{ClippedTriangle, Triangle, glam::{DVec3, Vec3}};
///
/// let triangle = Triangle::new(Vec3::ZERO, Vec3::X * 1.5, Vec3::Y * 1.5);
/// let part = ClippedTriangle::new(&triangle).in_box(DVec3::ZERO, DVec3::ONE);
/// assert_eq!((part.vertices().len(), part.area()), (5, 0.875));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct ClippedTriangle {
    vertices: [ClippedVertex; MAX_VERTICES],
    count: usize,
}

/// A vertex of a [`ClippedTriangle`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClippedVertex {
    /// Where it is.
    pub position: DVec3,
    /// Whether it is a point where an edge was cut, and not one of the triangle's vertices.
    pub is_cut: bool,
}

const MAX_VERTICES: usize = 9;

impl ClippedTriangle {
    /// A whole triangle.
    #[must_use]
    #[inline]
    pub fn new(triangle: &Triangle) -> Self {
        let mut whole = Self::NOTHING;
        for corner in triangle.vertices() {
            whole.push(ClippedVertex {
                position: corner.as_dvec3(),
                is_cut: false,
            });
        }
        whole
    }

    const NOTHING: Self = Self {
        vertices: [ClippedVertex {
            position: DVec3::ZERO,
            is_cut: false,
        }; MAX_VERTICES],
        count: 0,
    };

    /// The part in the box between two corners. Planes that the polygon does not cross cost a comparison.
    #[must_use]
    #[inline]
    pub fn in_box(&self, min: DVec3, max: DVec3) -> Self {
        let mut part = *self;
        let (least, most) = self.bounds();
        for axis in 0..3 {
            if least[axis] < min[axis] {
                part.cut(axis, min[axis], 1.0);
            }
            if most[axis] > max[axis] {
                part.cut(axis, max[axis], -1.0);
            }
        }
        part
    }

    /// The smallest and the largest coordinates; infinite, the smallest above the largest, if there is nothing.
    #[must_use]
    #[inline]
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let positions = || self.vertices().iter().map(|vertex| vertex.position);
        (
            positions().fold(DVec3::INFINITY, DVec3::min),
            positions().fold(DVec3::NEG_INFINITY, DVec3::max),
        )
    }

    /// The vertices, in the order of the triangle's; none if no part of it is in all boxes.
    #[must_use]
    #[inline]
    pub fn vertices(&self) -> &[ClippedVertex] {
        &self.vertices[..self.count]
    }

    /// The area, with the error that the cut points cause and a few roundings.
    #[must_use]
    #[inline]
    pub fn area(&self) -> f64 {
        let Some((first, others)) = self.vertices().split_first() else {
            return 0.0;
        };
        let mut sum = DVec3::ZERO;
        for edge in others.windows(2) {
            let [from, to] = [edge[0].position, edge[1].position];
            sum += (from - first.position).cross(to - first.position);
        }
        0.5 * sum.length()
    }

    /// Keeps what is on one side of a plane: coordinates from it up for a `side` of 1, down for -1.
    #[inline]
    fn cut(&mut self, axis: usize, plane: f64, side: f64) {
        let distance = |vertex: &ClippedVertex| (vertex.position[axis] - plane) * side;
        let mut kept = Self::NOTHING;
        let mut previous = self.vertices[self.count.saturating_sub(1)];
        let mut previous_distance = distance(&previous);
        for vertex in self.vertices() {
            let current_distance = distance(vertex);
            let crosses = |from: f64, to: f64| from < 0.0 && to > 0.0;
            if crosses(previous_distance, current_distance)
                || crosses(current_distance, previous_distance)
            {
                let weight = previous_distance / (previous_distance - current_distance);
                kept.push(cut_point(
                    previous.position,
                    vertex.position,
                    weight,
                    axis,
                    plane,
                ));
            }
            if current_distance >= 0.0 {
                kept.push(*vertex);
            }
            previous = *vertex;
            previous_distance = current_distance;
        }
        *self = kept;
    }

    #[inline]
    fn push(&mut self, vertex: ClippedVertex) {
        self.vertices[self.count] = vertex;
        self.count += 1;
    }
}

/// The point of an edge in a plane, between the ends of the edge in every coordinate.
#[inline]
fn cut_point(from: DVec3, to: DVec3, weight: f64, axis: usize, plane: f64) -> ClippedVertex {
    let point = from + weight * (to - from);
    let mut position = point.max(from.min(to)).min(from.max(to));
    position[axis] = plane;
    ClippedVertex {
        position,
        is_cut: true,
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    fn clip(triangle: &Triangle, min: Vec3, max: Vec3) -> ClippedTriangle {
        ClippedTriangle::new(triangle).in_box(min.as_dvec3(), max.as_dvec3())
    }

    #[test]
    fn a_triangle_in_the_box_is_kept_as_it_is() {
        let triangle = Triangle::new(Vec3::ZERO, Vec3::X, Vec3::Y);
        let part = clip(&triangle, Vec3::ZERO, Vec3::ONE);
        assert_eq!((part.vertices().len(), part.area()), (3, 0.5));
        assert!(
            part.vertices().iter().all(|vertex| !vertex.is_cut),
            "no cut"
        );
    }

    #[test]
    fn a_triangle_in_a_face_has_the_area_of_its_part_in_the_face() {
        let triangle = Triangle::new(Vec3::Z, Vec3::new(4.0, 0.0, 1.0), Vec3::new(0.0, 4.0, 1.0));
        assert_eq!(clip(&triangle, Vec3::ZERO, Vec3::ONE).area(), 1.0);
    }

    #[test]
    fn a_triangle_that_passes_a_corner_of_the_box_leaves_nothing() {
        let triangle = Triangle::new(Vec3::X * 3.0, Vec3::Y * 3.0, Vec3::new(3.0, 3.0, 0.0));
        let part = clip(&triangle, Vec3::NEG_ONE, Vec3::ONE);
        assert_eq!((part.vertices().len(), part.area()), (0, 0.0));
    }

    #[test]
    fn all_six_planes_make_nine_vertices() {
        // The plane x + y + z = 0 meets the cube in a hexagon. The edges of the triangle pass beyond all of its corners, or cut off
        // every second one.
        let clipped = |size: f32| {
            let corner = |x: f32, y: f32, z: f32| size * Vec3::new(x, y, z);
            let triangle = Triangle::new(
                corner(1.0, 0.0, -1.0),
                corner(-1.0, 1.0, 0.0),
                corner(0.0, -1.0, 1.0),
            );
            clip(&triangle, Vec3::NEG_ONE, Vec3::ONE)
        };
        let hexagon = clipped(8.0);
        let area = 3.0 * 3f64.sqrt();
        assert_eq!(hexagon.vertices().len(), 6);
        assert!((hexagon.area() - area).abs() < 1e-12, "{}", hexagon.area());
        assert_eq!(clipped(1.75).vertices().len(), 9);
        let corner = 3f64.sqrt() / 32.0;
        assert!(
            (clipped(1.75).area() - (area - 3.0 * corner)).abs() < 1e-12,
            "{}",
            area - clipped(1.75).area()
        );
    }

    #[test]
    fn many_boxes_make_no_more_vertices_than_the_last() {
        // Each box is a little smaller than the one before on one of six sides, until little is left.
        let corners = [
            Vec3::new(3.0, 0.1, -3.2),
            Vec3::new(-3.1, 3.0, 0.3),
            Vec3::new(0.2, -3.3, 3.1),
        ];
        let triangle = Triangle::new(corners[0], corners[1], corners[2]);
        let [mut min, mut max] = [DVec3::splat(-2.0), DVec3::splat(2.0)];
        let mut part = ClippedTriangle::new(&triangle);
        for step in 0..600 {
            let axis = step % 3;
            if step % 2 == 0 {
                min[axis] += 0.0171;
            } else {
                max[axis] -= 0.0173;
            }
            part = part.in_box(min, max);
            let at_once = ClippedTriangle::new(&triangle).in_box(min, max);
            assert_eq!(
                part.vertices().len(),
                at_once.vertices().len(),
                "step {step}"
            );
            assert!((part.area() - at_once.area()).abs() < 1e-12, "step {step}");
        }
        assert!(part.area() < 0.5, "{part:?}");
    }

    #[test]
    fn coordinates_of_any_size_are_cut() {
        let size = f32::MAX;
        let triangle = Triangle::new(Vec3::MIN, Vec3::MAX, Vec3::new(size, -size, 0.0));
        let part = clip(&triangle, Vec3::NEG_ONE, Vec3::ONE);
        assert!(part.area() > 1.0 && part.area() < 6.0, "{}", part.area());
        let tiny = f32::from_bits(8);
        let triangle = Triangle::new(Vec3::ZERO, Vec3::X * tiny, Vec3::Y * tiny);
        let half = clip(&triangle, Vec3::ZERO, Vec3::splat(0.5 * tiny));
        assert_eq!(half.area(), 0.25 * f64::from(tiny) * f64::from(tiny));
    }
}
