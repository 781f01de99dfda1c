//! Planes.

use glam::DVec3;

use crate::Triangle;

/// The points `p` with `normal . p + offset = 0`. The front is where this value is positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Unit normal, up to rounding; points to the front.
    pub normal: DVec3,
    /// Minus the signed distance of the plane from the origin.
    pub offset: f64,
}

/// On which side of a plane something lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    /// Where the normal points, or on the plane in part.
    Front,
    /// Opposite to the normal, or on the plane in part.
    Back,
    /// In the plane.
    Coplanar,
    /// On both sides.
    Spanning,
}

/// Unit roundoff of f64.
const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;

impl Plane {
    /// The plane through a point with a normal of any length; `None` if the normal is zero or not finite.
    #[must_use]
    pub fn from_point_normal(point: DVec3, normal: DVec3) -> Option<Self> {
        // Scaled first, so that squares neither overflow nor underflow.
        let largest = normal.abs().max_element();
        let normal = (normal / largest).normalize();
        let plane = Self {
            normal,
            offset: -normal.dot(point),
        };
        (normal.is_finite() && plane.offset.is_finite()).then_some(plane)
    }

    /// The plane through three points, with the normal `(b - a) x (c - a)`: its front is where the points
    /// are seen counter-clockwise. `None` if they lie on a line.
    #[must_use]
    pub fn from_points(a: DVec3, b: DVec3, c: DVec3) -> Option<Self> {
        Self::from_point_normal(a, (b - a).cross(c - a))
    }

    /// The plane of a triangle; `None` if its area is zero.
    #[must_use]
    pub fn from_triangle(triangle: &Triangle) -> Option<Self> {
        Self::from_point_normal(triangle.a.as_dvec3(), triangle.scaled_normal())
    }

    /// The same plane with front and back exchanged.
    #[must_use]
    pub fn flipped(self) -> Self {
        Self {
            normal: -self.normal,
            offset: -self.offset,
        }
    }

    /// The distance of a point from the plane, positive in front; rounded.
    #[must_use]
    pub fn signed_distance(&self, point: DVec3) -> f64 {
        self.normal.dot(point) + self.offset
    }

    /// The distance below which a point counts as lying on the plane.
    ///
    /// Sixteen roundings of f64, relative to the terms that the distance is summed from: three products,
    /// three sums and the normalisation of the plane take eight, and as much again is left for the point, which may
    /// be where another plane cuts an edge and then carries the roundings of its interpolation.
    #[must_use]
    pub fn rounding_error(&self, point: DVec3) -> f64 {
        16.0 * UNIT_ROUNDOFF * (self.normal.abs().dot(point.abs()) + self.offset.abs())
    }

    /// The side of a point: front, back or coplanar, where the latter is all that rounding cannot tell from it.
    #[must_use]
    pub fn side_of(&self, point: DVec3) -> Side {
        let distance = self.signed_distance(point);
        if distance.abs() <= self.rounding_error(point) {
            Side::Coplanar
        } else if distance > 0.0 {
            Side::Front
        } else {
            Side::Back
        }
    }

    /// The side of the convex hull of some points.
    #[must_use]
    pub fn side_of_points(&self, points: impl IntoIterator<Item = DVec3>) -> Side {
        let mut side = Side::Coplanar;
        for point in points {
            side = side.joined_with(self.side_of(point));
        }
        side
    }
}

impl Side {
    /// The side of the convex hull of two things whose sides are known.
    #[must_use]
    pub const fn joined_with(self, other: Self) -> Self {
        match (self, other) {
            (Self::Coplanar, side) | (side, Self::Coplanar) => side,
            (Self::Front, Self::Front) => Self::Front,
            (Self::Back, Self::Back) => Self::Back,
            _ => Self::Spanning,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn z_plane(height: f64) -> Plane {
        Plane::from_point_normal(DVec3::new(3.0, -2.0, height), DVec3::Z * 1e-200).unwrap()
    }

    #[test]
    fn the_front_of_three_points_is_where_they_run_counter_clockwise() {
        let plane = Plane::from_points(DVec3::ZERO, DVec3::X, DVec3::Y).unwrap();
        assert_eq!(plane.side_of(DVec3::Z), Side::Front);
        assert_eq!(plane.flipped().side_of(DVec3::Z), Side::Back);
        assert_eq!(plane.signed_distance(DVec3::new(5.0, 6.0, 7.0)), 7.0);
    }

    #[test]
    fn points_on_a_line_have_no_plane() {
        let points = [DVec3::ZERO, DVec3::ONE, DVec3::splat(2.0)];
        assert_eq!(Plane::from_points(points[0], points[1], points[2]), None);
    }

    #[test]
    fn hulls_touching_the_plane_belong_to_their_side() {
        let plane = z_plane(1.0);
        let on = DVec3::new(7.0, 7.0, 1.0);
        let above = DVec3::new(0.0, 0.0, 1.5);
        let below = DVec3::ZERO;
        assert_eq!(plane.side_of_points([on, above]), Side::Front);
        assert_eq!(plane.side_of_points([below, on]), Side::Back);
        assert_eq!(plane.side_of_points([on, on]), Side::Coplanar);
        assert_eq!(plane.side_of_points([above, below]), Side::Spanning);
    }
}
