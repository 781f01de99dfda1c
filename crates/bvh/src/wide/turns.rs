//! Several rays in flight, a step each in turn.
//!
//! A single ray spends most of its time waiting: for the next node to come from memory, for one result of a chain of others, for a branch that was foreseen wrongly. So a thread
//! has several rays in flight, and each in turn visits a node or a block of triangles: while one waits the others work. What a ray needs next is asked for when that is decided.
//!
//! **Late decisions.** A visit only tests, without a branch on what is found. What follows from it is decided some visits of other rays later, when the result is known: a branch
//! that was foreseen wrongly is then noticed at once, and the work on other rays that was begun before it is not lost. Hence, too, a block is only
//! [filtered](BlockTest::candidates) when it is visited, also for the triangle that a ray starts on, and looked at again if that leaves something of it.
//!
//! Each ray visits the nodes that it would visit alone, in the same order.

use std::marker::PhantomData;
use std::ops::ControlFlow;

use tahko_geometry::kernel::{BlockFilter, BlockTest};
use tahko_geometry::simd::{Lanes, Simd, WithSimd};
use tahko_geometry::{Candidates, FusedRay, HitCollector, Ray, TriangleBlock, TriangleKernel};

use super::access::View;
use super::batch::Batch;
use super::leaf::{Left, Nearer};
use super::node::Node;
use super::order::nearest_child;
use super::plane_order::PlaneOrder;
use super::slabs::Slabs;
use super::stack::{Entry, Rooms, Stack};
use super::{Child, Kind};

/// Rays that a thread has in flight.
const IN_FLIGHT: usize = 16;
/// So many visits of other rays are between the visit of a ray and the decision.
const LAG: usize = 2;

/// The searches of a batch, in turns.
pub(super) struct Turns<'a, K: TriangleKernel, H: HitCollector, N>(pub(super) Batch<'a, K, H, N>);

/// A ray on its way. What a visit of a node wants is in three cache lines; and the place of each is found by a shift.
#[repr(C, align(512))]
struct Flight<'a, K: TriangleKernel, H> {
    fused: FusedRay,
    t_max: f32,
    /// What it visits.
    child: Child,
    /// Lanes whose boxes the ray enters, or whose triangles it may hit; as of the last visit.
    hits: u32,
    /// Lanes whose triangles its line meets for certain.
    met: u32,
    /// Where it enters the boxes.
    starts: Lanes,
    stack: Stack<'a>,
    ray: &'a Ray,
    /// Its place in the batch.
    index: usize,
    filter: K::Block,
    collector: H,
}

impl<K: TriangleKernel, H: HitCollector, N: Node> WithSimd for Turns<'_, K, H, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Batch {
            bvh, rays, answers, ..
        } = self.0;
        let mut waiting = rays.iter().enumerate();
        let mut rooms = Rooms::new(rays.len().min(IN_FLIGHT));
        let mut flights: Vec<Flight<'_, K, H>> = Vec::with_capacity(IN_FLIGHT);
        for room in rooms.iter_mut() {
            let Some((index, ray)) = next_valid::<S, K, H>(simd, &mut waiting, answers) else {
                break;
            };
            flights.push(Flight::new(bvh, index, ray, Stack::new(room)));
        }
        // While all places are taken no branch has to ask for the last one of them: in between are the branches of several rays, after which it would be foreseen wrongly.
        if let Ok(all) = <&mut [_; IN_FLIGHT]>::try_from(&mut *flights) {
            for flight in &mut all[..LAG] {
                flight.visit(simd, bvh);
            }
            let mut place = 0;
            loop {
                all[(place + LAG) % IN_FLIGHT].visit(simd, bvh);
                let deciding = &mut all[place % IN_FLIGHT];
                if deciding.turn(simd, bvh, &mut waiting, answers).is_break() {
                    break;
                }
                place += 1;
            }
            flights.swap_remove(place % IN_FLIGHT);
        }
        // Some have been visited: once more changes no answer.
        while !flights.is_empty() {
            for flight in &mut flights {
                flight.visit(simd, bvh);
            }
            flights.retain_mut(|flight| {
                let turn = flight.turn(simd, bvh, &mut waiting, answers);
                turn.is_continue()
            });
        }
    }
}

/// The next ray that can hit anything; those before it are answered.
#[inline(always)]
fn next_valid<'a, S: Simd, K: TriangleKernel, H: HitCollector>(
    simd: S,
    rays: &mut impl Iterator<Item = (usize, &'a Ray)>,
    answers: &mut [H::Answer],
) -> Option<(usize, &'a Ray)> {
    rays.find(|(index, ray)| {
        let is_valid = ray.is_valid();
        if !is_valid {
            answers[*index] = H::new(ray).finish::<S, K, ()>(simd, ray, &mut ());
        }
        is_valid
    })
}

impl<'a, K: TriangleKernel, H: HitCollector> Flight<'a, K, H> {
    #[inline(always)]
    fn new<N: Node>(bvh: View<'_, N>, index: usize, ray: &'a Ray, stack: Stack<'a>) -> Self {
        let fused = FusedRay::new(ray, bvh.size, K::REACH);
        Self {
            index,
            ray,
            fused,
            filter: K::Block::new(ray, &fused),
            collector: H::new(ray),
            t_max: ray.t_max,
            hits: 0,
            met: 0,
            starts: Lanes::splat(0.0),
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

    /// [Decides](Self::decide), and gives the place of a ray that is done to another one. `Break` if no ray is left.
    #[inline(always)]
    fn turn<S: Simd, N: Node>(
        &mut self,
        simd: S,
        bvh: View<'_, N>,
        waiting: &mut impl Iterator<Item = (usize, &'a Ray)>,
        answers: &mut [H::Answer],
    ) -> ControlFlow<()> {
        if self.decide(simd, bvh).is_continue() {
            return ControlFlow::Continue(());
        }
        answers[self.index] = self.collector.finish::<S, K, ()>(simd, self.ray, &mut ());
        match next_valid::<S, K, H>(simd, waiting, answers) {
            Some((index, ray)) => {
                self.start(bvh, index, ray);
                ControlFlow::Continue(())
            }
            None => ControlFlow::Break(()),
        }
    }

    /// Tests the boxes of a node, or filters a block of triangles.
    #[inline(always)]
    fn visit<S: Simd, N: Node>(&mut self, simd: S, bvh: View<'_, N>) {
        match self.child.kind() {
            Kind::Inner(index) => {
                let node = bvh.node(index);
                let order = PlaneOrder::known(self.fused.negative);
                let slabs = Slabs::new(simd, &self.fused, order);
                let (start, hits) = slabs.clip(node, simd.splat(self.t_max));
                self.starts = simd.store(start);
                self.hits = simd.bits(hits);
            }
            Kind::Leaf(index) => {
                let block = bvh.block(index);
                let Candidates { possible, met } = self.filter.candidates(simd, block, self.t_max);
                self.hits = possible;
                self.met = met;
                // Whatever is closer by then, it begins before that.
                let next = Entry::new(Child::leaf(index + 1), f32::NEG_INFINITY);
                self.stack.push_if(block.continues(), next);
            }
        }
    }

    /// Tests what may be hit of a block.
    #[inline(always)]
    fn test<S: Simd>(&mut self, simd: S, block: &TriangleBlock) -> ControlFlow<()> {
        if H::ORDERED {
            let candidates = Candidates {
                possible: self.hits,
                met: self.met,
            };
            return simd.outline(Nearer::<K, H, ()> {
                block,
                candidates,
                ray: self.ray,
                kernel: PhantomData,
                collector: &mut self.collector,
                counter: &mut (),
            });
        }
        simd.outline(Left::<K, H, ()> {
            block,
            possible: self.hits,
            ray: self.ray,
            filter: &self.filter,
            collector: &mut self.collector,
            counter: &mut (),
        })
    }

    /// Finds what comes next after a visit. `Break` at the end of the search.
    #[inline(always)]
    fn decide<S: Simd, N: Node>(&mut self, simd: S, bvh: View<'_, N>) -> ControlFlow<()> {
        let child = if self.hits == 0 {
            self.stack.pop_before::<H>(self.t_max)
        } else {
            match self.child.kind() {
                Kind::Inner(index) => {
                    let node = bvh.node(index);
                    let starts = || &self.starts;
                    Some(nearest_child::<S, H, N, _>(
                        bvh,
                        simd,
                        node,
                        starts,
                        self.hits,
                        &mut self.stack,
                    ))
                }
                Kind::Leaf(index) => {
                    let block = bvh.block(index);
                    self.test(simd, block)?;
                    self.t_max = self.collector.t_max();
                    self.stack.pop_before::<H>(self.t_max)
                }
            }
        };
        let Some(child) = child else {
            return ControlFlow::Break(());
        };
        bvh.prefetch(simd, child);
        self.child = child;
        ControlFlow::Continue(())
    }
}
