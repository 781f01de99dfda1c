//! The step of packets: eight rays and a triangle.

use super::collector::{CertainHit, HitCollector};
use super::{RaySearches, test_filtered};
use crate::kernel::{BlockFilter, RaysFilter};
use crate::simd::{Simd, lanes_of};
use crate::{Interval, RayLanes, TriangleBlock, TriangleKernel};

/// The filter of a kernel for eight rays.
pub type RaysFilterOf<K> = <<K as TriangleKernel>::Block as BlockFilter>::Rays;

/// Tests a triangle of a block with the rays of some lanes and offers the hits to their searches, which are those from a place on, as [`test_block`](super::test_block) does for one ray and eight triangles. Keeps the
/// lanes' `t_max`; gives a bit for each ray whose search is over.
///
/// The filter was prepared for these rays, and decides.
#[inline(always)]
pub fn test_rays<S: Simd, K: TriangleKernel, H: HitCollector>(
    simd: S,
    (rays, filter): (&mut RayLanes, &RaysFilterOf<K>),
    (block, triangle): (&TriangleBlock, usize),
    (searches, first): (&mut RaySearches<'_, H>, usize),
    lanes: u32,
) -> u32 {
    let Some(verdict) = filter.test(simd, rays, block, triangle) else {
        return 0;
    };
    let mut done = 0;
    let certain = verdict.certain & lanes;
    if certain != 0 {
        let (primitive, vertices) = (block.used_number(triangle), block.vertices(triangle));
        for lane in lanes_of(certain) {
            let search = searches.search(first + lane);
            let t = Interval {
                start: verdict.starts.0[lane],
                end: verdict.ends.0[lane],
            };
            if t.start > search.collector.t_max() {
                continue;
            }
            let hit = CertainHit {
                primitive,
                vertices,
                t,
            };
            let step = search
                .collector
                .collect_certain::<K, ()>(search.ray, &hit, &mut ());
            done |= u32::from(search.keep(rays, lane, step)) << lane;
        }
    }
    for lane in lanes_of(verdict.possible & !verdict.certain & lanes) {
        let search = searches.search(first + lane);
        let step = test_filtered(
            &K::new(search.ray),
            &block.triangle(triangle),
            block.used_number(triangle),
            &mut search.collector,
            &mut (),
        );
        done |= u32::from(search.keep(rays, lane, step)) << lane;
    }
    done
}
