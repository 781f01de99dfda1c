//! The test of a packet against the triangles of a leaf: one by one with eight rays at a time, or eight at a time with one ray after the other, whichever takes less.

use std::marker::PhantomData;
use std::ops::ControlFlow;

use tahko_geometry::kernel::{BlockFilter, BlockTest};
use tahko_geometry::simd::{LANES, Simd, WithSimd, bits_of};
use tahko_geometry::{
    FusedRay, HitCollector, RaySearch, RaysFilter, TriangleBlock, TriangleKernel, offer_all,
    test_possible, test_rays,
};

use super::{GROUPS, Group, Packet, SIZE, groups_with, last_rays};
use crate::wide::access::View;
use crate::wide::frustum::Frustum;
use crate::wide::leaf::Leaf;
use crate::wide::node::Node;

/// The costs of a test of a triangle with eight rays and of a ray with eight triangles, which is read from the lanes. Measured when it had a call and a filter of its own, with 1 to 2, 2 to 3, 4 to 5 and 1 to 1: the last is
/// better by a twentieth on scans and among hairs than 2 to 3, and slower by as much for shadow rays in a kitchen; the one before is not.
const COST_OF_RAYS: [u32; 2] = [4, 5];

/// From so many rays on that look for any hit, the triangles that all of the packet miss are looked for before any is tested, for often that is all of them. With rays that look for the closest hit
/// it seldom is, and the look pays only before tests of eight rays.
const MANY: u32 = 16;

/// The test of a leaf by rays whose filters decide, which tells those whose search is over.
pub(super) struct LeafOfAll<'p, 'a, K: TriangleKernel, H, L: Simd> {
    pub(super) packet: &'p mut Packet<'a, K, H>,
    /// What bounds the packet.
    pub(super) frustum: &'p Frustum<L>,
    /// The largest `t` that still matters to any of its rays.
    pub(super) t_max: f32,
    /// The leaf begins here.
    pub(super) blocks: &'p [TriangleBlock],
    /// The rays that have entered it.
    pub(super) rays: u64,
}

impl<K: TriangleKernel, H: HitCollector, L: Simd> WithSimd for LeafOfAll<'_, '_, K, H, L> {
    type Output = u64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> u64 {
        let Self {
            packet,
            frustum,
            t_max,
            blocks,
            rays,
        } = self;
        let mut left = rays;
        for block in blocks {
            let [cost_of_rays, cost] = COST_OF_RAYS;
            let (count, groups) = (left.count_ones(), last_rays(left).count_ones());
            let goes_together =
                |triangles: u32| triangles.count_ones() * groups * cost_of_rays < count * cost;
            let mut triangles = block.used();
            if goes_together(triangles) || !H::ORDERED && count >= MANY {
                triangles = frustum.candidates(block, t_max);
            }
            let done = if triangles == 0 {
                0
            } else if goes_together(triangles) {
                packet.test_together(simd, block, triangles, left)
            } else if H::ORDERED {
                packet.test_one_by_one(simd, block, left)
            } else {
                packet.filter_then_test(simd, block, left)
            };
            left &= !done;
            if !block.continues() || left == 0 {
                break;
            }
        }
        rays & !left
    }
}

impl<K: TriangleKernel, H: HitCollector> Packet<'_, K, H> {
    /// Tests some triangles of a block one by one with eight rays at a time; the filters decide.
    #[inline(always)]
    fn test_together<S: Simd>(
        &mut self,
        simd: S,
        block: &TriangleBlock,
        triangles: u32,
        rays: u64,
    ) -> u64 {
        let mut left = rays;
        for triangle in bits_of(u64::from(triangles)) {
            for group in groups_with(left) {
                let lanes = (left >> (LANES * group) & 0xff) as u32;
                let searches = (&mut self.searches, LANES * group);
                let Group { rays, filter, .. } = &mut self.groups[group];
                let prepared = (rays, &*filter);
                let place = (block, triangle % LANES);
                let done = test_rays::<S, K, H>(simd, prepared, place, searches, lanes);
                left &= !(u64::from(done) << (LANES * group));
            }
        }
        rays & !left
    }

    /// Tests a block with one ray after the other; the filters decide.
    #[inline(always)]
    fn test_one_by_one<S: Simd>(&mut self, simd: S, block: &TriangleBlock, rays: u64) -> u64 {
        let mut done = 0;
        for place in bits_of(rays) {
            let lane = place % LANES;
            let Group { rays, filter, .. } = &mut self.groups[place / LANES % GROUPS];
            let verdict = filter
                .of_lane(rays, lane)
                .test(simd, block, rays.t_max.0[lane]);
            if let Some(verdict) = verdict {
                let search = self.searches.search(place);
                let step = offer_all::<K, H, ()>(
                    search.ray,
                    block,
                    &verdict,
                    &mut search.collector,
                    &mut (),
                );
                done |= u64::from(search.keep(rays, lane, step)) << place;
            }
        }
        done
    }

    /// Filters a block for one ray after the other, without a branch on what is found, before it tests what is left for any of them. The filters decide.
    ///
    /// Rays that look for any hit mostly start on a surface, and pass what looks like hits and is none: that would be foreseen wrongly again and again. Rays that look for the closest hit
    /// mostly have one, which would be looked at twice.
    #[inline(always)]
    fn filter_then_test<S: Simd>(&mut self, simd: S, block: &TriangleBlock, rays: u64) -> u64 {
        let mut left = 0;
        for place in bits_of(rays) {
            let Group { rays, filter, .. } = &self.groups[place / LANES % GROUPS];
            let lane = place % LANES;
            let filter = filter.of_lane(rays, lane);
            let possible = filter.possible(simd, block, rays.t_max.0[lane]);
            self.possible[place % SIZE] = possible;
            left |= u64::from(possible != 0) << place;
        }
        let mut done = 0;
        for place in bits_of(left) {
            let Group { rays, filter, .. } = &mut self.groups[place / LANES % GROUPS];
            let filter = filter.of_lane(rays, place % LANES);
            let search = self.searches.search(place);
            let step = test_possible::<S, K, H, ()>(
                simd,
                (search.ray, &filter),
                (block, self.possible[place % SIZE]),
                &mut search.collector,
                &mut (),
            );
            done |= u64::from(search.keep(rays, place % LANES, step)) << place;
        }
        done
    }
}

/// A ray's test of a leaf.
pub(super) struct LeafOf<'m, 'a, K, H, N>(
    pub(super) View<'m, N>,
    pub(super) &'m mut RaySearch<'a, H>,
    pub(super) usize,
    pub(super) PhantomData<K>,
);

impl<K: TriangleKernel, H: HitCollector, N: Node> WithSimd for LeafOf<'_, '_, K, H, N> {
    type Output = ControlFlow<()>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> ControlFlow<()> {
        let Self(bvh, search, first_block, _) = self;
        let fused = FusedRay::new(search.ray, bvh.size, K::REACH);
        let leaf = Leaf::<K, H, ()> {
            blocks: bvh.blocks_from(first_block),
            ray: search.ray,
            filter: &K::Block::new(search.ray, &fused),
            collector: &mut search.collector,
            counter: &mut (),
        };
        leaf.with_simd(simd)
    }
}
