//! What a query makes of the triangles that a traversal finds.

use std::cmp::Ordering;
use std::ops::ControlFlow;

use super::{Hit, RaySearch, TraversalCounter, test_filtered};
use glam::Vec3A;

use crate::predicate::Rung;
use crate::simd::{LANES, Simd, lanes_of};
use crate::{Interval, Ray, RayLanes, Triangle, TriangleHit, TriangleKernel};

/// A triangle that a kernel accepted.
#[derive(Clone, Copy, Debug)]
pub struct Candidate<'a> {
    /// Its index in the mesh.
    pub primitive: u32,
    /// The triangle.
    pub triangle: &'a Triangle,
    /// Where the ray meets it.
    pub hit: TriangleHit,
}

impl Candidate<'_> {
    pub(super) fn hit(&self) -> Hit {
        let TriangleHit { t, u, v } = self.hit;
        Hit {
            t,
            u,
            v,
            primitive: self.primitive,
        }
    }
}

/// A triangle that is certainly hit.
#[derive(Clone, Copy, Debug)]
pub struct CertainHit {
    /// Its index in the mesh.
    pub primitive: u32,
    /// The triangle's vertices, each in a register's place: single coordinates that are written and read as vectors would be slow.
    pub vertices: [Vec3A; 3],
    /// Where the exact `t` is for certain.
    pub t: Interval,
}

impl CertainHit {
    /// The triangle.
    #[inline(always)]
    #[must_use]
    pub fn triangle(&self) -> Triangle {
        Triangle::from_vertices(&self.vertices)
    }
}

/// A hit that is known, of a triangle given by its vertices.
#[derive(Clone, Copy, Debug)]
pub struct KnownHit {
    /// The triangle's index in the mesh.
    pub primitive: u32,
    /// The triangle's vertices, each in a register's place.
    pub vertices: [Vec3A; 3],
    /// Where the ray meets it.
    pub hit: TriangleHit,
}

/// The goal of a search.
pub trait HitCollector: Sized {
    /// What a search finds.
    type Answer;

    /// Whether the search is over sooner if what is nearer comes first.
    const ORDERED: bool;

    /// A search up to the ray's `t_max`.
    fn new(ray: &Ray) -> Self;

    /// The largest rounded `t` that still matters. A traversal may skip whatever begins beyond it.
    fn t_max(&self) -> f32;

    /// Takes a hit with `t` not above [`t_max`](Self::t_max); the same triangle may come more than once. `Break` ends the
    /// traversal.
    fn collect<K: TriangleKernel, C: TraversalCounter>(
        &mut self,
        kernel: &K,
        candidate: &Candidate<'_>,
        counter: &mut C,
    ) -> ControlFlow<()>;

    /// Takes a triangle that is certainly hit, at a `t` inside the ray's interval that is known only roughly so far; the same triangle may come more
    /// than once. `Break` ends the traversal.
    ///
    /// A collector may put off what it takes to know the hit, or do without; then it wants [`finish`](Self::finish).
    #[inline]
    fn collect_certain<K: TriangleKernel, C: TraversalCounter>(
        &mut self,
        ray: &Ray,
        certain: &CertainHit,
        counter: &mut C,
    ) -> ControlFlow<()> {
        test_filtered(
            &K::new(ray),
            &certain.triangle(),
            certain.primitive,
            self,
            counter,
        )
    }

    /// [`collect`](Self::collect) where there is no kernel yet: most hits do without.
    #[inline]
    fn collect_known<K: TriangleKernel, C: TraversalCounter>(
        &mut self,
        ray: &Ray,
        known: &KnownHit,
        counter: &mut C,
    ) -> ControlFlow<()> {
        let candidate = Candidate {
            primitive: known.primitive,
            triangle: &Triangle::from_vertices(&known.vertices),
            hit: known.hit,
        };
        self.collect(&K::new(ray), &candidate, counter)
    }

    /// What the search found, after all that was put off.
    fn finish<S: Simd, K: TriangleKernel, C: TraversalCounter>(
        &mut self,
        simd: S,
        ray: &Ray,
        counter: &mut C,
    ) -> Self::Answer;

    /// [`finish`](Self::finish) for the searches of some lanes, a bit for each.
    #[inline(always)]
    fn finish_lanes<S: Simd, K: TriangleKernel>(
        simd: S,
        _rays: &RayLanes,
        searches: &mut [RaySearch<'_, Self>; LANES],
        lanes: u32,
        mut answer: impl FnMut(usize, Self::Answer),
    ) {
        for lane in lanes_of(lanes) {
            let search = &mut searches[lane];
            answer(
                lane,
                search
                    .collector
                    .finish::<S, K, ()>(simd, search.ray, &mut ()),
            );
        }
    }
}

/// The order of hits along a ray: by `t`, then by primitive.
#[inline]
pub(super) fn compare<K: TriangleKernel, C: TraversalCounter>(
    kernel: &K,
    first: (&Hit, &Triangle),
    second: (&Hit, &Triangle),
    counter: &mut C,
) -> Ordering {
    if first.0.t < second.0.t {
        return Ordering::Less;
    }
    if first.0.t > second.0.t {
        return Ordering::Greater;
    }
    if first.0.primitive == second.0.primitive {
        return Ordering::Equal;
    }
    let by_t = kernel.order_of_equal_t(first.1, second.1, counter);
    by_t.then_with(|| first.0.primitive.cmp(&second.0.primitive))
}

/// Ends the traversal at the first hit that is found.
#[derive(Clone, Copy, Debug)]
pub struct AnyHit {
    t_max: f32,
    ignored: Option<u32>,
    found: bool,
}

impl AnyHit {
    /// The same search without one primitive.
    #[must_use]
    pub const fn ignoring(self, primitive: u32) -> Self {
        Self {
            ignored: Some(primitive),
            ..self
        }
    }
}

impl HitCollector for AnyHit {
    type Answer = bool;

    const ORDERED: bool = false;

    #[inline]
    fn new(ray: &Ray) -> Self {
        Self {
            t_max: ray.t_max,
            ignored: None,
            found: false,
        }
    }

    #[inline]
    fn t_max(&self) -> f32 {
        self.t_max
    }

    #[inline]
    fn collect<K: TriangleKernel, C: TraversalCounter>(
        &mut self,
        _kernel: &K,
        candidate: &Candidate<'_>,
        _counter: &mut C,
    ) -> ControlFlow<()> {
        if self.ignored == Some(candidate.primitive) {
            return ControlFlow::Continue(());
        }
        self.found = true;
        ControlFlow::Break(())
    }

    #[inline]
    fn collect_certain<K: TriangleKernel, C: TraversalCounter>(
        &mut self,
        _ray: &Ray,
        certain: &CertainHit,
        counter: &mut C,
    ) -> ControlFlow<()> {
        counter.decisions(Rung::F32, 1);
        if self.ignored == Some(certain.primitive) {
            return ControlFlow::Continue(());
        }
        self.found = true;
        ControlFlow::Break(())
    }

    #[inline(always)]
    fn finish<S: Simd, K: TriangleKernel, C: TraversalCounter>(
        &mut self,
        _simd: S,
        _ray: &Ray,
        _counter: &mut C,
    ) -> bool {
        self.found
    }
}

/// Collects all hits, each triangle once.
#[derive(Clone, Debug)]
pub struct AllHits {
    t_max: f32,
    hits: Vec<(Hit, Triangle)>,
}

impl AllHits {
    /// The hits in their order along the ray: by `t`, then by primitive.
    pub fn into_sorted<K: TriangleKernel>(mut self, kernel: &K) -> impl Iterator<Item = Hit> {
        self.hits
            .sort_unstable_by(|(first, first_triangle), (second, second_triangle)| {
                compare(
                    kernel,
                    (first, first_triangle),
                    (second, second_triangle),
                    &mut (),
                )
            });
        self.hits.dedup_by_key(|(hit, _)| hit.primitive);
        self.hits.into_iter().map(|(hit, _)| hit)
    }

    /// How many triangles were hit.
    #[must_use]
    pub fn count(mut self) -> usize {
        self.hits.sort_unstable_by_key(|(hit, _)| hit.primitive);
        self.hits.dedup_by_key(|(hit, _)| hit.primitive);
        self.hits.len()
    }
}

impl HitCollector for AllHits {
    /// The collector has the hits.
    type Answer = ();

    const ORDERED: bool = false;

    #[inline]
    fn new(ray: &Ray) -> Self {
        Self {
            t_max: ray.t_max,
            hits: Vec::new(),
        }
    }

    #[inline]
    fn t_max(&self) -> f32 {
        self.t_max
    }

    #[inline]
    fn collect<K: TriangleKernel, C: TraversalCounter>(
        &mut self,
        _kernel: &K,
        candidate: &Candidate<'_>,
        _counter: &mut C,
    ) -> ControlFlow<()> {
        self.hits.push((candidate.hit(), *candidate.triangle));
        ControlFlow::Continue(())
    }

    #[inline(always)]
    fn finish<S: Simd, K: TriangleKernel, C: TraversalCounter>(
        &mut self,
        _simd: S,
        _ray: &Ray,
        _counter: &mut C,
    ) {
    }
}
