//! The test of a packet of rays, all at once, against the boxes of a node or of triangles.

use tahko_geometry::simd::{Lanes, Simd};
use tahko_geometry::{PacketBounds, TriangleBlock};

use super::node::Node;
use super::plane_order::PlaneOrder;

/// What bounds the rays of a packet.
pub(super) struct Frustum<S: Simd> {
    simd: S,
    /// By axis, for near and far planes: the shifted origin.
    origins: [[S::F32s; 2]; 3],
    /// By axis, for near and far planes: the smallest and the largest reciprocal.
    reciprocals: [[[S::F32s; 2]; 2]; 3],
    order: PlaneOrder,
    /// The octant.
    negative: u32,
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
            order: PlaneOrder::new(negative),
            negative,
        }
    }

    /// Numbers that no ray enters the boxes before, and a bit for each box that one of them may meet up to `t_max`.
    #[inline(always)]
    pub(super) fn clip<N: Node>(&self, node: &N, t_max: f32) -> (Lanes, u32) {
        let planes = |axis: usize| node.planes(self.simd, axis, &self.order);
        let (start, hits) = self.clip_boxes([planes(0), planes(1), planes(2)], t_max);
        (self.simd.store(start), hits)
    }

    /// A bit for each triangle of a block that one of the rays may meet up to `t_max`: those whose boxes they meet.
    #[inline(always)]
    pub(super) fn candidates(&self, block: &TriangleBlock, t_max: f32) -> u32 {
        let mut planes = block.bounds(self.simd);
        for (axis, planes) in planes.iter_mut().enumerate() {
            if self.negative >> axis & 1 != 0 {
                planes.swap(0, 1);
            }
        }
        let (_, hits) = self.clip_boxes(planes, t_max);
        hits & block.used()
    }

    /// Where no ray enters boxes before, given the planes that are met first and last across each axis, and a bit for each that one of them may meet.
    #[inline(always)]
    fn clip_boxes(&self, [x, y, z]: [[S::F32s; 2]; 3], t_max: f32) -> (S::F32s, u32) {
        let simd = self.simd;
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
        (start, simd.bits(simd.le(start, end)))
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

#[cfg(test)]
mod tests {
    use tahko_geometry::glam::{Vec3, Vec3Swizzles};
    use tahko_geometry::simd::{SimdLevel, WithSimd};
    use tahko_geometry::{Aabb, FusedPacket, GatheredBounds, Ray, RayLanes, Triangle};

    use super::*;
    use crate::wide::{Child, WideNode};

    struct Clip<'a> {
        rays: &'a RayLanes,
        negative: u32,
        node: &'a WideNode,
        block: &'a TriangleBlock,
        t_max: f32,
    }

    impl WithSimd for Clip<'_> {
        type Output = (Lanes, [u32; 2]);

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
            let mut bounds = GatheredBounds::new(self.negative);
            let mut packet = FusedPacket::EMPTY;
            packet.prepare(simd, self.rays, self.negative, (20.0, 0.0), &mut bounds);
            let frustum = Frustum::new(simd, &bounds.all_lanes(simd, self.negative), self.negative);
            let (starts, hits) = frustum.clip(self.node, self.t_max);
            (starts, [hits, frustum.candidates(self.block, self.t_max)])
        }
    }

    /// A node of cubes, at -9, -6 and so on along an axis, which leaves the last lane without a child; and triangles with the same boxes.
    fn row_of_cubes(axis: Vec3) -> (WideNode, TriangleBlock) {
        let mut node = WideNode::EMPTY;
        let mut block = TriangleBlock::EMPTY;
        for lane in 0..7u8 {
            let centre = axis * (3.0 * f32::from(lane) - 9.0);
            let cube = Aabb::new(centre - Vec3::ONE, centre + Vec3::ONE);
            node.set(usize::from(lane), &cube, Child::leaf(1));
            let triangle = Triangle::new(cube.max, centre + Vec3::X, cube.min);
            block.set(usize::from(lane), 0, &triangle);
        }
        (node, block)
    }

    #[test]
    fn boxes_that_a_ray_of_the_packet_meets_are_left_and_others_are_not() {
        for axis in Vec3::AXES {
            let (node, block) = row_of_cubes(axis);
            for sign in [1.0, -1.0] {
                // From beside the fifth cube, at 3, on to all but the first ones; those behind, and those beyond `t_max`, are culled.
                let side = axis.yzx() * 0.1;
                let direction = sign * axis + 0.01 * axis.yzx();
                let mut rays = RayLanes::splat(&Ray::new(1.5 * axis + side, direction));
                rays.set(
                    1,
                    &Ray::new(1.6 * axis - side, direction + 0.02 * axis.zxy()),
                );
                let expected = if sign > 0.0 {
                    [0b111_0000, 0b001_0000]
                } else {
                    [0b000_1111, 0b000_1000]
                };
                for level in SimdLevel::ALL.into_iter().filter_map(SimdLevel::available) {
                    for (t_max, expected) in [f32::INFINITY, 2.0].into_iter().zip(expected) {
                        let (starts, hits) = level.dispatch(Clip {
                            rays: &rays,
                            negative: direction.is_negative_bitmask(),
                            node: &node,
                            block: &block,
                            t_max,
                        });
                        assert_eq!(hits, [expected; 2], "{axis} {sign} {t_max}: {hits:?}");
                        // The nearest cube begins half a unit ahead.
                        let nearest = if sign > 0.0 { 4 } else { 3 };
                        let start = starts.0[nearest];
                        assert!((0.38..=0.6).contains(&start), "{axis} {sign}: {start}");
                    }
                }
            }
        }
    }

    #[test]
    fn boxes_beside_all_rays_are_culled() {
        for axis in Vec3::AXES {
            let (node, block) = row_of_cubes(axis);
            let across = axis.yzx();
            let rays = RayLanes::splat(&Ray::new(-20.0 * across, across + 0.001 * axis));
            let level = SimdLevel::Portable.available().expect("on every processor");
            let (_, hits) = level.dispatch(Clip {
                rays: &rays,
                negative: 0,
                node: &node,
                block: &block,
                t_max: f32::INFINITY,
            });
            assert_eq!(
                hits, [0b000_1000; 2],
                "{axis}: the one at zero alone, {hits:?}"
            );
        }
    }
}
