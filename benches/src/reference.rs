//! The reference that errors are counted against: every triangle in f64.
//!
//! f64 decides all but the rays that pass an edge within `2^-50` or so of their length; those aimed exactly at
//! vertices and edges are often that close, so a share of the differences in the class `aimed` is the reference's own
//! rounding. An exact reference is to take its place.

use glam::{DVec3, Vec3};
use tahko_tracer::geometry::{Hit, Ray, RayQuery, Triangle, TriangleMesh};

/// How the answers of a structure differ from the reference.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Errors {
    pub(crate) rays: usize,
    /// Hits that the structure reports and the reference does not.
    pub(crate) false_hits: usize,
    /// Hits of the reference that the structure misses.
    pub(crate) false_misses: usize,
    /// Both hit, but `t` differs by more than `2^-16` of itself.
    pub(crate) wrong_hits: usize,
    /// The largest relative difference of `t` where both hit the same triangle.
    pub(crate) largest_t_error: f64,
}

/// Relative differences of t beyond this mean that another place was hit, and not rounding.
const SAME_PLACE: f64 = 1.0 / 65536.0;

/// Compares closest hits on some rays, `answers` being the reference's.
pub(crate) fn compare(
    query: &dyn RayQuery,
    rays: &[Ray],
    answers: &[Option<(f64, u32)>],
) -> Errors {
    let mut errors = Errors {
        rays: rays.len(),
        ..Errors::default()
    };
    for (ray, answer) in rays.iter().zip(answers) {
        match (query.closest_hit(ray), *answer) {
            (Some(_), None) => errors.false_hits += 1,
            (None, Some(_)) => errors.false_misses += 1,
            (Some(Hit { t, primitive, .. }), Some((expected, triangle))) => {
                let error = (f64::from(t) - expected).abs() / expected.abs().max(f64::MIN_POSITIVE);
                if error > SAME_PLACE {
                    errors.wrong_hits += 1;
                } else if primitive == triangle {
                    errors.largest_t_error = errors.largest_t_error.max(error);
                }
            }
            (None, None) => {}
        }
    }
    errors
}

/// The closest hits in f64: `t` and triangle.
pub(crate) fn closest_hits(mesh: &TriangleMesh, rays: &[Ray]) -> Vec<Option<(f64, u32)>> {
    let triangles: Vec<Triangle> = mesh.triangles().collect();
    rays.iter()
        .map(|ray| {
            let hits = (0u32..)
                .zip(&triangles)
                .filter_map(|(index, triangle)| intersect(ray, triangle).map(|t| (t, index)));
            hits.min_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal))
        })
        .collect()
}

/// Möller and Trumbore in f64 with closed comparisons.
fn intersect(ray: &Ray, triangle: &Triangle) -> Option<f64> {
    let [a, b, c] = triangle.vertices().map(Vec3::as_dvec3);
    let direction: DVec3 = ray.direction.as_dvec3();
    let (edge1, edge2) = (b - a, c - a);
    let p = direction.cross(edge2);
    let determinant = edge1.dot(p);
    let from_a = ray.origin.as_dvec3() - a;
    let u = from_a.dot(p) / determinant;
    let q = from_a.cross(edge1);
    let v = direction.dot(q) / determinant;
    let t = edge2.dot(q) / determinant;
    let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
    (inside && f64::from(ray.t_min) <= t && t <= f64::from(ray.t_max)).then_some(t)
}

#[cfg(test)]
mod tests {
    use tahko_tracer::geometry::{BruteForce, Precision};

    use super::*;

    #[test]
    fn a_structure_that_answers_right_has_no_errors_and_a_wrong_one_has() {
        let mesh = TriangleMesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]).unwrap();
        let rays = [
            Ray::new(Vec3::new(0.2, 0.2, 1.0), Vec3::NEG_Z),
            Ray::new(Vec3::new(0.9, 0.9, 1.0), Vec3::NEG_Z),
        ];
        let answers = closest_hits(&mesh, &rays);
        assert_eq!(answers, [Some((1.0, 0)), None]);
        let query = BruteForce::new(&mesh, Precision::Fast);
        let errors = compare(&query, &rays, &answers);
        assert_eq!(
            (errors.false_hits, errors.false_misses, errors.wrong_hits),
            (0, 0, 0)
        );
        let swapped = [None, Some((1.0, 0))];
        let errors = compare(&query, &rays, &swapped);
        assert_eq!(
            (errors.false_hits, errors.false_misses, errors.wrong_hits),
            (1, 1, 0)
        );
        let errors = compare(&query, &rays, &[Some((2.0, 0)), None]);
        assert_eq!(errors.wrong_hits, 1);
    }
}
