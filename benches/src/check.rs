//! Random rays, and the errors of a structure on them.

use anyhow::{Result, bail};
use tahko_bench::audit::Closest;
use tahko_bench::random::Random;
use tahko_tracer::geometry::{Aabb, Ray, RayQuery};

use crate::errors::of_closest_hits;
use crate::report::Errors;

/// Rays through two random points of the bounds, from the first.
pub(crate) fn random_rays(bounds: &Aabb, count: usize) -> Vec<Ray> {
    let mut random = Random::new(1);
    (0..count)
        .map(|_| {
            let [from, through] = [(); 2].map(|()| random.point_in(bounds));
            Ray::new(from, through - from)
        })
        .collect()
}

/// How the closest hits of a structure differ from the exact ones.
pub(crate) fn errors(query: &dyn RayQuery, rays: &[Ray], exact: &[Option<Closest>]) -> Errors {
    let hits: Vec<_> = rays.iter().map(|ray| query.closest_hit(ray)).collect();
    of_closest_hits(&hits, exact, |_, _| false)
}

/// An error unless all closest hits were the exact ones, with `t` correctly rounded.
pub(crate) fn require_exact(errors: &Errors, whose: &str) -> Result<()> {
    let is_rounded = errors.t_ulp.is_none_or(|t_ulp| t_ulp.largest <= 0.5);
    if mistakes(errors) > 0 || !is_rounded {
        bail!("{whose} does not answer exactly: {errors:?}");
    }
    Ok(())
}

/// Rays with a wrong answer to what is hit.
pub(crate) const fn mistakes(errors: &Errors) -> usize {
    errors.false_hits + errors.false_misses + errors.wrong_triangles
}

/// The columns of errors in a table.
pub(crate) const ERROR_COLUMNS: [&str; 5] = [
    "audited",
    "false hits",
    "false misses",
    "wrong triangles",
    "largest t error, ulp",
];

/// What stands in these columns.
pub(crate) fn error_cells(errors: &Errors) -> [String; 5] {
    [
        errors.audited.to_string(),
        errors.false_hits.to_string(),
        errors.false_misses.to_string(),
        errors.wrong_triangles.to_string(),
        errors
            .t_ulp
            .map_or_else(String::new, |t_ulp| format!("{:.2}", t_ulp.largest)),
    ]
}

#[cfg(test)]
mod tests {
    use tahko_bench::audit::TErrors;
    use tahko_geometry::oracle::Oracle;
    use tahko_tracer::geometry::{BruteForce, Precision, TriangleMesh, glam::Vec3};

    use super::*;
    use crate::errors::exact_answers;

    #[test]
    fn only_exact_answers_pass() {
        let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        let mesh = TriangleMesh::new(corners, vec![[0, 1, 2]]).unwrap();
        let down = |x: f32| Ray::new(Vec3::new(x, x, 1.0), Vec3::NEG_Z);
        let rays = [down(0.2), down(0.9)];
        let query = BruteForce::new(&mesh, Precision::Exact);
        let exact = exact_answers(&Oracle::new(&mesh), &rays);
        let found = errors(&query, &rays, &exact);
        assert_eq!((found.audited, found.hits, mistakes(&found)), (2, 1, 0));
        require_exact(&found, "brute force").unwrap();

        let swapped = [exact[1], exact[0]];
        let found = errors(&query, &rays, &swapped);
        assert!(require_exact(&found, "brute force").is_err());
    }

    #[test]
    fn a_t_that_is_not_correctly_rounded_does_not_pass() {
        let errors = Errors {
            t_ulp: TErrors::of(vec![0.1, 0.6]),
            ..Errors::default()
        };
        assert!(require_exact(&errors, "a structure").is_err());
    }
}
