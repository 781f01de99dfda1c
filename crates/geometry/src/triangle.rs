//! Triangles.

use glam::{DVec3, Vec3, Vec3A};

use crate::{Aabb, predicate};

/// A triangle with f32 vertices: a closed set, front side by winding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    /// First vertex.
    pub a: Vec3,
    /// Second vertex; counter-clockwise from the first, seen from the front.
    pub b: Vec3,
    /// Third vertex.
    pub c: Vec3,
}

impl Triangle {
    /// A triangle from its vertices, as vectors want them.
    #[inline(always)]
    pub(crate) fn from_vertices([a, b, c]: &[Vec3A; 3]) -> Self {
        Self::new((*a).into(), (*b).into(), (*c).into())
    }

    /// A triangle from its vertices.
    #[must_use]
    pub const fn new(a: Vec3, b: Vec3, c: Vec3) -> Self {
        Self { a, b, c }
    }

    /// The vertices in order.
    #[must_use]
    pub const fn vertices(&self) -> [Vec3; 3] {
        [self.a, self.b, self.c]
    }

    /// The normal `(b - a) x (c - a)`, not of unit length: it is twice the area long and points to the
    /// front. Its direction is correct to about `2^-40`, however thin the triangle; it is zero only if the area is.
    #[must_use]
    pub fn scaled_normal(&self) -> DVec3 {
        predicate::normal(self)
    }

    /// Whether the area is zero: the vertices are on a line, exactly. Such a triangle is never hit, so
    /// structures may leave it out.
    #[must_use]
    pub fn is_degenerate(&self) -> bool {
        predicate::are_collinear(self)
    }

    /// The area.
    #[must_use]
    pub fn area(&self) -> f64 {
        0.5 * self.scaled_normal().length()
    }

    /// The smallest box around the triangle.
    #[must_use]
    pub fn aabb(&self) -> Aabb {
        Aabb {
            min: self.a.min(self.b).min(self.c),
            max: self.a.max(self.b).max(self.c),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Plane;

    #[test]
    fn triangles_without_area_are_those_without_a_plane() {
        let on_a_line = Triangle::new(Vec3::ZERO, Vec3::splat(0.1), Vec3::splat(0.3));
        let point = Triangle::new(Vec3::ONE, Vec3::ONE, Vec3::ONE);
        let needle = Triangle::new(Vec3::ZERO, Vec3::X * 1e6, Vec3::new(5e5, 1e-3, 0.0));
        let tiny = Triangle::new(Vec3::ZERO, Vec3::X * 1e-45, Vec3::Y * 1e-45);
        let huge = Triangle::new(
            Vec3::splat(f32::MIN),
            Vec3::X * f32::MAX,
            Vec3::Y * f32::MAX,
        );
        for (triangle, is_degenerate) in [
            (on_a_line, true),
            (point, true),
            (needle, false),
            (tiny, false),
            (huge, false),
        ] {
            assert_eq!(triangle.is_degenerate(), is_degenerate, "{triangle:?}");
            assert_eq!(
                Plane::from_triangle(&triangle).is_none(),
                is_degenerate,
                "{triangle:?}"
            );
        }
    }
}
