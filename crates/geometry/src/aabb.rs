//! Axis-aligned boxes.

use glam::Vec3;

use crate::Axis;

/// A closed axis-aligned box, or [`Aabb::EMPTY`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// The smallest coordinates.
    pub min: Vec3,
    /// The largest coordinates.
    pub max: Vec3,
}

impl Aabb {
    /// The box that contains nothing; joined with another box it gives that box.
    pub const EMPTY: Self = Self {
        min: Vec3::INFINITY,
        max: Vec3::NEG_INFINITY,
    };

    /// The box between two corners; `min` must not exceed `max` in any component, or the box is empty.
    #[must_use]
    pub const fn new(min: Vec3, max: Vec3) -> Self {
        Self { min, max }
    }

    /// The smallest box around some points; empty for no points.
    #[must_use]
    pub fn from_points(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::including)
    }

    /// The smallest box around this box and a point.
    #[must_use]
    pub fn including(self, point: Vec3) -> Self {
        Self {
            min: self.min.min(point),
            max: self.max.max(point),
        }
    }

    /// The smallest box around two boxes.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// The common part of two boxes, which may be empty.
    #[must_use]
    pub fn intersection(self, other: Self) -> Self {
        Self {
            min: self.min.max(other.min),
            max: self.max.min(other.max),
        }
    }

    /// Whether the box contains no point.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// Whether the closed box contains a point.
    #[must_use]
    pub fn contains(&self, point: Vec3) -> bool {
        self.min.cmple(point).all() && point.cmple(self.max).all()
    }

    /// Whether the closed box contains another box. Every box contains the empty one.
    #[must_use]
    pub fn contains_box(&self, other: &Self) -> bool {
        other.is_empty() || (self.contains(other.min) && self.contains(other.max))
    }

    /// Edge lengths; zero for the empty box, infinite where a length exceeds the largest f32.
    #[must_use]
    pub fn extent(&self) -> Vec3 {
        if self.is_empty() {
            Vec3::ZERO
        } else {
            self.max - self.min
        }
    }

    /// The middle of the box, computed without overflow. Not finite for the empty box.
    #[must_use]
    pub fn center(&self) -> Vec3 {
        0.5 * self.min + 0.5 * self.max
    }

    /// Half of the surface area, the probability measure of the surface area heuristic; zero for the
    /// empty box. In f64, where the area of the largest box is finite.
    #[must_use]
    pub fn half_area(&self) -> f64 {
        if self.is_empty() {
            return 0.0;
        }
        let extent = self.max.as_dvec3() - self.min.as_dvec3();
        extent.x * extent.y + extent.y * extent.z + extent.z * extent.x
    }

    /// The axis of the longest edge; the first one on a tie.
    #[must_use]
    pub fn longest_axis(&self) -> Axis {
        Axis::dominant(self.extent())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_empty_box_has_no_extent_and_is_neutral_in_unions() {
        let unit = Aabb::new(Vec3::ZERO, Vec3::ONE);
        assert!(Aabb::EMPTY.is_empty(), "EMPTY is empty");
        assert_eq!(Aabb::EMPTY.extent(), Vec3::ZERO);
        assert_eq!(Aabb::EMPTY.half_area(), 0.0);
        assert_eq!(Aabb::EMPTY.union(unit), unit);
        assert!(unit.contains_box(&Aabb::EMPTY), "nothing is inside");
    }

    #[test]
    fn a_flat_box_is_not_empty_and_has_the_area_of_one_face() {
        let flat = Aabb::new(Vec3::ZERO, Vec3::new(2.0, 3.0, 0.0));
        assert!(!flat.is_empty(), "a face is a closed set");
        assert_eq!(flat.half_area(), 6.0);
        assert_eq!(flat.longest_axis(), Axis::Y);
    }

    #[test]
    fn huge_boxes_have_a_finite_area_and_center() {
        let huge = Aabb::new(Vec3::splat(-3.0e38), Vec3::splat(3.0e38));
        assert_eq!(huge.center(), Vec3::ZERO);
        assert!(huge.half_area().is_finite(), "areas are computed in f64");
    }
}
