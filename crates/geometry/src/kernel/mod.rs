//! Ray/triangle kernels: one type per [`Precision`], prepared for a ray.
//!
//! Every kernel is a filter in f32 followed by arithmetic in f64 that runs only for the few triangles that
//! pass, and gives `t`, `u` and `v`. [`Exact`] has expansion arithmetic behind that, which decides
//! what f64 cannot. All keep a promise that the structures rely on:
//!
//! > **Reach.** If a kernel accepts a triangle with value `t`, then some point of the triangle lies
//! > within `REACH * (2^-24 m + 2^-149)` of the point `O + tD` in every coordinate, where `m` is the largest
//! > coordinate difference between the ray's origin and the triangle's vertices that the kernel computed.
//!
//! [`ConservativeRay`](crate::ConservativeRay) and [`FusedRay`](crate::FusedRay) widen box and plane tests by that distance, which is zero for
//! the exact kernels. So whatever a kernel accepts lies in a cell that the traversal visits, and all structures give the
//! answer of brute force.
//!
//! **Blocks.** Before the tests of single triangles a [`BlockFilter`] may look at a [`TriangleBlock`](crate::TriangleBlock) of up to eight. It throws
//! out what the kernel certainly rejects, and may name triangles that are *certain hits*, each with an interval around its `t`. What it says is true of
//! the kernel, so answers depend neither on blocks nor on the vector instructions. Of a certain hit the kernel computes `t`, `u` and `v` only where they
//! are needed: for the closest one at the end, and where the intervals of two overlap. For callers who have other work until it is known, it also tells without a branch what the kernel may accept, and which
//! triangles the ray's line [meets for certain](Candidates::met). [`ExactBlockFilter`] is that of the exact kernels. [`ReachBlockFilter`], that
//! of the others, has bounds that are wider by the reach, and names no certain hits. Each has a [`RaysFilter`] beside it, for eight rays of a packet and one triangle at a time.

mod behind;
mod block;
mod confirm;
mod exact;
mod exact_block;
mod lanes;
mod moller_trumbore;
mod one_ray;
mod rays;
mod reach_block;
pub(crate) mod sheared;
mod terms;
mod woop;

pub use block::{BlockFilter, BlockTest, BlockVerdict, Candidates};
pub use exact::{Exact, ExactCrossing, Ladder};
pub use exact_block::{ExactBlockFilter, ExactRaysFilter};
pub use lanes::{HitLanes, VertexLanes};
pub use moller_trumbore::MollerTrumbore;
pub use rays::{RayOfLane, RaysFilter};
pub use reach_block::{ReachBlockFilter, ReachRaysFilter, WithinReach};
pub(crate) use terms::WEIGHT_ERROR;
pub use woop::Woop;

use std::cmp::Ordering;

use glam::Vec3A;

use crate::simd::Simd;
use crate::{Ray, RayLanes, TraversalCounter, Triangle};

/// The distance within which a kernel with a [`REACH`](TriangleKernel::REACH) keeps the promise in the module's documentation, for the largest coordinate
/// difference `m`. The second term covers products that underflow.
pub(crate) fn reach(kernel_reach: f32, m: f64) -> f64 {
    const UNIT_ROUNDOFF: f64 = 1.0 / (1u64 << 24) as f64;
    f64::from(kernel_reach) * (UNIT_ROUNDOFF * m + f64::from(f32::from_bits(1)))
}

/// How hits are decided; chosen when a structure is built.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Precision {
    /// [`MollerTrumbore`]: a ray that passes an edge within about `2^-22` of its distance to the triangle
    /// may be lost.
    Fast,
    /// [`Woop`]: no ray passes between triangles that share an edge or a vertex.
    Watertight,
    /// [`Exact`](struct@Ladder): the mathematically exact answer for the given numbers.
    #[default]
    Exact,
}

impl Precision {
    /// All precisions, from the fastest to the most careful.
    pub const ALL: [Self; 3] = [Self::Fast, Self::Watertight, Self::Exact];

    /// The name on the command line: `fast`, `watertight` or `exact`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Fast => "fast",
            Self::Watertight => "watertight",
            Self::Exact => "exact",
        }
    }
}

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleHit {
    /// Parameter along the ray, in lengths of the ray's direction.
    pub t: f32,
    /// Weight of the second vertex, in `[0, 1]`.
    pub u: f32,
    /// Weight of the third vertex, in `[0, 1 - u]`; the first vertex has the weight `1 - u - v`.
    pub v: f32,
}

impl TriangleHit {
    /// A hit with `u` and `v` rounded to f32 and kept inside the triangle. A zero `t` is positive.
    #[inline]
    pub(crate) fn new(t: f32, u: f64, v: f64) -> Self {
        #[expect(clippy::cast_possible_truncation, reason = "rounds to the nearest f32")]
        let [u, v] = [u, v].map(|value| (value as f32).clamp(0.0, 1.0));
        Self::in_triangle(t + 0.0, u, v)
    }

    /// A hit with `u` and `v` in `[0, 1]`.
    #[inline]
    fn in_triangle(t: f32, u: f32, v: f32) -> Self {
        // Seldom; which one is larger would be anyone's guess.
        if u + v >= 1.0 {
            // The difference is exact where it matters: where the larger weight is at least a half.
            let (u, v) = if u > v {
                (u, v.min(1.0 - u))
            } else {
                (u.min(1.0 - v), v)
            };
            return Self { t, u, v };
        }
        Self { t, u, v }
    }

    /// Rounds a hit to f32; `None` if `t`, rounded, is outside `[t_min, t_max]` or NaN.
    ///
    /// Rounding comes before the comparison, so that the order in which triangles are tested, with
    /// `t_max` shrinking to the best `t` so far, cannot change the answer. A negative `t` stays negative: where it would underflow, the
    /// hit is behind the origin nevertheless.
    fn rounded(t: f64, u: f64, v: f64, t_min: f32, t_max: f32) -> Option<Self> {
        #[expect(clippy::cast_possible_truncation, reason = "rounds to the nearest f32")]
        let nearest = t as f32;
        let t = if t < 0.0 {
            nearest.min(-f32::from_bits(1))
        } else {
            nearest
        };
        // A positive comparison: coordinates that overflow make t NaN, which is no hit.
        (t_min <= t && t <= t_max).then(|| Self::new(t, u, v))
    }
}

/// A ray prepared for testing many triangles at one precision.
///
/// The verdict on a triangle depends on the ray and on the triangle alone, so every structure that
/// tests the same triangles gives the same bits.
pub trait TriangleKernel: Copy {
    /// The constant of the promise in the module's documentation, in units of `2^-24`.
    const REACH: f32;

    /// Its filter for blocks of triangles.
    type Block: BlockFilter;

    /// Prepares a valid ray.
    fn new(ray: &Ray) -> Self;

    /// The hit of a triangle with `t` in the ray's interval and, rounded to f32, not above `t_max`.
    fn intersect<C: TraversalCounter>(
        &self,
        triangle: &Triangle,
        t_max: f32,
        counter: &mut C,
    ) -> Option<TriangleHit>;

    /// [`intersect`](Self::intersect) for a triangle that the [filter for blocks](Self::Block) lets through, which is another filter's work done.
    #[inline]
    fn intersect_filtered<C: TraversalCounter>(
        &self,
        triangle: &Triangle,
        t_max: f32,
        counter: &mut C,
    ) -> Option<TriangleHit> {
        self.intersect(triangle, t_max, counter)
    }

    /// The hit of a triangle, given by its vertices, that is certainly hit with `t` in the ray's interval.
    #[inline]
    fn intersect_certain<S: Simd, C: TraversalCounter>(
        _simd: S,
        ray: &Ray,
        vertices: &[Vec3A; 3],
        counter: &mut C,
    ) -> Option<TriangleHit> {
        let triangle = Triangle::from_vertices(vertices);
        Self::new(ray).intersect_filtered(&triangle, f32::INFINITY, counter)
    }

    /// [`intersect_filtered`](Self::intersect_filtered) for a triangle that the line of the ray [meets for certain](Candidates::met).
    #[inline]
    fn intersect_met<S: Simd, C: TraversalCounter>(
        _simd: S,
        ray: &Ray,
        vertices: &[Vec3A; 3],
        t_max: f32,
        counter: &mut C,
    ) -> Option<TriangleHit> {
        let triangle = Triangle::from_vertices(vertices);
        Self::new(ray).intersect_filtered(&triangle, t_max, counter)
    }

    /// [`intersect_certain`](Self::intersect_certain) for eight rays and a triangle of each, which it certainly hits, as far as it is quickly known. What is in lanes without a hit does not matter.
    #[inline(always)]
    fn intersect_certain_lanes<S: Simd>(
        _simd: S,
        _rays: &RayLanes,
        _vertices: &VertexLanes,
    ) -> HitLanes {
        HitLanes::UNKNOWN
    }

    /// The order along the ray of two triangles that were hit at the same rounded `t`; equal where the kernel knows no more.
    fn order_of_equal_t<C: TraversalCounter>(
        &self,
        _first: &Triangle,
        _second: &Triangle,
        _counter: &mut C,
    ) -> Ordering {
        Ordering::Equal
    }
}

#[cfg(test)]
mod tests;
