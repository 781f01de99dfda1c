//! Counts the errors of structures against the exact reference.

use tahko_geometry::oracle::ExactHit;
use tahko_tracer::geometry::{Hit, Ray, RayQuery};

/// How the closest hits of a structure differ from the exact ones.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Errors {
    pub(crate) rays: usize,
    /// Rays that the structure says hit something, and that hit nothing.
    pub(crate) false_hits: usize,
    /// Rays that hit something, and that the structure says hit nothing.
    pub(crate) false_misses: usize,
    /// Rays for which the structure names another triangle than the closest one.
    pub(crate) wrong_triangles: usize,
    /// The largest error of `t`, in units in the last place of an f32, where the triangle is right.
    pub(crate) largest_t_error: f64,
}

/// Compares the closest hits of a structure with the exact ones.
pub(crate) fn compare(query: &dyn RayQuery, rays: &[Ray], exact: &[Option<ExactHit>]) -> Errors {
    let mut errors = Errors {
        rays: rays.len(),
        ..Errors::default()
    };
    for (ray, exact) in rays.iter().zip(exact) {
        match (query.closest_hit(ray), exact) {
            (Some(_), None) => errors.false_hits += 1,
            (None, Some(_)) => errors.false_misses += 1,
            (Some(Hit { t, primitive, .. }), Some(exact)) => {
                if primitive == exact.triangle {
                    errors.largest_t_error = errors.largest_t_error.max(exact.t_error_in_ulps(t));
                } else {
                    errors.wrong_triangles += 1;
                }
            }
            (None, None) => {}
        }
    }
    errors
}

#[cfg(test)]
mod tests {
    use tahko_geometry::oracle::{Oracle, RBig};
    use tahko_tracer::geometry::{BruteForce, Precision, TriangleMesh, glam::Vec3};

    use super::*;

    #[test]
    fn errors_of_a_structure_are_counted_by_kind() {
        let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        let mesh = TriangleMesh::new(corners, vec![[0, 1, 2], [0, 1, 2]]).unwrap();
        let down = |x: f32| Ray::new(Vec3::new(x, x, 1.0), Vec3::NEG_Z);
        let rays = [down(0.2), down(0.9)];
        let oracle = Oracle::new(&mesh);
        let exact = rays.map(|ray| oracle.closest_hit(&ray));
        let query = BruteForce::new(&mesh, Precision::Fast);
        let count = |exact: &[Option<ExactHit>]| {
            let errors = compare(&query, &rays, exact);
            (
                errors.false_hits,
                errors.false_misses,
                errors.wrong_triangles,
                errors.largest_t_error,
            )
        };
        assert_eq!(count(&exact), (0, 0, 0, 0.0));
        let hit = |t: f32, triangle| {
            Some(ExactHit {
                t: RBig::try_from(t).unwrap(),
                u: RBig::ZERO,
                v: RBig::ZERO,
                triangle,
            })
        };
        assert_eq!(count(&[None, hit(1.0, 0)]), (1, 1, 0, 0.0));
        assert_eq!(count(&[hit(1.0, 1), None]), (0, 0, 1, 0.0));
        assert_eq!(count(&[hit(1.0f32.next_up(), 0), None]), (0, 0, 0, 1.0));
    }
}
