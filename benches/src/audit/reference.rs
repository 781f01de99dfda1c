//! The exact answers, in a form that is small and quick to compare with.

use rayon::prelude::*;
use tahko_geometry::oracle::{ExactHit, Oracle};
use tahko_tracer::geometry::Ray;

/// Rays that one thread answers in one go.
const BATCH: usize = 64;

/// The exact answers to a ray.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Answer {
    pub(super) closest: Option<Closest>,
    /// Triangle and rounded `t` of the crossings, in their order.
    pub(super) crossings: Box<[(u32, f32)]>,
}

/// An exact closest hit, rounded to numbers that are quick to compare with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closest {
    /// The triangle's index in the mesh.
    pub triangle: u32,
    /// `t`, correctly rounded to f32.
    pub rounded_t: f32,
    /// `t`, correctly rounded to f64, as are the weights.
    pub t: f64,
    pub(super) u: f64,
    pub(super) v: f64,
}

impl Closest {
    /// Rounds an exact hit.
    #[must_use]
    pub fn new(hit: &ExactHit) -> Self {
        let [t, u, v] = [&hit.t, &hit.u, &hit.v].map(|exact| exact.to_f64().value());
        Self {
            triangle: hit.triangle,
            rounded_t: hit.rounded_t(),
            t,
            u,
            v,
        }
    }

    /// How far a `t` is from the exact one, in units in the last place of the exact one, correct to `2^-28` of such a unit. An exact `t` beyond the
    /// largest f32 counts as that. Infinite for a `t` that is not finite.
    #[must_use]
    pub fn t_error_in_ulps(&self, t: f32) -> f64 {
        if !t.is_finite() {
            return f64::INFINITY;
        }
        let exact = self.t.clamp(f32::MIN.into(), f32::MAX.into());
        #[expect(clippy::cast_possible_truncation, reason = "rounds to the nearest f32")]
        let nearest = exact.abs() as f32;
        let is_above = f64::from(nearest) > exact.abs() || nearest == f32::MAX;
        let below = if is_above {
            nearest.next_down()
        } else {
            nearest
        };
        let ulp = f64::from(below.next_up()) - f64::from(below);
        (f64::from(t) - exact).abs() / ulp
    }
}

/// Computes the answers to all rays, in their order, and tells `advance` of each batch that is done.
pub(super) fn answers(
    oracle: &Oracle,
    rays: &[Ray],
    advance: &(dyn Fn(u64) + Sync),
) -> Vec<Answer> {
    let batches = rays.par_chunks(BATCH).flat_map_iter(|batch| {
        let answers: Vec<Answer> = batch.iter().map(|ray| answer(oracle, ray)).collect();
        advance(batch.len() as u64);
        answers
    });
    batches.collect()
}

fn answer(oracle: &Oracle, ray: &Ray) -> Answer {
    let crossings = oracle.crossings(ray).into_iter();
    Answer {
        closest: oracle.closest_hit(ray).as_ref().map(Closest::new),
        crossings: crossings
            .map(|hit| (hit.triangle, hit.rounded_t()))
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use tahko_geometry::oracle::RBig;

    use super::*;

    #[test]
    fn errors_of_t_are_those_of_the_oracle() {
        let ratio = |numerator: i64, power: i32| {
            RBig::from_parts(numerator.into(), 3u8.into())
                * RBig::try_from(2f64.powi(power)).unwrap()
        };
        let exact = [
            ratio(1, 0),
            ratio(-100, 20),
            ratio(3, 0),
            ratio(0, 0),
            ratio(5, -150),
            ratio(1, 130),
            ratio(-1, 130),
        ];
        for t in exact {
            let hit = ExactHit {
                u: RBig::ZERO,
                v: RBig::ZERO,
                triangle: 0,
                t,
            };
            let closest = Closest::new(&hit);
            let rounded = hit.rounded_t();
            for t in [rounded, rounded.next_up(), rounded.next_down(), f32::NAN] {
                let (error, expected) = (closest.t_error_in_ulps(t), hit.t_error_in_ulps(t));
                assert!(
                    error == expected || (error - expected).abs() < 2f64.powi(-28),
                    "{t} {}: {error} {expected}",
                    hit.t
                );
            }
        }
    }
}
