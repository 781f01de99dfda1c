//! The order in which a ray visits the children of a node.

use std::borrow::Borrow;

use tahko_geometry::HitCollector;
use tahko_geometry::simd::{LANES, Lanes, Simd};

use super::Child;
use super::access::View;
use super::node::Node;
use super::stack::{Entry, Stack};

/// Of at least one child that the ray hits, the one that it enters first; the others are pushed, the farthest one first. Where it enters them is asked for if there are several.
#[inline(always)]
pub(super) fn nearest_child<S: Simd, H: HitCollector, N: Node, L: Borrow<Lanes>>(
    bvh: View<'_, N>,
    simd: S,
    node: &N,
    starts: impl FnOnce() -> L,
    hits: u32,
    stack: &mut Stack<'_>,
) -> Child {
    let children = node.lanes();
    let lane = |bits: u32| bits.trailing_zeros() as usize % LANES;
    let first = lane(hits);
    let rest = hits & (hits - 1);
    if rest == 0 {
        return children[first];
    }
    if !H::ORDERED {
        stack.push_all(rest, children);
        return children[first];
    }
    let starts = starts();
    let starts: &Lanes = starts.borrow();
    let entry = |lane: usize| Entry::new(children[lane], starts.0[lane]);
    let a = entry(first);
    let b = entry(lane(rest));
    let rest = rest & (rest - 1);
    if rest == 0 {
        let [near, far] = sorted(a, b);
        if !bvh.is_cached {
            bvh.prefetch(simd, far.child());
        }
        stack.push(far);
        return near.child();
    }
    let c = entry(lane(rest));
    let rest = rest & (rest - 1);
    if rest == 0 {
        let [a, b] = sorted(a, b);
        let [b, c] = sorted(b, c);
        let [a, b] = sorted(a, b);
        if !bvh.is_cached {
            bvh.prefetch(simd, b.child());
        }
        stack.push(c);
        stack.push(b);
        return a.child();
    }
    let d = entry(lane(rest));
    let rest = rest & (rest - 1);
    if rest == 0 {
        let ([a, b], [c, d]) = (sorted(a, b), sorted(c, d));
        let ([a, c], [b, d]) = (sorted(a, c), sorted(b, d));
        let [b, c] = sorted(b, c);
        stack.push(d);
        stack.push(c);
        stack.push(b);
        return a.child();
    }
    for entry in [a, b, c, d] {
        stack.push(entry);
    }
    let mut count = 4;
    let mut rest = rest;
    while rest != 0 {
        stack.push(entry(lane(rest)));
        rest &= rest - 1;
        count += 1;
    }
    stack.sort_last(count);
    stack.pop().map_or(Child::NOTHING, Entry::child)
}

/// Two entries in order, without a branch.
#[inline(always)]
fn sorted(a: Entry, b: Entry) -> [Entry; 2] {
    if b < a { [b, a] } else { [a, b] }
}
