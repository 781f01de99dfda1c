//! The query trait that all structures share, and what traversals need to serve it.

use std::ops::ControlFlow;

use crate::{MollerTrumbore, Precision, Ray, TriangleHit, TriangleKernel, Woop};

/// The hit of a ray on a primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Parameter along the ray, in lengths of the ray's direction.
    pub t: f32,
    /// Weight of the triangle's second vertex, in `[0, 1]`.
    pub u: f32,
    /// Weight of the triangle's third vertex, in `[0, 1 - u]`.
    pub v: f32,
    /// The triangle's index in the mesh that the structure was built from.
    pub primitive: u32,
}

/// Ray queries against a set of triangles.
///
/// All structures give equal answers, bit for bit, at the same [`Precision`]. A ray that is not
/// [valid](Ray::is_valid) hits nothing. The closest hit is the one with the smallest `t`; where several
/// triangles are hit at the same `t`, it is the one with the smallest index.
pub trait RayQuery: Sync {
    /// The closest hit with `t` in the ray's interval.
    fn closest_hit(&self, ray: &Ray) -> Option<Hit>;

    /// Whether anything is hit with `t` in the ray's interval; cheaper than the closest hit.
    fn any_hit(&self, ray: &Ray) -> bool;

    /// The closest hits of many rays; `hits[i]` answers `rays[i]`.
    ///
    /// # Panics
    /// If the slices differ in length.
    fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]);

    /// Whether anything is hit, for many rays; `hits[i]` answers `rays[i]`.
    ///
    /// # Panics
    /// If the slices differ in length.
    fn any_hits(&self, rays: &[Ray], hits: &mut [bool]);

    /// [`closest_hit`](Self::closest_hit), adding what it did to `counts`.
    fn closest_hit_counted(&self, ray: &Ray, counts: &mut QueryCounts) -> Option<Hit>;

    /// [`any_hit`](Self::any_hit), adding what it did to `counts`.
    fn any_hit_counted(&self, ray: &Ray, counts: &mut QueryCounts) -> bool;
}

/// What queries did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct QueryCounts {
    /// Nodes visited, leaves included.
    pub node_visits: u64,
    /// Tests of the ray against a box or a splitting plane.
    pub bound_tests: u64,
    /// Tests of the ray against a triangle.
    pub triangle_tests: u64,
}

impl std::ops::AddAssign for QueryCounts {
    fn add_assign(&mut self, other: Self) {
        self.node_visits += other.node_visits;
        self.bound_tests += other.bound_tests;
        self.triangle_tests += other.triangle_tests;
    }
}

/// Receives the events of a traversal. The unit type ignores them at no cost.
pub trait TraversalCounter {
    /// A node was visited.
    fn node_visit(&mut self);
    /// The ray was tested against `count` boxes or planes.
    fn bound_tests(&mut self, count: u64);
    /// The ray was tested against `count` triangles.
    fn triangle_tests(&mut self, count: u64);
}

impl TraversalCounter for () {
    #[inline]
    fn node_visit(&mut self) {}
    #[inline]
    fn bound_tests(&mut self, _count: u64) {}
    #[inline]
    fn triangle_tests(&mut self, _count: u64) {}
}

impl TraversalCounter for QueryCounts {
    #[inline]
    fn node_visit(&mut self) {
        self.node_visits += 1;
    }
    #[inline]
    fn bound_tests(&mut self, count: u64) {
        self.bound_tests += count;
    }
    #[inline]
    fn triangle_tests(&mut self, count: u64) {
        self.triangle_tests += count;
    }
}

/// What a query makes of the triangles that a traversal finds: the goal of the search.
pub trait HitCollector {
    /// The largest `t` that still matters. A traversal may skip whatever begins beyond it.
    fn t_max(&self) -> f32;

    /// Takes a hit with `t` not above [`t_max`](Self::t_max). `Break` ends the traversal.
    fn collect(&mut self, primitive: u32, hit: TriangleHit) -> ControlFlow<()>;
}

/// Collects the closest hit: smallest `t`, then smallest primitive.
#[derive(Clone, Copy, Debug)]
pub struct ClosestHit {
    t_max: f32,
    hit: Option<Hit>,
}

impl ClosestHit {
    /// A search up to the ray's `t_max`.
    #[must_use]
    pub const fn new(ray: &Ray) -> Self {
        Self {
            t_max: ray.t_max,
            hit: None,
        }
    }

    /// The closest hit so far.
    #[must_use]
    pub const fn hit(&self) -> Option<Hit> {
        self.hit
    }
}

impl HitCollector for ClosestHit {
    #[inline]
    fn t_max(&self) -> f32 {
        self.t_max
    }

    #[inline]
    fn collect(&mut self, primitive: u32, TriangleHit { t, u, v }: TriangleHit) -> ControlFlow<()> {
        let is_closer = self
            .hit
            .is_none_or(|best| t < best.t || (t == best.t && primitive < best.primitive));
        if is_closer {
            self.t_max = t;
            self.hit = Some(Hit { t, u, v, primitive });
        }
        ControlFlow::Continue(())
    }
}

/// Ends the traversal at the first hit that is found.
#[derive(Clone, Copy, Debug)]
pub struct AnyHit {
    t_max: f32,
    found: bool,
}

impl AnyHit {
    /// A search up to the ray's `t_max`.
    #[must_use]
    pub const fn new(ray: &Ray) -> Self {
        Self {
            t_max: ray.t_max,
            found: false,
        }
    }

    /// Whether a hit was found.
    #[must_use]
    pub const fn found(&self) -> bool {
        self.found
    }
}

impl HitCollector for AnyHit {
    #[inline]
    fn t_max(&self) -> f32 {
        self.t_max
    }

    #[inline]
    fn collect(&mut self, _primitive: u32, _hit: TriangleHit) -> ControlFlow<()> {
        self.found = true;
        ControlFlow::Break(())
    }
}

/// What a structure implements to become a [`RayQuery`]: one traversal, generic over the kernel, the goal
/// and the counter, so that each combination is compiled into a loop of its own.
pub trait Traverse: Sync {
    /// The precision that the structure was built for.
    fn precision(&self) -> Precision;

    /// Offers to `collector` every triangle that `ray` may hit with `t` in `[ray.t_min,
    /// collector.t_max()]` and that the kernel accepts. The ray is valid.
    fn traverse<K: TriangleKernel, H: HitCollector, C: TraversalCounter>(
        &self,
        ray: &Ray,
        collector: &mut H,
        counter: &mut C,
    );
}

/// Runs the traversal with the kernel of the structure's precision, if the ray is valid.
fn run<T, H, C>(structure: &T, ray: &Ray, mut collector: H, counter: &mut C) -> H
where
    T: Traverse + ?Sized,
    H: HitCollector,
    C: TraversalCounter,
{
    if ray.is_valid() {
        match structure.precision() {
            Precision::Fast => {
                structure.traverse::<MollerTrumbore, _, _>(ray, &mut collector, counter);
            }
            Precision::Watertight => structure.traverse::<Woop, _, _>(ray, &mut collector, counter),
        }
    }
    collector
}

impl<T: Traverse> RayQuery for T {
    fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        run(self, ray, ClosestHit::new(ray), &mut ()).hit()
    }

    fn any_hit(&self, ray: &Ray) -> bool {
        run(self, ray, AnyHit::new(ray), &mut ()).found()
    }

    fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        assert_eq!(rays.len(), hits.len(), "one hit per ray");
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.closest_hit(ray);
        }
    }

    fn any_hits(&self, rays: &[Ray], hits: &mut [bool]) {
        assert_eq!(rays.len(), hits.len(), "one hit per ray");
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.any_hit(ray);
        }
    }

    fn closest_hit_counted(&self, ray: &Ray, counts: &mut QueryCounts) -> Option<Hit> {
        run(self, ray, ClosestHit::new(ray), counts).hit()
    }

    fn any_hit_counted(&self, ray: &Ray, counts: &mut QueryCounts) -> bool {
        run(self, ray, AnyHit::new(ray), counts).found()
    }
}

/// Tests one triangle and offers a hit to the collector: the inner step of every traversal.
#[inline]
pub fn test_triangle<K: TriangleKernel, H: HitCollector>(
    kernel: &K,
    t_min: f32,
    triangle: &crate::Triangle,
    primitive: u32,
    collector: &mut H,
) -> ControlFlow<()> {
    match kernel.intersect(triangle, t_min, collector.t_max()) {
        Some(hit) => collector.collect(primitive, hit),
        None => ControlFlow::Continue(()),
    }
}
