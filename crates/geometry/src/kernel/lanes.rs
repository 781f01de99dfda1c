//! The f64 rung of the exact kernels for eight rays at a time: what a packet ends with.

use super::terms::{RayAndTriangle, Sums, certain_terms};
use crate::simd::{Lanes, Simd, widen_all};
use crate::{RayLanes, TriangleHit};

/// The vertices of eight triangles, by vertex and axis.
pub type VertexLanes = [[Lanes; 3]; 3];

/// Hits of eight rays.
#[derive(Clone, Copy, Debug)]
pub struct HitLanes {
    /// A bit for each lane whose hit is known; the others mean nothing.
    pub known: u32,
    t: Lanes,
    u: Lanes,
    v: Lanes,
}

impl HitLanes {
    /// Nothing is known.
    pub const UNKNOWN: Self = Self {
        known: 0,
        t: Lanes::splat(0.0),
        u: Lanes::splat(0.0),
        v: Lanes::splat(0.0),
    };

    /// The hit of a lane.
    #[inline(always)]
    #[must_use]
    pub fn hit(&self, lane: usize) -> TriangleHit {
        TriangleHit::in_triangle(self.t.0[lane], self.u.0[lane], self.v.0[lane])
    }
}

/// What [`certain_hit`](super::terms::certain_hit) gives, to the last bit, for eight rays and a triangle of each.
#[inline(always)]
pub(super) fn certain_hits<S: Simd>(simd: S, rays: &RayLanes, [a, b, c]: &VertexLanes) -> HitLanes {
    let load = |[x, y, z]: &[Lanes; 3]| [simd.load(x), simd.load(y), simd.load(z)];
    let vectors = [
        load(&rays.origin),
        load(&rays.direction),
        load(a),
        load(b),
        load(c),
    ];
    let [first, last] = halves(simd, vectors);
    let first = certain_terms(simd, &Sums::of_lanes(simd, first));
    let last = certain_terms(simd, &Sums::of_lanes(simd, last));
    let low = simd.narrow([first.ends[0], last.ends[0]]);
    let high = simd.narrow([first.ends[1], last.ends[1]]);
    let u = simd.narrow([first.u, last.u]);
    let v = simd.narrow([first.v, last.v]);
    let is_unsure = simd.sign_bits_f64([first.slack, last.slack]);
    let is_one = simd.and(simd.le(low, high), simd.le(high, low));
    let is_finite = simd.lt(simd.abs(low), simd.splat(f32::INFINITY));
    // As `TriangleHit::new`.
    let (zero, one) = (simd.splat(0.0), simd.splat(1.0));
    HitLanes {
        known: simd.bits(simd.and(is_one, is_finite)) & !is_unsure,
        t: simd.store(simd.add(low, zero)),
        u: simd.store(simd.min(one, simd.max(zero, u))),
        v: simd.store(simd.min(one, simd.max(zero, v))),
    }
}

/// The first four lanes and the last, as f64.
#[inline(always)]
fn halves<S: Simd>(
    simd: S,
    [o, d, a, b, c]: RayAndTriangle<S::F32s>,
) -> [RayAndTriangle<S::F64s>; 2] {
    let ([o0, o1], [d0, d1]) = (widen_all(simd, o), widen_all(simd, d));
    let ([a0, a1], [b0, b1]) = (widen_all(simd, a), widen_all(simd, b));
    let [c0, c1] = widen_all(simd, c);
    [[o0, d0, a0, b0, c0], [o1, d1, a1, b1, c1]]
}

#[cfg(test)]
mod tests;
