//! Rays.

use glam::{Vec3, Vec4};

/// The points `origin + t * direction` for `t` in the closed interval `[t_min, t_max]`.
///
/// The direction need not have unit length: `t` counts in lengths of the direction as given. A ray
/// that is not [valid](Self::is_valid) hits nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where `t` is 0.
    pub origin: Vec3,
    /// The way in which `t` grows, of any length but zero.
    pub direction: Vec3,
    /// The smallest `t` that counts; may be negative.
    pub t_min: f32,
    /// The largest `t` that counts; may be infinite.
    pub t_max: f32,
}

impl Ray {
    /// The half-line from `origin`: `t` in `[0, infinity]`.
    #[must_use]
    pub const fn new(origin: Vec3, direction: Vec3) -> Self {
        Self::with_interval(origin, direction, 0.0, f32::INFINITY)
    }

    /// A ray with `t` in `[t_min, t_max]`.
    #[must_use]
    pub const fn with_interval(origin: Vec3, direction: Vec3, t_min: f32, t_max: f32) -> Self {
        Self {
            origin,
            direction,
            t_min,
            t_max,
        }
    }

    /// The segment from `start` (t = 0) to `end` (t = 1, up to the rounding of `end - start`).
    #[must_use]
    pub fn segment(start: Vec3, end: Vec3) -> Self {
        Self::with_interval(start, end - start, 0.0, 1.0)
    }

    /// The point at `t`, rounded.
    #[must_use]
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + t * self.direction
    }

    /// Whether the ray can hit anything: finite origin and direction, a direction that is not zero,
    /// and an interval that is neither empty nor contains NaN.
    #[inline]
    #[must_use]
    pub fn is_valid(&self) -> bool {
        let (origin, direction) = (self.origin, self.direction);
        // Two loads of four numbers, which overlap, and no branches between: nearly all rays are valid.
        let first = Vec4::new(origin.x, origin.y, origin.z, direction.x);
        let second = Vec4::new(origin.z, direction.x, direction.y, direction.z);
        (first.is_finite_mask() & second.is_finite_mask()).all()
            & (second.cmpne(Vec4::ZERO).bitmask() & 0b1110 != 0)
            & (self.t_min <= self.t_max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_with_nan_or_an_empty_interval_are_not_valid() {
        let good = Ray::new(Vec3::ZERO, Vec3::X);
        assert!(good.is_valid(), "a plain ray is valid");
        for bad in crate::test_support::invalid_rays(good) {
            assert!(!bad.is_valid(), "{bad:?} must not be valid");
        }
    }

    #[test]
    fn every_component_is_looked_at() {
        let good = Ray::new(Vec3::ONE, Vec3::ONE);
        for axis in 0..3 {
            let mut along = Ray::new(Vec3::ZERO, Vec3::ZERO);
            along.direction[axis] = -1e-45;
            assert!(along.is_valid(), "{along:?}");
            for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
                let [mut origin, mut direction] = [good; 2];
                origin.origin[axis] = bad;
                direction.direction[axis] = bad;
                assert!(!origin.is_valid(), "{origin:?} must not be valid");
                assert!(!direction.is_valid(), "{direction:?} must not be valid");
            }
        }
    }
}
