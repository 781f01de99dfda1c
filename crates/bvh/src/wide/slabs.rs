//! The test of a ray against the boxes of a node.

use tahko_geometry::simd::Simd;
use tahko_geometry::{FusedRay, FusedSlabs};

use super::node::Node;
use super::plane_order::PlaneOrder;

/// What the boxes of nodes are tested with, in registers.
pub(super) struct Slabs<'a, S: Simd> {
    simd: S,
    /// By axis: reciprocals and offsets of near planes, then of far planes.
    near: [[S::F32s; 2]; 3],
    far: [[S::F32s; 2]; 3],
    order: &'a PlaneOrder,
    t_min: S::F32s,
}

impl<'a, S: Simd> Slabs<'a, S> {
    /// The ray is read from memory, into all lanes: the place of each of its numbers is all that has to be known for that.
    #[inline(always)]
    pub(super) fn new(simd: S, ray: &FusedRay, order: &'a PlaneOrder) -> Self {
        Self {
            simd,
            near: splat(simd, &ray.near),
            far: splat(simd, &ray.far),
            order,
            t_min: simd.splat(ray.t_min),
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
        let [near, far] = node.planes(self.simd, axis, self.order);
        let t = |[reciprocal, offset]: [S::F32s; 2], places: S::F32s| {
            self.simd.mul_add(places, reciprocal, offset)
        };
        (t(self.near[axis], near), t(self.far[axis], far))
    }
}

#[inline(always)]
fn splat<S: Simd>(simd: S, slabs: &FusedSlabs) -> [[S::F32s; 2]; 3] {
    let FusedSlabs { reciprocal, offset } = slabs;
    [
        [simd.splat(reciprocal.x), simd.splat(offset.x)],
        [simd.splat(reciprocal.y), simd.splat(offset.y)],
        [simd.splat(reciprocal.z), simd.splat(offset.z)],
    ]
}
