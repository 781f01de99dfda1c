//! The traversal of a packet: rays that go nearly the same way.
//!
//! A node is tested once for all rays, by [what bounds them](Frustum). The boxes that this leaves are tested, when their turn comes, with
//! eight rays at a time. Where few rays are left, each goes on alone. What happens in [leaves](leaf) depends on how many rays there are.

mod leaf;

use std::marker::PhantomData;
use std::ops::ControlFlow;

use tahko_geometry::glam::Vec3;
use tahko_geometry::kernel::BlockFilter;
use tahko_geometry::simd::{LANES, Lanes, Simd, WithSimd, bits_of};
use tahko_geometry::{
    Axis, ClosestHit, FusedPacket, FusedRay, GatheredBounds, HitCollector, Ray, RayLanes,
    RaySearch, RaySearches, RaysFilter, RaysFilterOf, TriangleKernel,
};

use self::leaf::{LeafOf, LeafOfAll};
use super::access::View;
use super::frustum::Frustum;
use super::node::Node;
use super::traverse::Way;
use super::{Child, Kind};

/// Rays of a packet at most: one bit each.
pub(super) const SIZE: usize = RaySearches::<ClosestHit>::MOST;
const GROUPS: usize = SIZE / LANES;
/// So few rays go on alone. Measured with 4 and 8: 4 is better by up to 2 %, for primary rays.
const FEW: u32 = 4;

/// Rays that go into the same octant and begin at zero or later, with what they have found.
pub(super) struct Packet<'a, K: TriangleKernel, H> {
    groups: [Group<K>; GROUPS],
    /// Whether all filters decide.
    filters_decide: bool,
    /// For each ray, a bit for each triangle of a block that it may hit.
    possible: [u32; SIZE],
    searches: RaySearches<'a, H>,
    waiting: Vec<Waiting>,
}

/// Eight of the rays.
struct Group<K: TriangleKernel> {
    rays: RayLanes,
    fused: FusedPacket,
    filter: RaysFilterOf<K>,
}

/// A child that waits.
#[derive(Clone, Copy)]
struct Waiting {
    /// A bit for each ray that has entered its parent.
    rays: u64,
    /// The parent, and where in it the child is.
    node: Child,
    lane: usize,
    /// No ray enters it before.
    start: f32,
}

impl<'a, K: TriangleKernel, H: HitCollector> Packet<'a, K, H> {
    /// Room for a packet.
    pub(super) fn new() -> Self {
        let anything = Ray::new(Vec3::ZERO, Vec3::ONE);
        Self {
            groups: std::array::from_fn(|_| Group {
                rays: RayLanes::splat(&anything),
                fused: FusedPacket::EMPTY,
                filter: RaysFilterOf::<K>::EMPTY,
            }),
            filters_decide: false,
            possible: [0; SIZE],
            searches: RaySearches::new(),
            waiting: Vec::new(),
        }
    }

    /// Makes it a packet of up to [`SIZE`] rays.
    #[inline(always)]
    pub(super) fn fill<S: Simd>(&mut self, simd: S, rays: &'a [Ray]) {
        let (groups, rest) = rays.as_chunks::<LANES>();
        for (group, rays) in self.groups.iter_mut().zip(groups) {
            group.rays = RayLanes::new(simd, rays);
        }
        if let (Some(group), Some(first)) = (self.groups.get_mut(groups.len()), rest.first()) {
            group.rays = lanes_beside(first);
            for (lane, ray) in rest.iter().enumerate() {
                group.rays.set(lane, ray);
            }
        }
        self.searches.fill(rays);
    }

    /// Makes it a packet of the rays of some places.
    pub(super) fn fill_with(&mut self, rays: &'a [Ray], places: u64) {
        self.searches.fill_with(rays, places);
        for (place, index) in bits_of(places).enumerate() {
            let (lanes, ray) = (&mut self.groups[place / LANES % GROUPS].rays, &rays[index]);
            if place.is_multiple_of(LANES) {
                *lanes = lanes_beside(ray);
            }
            lanes.set(place % LANES, ray);
        }
    }

    /// The rays, eight at a time.
    pub(super) fn rays(&self) -> impl Iterator<Item = &RayLanes> {
        self.groups[..self.used_groups()]
            .iter()
            .map(|group| &group.rays)
    }

    /// The answers of all rays, each with the place of its ray in the list.
    #[inline(always)]
    pub(super) fn finish<S: Simd>(&mut self, simd: S, answer: impl FnMut(usize, H::Answer)) {
        let groups = &self.groups[..self.used_groups()];
        let lanes = groups.iter().map(|group| &group.rays);
        self.searches.finish::<S, K>(simd, lanes, answer);
    }

    fn used_groups(&self) -> usize {
        self.searches.len().div_ceil(LANES)
    }

    /// The largest `t` that still matters to any ray.
    #[inline(always)]
    fn t_max<S: Simd>(&self, simd: S) -> f32 {
        let mut largest = simd.splat(f32::NEG_INFINITY);
        for rays in self.rays() {
            largest = simd.max(largest, simd.load(&rays.t_max));
        }
        // One instruction each, which `f32::max` is not: there is no NaN.
        let larger = |a: f32, b: f32| if a > b { a } else { b };
        let [a, b, c, d, e, f, g, h] = simd.store(largest).0;
        let (first, last) = (
            larger(larger(a, b), larger(c, d)),
            larger(larger(e, f), larger(g, h)),
        );
        larger(first, last)
    }

    /// Which rays meet the box of a child.
    #[inline(always)]
    fn clip<S: Simd, N: Node>(
        &self,
        simd: S,
        node: &N,
        lane: usize,
        negative: u32,
        rays: u64,
    ) -> u64 {
        let plane = |axis: usize, side: u32| {
            simd.splat(node.child_plane(axis, side ^ negative >> axis, lane))
        };
        let near_planes = [plane(0, 0), plane(1, 0), plane(2, 0)];
        let far_planes = [plane(0, 1), plane(1, 1), plane(2, 1)];
        let mut met = 0;
        for group in groups_with(rays) {
            let Group {
                rays: lanes, fused, ..
            } = &self.groups[group];
            let place = |plane: S::F32s, [reciprocal, offset]: &[Lanes; 2]| {
                simd.mul_add(plane, simd.load(reciprocal), simd.load(offset))
            };
            let near = |axis: usize| place(near_planes[axis], &fused.near[axis]);
            let far = |axis: usize| place(far_planes[axis], &fused.far[axis]);
            let start = simd.max(
                simd.max(near(0), near(1)),
                simd.max(near(2), simd.load(&lanes.t_min)),
            );
            let end = simd.min(
                simd.min(far(0), far(1)),
                simd.min(far(2), simd.load(&lanes.t_max)),
            );
            met |= u64::from(simd.bits(simd.le(start, end))) << (LANES * group);
        }
        met & rays
    }

    /// Does something with some rays that may lead to their answers, and tells which of them have it.
    #[inline(always)]
    fn advance(
        &mut self,
        rays: u64,
        mut step: impl FnMut(&mut RaySearch<'a, H>) -> ControlFlow<()>,
    ) -> u64 {
        let mut done = 0;
        for place in bits_of(rays) {
            let rays = &mut self.groups[place / LANES % GROUPS].rays;
            let search = self.searches.search(place);
            let step = step(search);
            done |= u64::from(search.keep(rays, place % LANES, step)) << place;
        }
        done
    }

    /// Lets the children of a node wait, the nearest one in front.
    #[inline(always)]
    fn wait(&mut self, node: Child, starts: &Lanes, hits: u32, rays: u64) {
        let first = self.waiting.len();
        for lane in bits_of(u64::from(hits)) {
            let child = Waiting {
                rays,
                node,
                lane,
                start: starts.0[lane % LANES],
            };
            let mut place = self.waiting.len();
            self.waiting.push(child);
            while H::ORDERED && place > first && self.waiting[place - 1].start < child.start {
                self.waiting[place] = self.waiting[place - 1];
                place -= 1;
            }
            self.waiting[place] = child;
        }
    }
}

/// The groups that have any of some rays, a bit in the place of its last ray for each.
#[inline(always)]
const fn last_rays(rays: u64) -> u64 {
    const BELOW_LAST: u64 = u64::from_ne_bytes([0x7f; GROUPS]);
    (((rays & BELOW_LAST) + BELOW_LAST) | rays) & !BELOW_LAST
}

/// The groups that have any of some rays.
#[inline(always)]
fn groups_with(rays: u64) -> impl Iterator<Item = usize> {
    bits_of(last_rays(rays)).map(|place| place / LANES % GROUPS)
}

/// Lanes that are not used have a ray of the packet, for the bounds, and take no part.
fn lanes_beside(ray: &Ray) -> RayLanes {
    let mut lanes = RayLanes::splat(ray);
    lanes.t_max = Lanes::splat(f32::NEG_INFINITY);
    lanes
}

/// The searches of the rays of a packet, of which there is at least one.
pub(super) struct PacketSearch<'p, 'a, K: TriangleKernel, H, N> {
    pub(super) bvh: View<'p, N>,
    pub(super) packet: &'p mut Packet<'a, K, H>,
    pub(super) negative: u32,
}

impl<K: TriangleKernel, H: HitCollector, N: Node> WithSimd for PacketSearch<'_, '_, K, H, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self {
            bvh,
            packet,
            negative,
        } = self;
        let mut bounds = GatheredBounds::new(negative);
        let size = (bvh.size, K::REACH);
        let axis = Axis::dominant(packet.searches.ray(0).direction);
        packet.filters_decide = true;
        let used = packet.used_groups();
        for group in &mut packet.groups[..used] {
            let rays = &group.rays;
            group.fused.prepare(simd, rays, negative, size, &mut bounds);
            packet.filters_decide &= group.filter.prepare(simd, rays, axis, bvh.size);
        }
        let frustum = Frustum::new(simd, &bounds.all_lanes(simd, negative), negative);
        let mut searching = u64::MAX >> (SIZE - packet.searches.len());
        let mut t_max = packet.t_max(simd);
        packet.waiting.clear();
        let mut next = Some((bvh.root, searching));
        loop {
            if let Some((child, rays)) = next.take() {
                if let Kind::Inner(index) = child.kind()
                    && rays.count_ones() > FEW
                {
                    let (starts, hits) = frustum.clip(bvh.node(index), t_max);
                    packet.wait(child, &starts, hits, rays);
                } else {
                    let done = match child.kind() {
                        Kind::Inner(_) => packet.advance(rays, |search| {
                            simd.outline(Alone::<K, H, N>(bvh, search, child, PhantomData))
                        }),
                        Kind::Leaf(first_block) if packet.filters_decide => {
                            let blocks = bvh.blocks_from(first_block);
                            simd.outline(LeafOfAll {
                                packet,
                                frustum: &frustum,
                                t_max,
                                blocks,
                                rays,
                            })
                        }
                        Kind::Leaf(first_block) => packet.advance(rays, |search| {
                            simd.outline(LeafOf::<K, H, N>(bvh, search, first_block, PhantomData))
                        }),
                    };
                    searching &= !done;
                    if searching == 0 {
                        return;
                    }
                    if H::ORDERED {
                        t_max = packet.t_max(simd);
                    }
                }
            }
            let Some(waiting) = packet.waiting.pop() else {
                return;
            };
            if waiting.start > t_max {
                continue;
            }
            let node = bvh.node(waiting.node.index());
            let lane = waiting.lane % LANES;
            let child = node.lanes()[lane];
            if !bvh.is_cached {
                // They come while the box is tested: the child, and the one that is next, if none of this one's comes before it.
                bvh.prefetch(simd, child);
                if let Some(next) = packet.waiting.last() {
                    let node = bvh.node(next.node.index());
                    bvh.prefetch(simd, node.lanes()[next.lane % LANES]);
                }
            }
            let rays = packet.clip(simd, node, lane, negative, waiting.rays & searching);
            next = (rays != 0).then_some((child, rays));
        }
    }
}

/// A ray's way through a subtree.
struct Alone<'m, 'a, K, H, N>(View<'m, N>, &'m mut RaySearch<'a, H>, Child, PhantomData<K>);

impl<K: TriangleKernel, H: HitCollector, N: Node> WithSimd for Alone<'_, '_, K, H, N> {
    type Output = ControlFlow<()>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> ControlFlow<()> {
        let Self(bvh, search, child, _) = self;
        let fused = FusedRay::new(search.ray, bvh.size, K::REACH);
        let way = Way::<K, H, (), N> {
            bvh,
            ray: search.ray,
            fused: &fused,
            filter: &K::Block::new(search.ray, &fused),
            collector: &mut search.collector,
            counter: &mut (),
        };
        way.search(simd, child)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_are_those_that_have_any_ray() {
        let groups = |rays: u64| groups_with(rays).collect::<Vec<_>>();
        assert_eq!(groups(0), []);
        assert_eq!(groups(u64::MAX), [0, 1, 2, 3, 4, 5, 6, 7]);
        for ray in 0..SIZE {
            assert_eq!(groups(1 << ray), [ray / LANES], "{ray}");
            assert_eq!(last_rays(1 << ray), 1 << (ray | 7), "{ray}");
            let next = (ray + LANES) % SIZE;
            let mut expected = [ray / LANES, next / LANES];
            expected.sort_unstable();
            assert_eq!(groups(1 << ray | 1 << next), expected, "{ray}");
        }
        assert_eq!(groups(0x8000_0000_7f00_0100), [1, 3, 7]);
    }
}
