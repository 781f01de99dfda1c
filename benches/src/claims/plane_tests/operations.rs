//! The tests that are timed.

use tahko_bench::random::Random;
use tahko_tracer::geometry::glam::{DVec3, Vec3};
use tahko_tracer::geometry::{Aabb, Axis, ConservativeRay, Plane, Ray};

/// Where planes and rays are.
pub(super) const BOUNDS: Aabb = Aabb {
    min: Vec3::ZERO,
    max: Vec3::ONE,
};

/// Where a ray crosses a plane.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Crossing {
    /// Not behind the crossing; the crossing itself of a plain test.
    pub(super) start: f32,
    /// Not before the crossing; the crossing itself of a plain test.
    pub(super) end: f32,
    /// Whether the ray comes from the front of the plane.
    pub(super) comes_from_front: bool,
}

/// A ray that is prepared for crossing planes of a kind.
pub(super) trait PlaneTest {
    type Plane: Copy;

    /// Whether the crossing is certainly in the interval.
    const ENCLOSES: bool;

    fn new(ray: &Ray) -> Self;

    fn cross(&self, plane: &Self::Plane) -> Crossing;

    /// A plane through a random point of [`BOUNDS`].
    fn random_plane(random: &mut Random) -> Self::Plane;

    /// Normal and offset of the plane as it is stored, without rounding.
    fn coefficients(plane: &Self::Plane) -> (DVec3, f64);
}

/// A plane at right angles to an axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct AxisPlane {
    axis: Axis,
    position: f32,
}

impl AxisPlane {
    fn random(random: &mut Random) -> Self {
        Self {
            axis: Axis::ALL[random.below(3)],
            position: random.unit(),
        }
    }

    fn coefficients(self) -> (DVec3, f64) {
        let normal = self.axis.unit_vector().as_dvec3();
        (normal, -f64::from(self.position))
    }
}

/// A plane in a random direction.
fn random_plane(random: &mut Random) -> Plane {
    loop {
        let normal = random.point_in(&BOUNDS).as_dvec3() - DVec3::splat(0.5);
        let through = random.point_in(&BOUNDS).as_dvec3();
        // By rejection evenly in the ball, and so in all directions.
        if normal.length() <= 0.5
            && let Some(plane) = Plane::from_point_normal(through, normal)
        {
            return plane;
        }
    }
}

/// `t = (p - o) r` with `r = 1 / d`.
pub(super) struct AxisPlain {
    origin: [f32; 3],
    reciprocal: [f32; 3],
}

impl PlaneTest for AxisPlain {
    type Plane = AxisPlane;
    const ENCLOSES: bool = false;

    fn new(ray: &Ray) -> Self {
        Self {
            origin: ray.origin.to_array(),
            reciprocal: ray.direction.recip().to_array(),
        }
    }

    #[inline]
    fn cross(&self, plane: &AxisPlane) -> Crossing {
        let axis = plane.axis as usize;
        let t = (plane.position - self.origin[axis]) * self.reciprocal[axis];
        Crossing {
            start: t,
            end: t,
            comes_from_front: self.reciprocal[axis] < 0.0,
        }
    }

    fn random_plane(random: &mut Random) -> AxisPlane {
        AxisPlane::random(random)
    }

    fn coefficients(plane: &AxisPlane) -> (DVec3, f64) {
        plane.coefficients()
    }
}

/// `t = -(n . o + c) / (n . d)`.
pub(super) struct GeneralPlain {
    origin: Vec3,
    direction: Vec3,
}

impl PlaneTest for GeneralPlain {
    type Plane = (Vec3, f32);
    const ENCLOSES: bool = false;

    fn new(ray: &Ray) -> Self {
        Self {
            origin: ray.origin,
            direction: ray.direction,
        }
    }

    #[inline]
    fn cross(&self, (normal, offset): &(Vec3, f32)) -> Crossing {
        let distance = normal.dot(self.origin) + offset;
        let speed = normal.dot(self.direction);
        let t = -distance / speed;
        Crossing {
            start: t,
            end: t,
            comes_from_front: speed < 0.0,
        }
    }

    #[expect(clippy::cast_possible_truncation, reason = "another plane nearby")]
    fn random_plane(random: &mut Random) -> (Vec3, f32) {
        let plane = random_plane(random);
        (plane.normal.as_vec3(), plane.offset as f32)
    }

    fn coefficients((normal, offset): &(Vec3, f32)) -> (DVec3, f64) {
        (normal.as_dvec3(), f64::from(*offset))
    }
}

/// The test of the kd-tree.
pub(super) struct AxisConservative(ConservativeRay);

impl PlaneTest for AxisConservative {
    type Plane = AxisPlane;
    const ENCLOSES: bool = true;

    fn new(ray: &Ray) -> Self {
        Self(ConservativeRay::new(ray, &BOUNDS, 0.0))
    }

    #[inline]
    fn cross(&self, plane: &AxisPlane) -> Crossing {
        let interval = self.0.crossing(plane.axis, plane.position);
        Crossing {
            start: interval.start,
            end: interval.end,
            comes_from_front: self.0.is_negative(plane.axis),
        }
    }

    fn random_plane(random: &mut Random) -> AxisPlane {
        AxisPlane::random(random)
    }

    fn coefficients(plane: &AxisPlane) -> (DVec3, f64) {
        plane.coefficients()
    }
}

/// The test of the BSP tree, whose own is private: the same operations in the same order, with the bound that its module `crossing` derives.
pub(super) struct GeneralConservative {
    origin: DVec3,
    direction: DVec3,
    widening: f64,
}

/// The depth of a tree of some ten thousand triangles.
const DEPTH: f64 = 24.0;

/// The smallest f32 above zero.
const SMALLEST: f64 = 1.0 / (1u128 << 100) as f64 / (1u64 << 49) as f64;

impl PlaneTest for GeneralConservative {
    type Plane = Plane;
    const ENCLOSES: bool = true;

    fn new(ray: &Ray) -> Self {
        let origin = ray.origin.as_dvec3();
        let size = origin.abs().max_element() + BOUNDS.max.as_dvec3().max_element();
        Self {
            origin,
            direction: ray.direction.as_dvec3(),
            widening: 32.0 * (DEPTH + 8.0) * (f64::EPSILON / 2.0) * size,
        }
    }

    #[inline]
    #[expect(
        clippy::cast_possible_truncation,
        reason = "widened by more than the rounding"
    )]
    fn cross(&self, plane: &Plane) -> Crossing {
        let distance = plane.signed_distance(self.origin);
        let speed = plane.normal.dot(self.direction);
        let comes_from_front = speed < 0.0;
        let distance = if comes_from_front {
            -distance
        } else {
            distance
        };
        let reciprocal = 1.0 / speed.abs();
        let start = (-self.widening - distance) * reciprocal;
        let end = (self.widening - distance) * reciprocal;
        Crossing {
            start: (start - widening_of(start)) as f32,
            end: (end + widening_of(end)) as f32,
            comes_from_front,
        }
    }

    fn random_plane(random: &mut Random) -> Plane {
        random_plane(random)
    }

    fn coefficients(plane: &Plane) -> (DVec3, f64) {
        (plane.normal, plane.offset)
    }
}

#[inline]
fn widening_of(value: f64) -> f64 {
    if value.is_finite() {
        value.abs() * f64::from(f32::EPSILON) + SMALLEST
    } else {
        0.0
    }
}
