//! Rays as vectors want them.

use crate::simd::{LANES, Lanes, Simd};
use crate::{Axis, Ray};

/// Eight rays, number by number.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct RayLanes {
    pub(crate) origin: [Lanes; 3],
    pub(crate) direction: [Lanes; 3],
    /// The smallest `t` of each that counts.
    pub t_min: Lanes,
    /// The largest.
    pub t_max: Lanes,
}

impl RayLanes {
    /// Eight times the same ray.
    #[must_use]
    pub fn splat(ray: &Ray) -> Self {
        let splat = |vector: glam::Vec3| vector.to_array().map(Lanes::splat);
        Self {
            origin: splat(ray.origin),
            direction: splat(ray.direction),
            t_min: Lanes::splat(ray.t_min + 0.0),
            t_max: Lanes::splat(ray.t_max),
        }
    }

    /// Which rays may be in a packet, and into which octants they go.
    #[inline(always)]
    #[must_use]
    pub fn octants<S: Simd>(&self, simd: S) -> OctantLanes {
        let zero = simd.splat(0.0);
        let [x, y, z] = self.directions(simd);
        let negative = [simd.sign_bits(x), simd.sign_bits(y), simd.sign_bits(z)];
        let [x, y, z] = [simd.abs(x), simd.abs(y), simd.abs(z)];
        let [u, v, w] = self.origins(simd);
        let [u, v, w] = [simd.abs(u), simd.abs(v), simd.abs(w)];
        // False for NaN, as all that follows.
        let finite = simd.splat(f32::MAX);
        let is_finite = |a: S::F32s, b: S::F32s| simd.and(simd.le(a, finite), simd.le(b, finite));
        let are_finite = simd.and(simd.and(is_finite(x, y), is_finite(z, u)), is_finite(v, w));
        let is_somewhere = simd.or(
            simd.or(simd.lt(zero, x), simd.lt(zero, y)),
            simd.lt(zero, z),
        );
        let (t_min, t_max) = (simd.load(&self.t_min), simd.load(&self.t_max));
        let is_interval = simd.and(simd.le(zero, t_min), simd.le(t_min, t_max));
        OctantLanes {
            members: simd.bits(simd.and(simd.and(are_finite, is_somewhere), is_interval)),
            negative,
        }
    }

    /// Eight rays.
    #[inline(always)]
    #[must_use]
    pub fn new<S: Simd>(simd: S, rays: &[Ray; LANES]) -> Self {
        let row = |ray: &Ray| {
            let ([u, v, w], [x, y, z]) = (ray.origin.to_array(), ray.direction.to_array());
            simd.load(&Lanes([u, v, w, x, y, z, ray.t_min, ray.t_max]))
        };
        let [a, b, c, d, e, f, g, h] = rays;
        let rows = [
            row(a),
            row(b),
            row(c),
            row(d),
            row(e),
            row(f),
            row(g),
            row(h),
        ];
        let [u, v, w, x, y, z, t_min, t_max] = simd.transpose(rows);
        Self {
            origin: [simd.store(u), simd.store(v), simd.store(w)],
            direction: [simd.store(x), simd.store(y), simd.store(z)],
            t_min: simd.store(simd.add(t_min, simd.splat(0.0))),
            t_max: simd.store(t_max),
        }
    }

    /// Puts a ray in the place of another one.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, ray: &Ray) {
        for axis in Axis::ALL {
            self.origin[axis as usize].0[lane] = ray.origin[axis as usize];
            self.direction[axis as usize].0[lane] = ray.direction[axis as usize];
        }
        self.t_min.0[lane] = ray.t_min + 0.0;
        self.t_max.0[lane] = ray.t_max;
    }

    /// The origins of all, by axis.
    // No `map`: what is not inlined is compiled without the instructions of the level.
    #[inline(always)]
    pub(crate) fn origins<S: Simd>(&self, simd: S) -> [S::F32s; 3] {
        let [x, y, z] = &self.origin;
        [simd.load(x), simd.load(y), simd.load(z)]
    }

    /// The directions of all, by axis.
    #[inline(always)]
    pub(crate) fn directions<S: Simd>(&self, simd: S) -> [S::F32s; 3] {
        let [x, y, z] = &self.direction;
        [simd.load(x), simd.load(y), simd.load(z)]
    }
}

/// What [`RayLanes::octants`] tells, a bit for each lane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OctantLanes {
    /// Rays that are valid and begin at zero or later.
    pub members: u32,
    /// By axis: rays with a negative direction, also of -0.0.
    pub negative: [u32; 3],
}

#[cfg(test)]
mod tests;
