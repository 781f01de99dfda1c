//! The exact kernels: a ladder of two filters and exact arithmetic.
//!
//! For the ray `O + tD` and the triangle `A`, `B`, `C` let `f = A - O`, `e1 = B - A`, `e2 = C - A`, `n = e1 x e2` and `r = D x f`. Then
//!
//! ```text
//! determinant  D . n          weight of B  -(e2 . r) / determinant      t  (f . n) / determinant
//! weight of A  the rest       weight of C    e1 . r  / determinant
//! ```
//!
//! and the ray hits the closed triangle where no two weights have opposite signs and the determinant is not zero.
//!
//! **The f32 rung** throws out what certainly misses: two weights certainly have opposite signs. By the count of roundings in
//! [`predicate`](crate::predicate) each term is off by at most `64 u m`, with `u = 2^-24` and `m` the product of the largest components of
//! its three factors; the weight of `A`, a difference of the other three terms, by at most the sum of their errors, which have a quarter to spare for its
//! two roundings. Range: the direction is scaled by a power of two so that its largest component is in `[1, 2)`. Lengths enter the bounds with at
//! least `2^-50`: what products of smaller numbers lose by underflow, at most `2^-145` and `2^-147` times a length, is then inside
//! them. Where a length is `2^60` or more, the rung decides nothing, so that nothing overflows.
//!
//! It also throws out what is certainly hit outside the interval, if the determinant is certain: `(f . n)` carries one more rounding than the
//! others, which its bound covers, and is compared with `t_max` times the determinant, or with zero where `t_min` is not negative. This
//! is a product of three lengths on each side, so it is left to f64 unless all lengths are below `2^30`, and those below
//! `2^-30` count as that in its bound; likewise a scaled `t_max`. A best `t` may be beyond the largest f32, to which it was rounded, and a nearer
//! one too: neither is thrown out, as with these lengths `(f . n)` is below `2^50` certain determinants, and that limit
//! above `2^67` of them.
//!
//! **The f64 rung** computes the same terms with the same bounds, for `u = 2^-53`, where f32 input can neither overflow nor underflow. It decides where the
//! weights are certain, where `t` rounds to the same f32 at both ends of its error, and where that is neither end of the ray's
//! interval.
//!
//! **Exact arithmetic** decides the rest, on whole numbers or expansions: the sides of single edges, for rays aimed at them, or all of it where the determinant
//! or `t` is uncertain.
//!
//! **What is returned.** `t` is the exact value rounded to the nearest f32 (and to the largest finite one instead of infinity). Rounding is monotone, so
//! where two rounded `t` differ they have the order of the exact ones; only where they are equal is the exact order asked for.
//! `u` and `v` are correct to `2^-24`.
//!
//! Source of the terms: Möller and Trumbore 1997, in the order of Havel and Herout, "Yet faster ray-triangle intersection (using SSE4)", 2010.

use std::cmp::Ordering;

use glam::{Vec3, Vec3A};

use super::lanes::{HitLanes, VertexLanes, certain_hits};
use super::terms::{Terms, certain_hit};
use crate::predicate::{EdgeRule, Rung, Sign, intersect_exactly, order_of_planes, passes_edges};
use crate::simd::Simd;
use crate::{Ray, RayLanes, TraversalCounter, Triangle, TriangleHit, TriangleKernel};

/// The exact kernel: what it answers is true of the given numbers.
///
/// A triangle is a closed set: a ray through its edge or vertex hits it. `t` is correct to half a unit in the last place.
pub type Exact = Ladder<false>;

/// The exact kernel for counting crossings: a ray through an edge or vertex hits as many of the triangles there as it crosses
/// the surface, by a symbolic perturbation.
pub type ExactCrossing = Ladder<true>;

/// The ladder of [`Exact`] and [`ExactCrossing`]; `PERTURBED` says whether edges are settled by the perturbation.
#[derive(Clone, Copy, Debug)]
pub struct Ladder<const PERTURBED: bool> {
    ray: Ray,
    /// The direction, scaled by a power of two to a largest component in `[1, 2)`.
    scaled_direction: Vec3,
    /// What `t` is to be multiplied by for the scaled direction; NaN where that could be inexact.
    t_scale: f32,
}

/// The bound of the f32 rung, relative to the product of the largest factors.
const F32_ERROR: f32 = 64.0 / (1u32 << 24) as f32;
/// Lengths below this are taken for as long in the bounds of the f32 rung.
const SMALLEST_LENGTH: f32 = 1.0 / (1u64 << 50) as f32;
/// From this length on the f32 rung decides nothing.
const LARGEST_LENGTH: f32 = (1u64 << 60) as f32;
/// Lengths between this and its reciprocal may decide about `t` on the f32 rung.
const SHORT: f32 = 1.0 / (1u64 << 30) as f32;
/// One, and some roundings.
const ABOVE_ONE: f32 = 1.0 + 8.0 * f32::EPSILON;

impl<const PERTURBED: bool> TriangleKernel for Ladder<PERTURBED> {
    const REACH: f32 = 0.0;

    type Block = super::ExactBlockFilter;

    #[inline]
    fn new(ray: &Ray) -> Self {
        let (scaled_direction, t_scale) = scaled(ray.direction);
        Self {
            ray: *ray,
            scaled_direction,
            t_scale,
        }
    }

    #[inline]
    fn intersect<C: TraversalCounter>(
        &self,
        triangle: &Triangle,
        t_max: f32,
        counter: &mut C,
    ) -> Option<TriangleHit> {
        if self.certainly_misses(triangle, t_max) {
            counter.decisions(Rung::F32, 1);
            return None;
        }
        self.intersect_in_f64(triangle, t_max, counter)
    }

    #[inline]
    fn intersect_filtered<C: TraversalCounter>(
        &self,
        triangle: &Triangle,
        t_max: f32,
        counter: &mut C,
    ) -> Option<TriangleHit> {
        self.intersect_in_f64(triangle, t_max, counter)
    }

    #[inline(always)]
    fn intersect_certain<S: Simd, C: TraversalCounter>(
        simd: S,
        ray: &Ray,
        vertices: &[Vec3A; 3],
        counter: &mut C,
    ) -> Option<TriangleHit> {
        if let Some(hit) = certain_hit(simd, ray, vertices) {
            counter.decisions(Rung::F64, 1);
            return Some(hit);
        }
        // A copy: what only the rare call wants is not computed or stored before.
        let triangle = Triangle::from_vertices(vertices);
        Self::new(ray).intersect_in_f64(&triangle, f32::INFINITY, counter)
    }

    #[inline(always)]
    fn intersect_met<S: Simd, C: TraversalCounter>(
        simd: S,
        ray: &Ray,
        vertices: &[Vec3A; 3],
        t_max: f32,
        counter: &mut C,
    ) -> Option<TriangleHit> {
        if let Some(hit) = certain_hit(simd, ray, vertices)
            // Where the rounded `t` is an end of the interval, the exact one may be outside.
            && hit.t != ray.t_min
            && hit.t != ray.t_max
        {
            counter.decisions(Rung::F64, 1);
            return (ray.t_min < hit.t && hit.t <= t_max).then_some(hit);
        }
        // A copy, as above.
        let triangle = Triangle::from_vertices(vertices);
        Self::new(ray).intersect_in_f64(&triangle, t_max, counter)
    }

    #[inline(always)]
    fn intersect_certain_lanes<S: Simd>(
        simd: S,
        rays: &RayLanes,
        vertices: &VertexLanes,
    ) -> HitLanes {
        certain_hits(simd, rays, vertices)
    }

    #[cold]
    fn order_of_equal_t<C: TraversalCounter>(
        &self,
        first: &Triangle,
        second: &Triangle,
        counter: &mut C,
    ) -> Ordering {
        if have_same_vertices(first, second) {
            return Ordering::Equal;
        }
        // Both were hit, so neither is parallel to the ray.
        let (order, rung) = order_of_planes(&self.ray, first, second);
        counter.order(rung);
        order
    }
}

impl<const PERTURBED: bool> Ladder<PERTURBED> {
    const RULE: EdgeRule = if PERTURBED {
        EdgeRule::Perturbed
    } else {
        EdgeRule::Closed
    };

    /// The f32 rung.
    #[inline]
    fn certainly_misses(&self, triangle: &Triangle, t_max: f32) -> bool {
        let from_origin = triangle.a - self.ray.origin;
        let edge1 = triangle.b - triangle.a;
        let edge2 = triangle.c - triangle.a;
        let normal = edge1.cross(edge2);
        let moment = self.scaled_direction.cross(from_origin);
        let determinant = self.scaled_direction.dot(normal);
        let of_b = -edge2.dot(moment);
        let of_c = edge1.dot(moment);
        let of_a = determinant - of_b - of_c;

        let [f, e1, e2] = [from_origin, edge1, edge2].map(largest_component);
        // The direction's largest component is below 2.
        let scale = 2.0 * F32_ERROR;
        let error_b = scale * f * e2;
        let error_c = scale * f * e1;
        let determinant_error = scale * e1 * e2;
        let error_a = determinant_error + error_b + error_c;
        let positive = of_a > error_a || of_b > error_b || of_c > error_c;
        let negative = of_a < -error_a || of_b < -error_b || of_c < -error_c;
        let largest = f.max(e1).max(e2);
        if positive && negative {
            return largest < LARGEST_LENGTH;
        }
        // In the direction of the ray: positive ahead of the origin.
        let depth = from_origin.dot(normal) * 1.0f32.copysign(determinant);
        let depth_error = F32_ERROR * f.max(SHORT) * e1.max(SHORT) * e2.max(SHORT);
        let determinant = determinant.abs();
        let scaled_t_max = t_max * self.t_scale;
        // NaN stays NaN, with which nothing is beyond.
        let limit = if scaled_t_max < SHORT {
            SHORT
        } else {
            scaled_t_max
        };
        let limit = limit * (determinant + determinant_error) * ABOVE_ONE;
        let is_behind = depth < -depth_error && self.ray.t_min >= 0.0;
        let is_beyond = depth - depth_error > limit;
        (is_behind || is_beyond) && determinant > determinant_error && largest < 1.0 / SHORT
    }

    /// The f64 rung.
    #[inline(never)]
    fn intersect_in_f64<C: TraversalCounter>(
        &self,
        triangle: &Triangle,
        t_max: f32,
        counter: &mut C,
    ) -> Option<TriangleHit> {
        let terms = Terms::new(&self.ray, triangle);
        // The triangle that a ray starts on, or a neighbour of it: the usual reason to come here, and soon seen.
        if self.ray.t_min >= 0.0 && terms.are_behind() {
            counter.decisions(Rung::F64, 1);
            return None;
        }
        let Terms {
            of_b,
            of_c,
            determinant,
            error_b,
            error_c,
            ..
        } = terms;
        let (of_a, error_a) = terms.of_a();
        let positive = [of_a > error_a, of_b > error_b, of_c > error_c];
        let negative = [of_a < -error_a, of_b < -error_b, of_c < -error_c];
        if positive.contains(&true) && negative.contains(&true) {
            counter.decisions(Rung::F64, 1);
            return None;
        }
        let Some((t, error)) = terms.t() else {
            return self.intersect_exactly(triangle, t_max, counter);
        };
        let [low, high] = [t - error, t + error].map(rounded);
        if low > t_max || high < self.ray.t_min {
            counter.decisions(Rung::F64, 1);
            return None;
        }
        let is_certain = low == high && low != self.ray.t_min && low != self.ray.t_max;
        if !is_certain {
            return self.intersect_exactly(triangle, t_max, counter);
        }
        let certain = [0, 1, 2].map(|index| positive[index] || negative[index]);
        let mut rung = Rung::F64;
        if certain != [true; 3] {
            rung = Rung::Exact;
            let uncertain = certain.map(|is_certain| !is_certain);
            let side = Sign::of(determinant);
            if !passes_edges(&self.ray, triangle, uncertain, side, Self::RULE) {
                counter.decisions(rung, 1);
                return None;
            }
        }
        counter.decisions(rung, 1);
        Some(terms.hit(low))
    }

    /// The last rung for all that a hit consists of.
    #[cold]
    #[inline(never)]
    fn intersect_exactly<C: TraversalCounter>(
        &self,
        triangle: &Triangle,
        t_max: f32,
        counter: &mut C,
    ) -> Option<TriangleHit> {
        counter.decisions(Rung::Exact, 1);
        let hit =
            intersect_exactly(&self.ray, triangle, Self::RULE)?.rounded_in_interval(&self.ray)?;
        (hit.t <= t_max).then_some(hit)
    }
}

/// The largest magnitude of a component, at least [`SMALLEST_LENGTH`].
#[inline]
fn largest_component(vector: Vec3) -> f32 {
    let larger = |a: f32, b: f32| if a > b { a } else { b };
    larger(
        vector.x.abs(),
        larger(vector.y.abs(), larger(vector.z.abs(), SMALLEST_LENGTH)),
    )
}

/// The nearest f32, or the largest finite one.
fn rounded(t: f64) -> f32 {
    #[expect(clippy::cast_possible_truncation, reason = "rounds to the nearest f32")]
    let nearest = t as f32;
    nearest.clamp(f32::MIN, f32::MAX)
}

/// A direction divided by the power of two that is not above its largest component and not below half of it, and that power; NaN for the power where products
/// with it could be inexact.
///
/// Dividing is exact, but for components below `2^-126` of the largest, which may lose up to `2^-150`: less than the bounds have to spare.
#[inline]
fn scaled(direction: Vec3) -> (Vec3, f32) {
    const EXPONENT: u32 = 0xff << 23;
    /// The sum of the exponents' fields of a power of two and its reciprocal.
    const OF_RECIPROCALS: u32 = 254 << 23;
    let largest = direction.abs().max_element();
    let power = largest.to_bits() & EXPONENT;
    if (1e-18..1e18).contains(&largest) {
        let reciprocal = f32::from_bits(OF_RECIPROCALS - power);
        return (direction * reciprocal, f32::from_bits(power));
    }
    // Every f32 but zero is a normal f64.
    let power = f64::from_bits(f64::from(largest).to_bits() & (0x7ff << 52));
    ((direction.as_dvec3() / power).as_vec3(), f32::NAN)
}

/// Whether two triangles have the same vertices in any order, and so the same plane.
fn have_same_vertices(first: &Triangle, second: &Triangle) -> bool {
    let [first, second] = [first, second].map(Triangle::vertices);
    first.iter().all(|vertex| second.contains(vertex))
        && second.iter().all(|vertex| first.contains(vertex))
}
