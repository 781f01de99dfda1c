//! Filters for eight rays of a packet and a triangle at a time: the other way round than [blocks](super::BlockFilter), and cheaper where many rays meet a leaf of few triangles.
//!
//! The rays are sheared onto a common axis; [`sheared`](super::sheared) says what that asks of them, and has the bounds.

use std::hint::black_box;

use super::block::{BlockTest, BlockVerdict};
use super::one_ray::RayAlongAxis;
use super::sheared::{DIRECTIONS, FARTHEST, Limits, Shear, Sight, T_ERROR, TINY_T};
use crate::simd::{Lanes, Simd};
use crate::{Axis, RayLanes, TriangleBlock};

/// Eight rays prepared for testing single triangles, with the same promise as a [`BlockTest`]: it depends on rays and triangles how much is thrown out, but answers do not.
pub trait RaysFilter: Copy {
    /// One of the rays, for eight triangles.
    type OneRay<'a>: BlockTest + Copy
    where
        Self: 'a;

    /// Room for one.
    const EMPTY: Self;

    /// Prepares rays that are valid and begin at zero or later, for triangles inside bounds of a [size](crate::size_of_bounds). The axis is that of a large direction component, best of
    /// the largest one; `false` if that is not large for one of the rays, or anything else is out of the range in which the filter decides. It must not be asked anything then.
    fn prepare<S: Simd>(&mut self, simd: S, rays: &RayLanes, axis: Axis, size: f32) -> bool;

    /// What can be said of a triangle of a block: `None` if the kernels of no ray accept it with `t`, rounded, up to the ray's present `t_max`. Lanes are those of rays.
    fn test<S: Simd>(
        &self,
        simd: S,
        rays: &RayLanes,
        block: &TriangleBlock,
        triangle: usize,
    ) -> Option<BlockVerdict>;

    /// One of the rays alone.
    fn of_lane<'a>(&'a self, rays: &'a RayLanes, lane: usize) -> Self::OneRay<'a>;
}

/// What filters know of eight rays beside the rays.
#[derive(Clone, Copy, Debug)]
pub(super) struct RaysAlongAxis {
    /// In cyclic order; they are sheared onto the last one.
    axes: [Axis; 3],
    /// Minus the reciprocals of the direction components along it.
    pub(super) minus_reciprocal: Lanes,
    /// The sizes of the largest direction components, and some roundings.
    along: Lanes,
    /// What a computed `t` may be for an exact one from `t_min` on.
    first_t: Lanes,
    /// The end of the interval: the `t_max` of [`RayLanes`] shrinks with what is found.
    end: Lanes,
}

impl RaysAlongAxis {
    pub(super) const EMPTY: Self = Self {
        axes: Axis::X.around(),
        minus_reciprocal: Lanes::splat(1.0),
        along: Lanes::splat(1.0),
        first_t: Lanes::splat(0.0),
        end: Lanes::splat(0.0),
    };

    /// Whether all rays are in the range in which filters decide.
    #[inline(always)]
    pub(super) fn prepare<S: Simd>(
        &mut self,
        simd: S,
        rays: &RayLanes,
        axis: Axis,
        size: f32,
    ) -> bool {
        let [x, y, z] = rays.directions(simd);
        let largest = simd.max(simd.max(simd.abs(x), simd.abs(y)), simd.abs(z));
        let component = simd.load(&rays.direction[axis as usize]);
        let along = simd.abs(component);
        let [x, y, z] = rays.origins(simd);
        let distance = simd.max(simd.max(simd.abs(x), simd.abs(y)), simd.abs(z));
        let farthest = simd.mul(
            simd.add(distance, simd.splat(size)),
            simd.splat(1.0 + T_ERROR),
        );
        let t_min = simd.load(&rays.t_min);
        let margin = simd.add(
            simd.mul(simd.abs(t_min), simd.splat(T_ERROR)),
            simd.splat(TINY_T),
        );
        *self = Self {
            axes: axis.around(),
            minus_reciprocal: simd.store(simd.div(simd.splat(-1.0), component)),
            along: simd.store(simd.mul(largest, simd.splat(1.0 + T_ERROR))),
            first_t: simd.store(simd.sub(t_min, margin)),
            end: rays.t_max,
        };
        let is_in_range = simd.and(
            simd.and(
                simd.le(simd.splat(*DIRECTIONS.start()), along),
                simd.le(largest, simd.splat(*DIRECTIONS.end())),
            ),
            simd.and(
                simd.le(largest, simd.add(along, along)),
                simd.le(farthest, simd.splat(FARTHEST)),
            ),
        );
        simd.bits(is_in_range) == 0xff
    }

    /// A triangle of a block before the rays.
    #[inline(always)]
    pub(super) const fn before<'a, S: Simd>(
        &'a self,
        simd: S,
        rays: &'a RayLanes,
        block: &'a TriangleBlock,
        triangle: usize,
    ) -> BeforeRays<'a, S> {
        BeforeRays {
            simd,
            prepared: self,
            rays,
            block,
            triangle,
        }
    }

    /// One of the rays.
    #[inline(always)]
    pub(super) const fn of_lane<'a>(&'a self, rays: &'a RayLanes, lane: usize) -> RayOfLane<'a> {
        RayOfLane {
            prepared: self,
            rays,
            lane,
        }
    }

    /// The intervals of the rays.
    #[inline(always)]
    pub(super) fn limits<S: Simd>(&self, simd: S, rays: &RayLanes) -> Limits<S> {
        Limits {
            is_ahead: true,
            t_min: simd.load(&rays.t_min),
            first_t: simd.load(&self.first_t),
            t_max: simd.load(&rays.t_max),
            end: simd.load(&self.end),
        }
    }
}

/// One of eight rays that filters decide of.
#[derive(Clone, Copy, Debug)]
pub struct RayOfLane<'a> {
    prepared: &'a RaysAlongAxis,
    rays: &'a RayLanes,
    lane: usize,
}

impl RayAlongAxis for RayOfLane<'_> {
    /// It is not asked otherwise.
    #[inline(always)]
    fn decides(&self) -> bool {
        true
    }

    #[inline(always)]
    fn axes(&self) -> [Axis; 3] {
        self.prepared.axes
    }

    #[inline(always)]
    fn origin(&self, axis: Axis) -> f32 {
        self.rays.origin[axis as usize].0[self.lane]
    }

    #[inline(always)]
    fn direction(&self, axis: Axis) -> f32 {
        self.rays.direction[axis as usize].0[self.lane]
    }

    #[inline(always)]
    fn minus_reciprocal(&self) -> f32 {
        self.prepared.minus_reciprocal.0[self.lane]
    }

    #[inline(always)]
    fn along(&self) -> f32 {
        self.prepared.along.0[self.lane]
    }

    #[inline(always)]
    fn t_min(&self) -> f32 {
        self.rays.t_min.0[self.lane]
    }

    #[inline(always)]
    fn first_t(&self) -> f32 {
        self.prepared.first_t.0[self.lane]
    }

    #[inline(always)]
    fn t_max(&self) -> f32 {
        self.prepared.end.0[self.lane]
    }
}

/// A triangle of a block before eight rays.
#[derive(Clone, Copy)]
pub(super) struct BeforeRays<'a, S> {
    simd: S,
    prepared: &'a RaysAlongAxis,
    rays: &'a RayLanes,
    block: &'a TriangleBlock,
    triangle: usize,
}

impl<S: Simd> Sight<S> for BeforeRays<'_, S> {
    #[inline(always)]
    fn axes(&self) -> [Axis; 3] {
        self.prepared.axes
    }

    #[inline(always)]
    fn shear(&self) -> Shear<S> {
        let [x, y, _] = self.prepared.axes;
        Shear {
            x: self.simd.load(&self.rays.direction[x as usize]),
            y: self.simd.load(&self.rays.direction[y as usize]),
            minus_reciprocal: self.simd.load(&self.prepared.minus_reciprocal),
            along: self.simd.load(&self.prepared.along),
        }
    }

    #[inline(always)]
    fn to_origin(&self, vertex: usize, axis: Axis) -> S::F32s {
        let coordinate = self.block.coordinate(self.triangle, vertex, axis);
        let origin = self.simd.load(&self.rays.origin[axis as usize]);
        self.simd.sub(origin, self.simd.splat(coordinate))
    }

    #[inline(always)]
    fn anew(self) -> Self {
        let (rays, block) = (black_box(self.rays), black_box(self.block));
        Self {
            rays,
            block,
            ..self
        }
    }
}

#[cfg(test)]
mod tests;
