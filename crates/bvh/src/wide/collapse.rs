//! Which nodes of a binary tree become nodes with eight children, and which become leaves, at the least cost.
//!
//! Source: Ylitie, Karras, Laine, "Efficient incoherent ray traversal on GPUs through compressed wide BVHs", 2017, section 3.1. For every node
//! and every `k`, the least cost of its subtree as a forest of at most `k` trees is the least over all ways to share `k` among its children.
//! A tree is a leaf, or a node over the best forest of eight. Areas count as parts of the root's, so that sums are in the range of f32 however
//! large the scene is; where the root has none, all trees cost the same.
//!
//! Costs go up the recursion and are not kept: what is kept of a node are the ways that were chosen, in four bytes. Subtrees share nothing, so tasks can
//! take them in any order.

use std::sync::atomic::{AtomicU32, Ordering};

use tahko_geometry::Aabb;
use tahko_geometry::simd::LANES;

use super::choice::Choice;
use crate::BvhOptions;
use crate::build::{BinaryTree, Link};
use crate::parallel::join_if;

/// What queries pay, in units of a block of up to eight triangles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Costs {
    /// For a node with up to eight children.
    pub(crate) node: f32,
    /// The most triangles in a leaf that is not one in the binary tree.
    pub(crate) max_leaf_size: usize,
}

/// Nodes do not count as dearer than this: sums stay finite.
const DEAREST_NODE: f64 = 1e20;

impl Costs {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "costs steer, and decide nothing else"
    )]
    pub(crate) fn new(options: &BvhOptions) -> Self {
        let node = options.traversal_cost / options.intersection_cost;
        Self {
            node: node.min(DEAREST_NODE) as f32,
            max_leaf_size: options.max_leaf_size,
        }
    }
}

/// The ways that were chosen for all subtrees.
pub(super) struct Collapse<'a> {
    tree: &'a BinaryTree,
    /// By node of the binary tree. Atomic only because tasks write to places that no slices tell apart: each is written once.
    choices: Vec<AtomicU32>,
}

/// A tree of a forest: its place in the binary tree, whether it is a leaf, and whether it is the last child of its parent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Root(u32);

impl Root {
    const LEAF: u32 = 1 << 31;
    const LAST: u32 = 1 << 30;

    #[expect(
        clippy::cast_possible_truncation,
        reason = "trees have fewer than 2^30 nodes"
    )]
    fn new(index: usize, is_leaf: bool) -> Self {
        debug_assert!(index < Self::LAST as usize, "{index} is too large");
        Self(index as u32 | if is_leaf { Self::LEAF } else { 0 })
    }

    pub(super) const fn index(self) -> usize {
        (self.0 & !(Self::LEAF | Self::LAST)) as usize
    }

    pub(super) const fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }

    pub(super) const fn is_last(self) -> bool {
        self.0 & Self::LAST != 0
    }
}

/// Nodes for each task, about: those of 50 microseconds.
const TASK: usize = 1 << 11;

impl<'a> Collapse<'a> {
    /// Memory for each node of the binary tree.
    pub(super) const BYTES_PER_NODE: u64 = size_of::<Choice>() as u64;

    /// Finds the least costs of all subtrees. Cost: O(n), 4 bytes per node.
    pub(super) fn new(tree: &'a BinaryTree, costs: &Costs) -> Self {
        let count = tree.node_count();
        let choices = (0..count).map(|_| AtomicU32::new(0)).collect();
        let collapse = Self { tree, choices };
        if count > 0 {
            let pricing = Pricing {
                collapse: &collapse,
                costs,
                relative_area: relative_area(tree),
            };
            pricing.price(
                0,
                (count / TASK)
                    .checked_ilog2()
                    .map_or(0, |levels| levels + 2),
            );
        }
        collapse
    }

    fn choice(&self, index: usize) -> Choice {
        Choice::from_bits(self.choices[index].load(Ordering::Relaxed))
    }

    /// The best tree for a subtree that may be a leaf.
    fn tree_at(&self, index: usize) -> Root {
        Root::new(index, self.choice(index).is_leaf())
    }

    /// The best tree for all triangles, of which there is at least one.
    pub(super) fn root(&self) -> Root {
        self.tree_at(0)
    }

    /// The references below a node of the binary tree, or [`Choice::MANY`].
    pub(super) fn count(&self, index: usize) -> u32 {
        self.choice(index).count()
    }

    /// Appends the children of the wide node that stands for a binary node with children, in order.
    pub(super) fn children(&self, index: usize, roots: &mut Vec<Root>) {
        self.add_forest(index, LANES, roots);
        if let Some(last) = roots.last_mut() {
            last.0 |= Root::LAST;
        }
    }

    /// Adds the trees of the best forest of at most `k`.
    fn add_forest(&self, index: usize, k: usize, roots: &mut Vec<Root>) {
        let choice = self.choice(index);
        if let Some((k, share)) = choice.forest(k)
            && let (_, Link::Inner([first, second])) = self.tree.node(index)
        {
            self.add_forest(first, share, roots);
            self.add_forest(second, k - share, roots);
        } else {
            roots.push(Root::new(index, choice.is_leaf()));
        }
    }
}

/// The costs of a subtree.
struct Subtree {
    /// `forest[k - 1]`: the least cost as at most `k` trees.
    forest: [f32; LANES - 1],
    /// References below.
    count: u32,
    /// Whether it is one node.
    is_single: bool,
}

/// What finds the costs and writes down the choices.
struct Pricing<'a, F> {
    collapse: &'a Collapse<'a>,
    costs: &'a Costs,
    relative_area: F,
}

impl<F: Fn(&Aabb) -> f32 + Sync> Pricing<'_, F> {
    /// Finds the costs of a subtree, that of its children at the same time if there are `levels` left on which that is worth it. The recursion is
    /// as deep as the binary tree.
    fn price(&self, index: usize, levels: u32) -> Subtree {
        let (bounds, link) = self.collapse.tree.node(index);
        let area = (self.relative_area)(&bounds);
        let (subtree, choice) = match link {
            Link::Leaf { count, .. } => Subtree::leaf(area, count),
            Link::Inner([first, second]) => {
                let below = levels.saturating_sub(1);
                let (first, second) = join_if(
                    levels > 0,
                    || self.price(first, below),
                    || self.price(second, below),
                );
                Subtree::inner(area, &first, &second, self.costs)
            }
        };
        self.collapse.choices[index].store(choice.bits(), Ordering::Relaxed);
        subtree
    }
}

impl Subtree {
    fn leaf(area: f32, count: usize) -> (Self, Choice) {
        let count = u32::try_from(count).unwrap_or(u32::MAX);
        let subtree = Self {
            forest: [leaf_cost(area, count); LANES - 1],
            count,
            is_single: true,
        };
        (subtree, Choice::new(true, count))
    }

    fn inner(area: f32, first: &Self, second: &Self, costs: &Costs) -> (Self, Choice) {
        let count = first.count.saturating_add(second.count);
        let ways = ways(first, second);
        let (share, below) = ways[LANES - 2];
        let inner = area * costs.node + below;
        let leaf = if count as usize <= costs.max_leaf_size {
            leaf_cost(area, count)
        } else {
            f32::INFINITY
        };
        let mut choice = Choice::new(leaf <= inner, count);
        // The children of a node are a forest, whether or not that is cheaper than the node.
        choice.set_share(LANES, share);
        let mut least = inner.min(leaf);
        let mut forest = [least; LANES - 1];
        for k in 2..LANES {
            let (share, cost) = ways[k - 2];
            if cost < least {
                least = cost;
                choice.set_share(k, share);
            }
            forest[k - 1] = least;
        }
        let subtree = Self {
            forest,
            count,
            is_single: false,
        };
        (subtree, choice)
    }
}

/// The cheapest ways to share two to eight trees among two children: the share of the first one, the smallest on a tie, and the cost.
///
/// A child that is one node has no use for more than one tree. Most nodes have such a child.
fn ways(first: &Subtree, second: &Subtree) -> [(usize, f32); LANES - 1] {
    let mut ways = [(1, f32::INFINITY); LANES - 1];
    if first.is_single {
        for (way, rest) in ways.iter_mut().zip(second.forest) {
            *way = (1, first.forest[0] + rest);
        }
    } else if second.is_single {
        let mut best = ways[0];
        for (index, (way, part)) in ways.iter_mut().zip(first.forest).enumerate() {
            let cost = part + second.forest[0];
            if cost < best.1 {
                best = (index + 1, cost);
            }
            *way = best;
        }
    } else {
        for (index, way) in ways.iter_mut().enumerate() {
            for share in 1..index + 2 {
                let cost = first.forest[share - 1] + second.forest[index + 1 - share];
                if cost < way.1 {
                    *way = (share, cost);
                }
            }
        }
    }
    ways
}

fn leaf_cost(area: f32, count: u32) -> f32 {
    let blocks = (count as usize).div_ceil(LANES);
    area * blocks as f32
}

/// Areas of boxes in a tree as parts of that of its root.
fn relative_area(tree: &BinaryTree) -> impl Fn(&Aabb) -> f32 {
    let root_area = if tree.is_empty() {
        0.0
    } else {
        tree.node(0).0.half_area()
    };
    let scale = if root_area > 0.0 {
        1.0 / root_area
    } else {
        0.0
    };
    #[expect(
        clippy::cast_possible_truncation,
        reason = "costs steer, and decide nothing else"
    )]
    move |bounds| (bounds.half_area() * scale) as f32
}

#[cfg(test)]
mod tests;
