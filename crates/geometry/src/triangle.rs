//! Triangles.

use glam::{DVec3, Vec3};

use crate::Aabb;

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
    /// front. In f64, where the products of f32 differences keep all their digits in most cases.
    #[must_use]
    pub fn scaled_normal(&self) -> DVec3 {
        let [a, b, c] = self.vertices().map(Vec3::as_dvec3);
        (b - a).cross(c - a)
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
