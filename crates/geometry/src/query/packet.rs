//! The step of packets: eight rays and a triangle.

use std::ops::ControlFlow;

use super::collector::{CertainHit, HitCollector};
use super::test_filtered;
use crate::kernel::{BlockFilter, RaysFilter};
use crate::simd::{LANES, Simd, lanes_of};
use crate::{Interval, Ray, RayLanes, TriangleBlock, TriangleKernel};

/// A ray on its way, and what it has found.
#[derive(Clone, Copy, Debug)]
pub struct RaySearch<'a, H> {
    /// The ray.
    pub ray: &'a Ray,
    /// What it has found.
    pub collector: H,
}

impl<'a, H: HitCollector> RaySearch<'a, H> {
    /// A search that has found nothing yet.
    #[inline(always)]
    #[must_use]
    pub fn new(ray: &'a Ray) -> Self {
        Self {
            ray,
            collector: H::new(ray),
        }
    }

    /// Keeps the ray's `t_max` after a step, in its lane. Whether the search is over, after which nothing matters to the ray.
    #[inline(always)]
    pub fn keep(&self, rays: &mut RayLanes, lane: usize, step: ControlFlow<()>) -> bool {
        let is_over = step.is_break();
        rays.t_max.0[lane % LANES] = if is_over {
            f32::NEG_INFINITY
        } else {
            self.collector.t_max()
        };
        is_over
    }
}

/// The filter of a kernel for eight rays.
pub type RaysFilterOf<K> = <<K as TriangleKernel>::Block as BlockFilter>::Rays;

/// Tests a triangle of a block with the rays of some lanes and offers the hits to their collectors, as [`test_block`](super::test_block) does for one ray and eight triangles. Keeps the
/// lanes' `t_max`; gives a bit for each ray whose search is over.
///
/// The filter was prepared for these rays, and decides.
#[inline(always)]
pub fn test_rays<S: Simd, K: TriangleKernel, H: HitCollector>(
    simd: S,
    (rays, filter): (&mut RayLanes, &RaysFilterOf<K>),
    (block, triangle): (&TriangleBlock, usize),
    searches: &mut [RaySearch<'_, H>],
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
            let search = &mut searches[lane];
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
        let search = &mut searches[lane];
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
