//! A ray before eight triangles, as the filters of the kernels want it.

use std::hint::black_box;

use super::sheared::{Limits, Shear, Sight};
use crate::simd::Simd;
use crate::{Axis, TriangleBlock};

/// What filters know of a ray that is sheared onto an axis: one that was prepared alone, or one of eight.
pub(super) trait RayAlongAxis: Copy {
    /// Whether filters say anything of triangles.
    fn decides(&self) -> bool;

    /// The axes in cyclic order, that of the shear last.
    fn axes(&self) -> [Axis; 3];

    /// A coordinate of the origin.
    fn origin(&self, axis: Axis) -> f32;

    /// A component of the direction.
    fn direction(&self, axis: Axis) -> f32;

    /// Minus the reciprocal of the direction component along the axis.
    fn minus_reciprocal(&self) -> f32;

    /// The size of the largest direction component, and some roundings.
    fn along(&self) -> f32;

    fn t_min(&self) -> f32;

    /// What a computed `t` may be for an exact one from `t_min` on.
    fn first_t(&self) -> f32;

    /// The end of the interval.
    fn t_max(&self) -> f32;
}

/// The interval of a ray.
#[inline(always)]
pub(super) fn limits<S: Simd>(simd: S, ray: &impl RayAlongAxis, t_max: f32) -> Limits<S> {
    Limits {
        is_ahead: ray.t_min() >= 0.0,
        t_min: simd.splat(ray.t_min()),
        first_t: simd.splat(ray.first_t()),
        t_max: simd.splat(t_max),
        end: simd.splat(ray.t_max()),
    }
}

/// The triangles of a block before a ray.
#[derive(Clone, Copy)]
pub(super) struct BeforeRay<'a, S, R> {
    simd: S,
    // Asked of the ray once: the compiler makes branches of it.
    axes: [Axis; 3],
    ray: &'a R,
    block: &'a TriangleBlock,
}

impl<'a, S: Simd, R: RayAlongAxis> BeforeRay<'a, S, R> {
    #[inline(always)]
    pub(super) fn new(simd: S, ray: &'a R, block: &'a TriangleBlock) -> Self {
        Self {
            simd,
            axes: ray.axes(),
            ray,
            block,
        }
    }
}

impl<S: Simd, R: RayAlongAxis> Sight<S> for BeforeRay<'_, S, R> {
    #[inline(always)]
    fn axes(&self) -> [Axis; 3] {
        self.axes
    }

    #[inline(always)]
    fn shear(&self) -> Shear<S> {
        let Self { simd, ray, .. } = *self;
        let [x, y, _] = self.axes;
        Shear {
            x: simd.splat(ray.direction(x)),
            y: simd.splat(ray.direction(y)),
            minus_reciprocal: simd.splat(ray.minus_reciprocal()),
            along: simd.splat(ray.along()),
        }
    }

    #[inline(always)]
    fn to_origin(&self, vertex: usize, axis: Axis) -> S::F32s {
        let origin = self.simd.splat(self.ray.origin(axis));
        self.simd
            .sub(origin, self.block.load(self.simd, vertex, axis))
    }

    #[inline(always)]
    fn anew(self) -> Self {
        Self {
            block: black_box(self.block),
            ..self
        }
    }
}
