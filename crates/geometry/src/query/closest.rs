//! The search for the closest hit.

use std::ops::ControlFlow;

use super::collector::{Candidate, CertainHit, HitCollector, compare};
use super::{Hit, TraversalCounter, offer_triangle};
use crate::predicate::Rung;
use crate::{Ray, Triangle, TriangleHit, TriangleKernel};

/// Collects the closest hit: smallest `t`, then smallest primitive.
///
/// Of a hit that is certain, `t`, `u` and `v` are computed only where its order with another one is not, and at the end for the
/// closest one.
#[derive(Clone, Copy, Debug)]
pub struct ClosestHit {
    t_max: f32,
    ignored: Option<u32>,
    best: Best,
}

#[derive(Clone, Copy, Debug)]
enum Best {
    None,
    Known(Hit, Triangle),
    Certain(CertainHit),
}

impl ClosestHit {
    /// A search up to the ray's `t_max`.
    #[must_use]
    pub const fn new(ray: &Ray) -> Self {
        Self {
            t_max: ray.t_max,
            ignored: None,
            best: Best::None,
        }
    }

    /// The same search without one primitive.
    #[must_use]
    pub const fn ignoring(self, primitive: u32) -> Self {
        Self {
            ignored: Some(primitive),
            ..self
        }
    }

    #[inline]
    fn keep_certain(&mut self, certain: &CertainHit) {
        self.t_max = certain.t.end;
        self.best = Best::Certain(*certain);
    }

    /// Computes the best hit if that was put off.
    #[inline]
    fn resolve<K: TriangleKernel, C: TraversalCounter>(&mut self, kernel: &K, counter: &mut C) {
        if let Best::Certain(certain) = self.best
            && let Some(hit) = known(&certain, kernel, counter)
        {
            self.t_max = hit.t;
            self.best = Best::Known(hit, certain.triangle());
        }
    }

    /// For hits whose order `t` alone does not settle for certain.
    #[cold]
    #[inline(never)]
    fn collect_both<K: TriangleKernel, C: TraversalCounter>(
        &mut self,
        kernel: &K,
        certain: &CertainHit,
        counter: &mut C,
    ) -> ControlFlow<()> {
        self.resolve(kernel, counter);
        offer_triangle(
            kernel,
            &certain.triangle(),
            certain.primitive,
            self,
            counter,
        )
    }
}

impl HitCollector for ClosestHit {
    type Answer = Option<Hit>;

    const ORDERED: bool = true;

    #[inline]
    fn t_max(&self) -> f32 {
        self.t_max
    }

    #[inline]
    fn collect<K: TriangleKernel, C: TraversalCounter>(
        &mut self,
        kernel: &K,
        candidate: &Candidate<'_>,
        counter: &mut C,
    ) -> ControlFlow<()> {
        if self.ignored == Some(candidate.primitive) {
            return ControlFlow::Continue(());
        }
        if let Best::Certain(best) = &self.best
            && candidate.hit.t >= best.t.start
        {
            self.resolve(kernel, counter);
        }
        let is_closer = match &self.best {
            Best::None => true,
            // The candidate begins before it.
            Best::Certain(_) => {
                counter.decisions(Rung::F32, 1);
                true
            }
            Best::Known(best, triangle) => compare(
                kernel,
                (&candidate.hit(), candidate.triangle),
                (best, triangle),
                counter,
            )
            .is_lt(),
        };
        if is_closer {
            self.t_max = candidate.hit.t;
            self.best = Best::Known(candidate.hit(), *candidate.triangle);
        }
        ControlFlow::Continue(())
    }

    #[inline]
    fn collect_certain<K: TriangleKernel, C: TraversalCounter>(
        &mut self,
        kernel: &K,
        certain: &CertainHit,
        counter: &mut C,
    ) -> ControlFlow<()> {
        let (best, start, end) = match &self.best {
            Best::None => (None, f32::INFINITY, f32::INFINITY),
            Best::Known(best, _) => (Some(best.primitive), best.t, best.t),
            Best::Certain(best) => (Some(best.primitive), best.t.start, best.t.end),
        };
        let is_certain = matches!(self.best, Best::Certain(_));
        if self.ignored == Some(certain.primitive)
            || best == Some(certain.primitive)
            || certain.t.start > end
        {
            counter.decisions(Rung::F32, 1);
        } else if best.is_none() || certain.t.end < start {
            counter.decisions(Rung::F32, u64::from(is_certain));
            self.keep_certain(certain);
        } else {
            return self.collect_both(kernel, certain, counter);
        }
        ControlFlow::Continue(())
    }

    #[inline(always)]
    fn finish<K: TriangleKernel, C: TraversalCounter>(
        self,
        ray: &Ray,
        counter: &mut C,
    ) -> Option<Hit> {
        match &self.best {
            Best::None => None,
            Best::Known(hit, _) => Some(*hit),
            Best::Certain(certain) => known(certain, &K::new(ray), counter),
        }
    }
}

/// The hit of a triangle that is certainly hit.
#[inline(always)]
fn known<K: TriangleKernel, C: TraversalCounter>(
    certain: &CertainHit,
    kernel: &K,
    counter: &mut C,
) -> Option<Hit> {
    let hit = kernel.intersect_certain(&certain.triangle(), counter);
    debug_assert!(hit.is_some(), "the triangle is certainly hit");
    hit.map(|TriangleHit { t, u, v }| Hit {
        t,
        u,
        v,
        primitive: certain.primitive,
    })
}
