//! The textbook formulas in rational numbers.

use dashu_ratio::{RBig, Relaxed};
use glam::DVec3;
use std::cmp::Ordering;

use crate::Ray;

/// Three rationals whose denominators are powers of two, which `Relaxed` keeps reduced at little cost.
pub(super) type ExactVector = [Relaxed; 3];

/// A valid ray.
pub(super) struct ExactRay {
    origin: ExactVector,
    direction: ExactVector,
    /// Bounds of `t`, where there are any.
    t_min: Option<Relaxed>,
    t_max: Option<Relaxed>,
}

/// The vertices of a triangle.
pub(super) struct ExactTriangle([ExactVector; 3]);

/// The value of a finite number.
pub(super) fn exact(value: f64) -> Relaxed {
    Relaxed::try_from(value).expect("coordinates of meshes and valid rays are finite")
}

pub(super) fn exact_vector(vector: DVec3) -> ExactVector {
    vector.to_array().map(exact)
}

impl ExactRay {
    /// `None` if the ray can hit nothing: it is not valid, or its interval has no finite `t`.
    pub(super) fn new(ray: &Ray) -> Option<Self> {
        let can_hit = ray.is_valid() && ray.t_min < f32::INFINITY && ray.t_max > f32::NEG_INFINITY;
        let bound = |t: f32| t.is_finite().then(|| exact(t.into()));
        can_hit.then(|| Self {
            origin: exact_vector(ray.origin.as_dvec3()),
            direction: exact_vector(ray.direction.as_dvec3()),
            t_min: bound(ray.t_min),
            t_max: bound(ray.t_max),
        })
    }

    /// The same ray with another origin.
    #[cfg(test)]
    pub(super) fn moved_by(mut self, shift: &ExactVector) -> Self {
        self.origin = [0, 1, 2].map(|axis| &self.origin[axis] + &shift[axis]);
        self
    }

    /// `t`, `u` and `v` of a hit on the closed triangle in the closed interval.
    pub(super) fn hit(&self, ExactTriangle([a, b, c]): &ExactTriangle) -> Option<[RBig; 3]> {
        let (edge1, edge2, from_a) = (minus(b, a), minus(c, a), minus(&self.origin, a));
        let p = cross(&self.direction, &edge2);
        let q = cross(&from_a, &edge1);
        let mut terms = [
            dot(&edge1, &p),
            dot(&edge2, &q),
            dot(&from_a, &p),
            dot(&self.direction, &q),
        ];
        match sign(&terms[0]) {
            Ordering::Less => terms = terms.map(|term| -term),
            // Parallel to the plane, or no area.
            Ordering::Equal => return None,
            Ordering::Greater => {}
        }
        let [determinant, t, u, v] = terms;
        let is_inside = sign(&u).is_ge() && sign(&v).is_ge() && &u + &v <= determinant;
        let is_in_interval = self
            .t_min
            .as_ref()
            .is_none_or(|t_min| t >= t_min * &determinant)
            && self
                .t_max
                .as_ref()
                .is_none_or(|t_max| t <= t_max * &determinant);
        (is_inside && is_in_interval)
            .then(|| [t, u, v].map(|term| (term / &determinant).canonicalize()))
    }

    /// Whether the line of the ray meets the triangle when the origin is moved by `(e, e^2, e^3)`, for every small enough `e > 0`.
    pub(super) fn crosses_when_moved(&self, ExactTriangle([a, b, c]): &ExactTriangle) -> bool {
        let [ab, bc, ca] =
            [(a, b), (b, c), (c, a)].map(|(from, to)| self.side_when_moved(from, to));
        ab == bc && bc == ca && ab.is_ne()
    }

    /// The side of an edge on which the line of the moved ray passes; equal only if the edge is parallel to the ray.
    fn side_when_moved(&self, from: &ExactVector, to: &ExactVector) -> Ordering {
        let [to_from, to_to] = [from, to].map(|end| minus(end, &self.origin));
        let side = sign(&dot(&self.direction, &cross(&to_from, &to_to)));
        // Moving the origin by m changes the triple product by m times this vector.
        let change = cross(&self.direction, &minus(to, from));
        change
            .iter()
            .fold(side, |side, component| side.then_with(|| sign(component)))
    }
}

impl ExactTriangle {
    pub(super) fn new(corners: &[DVec3; 3]) -> Self {
        Self(corners.map(exact_vector))
    }

    /// Whether a point lies on the closed triangle, which has an area.
    pub(super) fn contains(&self, point: &ExactVector) -> bool {
        let Self([a, b, c]) = self;
        let normal = cross(&minus(b, a), &minus(c, a));
        let is_flat = normal.iter().all(|component| sign(component).is_eq());
        let is_in_plane = || sign(&dot(&normal, &minus(point, a))).is_eq();
        let is_inside =
            |from, to| sign(&dot(&normal, &cross(&minus(to, from), &minus(point, from)))).is_ge();
        !is_flat && is_in_plane() && is_inside(a, b) && is_inside(b, c) && is_inside(c, a)
    }
}

fn sign(value: &Relaxed) -> Ordering {
    value.cmp(&Relaxed::ZERO)
}

fn minus(a: &ExactVector, b: &ExactVector) -> ExactVector {
    [0, 1, 2].map(|axis| &a[axis] - &b[axis])
}

fn cross(a: &ExactVector, b: &ExactVector) -> ExactVector {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| &a[i] * &b[j] - &a[j] * &b[i])
}

fn dot(a: &ExactVector, b: &ExactVector) -> Relaxed {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}
