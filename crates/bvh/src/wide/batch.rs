//! Many rays at a time: coherent ones in [packets](super::packets), others in turns.
//!
//! **In turns.** A single ray spends most of its time waiting: for the next node to come from memory, for one result of a chain of others, for a
//! branch that was foreseen wrongly. So a thread has several rays in flight and gives each a step, a node or a leaf, in turn: while one waits the others work. What a ray
//! needs next is asked for at the end of its step.
//!
//! Each ray visits the nodes that it would visit alone, in the same order.

use std::marker::PhantomData;
use std::ops::ControlFlow;

use tahko_geometry::glam::Vec3;
use tahko_geometry::kernel::BlockFilter;
use tahko_geometry::simd::{AvailableSimd, Simd, SimdLevel, WithSimd};
use tahko_geometry::{FusedRay, HitCollector, Ray, TriangleKernel};

use super::access::View;
use super::leaf::Leaf;
use super::node::Node;
use super::order::nearest_child;
use super::packets::Packets;
use super::slabs::Slabs;
use super::stack::Stack;
use super::traverse::search;
use super::{Child, Kind};

/// Rays that a thread has in flight.
const IN_FLIGHT: usize = 8;

/// The searches of many rays.
pub(super) struct Batch<'a, K: TriangleKernel, H: HitCollector, N> {
    pub(super) bvh: View<'a, N>,
    pub(super) rays: &'a [Ray],
    pub(super) answers: &'a mut [H::Answer],
    pub(super) kernel: PhantomData<K>,
}

impl<K: TriangleKernel, H: HitCollector, N: Node> Batch<'_, K, H, N> {
    /// The best instructions that packets are traced with. With AVX-512 a Sapphire Rapids was measured to take 7 to 24 % longer for packets of shadow rays and about as long for those
    /// of a camera, where rays alone gain.
    const OF_PACKETS: SimdLevel = SimdLevel::Avx2;

    /// Answers all rays, with instructions up to a level.
    pub(super) fn run(self, simd: AvailableSimd) {
        if are_coherent(self.rays, self.bvh.size) {
            simd.at_most(Self::OF_PACKETS).dispatch(Packets(self));
        } else {
            simd.dispatch(Turns(self));
        }
    }
}

/// Whether neighbours in a list of rays begin near each other and go nearly the same way, as a sample tells. The limits tell the rays of a camera from bounced
/// ones; they were not tuned further.
fn are_coherent(rays: &[Ray], size: f32) -> bool {
    const SAMPLES: usize = 64;
    let step = (rays.len() / SAMPLES).max(1);
    let pairs = rays.windows(2).step_by(step);
    let count = pairs.len();
    let similar = pairs.filter(|pair| {
        let [first, second] = [&pair[0], &pair[1]];
        let [from, to] = [first.direction, second.direction].map(Vec3::normalize_or_zero);
        let distance = (first.origin - second.origin).length();
        from.dot(to) > 0.99 && distance <= size * 0.05
    });
    2 * similar.count() > count
}

/// The search of a ray; one that is not valid hits nothing.
#[inline(always)]
pub(super) fn search_one<S: Simd, K: TriangleKernel, H: HitCollector, N: Node>(
    simd: S,
    bvh: View<'_, N>,
    ray: &Ray,
) -> H::Answer {
    let mut collector = H::new(ray);
    if ray.is_valid() {
        search::<S, K, H, (), N>(simd, bvh, ray, &mut collector, &mut ());
    }
    collector.finish::<K, ()>(ray, &mut ())
}

/// Several rays in flight.
struct Turns<'a, K: TriangleKernel, H: HitCollector, N>(Batch<'a, K, H, N>);

/// A ray on its way.
struct Flight<'a, K: TriangleKernel, H> {
    /// Its place in the batch.
    index: usize,
    ray: &'a Ray,
    fused: FusedRay,
    filter: K::Block,
    collector: H,
    t_max: f32,
    /// What it visits next.
    child: Child,
    stack: Stack<'a>,
}

impl<K: TriangleKernel, H: HitCollector, N: Node> WithSimd for Turns<'_, K, H, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Batch {
            bvh, rays, answers, ..
        } = self.0;
        let mut waiting = rays.iter().enumerate();
        let mut rooms = vec![Stack::room(); IN_FLIGHT];
        let mut flights: Vec<Flight<'_, K, H>> = Vec::with_capacity(IN_FLIGHT);
        for room in &mut rooms {
            let Some((index, ray)) = next_valid::<K, H>(&mut waiting, answers) else {
                break;
            };
            flights.push(Flight::new(bvh, index, ray, Stack::new(room)));
        }
        // While all places are taken no branch has to ask for the last one of them: in between are the branches of several rays, after which it would be foreseen wrongly.
        let mut place = 0;
        if let Ok(all) = <&mut [_; IN_FLIGHT]>::try_from(&mut *flights) {
            while all[place % IN_FLIGHT]
                .turn(simd, bvh, &mut waiting, answers)
                .is_continue()
            {
                place += 1;
            }
            flights.swap_remove(place % IN_FLIGHT);
        }
        while !flights.is_empty() {
            place = 0;
            while place < flights.len() {
                let turn = flights[place].turn(simd, bvh, &mut waiting, answers);
                if turn.is_break() {
                    flights.swap_remove(place);
                } else {
                    place += 1;
                }
            }
        }
    }
}

/// The next ray that can hit anything; those before it are answered.
#[inline(always)]
fn next_valid<'a, K: TriangleKernel, H: HitCollector>(
    rays: &mut impl Iterator<Item = (usize, &'a Ray)>,
    answers: &mut [H::Answer],
) -> Option<(usize, &'a Ray)> {
    rays.find(|(index, ray)| {
        let is_valid = ray.is_valid();
        if !is_valid {
            answers[*index] = H::new(ray).finish::<K, ()>(ray, &mut ());
        }
        is_valid
    })
}

impl<'a, K: TriangleKernel, H: HitCollector> Flight<'a, K, H> {
    #[inline(always)]
    fn new<N: Node>(bvh: View<'_, N>, index: usize, ray: &'a Ray, mut stack: Stack<'a>) -> Self {
        let fused = FusedRay::new(ray, bvh.size, K::REACH);
        stack.clear();
        Self {
            index,
            ray,
            fused,
            filter: K::Block::new(ray, &fused),
            collector: H::new(ray),
            t_max: ray.t_max,
            child: bvh.root,
            stack,
        }
    }

    /// Gives the place of a ray that is done to another one.
    #[inline(always)]
    fn start<N: Node>(&mut self, bvh: View<'_, N>, index: usize, ray: &'a Ray) {
        self.index = index;
        self.ray = ray;
        self.fused = FusedRay::new(ray, bvh.size, K::REACH);
        self.filter = K::Block::new(ray, &self.fused);
        self.collector = H::new(ray);
        self.t_max = ray.t_max;
        self.stack.clear();
        self.child = bvh.root;
    }

    /// Gives the ray a step, and its place to another one after its last step. `Break` if no ray is left.
    #[inline(always)]
    fn turn<S: Simd, N: Node>(
        &mut self,
        simd: S,
        bvh: View<'_, N>,
        waiting: &mut impl Iterator<Item = (usize, &'a Ray)>,
        answers: &mut [H::Answer],
    ) -> ControlFlow<()> {
        if self.step(simd, bvh).is_continue() {
            return ControlFlow::Continue(());
        }
        answers[self.index] = self.collector.finish::<K, ()>(self.ray, &mut ());
        match next_valid::<K, H>(waiting, answers) {
            Some((index, ray)) => {
                self.start(bvh, index, ray);
                ControlFlow::Continue(())
            }
            None => ControlFlow::Break(()),
        }
    }

    /// Visits one node or leaf. `Break` at the end of the search.
    #[inline(always)]
    fn step<S: Simd, N: Node>(&mut self, simd: S, bvh: View<'_, N>) -> ControlFlow<()> {
        let nearest = match self.child.kind() {
            Kind::Inner(index) => {
                let node = bvh.node(index);
                let slabs = Slabs::new(simd, &self.fused);
                let (start, hits) = slabs.clip(node, simd.splat(self.t_max));
                let hits = simd.bits(hits);
                if hits == 0 {
                    self.stack.pop_before::<H>(self.t_max)
                } else {
                    Some(nearest_child::<S, H, N>(
                        bvh,
                        simd,
                        node,
                        start,
                        hits,
                        &mut self.stack,
                    ))
                }
            }
            Kind::Leaf(first_block) => {
                let leaf = Leaf::<K, H, ()> {
                    blocks: bvh.blocks_from(first_block),
                    ray: self.ray,
                    filter: &self.filter,
                    collector: &mut self.collector,
                    counter: &mut (),
                };
                simd.outline(leaf)?;
                self.t_max = self.collector.t_max();
                self.stack.pop_before::<H>(self.t_max)
            }
        };
        let Some(child) = nearest else {
            return ControlFlow::Break(());
        };
        bvh.prefetch(simd, child);
        self.child = child;
        ControlFlow::Continue(())
    }
}

#[cfg(test)]
mod tests;
