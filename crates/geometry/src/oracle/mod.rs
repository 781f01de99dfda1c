//! The exact reference: brute force in rational numbers.
//!
//! Every f32 is a rational number, so hit or miss, the order of hits and `t` have exact values. The oracle computes them with the
//! rational numbers of `dashu-ratio` by the textbook formulas, and shares no code with the predicates, the kernels and
//! the structures that are held against it. A ray is not tried against every triangle in rationals: boxes of consecutive triangles
//! (`groups`) and a filter in f64 (`filter`) throw out what it certainly misses, each with a proof in its module.
//!
//! The rules are those of the numeric contract: triangles are closed, a ray hits at every `t` of its closed interval, a ray in the plane of a
//! triangle and a triangle without area never hit, ties go to the smallest index, and a ray that is not
//! [valid](Ray::is_valid) hits nothing.

mod filter;
mod groups;
mod order;
mod rational;
mod rounding;

pub use dashu_ratio::RBig;
use glam::{DVec3, Vec3};

use crate::{Ray, TriangleMesh};
use filter::{Candidate, Filter};
use groups::{Groups, RayInterval};
use rational::{ExactRay, ExactTriangle, exact_vector};
pub use rounding::{error_in_ulps, round_to_f32};

/// The exact hit of a ray on a triangle.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExactHit {
    /// Parameter along the ray, in lengths of the ray's direction.
    pub t: RBig,
    /// Weight of the triangle's second vertex, in `[0, 1]`.
    pub u: RBig,
    /// Weight of the triangle's third vertex, in `[0, 1 - u]`.
    pub v: RBig,
    /// The triangle's index in the mesh.
    pub triangle: u32,
}

/// Exact answers about a mesh.
///
/// Memory: about 80 bytes per triangle. Cost of a query: proportional to the boxes that the ray meets and the triangles in them, and some
/// ten microseconds for each triangle that it hits or passes closely.
///
/// ```
/// use tahko_geometry::oracle::{Oracle, RBig};
/// use tahko_geometry::{Ray, TriangleMesh, glam::Vec3};
///
/// let mesh = TriangleMesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]])?;
/// let ray = Ray::new(Vec3::new(0.25, 0.25, 1.0), Vec3::NEG_Z * 3.0);
/// let hit = Oracle::new(&mesh).closest_hit(&ray).expect("the triangle is below");
/// assert_eq!(hit.t, RBig::from_parts(1.into(), 3u8.into()));
/// assert_eq!(hit.rounded_t(), 1.0 / 3.0);
/// # Ok::<(), tahko_geometry::MeshError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Oracle {
    /// Along a space-filling curve.
    triangles: Vec<[DVec3; 3]>,
    /// The index in the mesh of each of these.
    numbers: Vec<u32>,
    groups: Groups,
}

impl ExactHit {
    /// [`t`](Self::t) as a correct structure gives it: see [`round_to_f32`].
    #[must_use]
    pub fn rounded_t(&self) -> f32 {
        round_to_f32(&self.t)
    }

    /// How far a `t` is from the exact one: see [`error_in_ulps`].
    #[must_use]
    pub fn t_error_in_ulps(&self, t: f32) -> f64 {
        error_in_ulps(t, &self.t)
    }
}

impl Oracle {
    /// Copies the triangles of a mesh.
    #[must_use]
    pub fn new(mesh: &TriangleMesh) -> Self {
        let corners = |number: u32| {
            let triangle = mesh.triangle(number as usize);
            triangle.vertices().map(Vec3::as_dvec3)
        };
        let numbers = order::along_curve(mesh);
        let triangles: Vec<_> = numbers.iter().copied().map(corners).collect();
        Self {
            groups: Groups::new(&triangles),
            triangles,
            numbers,
        }
    }

    /// The hit with the smallest `t`, and of those the one with the smallest index.
    #[must_use]
    pub fn closest_hit(&self, ray: &Ray) -> Option<ExactHit> {
        self.closest(ray, |_| true)
    }

    /// The closest hit on any triangle but one.
    #[must_use]
    pub fn closest_hit_ignoring(&self, ray: &Ray, primitive: u32) -> Option<ExactHit> {
        self.closest(ray, |number| number != primitive)
    }

    /// The hits on all closed triangles, in the order of `t`, then of the index. Any hit exists if there is one here.
    #[must_use]
    pub fn all_closed_hits(&self, ray: &Ray) -> Vec<ExactHit> {
        self.sorted_hits(ray, |_, _| true)
    }

    /// The crossings of the surface, in the order of `t`, then of the index: the closed hits whose triangle is also met by the ray
    /// when its origin is moved by `(e, e^2, e^3)` for every small enough `e > 0`. The interval is that of the ray as given.
    #[must_use]
    pub fn crossings(&self, ray: &Ray) -> Vec<ExactHit> {
        self.sorted_hits(ray, ExactRay::crosses_when_moved)
    }

    /// Whether a point lies on a closed triangle that has an area, or a ray from it crosses the surface an odd number of times:
    /// inside or on a closed mesh. A point that is not finite is outside.
    #[must_use]
    pub fn contains(&self, point: Vec3) -> bool {
        point.is_finite()
            && (self.has_on_surface(point)
                || self.crossings(&Ray::new(point, Vec3::X)).len() % 2 == 1)
    }

    fn closest(&self, ray: &Ray, is_wanted: impl Fn(u32) -> bool) -> Option<ExactHit> {
        let exact = ExactRay::new(ray)?;
        let mut candidates = self.candidates(ray);
        candidates.retain(|candidate| is_wanted(self.numbers[candidate.place]));
        // Roughly from front to back, so that few need rationals.
        candidates.sort_by(|a, b| a.approximate_t().total_cmp(&b.approximate_t()));
        let mut closest: Option<ExactHit> = None;
        let mut reach = f64::INFINITY;
        for candidate in candidates {
            if candidate.is_certainly_beyond(reach) {
                continue;
            }
            let triangle = self.exact_triangle(candidate.place);
            let Some(hit) = self.exact_hit(&exact, &triangle, candidate.place) else {
                continue;
            };
            let is_closer = closest
                .as_ref()
                .is_none_or(|closest| (&hit.t, hit.triangle) < (&closest.t, closest.triangle));
            if is_closer {
                reach = rounding::upper_bound(&hit.t);
                closest = Some(hit);
            }
        }
        closest
    }

    fn sorted_hits(
        &self,
        ray: &Ray,
        is_wanted: impl Fn(&ExactRay, &ExactTriangle) -> bool,
    ) -> Vec<ExactHit> {
        let Some(exact) = ExactRay::new(ray) else {
            return Vec::new();
        };
        let hit = |candidate: Candidate| {
            let triangle = self.exact_triangle(candidate.place);
            let hit = self.exact_hit(&exact, &triangle, candidate.place)?;
            is_wanted(&exact, &triangle).then_some(hit)
        };
        let mut hits: Vec<ExactHit> = self.candidates(ray).into_iter().filter_map(hit).collect();
        hits.sort_by(|a, b| (&a.t, a.triangle).cmp(&(&b.t, b.triangle)));
        hits
    }

    /// The triangles that a ray may hit. The ray is valid.
    fn candidates(&self, ray: &Ray) -> Vec<Candidate> {
        let filter = Filter::new(ray);
        let interval = RayInterval::new(ray);
        let mut candidates = Vec::new();
        self.groups.visit(
            |bounds| interval.may_meet(bounds),
            |places| {
                candidates.extend(
                    places.filter_map(|place| filter.candidate(place, &self.triangles[place])),
                );
            },
        );
        candidates
    }

    fn exact_triangle(&self, place: usize) -> ExactTriangle {
        ExactTriangle::new(&self.triangles[place])
    }

    fn exact_hit(
        &self,
        ray: &ExactRay,
        triangle: &ExactTriangle,
        place: usize,
    ) -> Option<ExactHit> {
        let [t, u, v] = ray.hit(triangle)?;
        Some(ExactHit {
            t,
            u,
            v,
            triangle: self.numbers[place],
        })
    }

    fn has_on_surface(&self, point: Vec3) -> bool {
        let (place, exact) = (point.as_dvec3(), exact_vector(point.as_dvec3()));
        let mut found = false;
        self.groups.visit(
            |bounds| bounds.contains(place),
            |mut places| {
                found = found || places.any(|place| self.exact_triangle(place).contains(&exact));
            },
        );
        found
    }
}

#[cfg(test)]
mod tests;
