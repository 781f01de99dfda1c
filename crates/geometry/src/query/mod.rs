//! The query trait that all structures share, and what traversals need to serve it.

mod closest;
mod collector;
mod counts;
mod packet;
mod searches;

use std::ops::ControlFlow;

use glam::Vec3;

pub use closest::ClosestHit;
pub use collector::{AllHits, AnyHit, Candidate, CertainHit, HitCollector, KnownHit};
pub use counts::{QueryCounts, RungCounts, TraversalCounter};
pub use packet::{RaysFilterOf, test_rays};
pub use searches::{RaySearch, RaySearches};

use crate::kernel::{
    BlockTest, BlockVerdict, Candidates, Exact, ExactCrossing, MollerTrumbore, Woop,
};
use crate::predicate::Rung;
use crate::simd::{Portable, Simd, lanes_of};
use crate::{Axis, Interval, Precision, Ray, TriangleBlock, TriangleHit, TriangleKernel};

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
    /// The precision of the answers.
    fn precision(&self) -> Precision;

    /// The closest hit with `t` in the ray's interval.
    fn closest_hit(&self, ray: &Ray) -> Option<Hit>;

    /// Whether anything is hit with `t` in the ray's interval; cheaper than the closest hit.
    fn any_hit(&self, ray: &Ray) -> bool;

    /// The closest hits of many rays; `hits[i]` answers `rays[i]`. A structure may work on several of them at a time; the answers are
    /// those of [`closest_hit`](Self::closest_hit).
    ///
    /// # Panics
    /// If the slices differ in length.
    fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]);

    /// Whether anything is hit, for many rays; `hits[i]` answers `rays[i]`. A structure may work on several of them at a time.
    ///
    /// # Panics
    /// If the slices differ in length.
    fn any_hits(&self, rays: &[Ray], hits: &mut [bool]);

    /// [`closest_hit`](Self::closest_hit), adding what it did to `counts`.
    fn closest_hit_counted(&self, ray: &Ray, counts: &mut QueryCounts) -> Option<Hit>;

    /// [`any_hit`](Self::any_hit), adding what it did to `counts`.
    fn any_hit_counted(&self, ray: &Ray, counts: &mut QueryCounts) -> bool;

    /// The closest hit on any primitive but one: that on which the ray starts, say.
    fn closest_hit_ignoring(&self, ray: &Ray, primitive: u32) -> Option<Hit>;

    /// Whether anything but one primitive is hit.
    fn any_hit_ignoring(&self, ray: &Ray, primitive: u32) -> bool;

    /// Visits the crossings of the ray with the triangles, in the order of their `t`, then of their primitives, until the visitor
    /// breaks.
    ///
    /// Each crossing of a closed surface comes once, also where the ray passes an edge or a vertex: there the ray counts as
    /// moved by an infinitesimal step, the same one for all triangles, so that it crosses one of those that
    /// share an edge, or two, or none. A triangle in whose plane the ray lies is not crossed.
    ///
    /// The answer is exact whatever the structure's [`Precision`]. Cost: all triangles along the ray are tested, and the hits
    /// sorted.
    fn all_hits(&self, ray: &Ray, visitor: &mut dyn FnMut(Hit) -> ControlFlow<()>);

    /// How often the ray crosses the triangles with `t` in its interval: the number of [`all_hits`](Self::all_hits).
    ///
    /// Even for a line through a closed surface; odd for a ray that starts inside.
    fn crossings(&self, ray: &Ray) -> usize;

    /// Whether a point is inside a closed surface, or on it.
    ///
    /// Inside is where a ray to infinity crosses the surface an odd number of times: exact for closed meshes, also those that
    /// intersect themselves, and without meaning for others. A point that is not finite is outside. Cost: four rays.
    fn contains(&self, point: Vec3) -> bool;
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

    /// The answer of a search by [`traverse`](Self::traverse).
    #[inline]
    fn answer<K: TriangleKernel, H: HitCollector, C: TraversalCounter>(
        &self,
        ray: &Ray,
        collector: &mut H,
        counter: &mut C,
    ) -> H::Answer {
        self.traverse::<K, H, C>(ray, collector, counter);
        collector.finish::<_, K, C>(Portable, ray, counter)
    }

    /// The answers of many searches, of equally many rays; rays that are not valid hit nothing.
    fn answers<K: TriangleKernel, H: HitCollector>(&self, rays: &[Ray], answers: &mut [H::Answer]) {
        for (ray, answer) in rays.iter().zip(answers) {
            *answer = search::<_, K, H, ()>(self, ray, &mut H::new(ray), &mut ());
        }
    }
}

/// Runs the searches with the kernel of the structure's precision.
fn run_all<T, H>(structure: &T, rays: &[Ray], answers: &mut [H::Answer])
where
    T: Traverse + ?Sized,
    H: HitCollector,
{
    match structure.precision() {
        Precision::Fast => structure.answers::<MollerTrumbore, H>(rays, answers),
        Precision::Watertight => structure.answers::<Woop, H>(rays, answers),
        Precision::Exact => structure.answers::<Exact, H>(rays, answers),
    }
}

/// Runs the search with the kernel of the structure's precision.
#[inline(always)]
fn run<T, H, C>(structure: &T, ray: &Ray, collector: &mut H, counter: &mut C) -> H::Answer
where
    T: Traverse + ?Sized,
    H: HitCollector,
    C: TraversalCounter,
{
    match structure.precision() {
        Precision::Fast => search::<_, MollerTrumbore, _, _>(structure, ray, collector, counter),
        Precision::Watertight => search::<_, Woop, _, _>(structure, ray, collector, counter),
        Precision::Exact => search::<_, Exact, _, _>(structure, ray, collector, counter),
    }
}

/// Runs the search if the ray is valid.
#[inline(always)]
fn search<T, K, H, C>(structure: &T, ray: &Ray, collector: &mut H, counter: &mut C) -> H::Answer
where
    T: Traverse + ?Sized,
    K: TriangleKernel,
    H: HitCollector,
    C: TraversalCounter,
{
    if ray.is_valid() {
        structure.answer::<K, H, C>(ray, collector, counter)
    } else {
        collector.finish::<_, K, C>(Portable, ray, counter)
    }
}

/// All crossings of a valid ray; none of others.
fn crossings<T: Traverse + ?Sized>(structure: &T, ray: &Ray) -> AllHits {
    let mut hits = AllHits::new(ray);
    search::<_, ExactCrossing, _, _>(structure, ray, &mut hits, &mut ());
    hits
}

/// Whether a point lies on a triangle that has an area: no such triangle is parallel to all three axes.
fn is_on_surface<T: Traverse + ?Sized>(structure: &T, point: Vec3) -> bool {
    Axis::ALL.into_iter().any(|axis| {
        let ray = Ray::with_interval(point, axis.unit_vector(), 0.0, 0.0);
        structure.answer::<Exact, _, _>(&ray, &mut AnyHit::new(&ray), &mut ())
    })
}

impl<T: Traverse> RayQuery for T {
    fn precision(&self) -> Precision {
        Traverse::precision(self)
    }

    fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        run(self, ray, &mut ClosestHit::new(ray), &mut ())
    }

    fn any_hit(&self, ray: &Ray) -> bool {
        run(self, ray, &mut AnyHit::new(ray), &mut ())
    }

    fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        assert_eq!(rays.len(), hits.len(), "one hit per ray");
        run_all::<_, ClosestHit>(self, rays, hits);
    }

    fn any_hits(&self, rays: &[Ray], hits: &mut [bool]) {
        assert_eq!(rays.len(), hits.len(), "one hit per ray");
        run_all::<_, AnyHit>(self, rays, hits);
    }

    fn closest_hit_counted(&self, ray: &Ray, counts: &mut QueryCounts) -> Option<Hit> {
        run(self, ray, &mut ClosestHit::new(ray), counts)
    }

    fn any_hit_counted(&self, ray: &Ray, counts: &mut QueryCounts) -> bool {
        run(self, ray, &mut AnyHit::new(ray), counts)
    }

    fn closest_hit_ignoring(&self, ray: &Ray, primitive: u32) -> Option<Hit> {
        run(
            self,
            ray,
            &mut ClosestHit::new(ray).ignoring(primitive),
            &mut (),
        )
    }

    fn any_hit_ignoring(&self, ray: &Ray, primitive: u32) -> bool {
        run(
            self,
            ray,
            &mut AnyHit::new(ray).ignoring(primitive),
            &mut (),
        )
    }

    fn all_hits(&self, ray: &Ray, visitor: &mut dyn FnMut(Hit) -> ControlFlow<()>) {
        let kernel = ExactCrossing::new(ray);
        let mut hits = crossings(self, ray).into_sorted(&kernel);
        // Broken off or at its end: the visitor knows.
        let (ControlFlow::Break(()) | ControlFlow::Continue(())) = hits.try_for_each(visitor);
    }

    fn crossings(&self, ray: &Ray) -> usize {
        crossings(self, ray).count()
    }

    fn contains(&self, point: Vec3) -> bool {
        point.is_finite()
            && (is_on_surface(self, point)
                || !self.crossings(&Ray::new(point, Vec3::X)).is_multiple_of(2))
    }
}

/// Tests one triangle and offers a hit to the collector: the inner step of every traversal.
#[inline]
pub fn test_triangle<K: TriangleKernel, H: HitCollector, C: TraversalCounter>(
    kernel: &K,
    triangle: &crate::Triangle,
    primitive: u32,
    collector: &mut H,
    counter: &mut C,
) -> ControlFlow<()> {
    counter.triangle_tests(1);
    let hit = kernel.intersect(triangle, collector.t_max(), counter);
    offer(kernel, triangle, primitive, hit, collector, counter)
}

/// Tests a triangle that the kernel's filter for blocks lets through, and that was counted there.
#[inline]
fn test_filtered<K: TriangleKernel, H: HitCollector, C: TraversalCounter>(
    kernel: &K,
    triangle: &crate::Triangle,
    primitive: u32,
    collector: &mut H,
    counter: &mut C,
) -> ControlFlow<()> {
    let hit = kernel.intersect_filtered(triangle, collector.t_max(), counter);
    offer(kernel, triangle, primitive, hit, collector, counter)
}

/// Offers a hit, if there is one, to the collector.
#[inline]
fn offer<K: TriangleKernel, H: HitCollector, C: TraversalCounter>(
    kernel: &K,
    triangle: &crate::Triangle,
    primitive: u32,
    hit: Option<TriangleHit>,
    collector: &mut H,
    counter: &mut C,
) -> ControlFlow<()> {
    match hit {
        Some(hit) => {
            let candidate = Candidate {
                primitive,
                triangle,
                hit,
            };
            collector.collect(kernel, &candidate, counter)
        }
        None => ControlFlow::Continue(()),
    }
}

/// Tests a block of triangles and offers the hits to the collector: the inner step of vector traversals.
///
/// The filter is one of the kernel, and of the ray. The kernel is made here, if the filter lets anything through: most blocks do without.
#[inline(always)]
pub fn test_block<S: Simd, K: TriangleKernel, H: HitCollector, C: TraversalCounter>(
    simd: S,
    (ray, filter): (&Ray, &impl BlockTest),
    block: &TriangleBlock,
    collector: &mut H,
    counter: &mut C,
) -> ControlFlow<()> {
    let verdict = filter.test(simd, block, collector.t_max());
    let used = block.used();
    counter.triangle_tests(u64::from(used.count_ones()));
    let possible = verdict.as_ref().map_or(0, |verdict| verdict.possible);
    counter.decisions(Rung::F32, u64::from((used & !possible).count_ones()));
    match verdict {
        Some(verdict) => offer_all::<K, H, C>(ray, block, &verdict, collector, counter),
        None => ControlFlow::Continue(()),
    }
}

/// Tests the triangles of a block that the [filter leaves](BlockTest::possible), of which there is at least one, and offers the hits to the collector.
#[inline(always)]
pub fn test_possible<S: Simd, K: TriangleKernel, H: HitCollector, C: TraversalCounter>(
    simd: S,
    (ray, filter): (&Ray, &impl BlockTest),
    (block, possible): (&TriangleBlock, u32),
    collector: &mut H,
    counter: &mut C,
) -> ControlFlow<()> {
    let verdict = filter.judge(simd, block, collector.t_max(), possible);
    let left = verdict.as_ref().map_or(0, |verdict| verdict.possible);
    counter.decisions(Rung::F32, u64::from((possible & !left).count_ones()));
    match verdict {
        Some(verdict) => offer_all::<K, H, C>(ray, block, &verdict, collector, counter),
        None => ControlFlow::Continue(()),
    }
}

/// Tests the [candidates](BlockTest::candidates) of a block, of which there is at least one, and offers the hits to the collector: each is known then, and the search has less to do at its end.
#[inline(always)]
pub fn test_candidates<S: Simd, K: TriangleKernel, H: HitCollector, C: TraversalCounter>(
    simd: S,
    ray: &Ray,
    block: &TriangleBlock,
    candidates: Candidates,
    collector: &mut H,
    counter: &mut C,
) -> ControlFlow<()> {
    for lane in lanes_of(candidates.possible) {
        let primitive = block.used_number(lane);
        if candidates.met >> lane & 1 != 0 {
            let vertices = block.vertices(lane);
            let hit = K::intersect_met(simd, ray, &vertices, collector.t_max(), counter);
            if let Some(hit) = hit {
                let known = KnownHit {
                    primitive,
                    vertices,
                    hit,
                };
                collector.collect_known::<K, C>(ray, &known, counter)?;
            }
        } else {
            let triangle = block.triangle(lane);
            test_filtered(&K::new(ray), &triangle, primitive, collector, counter)?;
        }
    }
    ControlFlow::Continue(())
}

/// Offers the hits among the triangles of a block to the collector, given what the [filter says](BlockTest::test) of it.
#[inline(always)]
pub fn offer_all<K: TriangleKernel, H: HitCollector, C: TraversalCounter>(
    ray: &Ray,
    block: &TriangleBlock,
    verdict: &BlockVerdict,
    collector: &mut H,
    counter: &mut C,
) -> ControlFlow<()> {
    for lane in lanes_of(verdict.certain) {
        let t = Interval {
            start: verdict.starts.0[lane],
            end: verdict.ends.0[lane],
        };
        if t.start > collector.t_max() {
            counter.decisions(Rung::F32, 1);
            continue;
        }
        let certain = CertainHit {
            primitive: block.used_number(lane),
            vertices: block.vertices(lane),
            t,
        };
        collector.collect_certain::<K, C>(ray, &certain, counter)?;
    }
    let uncertain = verdict.possible & !verdict.certain;
    if uncertain == 0 {
        return ControlFlow::Continue(());
    }
    let kernel = K::new(ray);
    for lane in lanes_of(uncertain) {
        let (triangle, primitive) = (block.triangle(lane), block.used_number(lane));
        test_filtered(&kernel, &triangle, primitive, collector, counter)?;
    }
    ControlFlow::Continue(())
}
