//! Cameras: from places on the film to rays in the world.

use glam::DVec3;
use tahko_geometry::{Aabb, Ray, Transform};
use thiserror::Error;

/// A camera at the origin of its own coordinates, looking along -z, with x to the right and y up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    camera_to_world: Transform,
    projection: Projection,
}

/// How the world is projected onto the film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// All rays start at the camera.
    Perspective(FieldOfView),
    /// All rays are parallel.
    Orthographic {
        /// Height of the part of the world that is seen.
        height: f64,
    },
}

/// The angle that is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldOfView {
    /// The angle in degrees, between 0 and 180.
    pub degrees: f64,
    /// Whether the angle spans the shorter side of the film instead of its height.
    pub spans_shorter_side: bool,
}

/// Why a camera cannot be made.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum CameraError {
    /// The angle is not between 0 and 180 degrees.
    #[error("a field of view of {degrees} degrees is not between 0 and 180")]
    FieldOfView {
        /// The angle given.
        degrees: f64,
    },
    /// The height of an orthographic view is not a positive number.
    #[error("a view of height {height} cannot be shown; it must be a positive number")]
    Height {
        /// The height given.
        height: f64,
    },
    /// The place, the target and the up direction do not define a view.
    #[error(
        "eye, target and up do not define a view: eye and target must differ, and up must not point along the line of sight"
    )]
    NoView,
    /// The scene is too large for a camera that sees all of it.
    #[error(
        "the scene reaches to {largest:e}; no f32 camera position frames it, give the scene a camera"
    )]
    SceneTooLarge {
        /// The largest coordinate.
        largest: f32,
    },
}

/// The default view: from the front, the right and above.
const DEFAULT_VIEW: DVec3 = DVec3::new(0.5, 0.4, 1.0);
const DEFAULT_FIELD_OF_VIEW: FieldOfView = FieldOfView {
    degrees: 40.0,
    spans_shorter_side: true,
};

impl Camera {
    /// A camera with a place in the world.
    ///
    /// # Errors
    /// If the field of view or the height is out of range.
    pub fn new(camera_to_world: Transform, projection: Projection) -> Result<Self, CameraError> {
        match projection {
            Projection::Perspective(FieldOfView { degrees, .. })
                if !(degrees > 0.0 && degrees < 180.0) =>
            {
                return Err(CameraError::FieldOfView { degrees });
            }
            Projection::Orthographic { height } if !(height > 0.0 && height.is_finite()) => {
                return Err(CameraError::Height { height });
            }
            _ => {}
        }
        Ok(Self {
            camera_to_world,
            projection,
        })
    }

    /// A camera at `eye` that looks at `target`.
    ///
    /// # Errors
    /// If the projection is out of range, or eye, target and up do not define a view.
    pub fn look_at(
        eye: DVec3,
        target: DVec3,
        up: DVec3,
        projection: Projection,
    ) -> Result<Self, CameraError> {
        let camera_to_world = Transform::look_at(eye, target, up).ok_or(CameraError::NoView)?;
        Self::new(camera_to_world, projection)
    }

    /// A camera that sees all of some bounds, from the front, the right and above, with y up.
    ///
    /// # Errors
    /// If the camera would be too far away for f32 coordinates.
    pub fn framing(bounds: &Aabb) -> Result<Self, CameraError> {
        let (center, radius) = if bounds.is_empty() {
            (DVec3::ZERO, 1.0)
        } else {
            let [min, max] = [bounds.min.as_dvec3(), bounds.max.as_dvec3()];
            let radius = 0.5 * (max - min).length();
            // A scene that is one point still has a front.
            (0.5 * (min + max), if radius > 0.0 { radius } else { 1.0 })
        };
        let half_angle = (0.5 * DEFAULT_FIELD_OF_VIEW.degrees).to_radians();
        let eye = center + DEFAULT_VIEW.normalize() * (radius / half_angle.sin());
        if !eye.as_vec3().is_finite() {
            let largest = bounds.min.abs().max(bounds.max.abs()).max_element();
            return Err(CameraError::SceneTooLarge { largest });
        }
        Self::look_at(
            eye,
            center,
            DVec3::Y,
            Projection::Perspective(DEFAULT_FIELD_OF_VIEW),
        )
    }

    /// Where the camera is.
    #[must_use]
    pub fn position(&self) -> DVec3 {
        self.camera_to_world.point(DVec3::ZERO)
    }

    /// A direction of the camera's coordinates (x right, y up, -z forward) in the world.
    #[must_use]
    pub fn direction(&self, local: DVec3) -> DVec3 {
        self.camera_to_world.vector(local)
    }

    /// The ray through a place on the film of a size in pixels: `x` from 0 at the left to the width, `y` from 0
    /// at the top to the height. The direction has unit length up to rounding.
    #[must_use]
    pub fn ray(&self, x: f64, y: f64, width: u32, height: u32) -> Ray {
        let [width, height] = [width, height].map(f64::from);
        // In units of half the film's height.
        let right = (2.0 * x - width) / height;
        let up = (height - 2.0 * y) / height;
        let (origin, direction) = match self.projection {
            Projection::Perspective(view) => {
                let shorter = if view.spans_shorter_side {
                    (width / height).min(1.0)
                } else {
                    1.0
                };
                let scale = (0.5 * view.degrees).to_radians().tan() / shorter;
                (DVec3::ZERO, DVec3::new(right * scale, up * scale, -1.0))
            }
            Projection::Orthographic { height } => {
                (DVec3::new(right, up, 0.0) * (0.5 * height), DVec3::NEG_Z)
            }
        };
        let direction = self.camera_to_world.vector(direction).normalize_or_zero();
        Ray::new(
            self.camera_to_world.point(origin).as_vec3(),
            direction.as_vec3(),
        )
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    fn perspective(degrees: f64) -> Projection {
        Projection::Perspective(FieldOfView {
            degrees,
            spans_shorter_side: false,
        })
    }

    #[test]
    fn the_middle_of_the_film_looks_at_the_target_and_its_top_is_up() {
        let camera =
            Camera::look_at(DVec3::Z * 4.0, DVec3::ZERO, DVec3::Y, perspective(90.0)).unwrap();
        assert_eq!(camera.ray(50.0, 25.0, 100, 50).direction, Vec3::NEG_Z);
        let top = camera.ray(50.0, 0.0, 100, 50).direction;
        assert!(
            top.y > 0.0 && (top.y + top.z).abs() < 1e-6,
            "45 degrees up: {top}"
        );
    }

    #[test]
    fn orthographic_rays_are_parallel_and_span_the_height() {
        let projection = Projection::Orthographic { height: 6.0 };
        let camera = Camera::look_at(DVec3::Z, DVec3::ZERO, DVec3::Y, projection).unwrap();
        let corner = camera.ray(0.0, 0.0, 200, 100);
        assert_eq!(
            (corner.origin, corner.direction),
            (Vec3::new(-6.0, 3.0, 1.0), Vec3::NEG_Z)
        );
    }

    #[test]
    fn framing_sees_every_corner_whatever_the_shape_of_the_film() {
        let bounds = Aabb::new(Vec3::new(-1.0, 0.0, 5.0), Vec3::new(9.0, 2.0, 6.0));
        let camera = Camera::framing(&bounds).unwrap();
        for (width, height) in [(400, 300), (300, 400)] {
            let [center, edge] = [(0.5, 0.5), (0.5, 0.0)].map(|(x, y)| {
                camera.ray(x * f64::from(width), y * f64::from(height), width, height)
            });
            for corner in 0..8u8 {
                let pick = |axis: usize| {
                    if corner >> axis & 1 == 0 {
                        bounds.min[axis]
                    } else {
                        bounds.max[axis]
                    }
                };
                let to_corner = (Vec3::new(pick(0), pick(1), pick(2)) - center.origin).normalize();
                let limit = edge
                    .direction
                    .dot(center.direction)
                    .max((20f32).to_radians().cos());
                assert!(
                    to_corner.dot(center.direction) >= limit - 1e-6,
                    "{corner} of {width}x{height}"
                );
            }
        }
    }

    #[test]
    fn bad_cameras_are_refused() {
        for degrees in [0.0, 180.0, -5.0, f64::NAN] {
            let camera = Camera::new(Transform::IDENTITY, perspective(degrees));
            assert!(
                matches!(camera, Err(CameraError::FieldOfView { .. })),
                "{degrees}"
            );
        }
        let huge = Aabb::new(Vec3::splat(f32::MIN), Vec3::splat(f32::MAX));
        assert!(
            matches!(
                Camera::framing(&huge),
                Err(CameraError::SceneTooLarge { .. })
            ),
            "f32 range"
        );
        assert!(
            Camera::framing(&Aabb::EMPTY).is_ok(),
            "nothing to see is no error"
        );
    }
}
