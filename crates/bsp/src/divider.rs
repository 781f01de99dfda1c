//! The classification of polygons against a splitting plane.

use tahko_geometry::{Plane, Side, glam::DVec3};

/// A splitting plane with the distance below which a vertex counts as lying on it.
///
/// That is the largest [`Plane::rounding_error`] of any point in the bounds, so that it need not be computed
/// for each vertex.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Divider {
    pub(crate) plane: Plane,
    tolerance: f64,
}

impl Divider {
    /// A plane among points with at most the given absolute coordinates.
    pub(crate) fn new(plane: Plane, largest_coordinates: DVec3) -> Self {
        Self {
            plane,
            tolerance: plane.rounding_error(largest_coordinates),
        }
    }

    /// The side of the convex hull of some points.
    #[inline]
    pub(crate) fn side_of(&self, points: &[DVec3]) -> Side {
        let mut in_front = false;
        let mut behind = false;
        for point in points {
            let distance = self.plane.signed_distance(*point);
            in_front |= distance > self.tolerance;
            behind |= distance < -self.tolerance;
        }
        match (in_front, behind) {
            (false, false) => Side::Coplanar,
            (true, false) => Side::Front,
            (false, true) => Side::Back,
            (true, true) => Side::Spanning,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hulls_are_where_their_vertices_are() {
        let plane = Plane::from_point_normal(DVec3::Z, DVec3::Z).expect("a plane");
        let divider = Divider::new(plane, DVec3::splat(2.0));
        let on = DVec3::new(2.0, 2.0, 1.0);
        let nearly_on = on + DVec3::Z * f64::EPSILON;
        let above = DVec3::Z * 2.0;
        assert_eq!(divider.side_of(&[on, above]), Side::Front);
        assert_eq!(divider.side_of(&[DVec3::ZERO, on]), Side::Back);
        assert_eq!(divider.side_of(&[on, nearly_on]), Side::Coplanar);
        assert_eq!(divider.side_of(&[above, on, DVec3::ZERO]), Side::Spanning);
    }
}
