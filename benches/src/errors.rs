//! Counts the errors of contenders against the exact reference.

use rayon::prelude::*;
use tahko_bench::audit::{Closest, TErrors};
use tahko_geometry::oracle::Oracle;
use tahko_tracer::geometry::{Hit, Ray};

use crate::contender::Contender;
use crate::report::{Errors, RayClass};

/// Rays with their exact answers.
pub(crate) struct Audit<'a> {
    oracle: &'a Oracle,
    class: RayClass,
    rays: Vec<Ray>,
    exact: Vec<Option<Closest>>,
}

/// What a library promises about triangles that are hit at the same `t`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ties {
    /// The one with the smallest index is the answer.
    Smallest,
    /// Any of them will do.
    Any,
}

/// How much `t` may be off, relative to the exact one, for a hit on a wrong triangle not to count as far off.
const FAR_OFF: f64 = 1e-3;

impl<'a> Audit<'a> {
    /// Computes the exact answers to about `count` of the rays, spread evenly over them, on the current pool of rayon.
    pub(crate) fn new(oracle: &'a Oracle, class: RayClass, rays: &[Ray], count: usize) -> Self {
        // Odd, so that rays of a tile of a power of two take turns.
        let stride = rays.len().div_ceil(count.max(1)) | 1;
        let rays: Vec<Ray> = rays.iter().copied().step_by(stride).collect();
        let exact = exact_answers(oracle, &rays);
        Self {
            oracle,
            class,
            rays,
            exact,
        }
    }

    /// Compares the answers of a contender with the exact ones.
    pub(crate) fn errors(&self, contender: &dyn Contender, ties: Ties) -> Errors {
        if self.class.asks_any() {
            let mut found = vec![false; self.rays.len()];
            contender.any_hits(&self.rays, &mut found);
            self.errors_of_any(&found)
        } else {
            let mut hits = vec![None; self.rays.len()];
            contender.closest_hits(&self.rays, &mut hits);
            self.errors_of_closest(&hits, ties)
        }
    }

    fn audited(&self) -> Errors {
        Errors {
            audited: self.rays.len(),
            hits: self.exact.iter().flatten().count(),
            ..Errors::default()
        }
    }

    fn errors_of_any(&self, found: &[bool]) -> Errors {
        let mut errors = self.audited();
        for (found, exact) in found.iter().zip(&self.exact) {
            errors.false_hits += usize::from(*found && exact.is_none());
            errors.false_misses += usize::from(!*found && exact.is_some());
        }
        errors
    }

    fn errors_of_closest(&self, hits: &[Option<Hit>], ties: Ties) -> Errors {
        of_closest_hits(hits, &self.exact, |index, triangle| {
            ties == Ties::Any && self.is_as_close(&self.rays[index], triangle)
        })
    }

    /// Whether a triangle is hit at exactly the same `t` as the closest one.
    fn is_as_close(&self, ray: &Ray, triangle: u32) -> bool {
        let hits = self.oracle.all_closed_hits(ray);
        let closest = hits.first().map(|hit| &hit.t);
        hits.iter()
            .any(|hit| hit.triangle == triangle && Some(&hit.t) == closest)
    }
}

/// The exact closest hits, on the current pool of rayon.
pub(crate) fn exact_answers(oracle: &Oracle, rays: &[Ray]) -> Vec<Option<Closest>> {
    let exact = rays
        .par_iter()
        .map(|ray| oracle.closest_hit(ray).as_ref().map(Closest::new));
    exact.collect()
}

/// How closest hits differ from the exact ones. `is_right_too` tells whether another triangle than the closest will do for a ray.
pub(crate) fn of_closest_hits(
    hits: &[Option<Hit>],
    exact: &[Option<Closest>],
    is_right_too: impl Fn(usize, u32) -> bool,
) -> Errors {
    let mut errors = Errors {
        audited: hits.len(),
        hits: exact.iter().flatten().count(),
        ..Errors::default()
    };
    let mut t_errors = Vec::new();
    for (index, (given, exact)) in hits.iter().zip(exact).enumerate() {
        match (given, exact) {
            (Some(_), None) => errors.false_hits += 1,
            (None, Some(_)) => errors.false_misses += 1,
            (None, None) => {}
            (Some(given), Some(exact)) => {
                let Hit { t, primitive, .. } = *given;
                if primitive == exact.triangle || is_right_too(index, primitive) {
                    t_errors.push(exact.t_error_in_ulps(t));
                    continue;
                }
                errors.wrong_triangles += 1;
                // A positive comparison, so that NaN is far off.
                let is_near = (f64::from(t) - exact.t).abs() <= FAR_OFF * exact.t.abs();
                errors.far_off += usize::from(!is_near);
            }
        }
    }
    errors.t_ulp = TErrors::of(t_errors);
    errors
}

#[cfg(test)]
mod tests {
    use tahko_tracer::geometry::{TriangleMesh, glam::Vec3};

    use super::*;

    /// Answers as it is told.
    struct Stub(Vec<Option<Hit>>);

    impl Contender for Stub {
        fn closest_hits(&self, _rays: &[Ray], hits: &mut [Option<Hit>]) {
            hits.copy_from_slice(&self.0);
        }

        fn any_hits(&self, _rays: &[Ray], found: &mut [bool]) {
            for (found, hit) in found.iter_mut().zip(&self.0) {
                *found = hit.is_some();
            }
        }
    }

    /// Two equal triangles with one behind them, a ray that hits them and one that does not.
    fn oracle() -> (Oracle, [Ray; 2]) {
        let corners = |z: f32| [Vec3::ZERO, Vec3::X, Vec3::Y].map(|corner| corner + Vec3::Z * z);
        let vertices = [corners(0.0), corners(-1.0)].concat();
        let mesh = TriangleMesh::new(vertices, vec![[0, 1, 2], [0, 1, 2], [3, 4, 5]]).unwrap();
        let down = |x: f32| Ray::new(Vec3::new(x, x, 1.0), Vec3::NEG_Z);
        (Oracle::new(&mesh), [down(0.2), down(0.9)])
    }

    fn hit(t: f32, primitive: u32) -> Option<Hit> {
        Some(Hit {
            t,
            u: 0.2,
            v: 0.2,
            primitive,
        })
    }

    fn errors(class: RayClass, ties: Ties, hits: [Option<Hit>; 2]) -> Errors {
        let (oracle, rays) = oracle();
        Audit::new(&oracle, class, &rays, 2).errors(&Stub(hits.to_vec()), ties)
    }

    #[test]
    fn errors_of_closest_hits_are_counted_by_kind() {
        let count = |hits| {
            let errors = errors(RayClass::Random, Ties::Smallest, hits);
            assert_eq!((errors.audited, errors.hits), (2, 1));
            let Errors {
                false_hits,
                false_misses,
                wrong_triangles,
                far_off,
                ..
            } = errors;
            (
                [false_hits, false_misses, wrong_triangles, far_off],
                errors.t_ulp.map(|t| t.largest),
            )
        };
        assert_eq!(count([hit(1.0, 0), None]), ([0; 4], Some(0.0)));
        assert_eq!(count([hit(1.0f32.next_up(), 0), None]), ([0; 4], Some(1.0)));
        assert_eq!(count([None, hit(1.0, 0)]), ([1, 1, 0, 0], None));
        assert_eq!(count([hit(1.0, 1), None]), ([0, 0, 1, 0], None));
        assert_eq!(count([hit(2.0, 2), None]), ([0, 0, 1, 1], None));
        assert_eq!(count([hit(f32::NAN, 2), None]), ([0, 0, 1, 1], None));
    }

    #[test]
    fn who_promises_nothing_about_ties_may_name_any_of_them() {
        let wrong = |hits| errors(RayClass::Random, Ties::Any, hits).wrong_triangles;
        assert_eq!(wrong([hit(1.0, 1), None]), 0, "hit at the same t");
        assert_eq!(wrong([hit(1.0, 2), None]), 1, "behind them");
    }

    #[test]
    fn errors_of_any_hits_are_hits_and_misses() {
        let count = |hits| {
            let errors = errors(RayClass::Shadow, Ties::Smallest, hits);
            (errors.false_hits, errors.false_misses, errors.t_ulp)
        };
        assert_eq!(count([hit(9.0, 2), None]), (0, 0, None));
        assert_eq!(count([None, hit(9.0, 2)]), (1, 1, None));
    }
}
