//! Asks a structure and compares.

use std::ops::ControlFlow;

use rayon::prelude::*;
use tahko_tracer::geometry::{Hit, Ray, RayQuery};

use super::errors::{Errors, Mistake, Mistakes, Tally};
use super::rays::RayKind;
use super::reference::{Answer, Closest};

/// Rays that one thread asks in one go, also as a batch. A multiple of the number of kinds.
const BATCH: usize = 64 * RayKind::ALL.len();

/// Queries per ray: closest hit and any hit, each alone and in a batch, and twice all crossings.
pub(super) const QUERIES_PER_RAY: u64 = 6;

/// How far the weights of a hit may be from the exact ones: two units in the last place of 1.
const WEIGHT_TOLERANCE: f64 = 2.0 * f32::EPSILON as f64;

/// A ray that a structure answered wrongly.
#[derive(Clone, Debug, PartialEq)]
pub struct Example {
    /// The ray.
    pub ray: Ray,
    /// Its kind.
    pub kind: RayKind,
    /// What is wrong with the answers.
    pub mistakes: Vec<Mistake>,
    /// Triangle and `t` of the exact closest hit, rounded to f32.
    pub exact: Option<(u32, f32)>,
    /// The closest hit that the structure gave.
    pub given: Option<Hit>,
}

/// What was found about a structure.
pub(super) struct Examined {
    pub(super) kinds: Vec<Errors>,
    pub(super) all: Errors,
    pub(super) example: Option<Example>,
}

/// Asks a structure all rays, and tells `advance` of each batch that is done.
pub(super) fn examine(
    query: &dyn RayQuery,
    rays: &[Ray],
    answers: &[Answer],
    has_crossings: bool,
    advance: &(dyn Fn(u64) + Sync),
) -> Examined {
    let batches = rays.par_chunks(BATCH).zip(answers.par_chunks(BATCH));
    let batches = batches.map(|(rays, answers)| {
        let examined = Batch::examine(query, rays, answers, has_crossings);
        advance(rays.len() as u64);
        examined
    });
    let whole =
        batches
            .collect::<Vec<_>>()
            .into_iter()
            .fold(Batch::default(), |mut whole, batch| {
                whole.merge(batch);
                whole
            });
    let mut all = Tally::default();
    for tally in &whole.kinds {
        all.merge(tally);
    }
    Examined {
        kinds: whole.kinds.into_iter().map(Tally::finish).collect(),
        all: all.finish(),
        example: whole.example,
    }
}

/// What was found about some rays.
#[derive(Default)]
struct Batch {
    kinds: [Tally; RayKind::ALL.len()],
    example: Option<Example>,
}

impl Batch {
    fn examine(
        query: &dyn RayQuery,
        rays: &[Ray],
        answers: &[Answer],
        has_crossings: bool,
    ) -> Self {
        let mut hits = vec![None; rays.len()];
        query.closest_hits(rays, &mut hits);
        let mut any = vec![false; rays.len()];
        query.any_hits(rays, &mut any);
        let mut found = Self::default();
        for (index, (ray, answer)) in rays.iter().zip(answers).enumerate() {
            let kind = RayKind::of_place(index);
            let exact = answer.closest.as_ref();
            let given = query.closest_hit(ray);
            let any_hit = query.any_hit(ray);
            let (mut mistakes, t_error) = compare(given.as_ref(), exact);
            let is_half_line = ray.t_min == 0.0 && ray.t_max == f32::INFINITY;
            let starts_inside = is_half_line && answer.crossings.len() % 2 == 1;
            mistakes.add_if(given.is_none() && starts_inside, Mistake::Leak);
            mistakes.add_if(any_hit != exact.is_some(), Mistake::AnyHit);
            let same_in_batch = bits(given) == bits(hits[index]) && any_hit == any[index];
            mistakes.add_if(!same_in_batch, Mistake::Batch);
            if has_crossings {
                let are_right = crossings_are_right(query, ray, &answer.crossings);
                mistakes.add_if(!are_right, Mistake::Crossings);
            }
            found.kinds[kind as usize].add(exact.is_some(), mistakes, t_error);
            if found.example.is_none() && mistakes != Mistakes::default() {
                found.example = Some(Example {
                    ray: *ray,
                    kind,
                    mistakes: mistakes.iter().collect(),
                    exact: exact.map(|exact| (exact.triangle, exact.rounded_t)),
                    given,
                });
            }
        }
        found
    }

    /// Adds what was found about rays that come later.
    fn merge(&mut self, later: Self) {
        for (tally, later) in self.kinds.iter_mut().zip(&later.kinds) {
            tally.merge(later);
        }
        self.example = self.example.take().or(later.example);
    }
}

/// The mistakes of a closest hit, and the error of `t` where the triangle is right.
fn compare(given: Option<&Hit>, exact: Option<&Closest>) -> (Mistakes, Option<f64>) {
    let mut mistakes = Mistakes::default();
    mistakes.add_if(given.is_some() && exact.is_none(), Mistake::FalseHit);
    mistakes.add_if(given.is_none() && exact.is_some(), Mistake::FalseMiss);
    let (Some(given), Some(exact)) = (given, exact) else {
        return (mistakes, None);
    };
    if given.primitive != exact.triangle {
        mistakes.add_if(true, Mistake::WrongTriangle);
        return (mistakes, None);
    }
    let is_exact = given.t.to_bits() == exact.rounded_t.to_bits();
    mistakes.add_if(!is_exact, Mistake::InexactT);
    mistakes.add_if(!weights_are_right(given, exact), Mistake::InexactWeights);
    (mistakes, Some(exact.t_error_in_ulps(given.t)))
}

/// Whether the weights are in the triangle and near the exact ones. NaN is neither.
fn weights_are_right(given: &Hit, exact: &Closest) -> bool {
    let (u, v) = (f64::from(given.u), f64::from(given.v));
    let is_near = |weight: f64, exact: f64| (weight - exact).abs() <= WEIGHT_TOLERANCE;
    u >= 0.0 && v >= 0.0 && u + v <= 1.0 && is_near(u, exact.u) && is_near(v, exact.v)
}

/// A hit by its bits, so that NaN equals itself and 0 differs from -0.
fn bits(hit: Option<Hit>) -> Option<(u32, [u32; 3])> {
    hit.map(|Hit { t, u, v, primitive }| (primitive, [t, u, v].map(f32::to_bits)))
}

/// Whether all crossings come in their order, each with the exact `t`, and their number is right.
fn crossings_are_right(query: &dyn RayQuery, ray: &Ray, expected: &[(u32, f32)]) -> bool {
    let mut remaining = expected.iter();
    let mut are_equal = true;
    query.all_hits(ray, &mut |hit| {
        are_equal &= remaining.next().is_some_and(|(triangle, t)| {
            hit.primitive == *triangle && hit.t.to_bits() == t.to_bits()
        });
        if are_equal {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    });
    are_equal && remaining.next().is_none() && query.crossings(ray) == expected.len()
}
