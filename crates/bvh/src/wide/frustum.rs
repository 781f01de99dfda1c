//! The test of a packet of rays, all at once, against the boxes of a node.

use tahko_geometry::PacketBounds;
use tahko_geometry::simd::{Lanes, Simd};

use super::node::Node;

/// What bounds the rays of a packet.
pub(super) struct Frustum<S: Simd> {
    simd: S,
    /// By axis, for near and far planes: the shifted origin.
    origins: [[S::F32s; 2]; 3],
    /// By axis, for near and far planes: the smallest and the largest reciprocal.
    reciprocals: [[[S::F32s; 2]; 2]; 3],
    negative: [bool; 3],
}

impl<S: Simd> Frustum<S> {
    /// The bounds of rays that go into an octant and begin at zero or later.
    #[inline(always)]
    pub(super) fn new(simd: S, bounds: &PacketBounds, negative: u32) -> Self {
        Self {
            simd,
            origins: [
                pair(simd, bounds.origins[0]),
                pair(simd, bounds.origins[1]),
                pair(simd, bounds.origins[2]),
            ],
            reciprocals: [
                pairs(simd, bounds.reciprocals[0]),
                pairs(simd, bounds.reciprocals[1]),
                pairs(simd, bounds.reciprocals[2]),
            ],
            negative: [1, 2, 4].map(|bit| negative & bit != 0),
        }
    }

    /// Numbers that no ray enters the boxes before, and a bit for each box that one of them may meet up to `t_max`.
    #[inline(always)]
    pub(super) fn clip<N: Node>(&self, node: &N, t_max: f32) -> (Lanes, u32) {
        let simd = self.simd;
        let planes = |axis: usize| node.planes(simd, axis, self.negative[axis]);
        let [x, y, z] = [planes(0), planes(1), planes(2)];
        let near = |planes: S::F32s, axis: usize| {
            let [a, b] = self.places(planes, axis, 0);
            simd.min(a, b)
        };
        let far = |planes: S::F32s, axis: usize| {
            let [a, b] = self.places(planes, axis, 1);
            simd.max(a, b)
        };
        // As for a single ray: what is NaN is dropped.
        let start = simd.max(
            simd.max(near(x[0], 0), near(y[0], 1)),
            simd.max(near(z[0], 2), simd.splat(0.0)),
        );
        let end = simd.min(
            simd.min(far(x[1], 0), far(y[1], 1)),
            simd.min(far(z[1], 2), simd.splat(t_max)),
        );
        (simd.store(start), simd.bits(simd.le(start, end)))
    }

    /// Where the planes of a side are met with the smallest and with the largest reciprocal.
    #[inline(always)]
    fn places(&self, planes: S::F32s, axis: usize, side: usize) -> [S::F32s; 2] {
        let simd = self.simd;
        let distance = simd.sub(planes, self.origins[axis][side]);
        let [smallest, largest] = self.reciprocals[axis][side];
        [simd.mul(distance, smallest), simd.mul(distance, largest)]
    }
}

#[inline(always)]
fn pair<S: Simd>(simd: S, [a, b]: [f32; 2]) -> [S::F32s; 2] {
    [simd.splat(a), simd.splat(b)]
}

#[inline(always)]
fn pairs<S: Simd>(simd: S, [a, b]: [[f32; 2]; 2]) -> [[S::F32s; 2]; 2] {
    [pair(simd, a), pair(simd, b)]
}
