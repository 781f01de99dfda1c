//! Random rays, and the errors of a structure on them.

use anyhow::{Result, bail};
use rayon::prelude::*;
use tahko_bench::random::Random;
use tahko_geometry::oracle::{ExactHit, Oracle};
use tahko_tracer::geometry::{Aabb, Ray, RayQuery};

use crate::report::{Distribution, Errors};

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

/// The exact closest hits.
pub(crate) fn answers(oracle: &Oracle, rays: &[Ray]) -> Vec<Option<ExactHit>> {
    rays.par_iter().map(|ray| oracle.closest_hit(ray)).collect()
}

/// How the closest hits of a structure differ from the exact ones.
pub(crate) fn errors(query: &dyn RayQuery, rays: &[Ray], exact: &[Option<ExactHit>]) -> Errors {
    let mut errors = Errors {
        audited: rays.len(),
        ..Errors::default()
    };
    let mut t_errors = Vec::new();
    for (ray, exact) in rays.iter().zip(exact) {
        errors.hits += usize::from(exact.is_some());
        match (query.closest_hit(ray), exact) {
            (Some(_), None) => errors.false_hits += 1,
            (None, Some(_)) => errors.false_misses += 1,
            (Some(hit), Some(exact)) if hit.primitive == exact.triangle => {
                t_errors.push(exact.t_error_in_ulps(hit.t));
            }
            (Some(hit), Some(exact)) => {
                let exact_t = exact.t.to_f64().value();
                let is_far_off = (f64::from(hit.t) - exact_t).abs() > 1e-3 * exact_t.abs();
                errors.wrong_triangles += 1;
                errors.far_off += usize::from(is_far_off);
            }
            (None, None) => {}
        }
    }
    errors.t_ulp = distribution(t_errors);
    errors
}

fn distribution(mut errors: Vec<f64>) -> Option<Distribution> {
    errors.sort_by(f64::total_cmp);
    let last = errors.len().checked_sub(1)?;
    Some(Distribution {
        median: errors[last / 2],
        quantile_999: errors[(999 * errors.len()).div_ceil(1000) - 1],
        largest: errors[last],
    })
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
    use tahko_tracer::geometry::{BruteForce, Precision, TriangleMesh, glam::Vec3};

    use super::*;

    #[test]
    fn errors_are_counted_by_kind_and_only_exact_answers_pass() {
        let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        let mesh = TriangleMesh::new(corners, vec![[0, 1, 2]]).unwrap();
        let down = |x: f32| Ray::new(Vec3::new(x, x, 1.0), Vec3::NEG_Z);
        let rays = [down(0.2), down(0.9)];
        let query = BruteForce::new(&mesh, Precision::Exact);
        let exact = answers(&Oracle::new(&mesh), &rays);
        let found = errors(&query, &rays, &exact);
        assert_eq!((found.audited, found.hits, mistakes(&found)), (2, 1, 0));
        assert_eq!(found.t_ulp.unwrap().largest, 0.0);
        require_exact(&found, "brute force").unwrap();

        let swapped = [exact[1].clone(), exact[0].clone()];
        let found = errors(&query, &rays, &swapped);
        assert_eq!((found.false_hits, found.false_misses), (1, 1));
        assert!(require_exact(&found, "brute force").is_err());

        let other = exact[0].clone().map(|hit| ExactHit { triangle: 7, ..hit });
        let found = errors(&query, &rays, &[other, None]);
        assert_eq!((found.wrong_triangles, found.far_off), (1, 0));
        assert!(require_exact(&found, "brute force").is_err());
    }

    #[test]
    fn a_t_that_is_not_correctly_rounded_does_not_pass() {
        let t_ulp = distribution(vec![0.1, 0.6]);
        let errors = Errors {
            t_ulp,
            ..Errors::default()
        };
        assert!(require_exact(&errors, "a structure").is_err());
    }
}
