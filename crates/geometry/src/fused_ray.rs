//! Box tests of one operation per plane that never lose a hit.
//!
//! The second way of [`ConservativeRay`](crate::ConservativeRay), for nodes whose planes come in vectors: a plane at `p` is met at `p r + c`, with `r` the
//! reciprocal of the direction and `c = -(o + s) r` for near planes, `c = -(o - s) r` for far planes, where `s` shifts the origin in the direction of the ray.
//! It takes one operation instead of two, and has an error that the first way does not have: it is relative to the coordinates of the origin, and does not
//! shrink with the distance of the plane. Nothing here but the largest component of the direction needs more than one axis, so the way from
//! a ray to its first node is short.
//!
//! **Relative errors.** Let `u = 2^-24`. As there, `r` is the reciprocal of the direction times `1 - 8 u` for near planes and `1 + 8 u` for far planes, off by
//! two roundings more. What is computed has the rounding of the sum, which is relative to the result; that of the product, where
//! it is not fused, `u |p r|`; and the two of `c`, `2 u |o + s| |r|`. With `|p| <= |p - o| + |o|` these are `u` of the result once more, and
//! `3 u |o r|`, less than a shift of the origin by `4 u |o|` makes up for. So a plane ahead of the origin is off by four roundings of the result, which the
//! factor of `r` makes up for, however large the structure is and wherever in it the plane. A plane behind the origin stays there.
//!
//! **More shifts** are the reach of a kernel; for rays with a negative `t_min`, where the factors of `r` work the wrong way, `16 u M` with `M` the
//! largest coordinate difference between the origin and the bounds, as there; and `2^-30 B`, with `B` the largest coordinate of the bounds.
//!
//! **Directions along a plane.** Components below `2^-84` are replaced by that size with their sign. With a largest component `d` of at least `2^-30` and an origin within
//! `2^22 B`, the way through the bounds ends before `2^23 B / d <= 2^53 B`. That moves the ray by at most `2^-31 B`, less than the last shift. Divided by `2^-84` that
//! shift is `2^54 B`, more than this way: a ray in the face of a box is in the slab for every `t` that counts.
//!
//! **Extremes.** For directions outside `[2^-30, 2^30]`, a `B` below `2^-60`, origins beyond `2^22 B` and differences beyond `2^42`, `c` is infinite and nothing is culled, every answer
//! stays right: a product that overflows then gives NaN, if anything, which the vector maxima and minima drop. Inside, products and `c` are below `2^127`: if
//! one of them overflowed and the other one did not, hits would be lost. What underflows is below `2^-148`, and divided by `r` below `2^-118`, which the last shift covers.

use std::ops::RangeInclusive;

use glam::{Vec3A, Vec4};

use crate::kernel::sheared;
use crate::{Aabb, Axis, Ray};

mod lanes;
mod packet;

pub use lanes::{OctantLanes, RayLanes};
pub use packet::{FusedPacket, GatheredBounds, PacketBounds};

/// A ray prepared for vector box tests that never lose a hit of a kernel. The fourth components mean nothing.
#[derive(Clone, Copy, Debug)]
pub struct FusedRay {
    /// Reciprocal of the direction, with zero clamped to a signed power of two.
    pub reciprocal: Vec4,
    /// What the places of the planes that the ray meets first are computed with.
    pub near: FusedSlabs,
    /// What the places of the planes that the ray meets last are computed with.
    pub far: FusedSlabs,
    /// Whether the direction is negative: bit `i` for axis `i`. Set for -0.0.
    pub negative: u32,
    /// The beginning of the ray's interval, not -0.0: entries into boxes may be ordered as integers.
    pub t_min: f32,
    /// The axis of the largest component of the direction; the first one on a tie.
    pub axis: Axis,
    /// The size of that component.
    pub largest: f32,
    /// Whether the ray is in the range in which the [filters](crate::BlockFilter) of kernels decide.
    pub filters_decide: bool,
}

/// What the `t` of near planes, or of far planes, is computed with: `position * reciprocal + offset` on each axis.
#[derive(Clone, Copy, Debug)]
pub struct FusedSlabs {
    /// The reciprocal of the direction, a little smaller for near planes and larger for far planes.
    pub reciprocal: Vec4,
    /// Where the plane through zero is met, for an origin that is shifted forward for near planes and backward for far planes.
    pub offset: Vec4,
}

/// How much reciprocals are smaller or larger than they are.
const RELATIVE_WIDENING: f32 = 8.0 / (1u32 << 24) as f32;
/// Direction components are kept above this.
const SMALLEST_COMPONENT: f32 = 1.0 / (1u128 << 84) as f32;
/// The shift of the origin relative to its coordinates; also more than the roundings of the other shifts.
const SHIFT: f32 = 4.0 / (1u32 << 24) as f32;
/// The shift of the origin relative to the size of the bounds.
const SHIFT_OF_SIZE: f32 = 1.0 / (1u32 << 30) as f32;
/// The shift of the origin for a negative `t_min`, relative to the largest distance.
const SHIFT_BEHIND: f32 = 2.0 * RELATIVE_WIDENING;
/// The size of the largest direction component with which boxes are culled.
const DIRECTIONS: RangeInclusive<f32> = 1.0 / (1u64 << 30) as f32..=(1u64 << 30) as f32;
/// The smallest size of bounds with which boxes are culled.
const SMALLEST_SIZE: f32 = 1.0 / (1u64 << 60) as f32;
/// The largest distance with which boxes are culled.
const FARTHEST: f32 = (1u64 << 42) as f32;
/// The same in sizes of the bounds.
const FARTHEST_IN_SIZES: f32 = (1u64 << 22) as f32;

/// The largest magnitude of a coordinate of a box that is not empty: what [`FusedRay::new`] wants to know of a structure.
#[must_use]
pub fn size_of_bounds(bounds: &Aabb) -> f32 {
    bounds.min.abs().max(bounds.max.abs()).max_element()
}

impl FusedRay {
    /// Prepares a valid ray for a structure whose bounds have the given [size](size_of_bounds) and a kernel with the given
    /// [`REACH`](crate::TriangleKernel::REACH).
    #[inline(always)]
    #[must_use]
    pub fn new(ray: &Ray, size: f32, reach: f32) -> Self {
        // All axes at a time. The fourth is harmless, and filled with what follows in memory: so this is one load.
        let (origin, direction) = (ray.origin, ray.direction);
        let origin = Vec4::new(origin.x, origin.y, origin.z, direction.x);
        let direction = Vec4::new(direction.x, direction.y, direction.z, ray.t_min);
        let magnitudes = direction.abs();
        let largest = largest_of_three(magnitudes);
        let reciprocal = magnitudes
            .max(Vec4::splat(SMALLEST_COMPONENT))
            .copysign(direction)
            .recip();
        let distance = largest_of_three(origin.abs());
        let mut shift = size * SHIFT_OF_SIZE;
        if reach > 0.0 {
            let [relative, absolute] = shift_for(reach);
            shift += (relative * farthest(size, distance) + absolute) * (1.0 + SHIFT);
        }
        let mut filters_decide = true;
        if !is_ordinary(ray, size, largest, distance) {
            (shift, filters_decide) = of_unusual_ray(ray, size, largest, distance, shift);
        }
        let shift = (origin.abs() * SHIFT + Vec4::splat(shift)).copysign(direction);
        Self {
            reciprocal,
            near: FusedSlabs::new(origin + shift, reciprocal * (1.0 - RELATIVE_WIDENING)),
            far: FusedSlabs::new(origin - shift, reciprocal * (1.0 + RELATIVE_WIDENING)),
            negative: direction.is_negative_bitmask() & 7,
            t_min: ray.t_min + 0.0,
            axis: first_axis(magnitudes.cmpeq(Vec4::splat(largest)).bitmask()),
            largest,
            filters_decide,
        }
    }
}

/// No coordinate differs more between the origin and the bounds.
#[inline(always)]
fn farthest(size: f32, distance: f32) -> f32 {
    (size + distance) * (1.0 + SHIFT)
}

/// Whether a ray begins at its origin or later, is culled, and is one that filters decide of, with room for roundings: as nearly all are.
#[inline(always)]
fn is_ordinary(ray: &Ray, size: f32, largest: f32, distance: f32) -> bool {
    let in_sizes = size * (0.5 * FARTHEST_IN_SIZES);
    let of_filters = 0.5 * sheared::FARTHEST;
    // One instruction, which `f32::min` is not.
    let farthest = if in_sizes < of_filters {
        in_sizes
    } else {
        of_filters
    };
    sheared::DIRECTIONS.contains(&largest)
        && distance <= farthest - size
        && size >= SMALLEST_SIZE
        && ray.t_min >= 0.0
}

const _: () = assert!(
    *sheared::DIRECTIONS.start() >= *DIRECTIONS.start()
        && *sheared::DIRECTIONS.end() <= *DIRECTIONS.end()
        && sheared::FARTHEST <= FARTHEST,
    "rays that filters decide of are culled"
);

/// The shift of the origin of a ray that is not ordinary, and whether filters decide of it. A call, where choices would be on the way of every ray to its first node.
#[cold]
#[inline(never)]
fn of_unusual_ray(ray: &Ray, size: f32, largest: f32, distance: f32, shift: f32) -> (f32, bool) {
    let farthest = farthest(size, distance);
    // What is not in these ranges, NaN included, culls nothing.
    let culls = DIRECTIONS.contains(&largest)
        && size >= SMALLEST_SIZE
        && farthest <= FARTHEST
        && farthest <= size * FARTHEST_IN_SIZES;
    let shift = if !culls {
        f32::INFINITY
    } else if ray.t_min < 0.0 {
        shift + SHIFT_BEHIND * farthest
    } else {
        shift
    };
    let filters_decide = sheared::DIRECTIONS.contains(&largest) && farthest <= sheared::FARTHEST;
    (shift, filters_decide)
}

/// The first axis with a bit, of which there is one.
#[inline(always)]
const fn first_axis(bits: u32) -> Axis {
    match bits.trailing_zeros() {
        0 => Axis::X,
        1 => Axis::Y,
        _ => Axis::Z,
    }
}

/// The shift of the origin for a kernel that accepts what is within its reach, in `f32` as [`reach`](crate::kernel::reach) has it: relative to the largest
/// distance, and the rest. Both are exact, for a reach is a power of two.
#[inline(always)]
const fn shift_for(reach: f32) -> [f32; 2] {
    [reach / (1u32 << 24) as f32, reach * f32::from_bits(1)]
}

/// The largest of the first three components.
#[inline(always)]
fn largest_of_three(vector: Vec4) -> f32 {
    Vec3A::from_vec4(vector).max_element()
}

impl FusedSlabs {
    #[inline(always)]
    fn new(origin: Vec4, reciprocal: Vec4) -> Self {
        Self {
            reciprocal,
            offset: -origin * reciprocal,
        }
    }
}

#[cfg(test)]
mod tests;
