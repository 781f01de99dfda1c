//! The search for the closest hit.

use std::ops::ControlFlow;

use super::collector::{Candidate, CertainHit, HitCollector, compare};
use super::{Hit, TraversalCounter};
use crate::predicate::Rung;
use crate::{Ray, Triangle, TriangleKernel};

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

    /// The closest hit of a traversal that is [finished](HitCollector::finish).
    #[must_use]
    pub fn hit(&self) -> Option<Hit> {
        match self.best {
            Best::Known(hit, _) => Some(hit),
            Best::None => None,
            Best::Certain(_) => {
                debug_assert!(false, "a traversal that offers certain hits finishes");
                None
            }
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
        let Best::Certain(certain) = self.best else {
            return;
        };
        let CertainHit {
            primitive,
            triangle,
            t,
        } = certain;
        let hit = kernel.intersect_certain(&triangle, counter);
        debug_assert!(hit.is_some(), "the triangle is certainly hit");
        self.best = hit.map_or(Best::None, |hit| {
            let candidate = Candidate {
                primitive,
                triangle: &triangle,
                hit,
            };
            Best::Known(candidate.hit(), triangle)
        });
        self.t_max = hit.map_or(t.end, |hit| hit.t);
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
        let CertainHit {
            primitive,
            triangle,
            ..
        } = certain;
        match kernel.intersect(triangle, self.t_max, counter) {
            Some(hit) => {
                let candidate = Candidate {
                    primitive: *primitive,
                    triangle,
                    hit,
                };
                self.collect(kernel, &candidate, counter)
            }
            None => ControlFlow::Continue(()),
        }
    }
}

impl HitCollector for ClosestHit {
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

    #[inline]
    fn finish<K: TriangleKernel, C: TraversalCounter>(&mut self, kernel: &K, counter: &mut C) {
        self.resolve(kernel, counter);
    }
}
