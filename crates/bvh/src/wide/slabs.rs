//! The test of a ray against the boxes of a node.

use tahko_geometry::glam::Vec4;
use tahko_geometry::simd::Simd;
use tahko_geometry::{FusedRay, FusedSlabs};

use super::node::Node;

/// What the boxes of nodes are tested with.
pub(super) struct Slabs<S: Simd> {
    simd: S,
    near: Planes<S>,
    far: Planes<S>,
    negative: [bool; 3],
    t_min: S::F32s,
}

/// What near planes, or far planes, are tested with.
struct Planes<S: Simd> {
    reciprocal: [S::F32s; 3],
    offset: [S::F32s; 3],
}

impl<S: Simd> Planes<S> {
    #[inline(always)]
    fn new(simd: S, slabs: &FusedSlabs) -> Self {
        Self {
            reciprocal: splat(simd, slabs.reciprocal),
            offset: splat(simd, slabs.offset),
        }
    }
}

impl<S: Simd> Slabs<S> {
    #[inline(always)]
    pub(super) fn new(simd: S, ray: &FusedRay, t_min: f32) -> Self {
        Self {
            simd,
            near: Planes::new(simd, &ray.near),
            far: Planes::new(simd, &ray.far),
            negative: [1, 2, 4].map(|bit| ray.negative & bit != 0),
            // Entries are ordered as integers: no negative zero.
            t_min: simd.splat(t_min + 0.0),
        }
    }

    /// Where the ray enters the boxes, and which of them it does not miss.
    #[inline(always)]
    pub(super) fn clip<N: Node>(&self, node: &N, t_max: S::F32s) -> (S::F32s, S::Mask) {
        let simd = self.simd;
        let (near_x, far_x) = self.planes(node, 0);
        let (near_y, far_y) = self.planes(node, 1);
        let (near_z, far_z) = self.planes(node, 2);
        // What is NaN is dropped, or drops what it is compared with: the limits come last, and are numbers.
        let start = simd.max(simd.max(near_x, near_y), simd.max(near_z, self.t_min));
        let end = simd.min(simd.min(far_x, far_y), simd.min(far_z, t_max));
        (start, simd.le(start, end))
    }

    /// Where the ray meets the planes across an axis: those that it meets first, and the others.
    #[inline(always)]
    fn planes<N: Node>(&self, node: &N, axis: usize) -> (S::F32s, S::F32s) {
        let [near, far] = node.planes(self.simd, axis, self.negative[axis]);
        let t = |planes: &Planes<S>, places: S::F32s| {
            self.simd
                .mul_add(places, planes.reciprocal[axis], planes.offset[axis])
        };
        (t(&self.near, near), t(&self.far, far))
    }
}

#[inline(always)]
fn splat<S: Simd>(simd: S, vector: Vec4) -> [S::F32s; 3] {
    [
        simd.splat(vector.x),
        simd.splat(vector.y),
        simd.splat(vector.z),
    ]
}
