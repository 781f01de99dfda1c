//! Affine transforms between local, world and camera coordinates.

use glam::{DAffine3, DMat4, DQuat, DVec3, Vec3};

/// An invertible affine map with its inverse, in f64, so that points are rounded to f32 only once.
///
/// Named after where it leads: an object's `local to world`, a camera's `camera to world`. The
/// [`inverse`](Self::inverse) leads back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    forward: DAffine3,
    backward: DAffine3,
}

impl Default for Transform {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl Transform {
    /// The map that changes nothing.
    pub const IDENTITY: Self = Self {
        forward: DAffine3::IDENTITY,
        backward: DAffine3::IDENTITY,
    };

    /// A transform from an affine map; `None` if the map or its inverse is not finite, as for a scale of zero.
    #[must_use]
    pub fn from_affine(forward: DAffine3) -> Option<Self> {
        let backward = forward.inverse();
        (forward.is_finite() && backward.is_finite()).then_some(Self { forward, backward })
    }

    /// A transform from a 4x4 matrix whose last row is `0 0 0 1`; `None` as for [`from_affine`](Self::from_affine).
    #[must_use]
    pub fn from_matrix(matrix: DMat4) -> Option<Self> {
        Self::from_affine(DAffine3::from_mat4(matrix))
    }

    /// A translation.
    #[must_use]
    pub fn translation(by: DVec3) -> Self {
        Self {
            forward: DAffine3::from_translation(by),
            backward: DAffine3::from_translation(-by),
        }
    }

    /// A rotation by `degrees` around an axis through the origin, counter-clockwise when the axis points at
    /// the viewer; `None` if the axis is zero or not finite.
    #[must_use]
    pub fn rotation(axis: DVec3, degrees: f64) -> Option<Self> {
        let axis = axis.try_normalize()?;
        Self::from_affine(DAffine3::from_quat(DQuat::from_axis_angle(
            axis,
            degrees.to_radians(),
        )))
    }

    /// A scaling along the axes; `None` if a factor is zero or not finite.
    #[must_use]
    pub fn scaling(factors: DVec3) -> Option<Self> {
        Self::from_affine(DAffine3::from_scale(factors))
    }

    /// Camera to world for a camera at `eye` that looks at `target`: camera x is to the right, y up, and the
    /// camera looks along -z. `None` if `eye` equals `target` or `up` is parallel to the line of sight.
    #[must_use]
    pub fn look_at(eye: DVec3, target: DVec3, up: DVec3) -> Option<Self> {
        let backward = (eye - target).try_normalize()?;
        let right = up.cross(backward).try_normalize()?;
        let rotation = glam::DMat3::from_cols(right, backward.cross(right), backward);
        Self::from_affine(DAffine3::from_mat3_translation(rotation, eye))
    }

    /// The transform that applies `self` first and then `next`.
    #[must_use]
    pub fn then(&self, next: &Self) -> Self {
        Self {
            forward: next.forward * self.forward,
            backward: self.backward * next.backward,
        }
    }

    /// The transform that leads back.
    #[must_use]
    pub fn inverse(&self) -> Self {
        Self {
            forward: self.backward,
            backward: self.forward,
        }
    }

    /// The image of a point.
    #[must_use]
    pub fn point(&self, point: DVec3) -> DVec3 {
        self.forward.transform_point3(point)
    }

    /// The image of an f32 point, rounded once.
    #[must_use]
    pub fn point_f32(&self, point: Vec3) -> Vec3 {
        self.point(point.as_dvec3()).as_vec3()
    }

    /// The image of a direction, which translations do not change.
    #[must_use]
    pub fn vector(&self, vector: DVec3) -> DVec3 {
        self.forward.transform_vector3(vector)
    }

    /// The direction perpendicular to the image of a surface: the transposed inverse applied to its normal. Not
    /// of unit length.
    #[must_use]
    pub fn normal(&self, normal: DVec3) -> DVec3 {
        self.backward.matrix3.transpose() * normal
    }

    /// Whether the transform is a mirror image, which turns the winding of triangles around.
    #[must_use]
    pub fn flips_winding(&self) -> bool {
        self.forward.matrix3.determinant() < 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn then_applies_the_first_transform_first() {
        let scale = Transform::scaling(DVec3::splat(2.0)).unwrap();
        let both = scale.then(&Transform::translation(DVec3::X));
        assert_eq!(both.point(DVec3::ONE), DVec3::new(3.0, 2.0, 2.0));
        assert_eq!(both.inverse().point(both.point(DVec3::ONE)), DVec3::ONE);
    }

    #[test]
    fn a_camera_looks_along_its_negative_z_axis() {
        let camera = Transform::look_at(DVec3::Z * 5.0, DVec3::ZERO, DVec3::Y).unwrap();
        assert_eq!(camera.vector(DVec3::NEG_Z), DVec3::NEG_Z);
        assert_eq!(camera.vector(DVec3::X), DVec3::X);
        assert_eq!(camera.point(DVec3::ZERO), DVec3::Z * 5.0);
        assert_eq!(Transform::look_at(DVec3::X, DVec3::X, DVec3::Y), None);
        assert_eq!(Transform::look_at(DVec3::Y, DVec3::ZERO, DVec3::Y), None);
    }

    #[test]
    fn normals_stay_perpendicular_under_uneven_scaling() {
        let scale = Transform::scaling(DVec3::new(1.0, 4.0, 0.5)).unwrap();
        let tangent = DVec3::new(1.0, -1.0, 0.0);
        let normal = DVec3::new(1.0, 1.0, 0.0);
        assert_eq!(scale.vector(tangent).dot(scale.normal(normal)), 0.0);
    }

    #[test]
    fn a_scale_of_zero_is_refused_and_a_mirror_flips_winding() {
        assert_eq!(Transform::scaling(DVec3::new(1.0, 0.0, 1.0)), None);
        let mirror = Transform::scaling(DVec3::new(-1.0, 1.0, 1.0)).unwrap();
        assert!(mirror.flips_winding(), "one negative factor mirrors");
    }
}
