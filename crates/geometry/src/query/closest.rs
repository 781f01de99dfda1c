//! The search for the closest hit.

use std::ops::ControlFlow;

use glam::Vec3A;

use super::collector::{Candidate, CertainHit, HitCollector, KnownHit, compare};
use super::{Hit, RaySearch, TraversalCounter, test_filtered};
use crate::kernel::{HitLanes, VertexLanes};
use crate::predicate::Rung;
use crate::simd::{LANES, Simd, lanes_of};
use crate::{Interval, Ray, RayLanes, Triangle, TriangleHit, TriangleKernel};

/// Collects the closest hit: smallest `t`, then smallest primitive.
///
/// Of a hit that is certain, `t`, `u` and `v` are computed only where its order with another one is not, and at the end for the
/// closest one.
#[derive(Clone, Copy, Debug)]
pub struct ClosestHit {
    t_max: f32,
    ignored: Option<u32>,
    /// What is known of the best hit so far. The fields that follow are written one by one, from registers: as a value that is moved they would be
    /// read back in other widths than they were written in, for which processors wait.
    best: Best,
    primitive: u32,
    /// Where `t` is; both ends are `t` for a hit that is known.
    t: Interval,
    u: f32,
    v: f32,
    vertices: [Vec3A; 3],
}

/// What is known of the best hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Best {
    /// There is none.
    None,
    /// All.
    Known,
    /// That it is one, and where `t` is.
    Certain,
}

impl ClosestHit {
    /// The same search without one primitive.
    #[must_use]
    pub const fn ignoring(self, primitive: u32) -> Self {
        Self {
            ignored: Some(primitive),
            ..self
        }
    }

    fn triangle(&self) -> Triangle {
        Triangle::from_vertices(&self.vertices)
    }

    #[inline(always)]
    fn known_hit(&self) -> Hit {
        Hit {
            t: self.t.end,
            u: self.u,
            v: self.v,
            primitive: self.primitive,
        }
    }

    #[inline(always)]
    fn keep_known(&mut self, primitive: u32, hit: TriangleHit) {
        self.best = Best::Known;
        self.primitive = primitive;
        self.t = Interval {
            start: hit.t,
            end: hit.t,
        };
        self.t_max = hit.t;
        self.u = hit.u;
        self.v = hit.v;
    }

    /// The best hit, which is certain.
    #[inline(always)]
    fn compute<S: Simd, K: TriangleKernel, C: TraversalCounter>(
        &self,
        simd: S,
        ray: &Ray,
        counter: &mut C,
    ) -> Option<Hit> {
        let hit = K::intersect_certain(simd, ray, &self.vertices, counter);
        debug_assert!(hit.is_some(), "the triangle is certainly hit");
        hit.map(|TriangleHit { t, u, v }| Hit {
            t,
            u,
            v,
            primitive: self.primitive,
        })
    }

    /// Computes the best hit if that was put off.
    fn resolve<K: TriangleKernel, C: TraversalCounter>(&mut self, kernel: &K, counter: &mut C) {
        if self.best == Best::Certain {
            let hit = kernel.intersect_filtered(&self.triangle(), f32::INFINITY, counter);
            debug_assert!(hit.is_some(), "the triangle is certainly hit");
            if let Some(hit) = hit {
                self.keep_known(self.primitive, hit);
            }
        }
    }

    /// For hits whose order `t` alone does not settle for certain.
    #[cold]
    #[inline(never)]
    fn collect_both<K: TriangleKernel, C: TraversalCounter>(
        &mut self,
        ray: &Ray,
        certain: &CertainHit,
        counter: &mut C,
    ) -> ControlFlow<()> {
        let kernel = K::new(ray);
        self.resolve(&kernel, counter);
        test_filtered(
            &kernel,
            &certain.triangle(),
            certain.primitive,
            self,
            counter,
        )
    }

    /// For hits that are ignored, or not certainly closer than the best one.
    #[cold]
    #[inline(never)]
    fn collect_with_kernel<K: TriangleKernel, C: TraversalCounter>(
        &mut self,
        ray: &Ray,
        candidate: &Candidate<'_>,
        counter: &mut C,
    ) -> ControlFlow<()> {
        self.collect(&K::new(ray), candidate, counter)
    }
}

impl HitCollector for ClosestHit {
    type Answer = Option<Hit>;

    const ORDERED: bool = true;

    #[inline]
    fn new(ray: &Ray) -> Self {
        Self {
            t_max: ray.t_max,
            ignored: None,
            best: Best::None,
            primitive: 0,
            t: Interval {
                start: f32::INFINITY,
                end: f32::INFINITY,
            },
            u: 0.0,
            v: 0.0,
            vertices: [Vec3A::ZERO; 3],
        }
    }

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
        if candidate.hit.t >= self.t.start {
            self.resolve(kernel, counter);
        }
        let is_closer = match self.best {
            Best::None => true,
            // The candidate begins before it.
            Best::Certain => {
                counter.decisions(Rung::F32, 1);
                true
            }
            Best::Known => compare(
                kernel,
                (&candidate.hit(), candidate.triangle),
                (&self.known_hit(), &self.triangle()),
                counter,
            )
            .is_lt(),
        };
        if is_closer {
            self.keep_known(candidate.primitive, candidate.hit);
            self.vertices = candidate.triangle.vertices().map(Vec3A::from);
        }
        ControlFlow::Continue(())
    }

    #[inline(always)]
    fn collect_certain<K: TriangleKernel, C: TraversalCounter>(
        &mut self,
        ray: &Ray,
        certain: &CertainHit,
        counter: &mut C,
    ) -> ControlFlow<()> {
        let is_known = self.best != Best::None && self.primitive == certain.primitive;
        if is_known || certain.t.start > self.t.end || self.ignored == Some(certain.primitive) {
            counter.decisions(Rung::F32, 1);
        } else if certain.t.end < self.t.start {
            counter.decisions(Rung::F32, u64::from(self.best == Best::Certain));
            self.best = Best::Certain;
            self.primitive = certain.primitive;
            self.t = certain.t;
            self.t_max = certain.t.end;
            self.vertices = certain.vertices;
        } else {
            // A copy: what the call can see would have to be in memory on the way to it.
            let [a, b, c] = certain.vertices;
            let vertices = [a, b, c];
            let copy = CertainHit {
                vertices,
                ..*certain
            };
            return self.collect_both::<K, C>(ray, &copy, counter);
        }
        ControlFlow::Continue(())
    }

    #[inline(always)]
    fn collect_known<K: TriangleKernel, C: TraversalCounter>(
        &mut self,
        ray: &Ray,
        known: &KnownHit,
        counter: &mut C,
    ) -> ControlFlow<()> {
        let is_ignored = self.ignored == Some(known.primitive);
        if is_ignored || known.hit.t >= self.t.start {
            // Copies, as of certain hits.
            let [a, b, c] = known.vertices;
            let candidate = Candidate {
                primitive: known.primitive,
                triangle: &Triangle::from_vertices(&[a, b, c]),
                hit: known.hit,
            };
            return self.collect_with_kernel::<K, C>(ray, &candidate, counter);
        }
        counter.decisions(Rung::F32, u64::from(self.best == Best::Certain));
        self.keep_known(known.primitive, known.hit);
        self.vertices = known.vertices;
        ControlFlow::Continue(())
    }

    #[inline(always)]
    fn finish<S: Simd, K: TriangleKernel, C: TraversalCounter>(
        &mut self,
        simd: S,
        ray: &Ray,
        counter: &mut C,
    ) -> Option<Hit> {
        match self.best {
            Best::None => None,
            Best::Known => Some(self.known_hit()),
            Best::Certain => self.compute::<S, K, C>(simd, ray, counter),
        }
    }

    #[inline(always)]
    fn finish_lanes<S: Simd, K: TriangleKernel>(
        simd: S,
        rays: &RayLanes,
        searches: &mut [RaySearch<'_, Self>; LANES],
        lanes: u32,
        mut answer: impl FnMut(usize, Option<Hit>),
    ) {
        let mut found = lanes_of(lanes).map(|lane| &searches[lane].collector);
        let hits = if found.any(|found| found.best == Best::Certain) {
            K::intersect_certain_lanes(simd, rays, &vertices_of(simd, searches))
        } else {
            HitLanes::UNKNOWN
        };
        for lane in lanes_of(lanes) {
            let RaySearch { ray, collector } = &mut searches[lane];
            let is_known = collector.best == Best::Certain && hits.known >> lane & 1 != 0;
            let hit = if is_known {
                let TriangleHit { t, u, v } = hits.hit(lane);
                Some(Hit {
                    t,
                    u,
                    v,
                    primitive: collector.primitive,
                })
            } else {
                collector.finish::<S, K, ()>(simd, ray, &mut ())
            };
            answer(lane, hit);
        }
    }
}

/// The vertices of the best hits; anything, if there is none.
#[inline(always)]
fn vertices_of<S: Simd>(simd: S, searches: &[RaySearch<'_, ClosestHit>; LANES]) -> VertexLanes {
    let [a, b, c, d, e, f, g, h] = searches;
    let first_two = simd.transpose([
        first_two_vertices(simd, a),
        first_two_vertices(simd, b),
        first_two_vertices(simd, c),
        first_two_vertices(simd, d),
        first_two_vertices(simd, e),
        first_two_vertices(simd, f),
        first_two_vertices(simd, g),
        first_two_vertices(simd, h),
    ]);
    let third = simd.transpose([
        third_vertex(simd, a),
        third_vertex(simd, b),
        third_vertex(simd, c),
        third_vertex(simd, d),
        third_vertex(simd, e),
        third_vertex(simd, f),
        third_vertex(simd, g),
        third_vertex(simd, h),
    ]);
    let [ax, ay, az, _, bx, by, bz, _] = first_two;
    let [cx, cy, cz, ..] = third;
    [
        [simd.store(ax), simd.store(ay), simd.store(az)],
        [simd.store(bx), simd.store(by), simd.store(bz)],
        [simd.store(cx), simd.store(cy), simd.store(cz)],
    ]
}

// No closures: those that are called more than once are not inlined, and then compiled without the instructions of the level.
#[inline(always)]
fn first_two_vertices<S: Simd>(simd: S, search: &RaySearch<'_, ClosestHit>) -> S::F32s {
    let [a, b, _] = &search.collector.vertices;
    simd.halves(a.extend(0.0).to_array(), b.extend(0.0).to_array())
}

#[inline(always)]
fn third_vertex<S: Simd>(simd: S, search: &RaySearch<'_, ClosestHit>) -> S::F32s {
    let [.., c] = &search.collector.vertices;
    simd.halves(c.extend(0.0).to_array(), [0.0; LANES / 2])
}
