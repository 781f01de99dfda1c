//! Rays that go into the same octant, eight at a time.
//!
//! **All of them at once.** [`PacketBounds`] bound where any of them meets a plane: a near plane at `p` not before `(p - o) r`, with `o` the farthest of the shifted
//! origins and `r` the reciprocal, of the smallest and the largest, that gives the smaller product; a far plane likewise. In exact arithmetic this is not above
//! what each ray has with its own shifted origin and its own `r`. The difference and the product have a rounding each, where the factor of `r` has room for
//! four. For a plane behind all of the shifted origins the product is negative, and so of no matter to rays that begin at zero or later, as all of a packet do. What underflows is
//! covered as it is there.

use crate::simd::{LANES, Lanes, Simd};

use super::lanes::RayLanes;
use super::{
    DIRECTIONS, FARTHEST, FARTHEST_IN_SIZES, RELATIVE_WIDENING, SHIFT, SHIFT_OF_SIZE,
    SMALLEST_COMPONENT, SMALLEST_SIZE, shift_for,
};

/// Eight rays prepared as [`FusedRay`](super::FusedRay) prepares one.
#[derive(Clone, Copy, Debug)]
pub struct FusedPacket {
    /// By axis: reciprocals and offsets for near planes.
    pub near: [[Lanes; 2]; 3],
    /// The same for far planes.
    pub far: [[Lanes; 2]; 3],
}

/// [`PacketBounds`] while they are gathered, lane by lane.
#[derive(Clone, Copy, Debug)]
pub struct GatheredBounds {
    /// By axis: the shifted origins from which near planes, and far planes, are nearest and farthest.
    origins: [[Lanes; 2]; 3],
    /// By axis: the smallest and the largest reciprocal.
    reciprocals: [[Lanes; 2]; 3],
}

/// What bounds the origins and directions of all rays of a packet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PacketBounds {
    /// By axis, for near and far planes: the shifted origin.
    pub origins: [[f32; 2]; 3],
    /// By axis, for near and far planes: the smallest and the largest reciprocal, widened.
    pub reciprocals: [[[f32; 2]; 2]; 3],
}

impl GatheredBounds {
    /// Bounds of no rays, into an octant: bit `i` is set for a negative direction along axis `i`.
    #[inline]
    #[must_use]
    pub fn new(negative: u32) -> Self {
        let (low, high) = (Lanes::splat(f32::NEG_INFINITY), Lanes::splat(f32::INFINITY));
        let mut origins = [[low, high]; 3];
        for (axis, origins) in origins.iter_mut().enumerate() {
            if negative >> axis & 1 != 0 {
                origins.swap(0, 1);
            }
        }
        Self {
            origins,
            reciprocals: [[high, low]; 3],
        }
    }

    /// The bounds of all lanes.
    #[inline(always)]
    #[must_use]
    pub fn all_lanes<S: Simd>(&self, simd: S, negative: u32) -> PacketBounds {
        // The smallest numbers are found, so what the largest is wanted of changes its sign.
        let side = |axis: usize| if negative >> axis & 1 == 0 { -1.0 } else { 1.0 };
        let sides = [side(0), side(1), side(2)];
        let ([x, y, z], [u, v, w]) = (&self.origins, &self.reciprocals);
        let first = smallest_of_rows(
            simd,
            [
                times(simd, &x[0], sides[0]),
                times(simd, &x[1], -sides[0]),
                times(simd, &y[0], sides[1]),
                times(simd, &y[1], -sides[1]),
                times(simd, &z[0], sides[2]),
                times(simd, &z[1], -sides[2]),
                simd.load(&u[0]),
                times(simd, &u[1], -1.0),
            ],
        );
        let zero = simd.splat(0.0);
        let last = smallest_of_rows(
            simd,
            [
                simd.load(&v[0]),
                times(simd, &v[1], -1.0),
                simd.load(&w[0]),
                times(simd, &w[1], -1.0),
                zero,
                zero,
                zero,
                zero,
            ],
        );
        let [x, x2, y, y2, z, z2, u, u2] = first.0;
        let [v, v2, w, w2, ..] = last.0;
        let [a, b, c] = sides;
        PacketBounds {
            origins: [[x * a, -x2 * a], [y * b, -y2 * b], [z * c, -z2 * c]],
            reciprocals: [widened([u, -u2]), widened([v, -v2]), widened([w, -w2])],
        }
    }
}

/// Lanes times a number.
#[inline(always)]
fn times<S: Simd>(simd: S, lanes: &Lanes, factor: f32) -> S::F32s {
    simd.mul(simd.load(lanes), simd.splat(factor))
}

/// The smallest number of each row.
#[inline(always)]
fn smallest_of_rows<S: Simd>(simd: S, rows: [S::F32s; LANES]) -> Lanes {
    let [a, b, c, d, e, f, g, h] = simd.transpose(rows);
    let first = simd.min(simd.min(a, b), simd.min(c, d));
    let last = simd.min(simd.min(e, f), simd.min(g, h));
    simd.store(simd.min(first, last))
}

/// The smallest and the largest reciprocal, widened for near planes and for far planes. Rounding is monotone: these are the ends of the widened reciprocals.
#[inline(always)]
const fn widened([smallest, largest]: [f32; 2]) -> [[f32; 2]; 2] {
    const NEAR: f32 = 1.0 - RELATIVE_WIDENING;
    const FAR: f32 = 1.0 + RELATIVE_WIDENING;
    [
        [smallest * NEAR, largest * NEAR],
        [smallest * FAR, largest * FAR],
    ]
}

impl FusedPacket {
    /// Nothing.
    pub const EMPTY: Self = Self {
        near: [[Lanes::splat(0.0); 2]; 3],
        far: [[Lanes::splat(0.0); 2]; 3],
    };

    /// Prepares rays that are valid, begin at zero or later, and go into the same octant, as [`FusedRay::new`](super::FusedRay::new) does, and adds them to bounds.
    #[inline(always)]
    pub fn prepare<S: Simd>(
        &mut self,
        simd: S,
        rays: &RayLanes,
        negative: u32,
        size_and_reach: (f32, f32),
        bounds: &mut GatheredBounds,
    ) {
        let origin = rays.origins(simd);
        let distance = [
            simd.abs(origin[0]),
            simd.abs(origin[1]),
            simd.abs(origin[2]),
        ];
        let [x, y, z] = rays.directions(simd);
        let magnitude = [simd.abs(x), simd.abs(y), simd.abs(z)];
        let shift = shift_of_all(simd, distance, magnitude, size_and_reach);

        for axis in 0..3 {
            let is_negative = negative >> axis & 1 != 0;
            let sign = simd.splat(if is_negative { -1.0 } else { 1.0 });
            let magnitude = simd.max(magnitude[axis], simd.splat(SMALLEST_COMPONENT));
            let reciprocal = simd.div(sign, magnitude);
            let shift = simd.mul(
                simd.add(simd.mul(distance[axis], simd.splat(SHIFT)), shift),
                sign,
            );
            let near_origin = simd.add(origin[axis], shift);
            let far_origin = simd.sub(origin[axis], shift);
            let planes = |origin: S::F32s, factor: f32| {
                let reciprocal = simd.mul(reciprocal, simd.splat(factor));
                let offset = simd.mul(simd.mul(origin, simd.splat(-1.0)), reciprocal);
                [simd.store(reciprocal), simd.store(offset)]
            };
            self.near[axis] = planes(near_origin, 1.0 - RELATIVE_WIDENING);
            self.far[axis] = planes(far_origin, 1.0 + RELATIVE_WIDENING);

            let [smallest, largest] = &mut bounds.reciprocals[axis];
            *smallest = simd.store(simd.min(simd.load(smallest), reciprocal));
            *largest = simd.store(simd.max(simd.load(largest), reciprocal));
            let [near, far] = &mut bounds.origins[axis];
            if is_negative {
                *near = simd.store(simd.min(simd.load(near), near_origin));
                *far = simd.store(simd.max(simd.load(far), far_origin));
            } else {
                *near = simd.store(simd.max(simd.load(near), near_origin));
                *far = simd.store(simd.min(simd.load(far), far_origin));
            }
        }
    }
}

/// How far origins are shifted beside what is relative to their own coordinates; infinitely where nothing is culled.
#[inline(always)]
fn shift_of_all<S: Simd>(
    simd: S,
    distance: [S::F32s; 3],
    magnitude: [S::F32s; 3],
    (size, reach): (f32, f32),
) -> S::F32s {
    let largest = |[x, y, z]: [S::F32s; 3]| simd.max(simd.max(x, y), z);

    let farthest = simd.mul(
        simd.add(simd.splat(size), largest(distance)),
        simd.splat(1.0 + SHIFT),
    );
    let mut shift = simd.splat(size * SHIFT_OF_SIZE);
    if reach > 0.0 {
        let [relative, absolute] = shift_for(reach);
        let reach = simd.add(
            simd.mul(simd.splat(relative), farthest),
            simd.splat(absolute),
        );
        shift = simd.add(shift, simd.mul(reach, simd.splat(1.0 + SHIFT)));
    }
    let component = largest(magnitude);
    let culls = simd.and(
        simd.and(
            simd.le(simd.splat(*DIRECTIONS.start()), component),
            simd.le(component, simd.splat(*DIRECTIONS.end())),
        ),
        simd.le(farthest, simd.splat(FARTHEST.min(size * FARTHEST_IN_SIZES))),
    );
    let infinite = simd.splat(f32::INFINITY);
    if size >= SMALLEST_SIZE {
        simd.select(culls, shift, infinite)
    } else {
        infinite
    }
}

#[cfg(test)]
mod tests;
