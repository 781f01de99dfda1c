//! Which nodes of a binary tree become nodes with eight children, and which become leaves, at the least cost.
//!
//! Source: Ylitie, Karras, Laine, "Efficient incoherent ray traversal on GPUs through compressed wide BVHs", 2017, section 3.1. For every node
//! and every `k`, the least cost of its subtree as a forest of at most `k` trees is the least over all ways to share `k` among its children.
//! A tree is a leaf, or a node over the best forest of eight. Areas count as parts of the root's, so that sums are in the range of f32 however
//! large the scene is; where the root has none, all trees cost the same.

use tahko_geometry::Aabb;
use tahko_geometry::simd::LANES;

use crate::BvhOptions;
use crate::build::{BinaryTree, Link};

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

/// The costs of all subtrees.
pub(super) struct Collapse {
    nodes: Vec<Subtree>,
}

#[derive(Clone, Copy, Debug)]
struct Subtree {
    /// `forest[k - 1]`: the least cost as at most `k` trees.
    forest: [f32; LANES - 1],
    /// References below.
    count: u32,
    /// Whether its cheapest tree is a leaf.
    is_leaf: bool,
}

/// A tree of a forest.
#[derive(Clone, Copy, Debug)]
pub(super) struct Root {
    /// Its place in the binary tree.
    pub(super) index: usize,
    pub(super) is_leaf: bool,
}

impl Collapse {
    /// Memory for each node of the binary tree.
    pub(super) const BYTES_PER_NODE: u64 = size_of::<Subtree>() as u64;

    /// Finds the least costs of all subtrees. Cost: O(n), 40 bytes per node.
    pub(super) fn new(tree: &BinaryTree, costs: &Costs) -> Self {
        let unused = Subtree {
            forest: [0.0; LANES - 1],
            count: 0,
            is_leaf: true,
        };
        let mut nodes = vec![unused; tree.node_count()];
        let relative_area = relative_area(tree);
        // Children have larger indices.
        for index in (0..nodes.len()).rev() {
            let (bounds, link) = tree.node(index);
            let area = relative_area(&bounds);
            nodes[index] = match link {
                Link::Leaf { count, .. } => Subtree::leaf(area, count),
                Link::Inner(children) => {
                    let [first, second] = children.map(|child| nodes[child]);
                    Subtree::inner(area, &first, &second, costs)
                }
            };
        }
        Self { nodes }
    }

    /// The best trees for a subtree that may be a leaf.
    pub(super) fn root(&self) -> Root {
        Root {
            index: 0,
            is_leaf: self.nodes[0].is_leaf,
        }
    }

    /// The children of the wide node that stands for a binary node with children.
    pub(super) fn children(&self, tree: &BinaryTree, index: usize, children: &mut Vec<Root>) {
        if let (_, Link::Inner([first, second])) = tree.node(index) {
            let share = self.share(first, second, LANES);
            self.forest(tree, first, share, children);
            self.forest(tree, second, LANES - share, children);
        }
    }

    /// Adds the trees of the best forest of at most `k`.
    fn forest(&self, tree: &BinaryTree, index: usize, k: usize, roots: &mut Vec<Root>) {
        let subtree = &self.nodes[index];
        // The fewest trees at the least cost.
        let cost = subtree.forest[k - 1];
        let k = 1 + subtree
            .forest
            .iter()
            .position(|other| *other <= cost)
            .unwrap_or(k - 1);
        match tree.node(index) {
            (_, Link::Inner([first, second])) if k > 1 => {
                let share = self.share(first, second, k);
                self.forest(tree, first, share, roots);
                self.forest(tree, second, k - share, roots);
            }
            _ => roots.push(Root {
                index,
                is_leaf: subtree.is_leaf,
            }),
        }
    }

    /// How many of `k` trees the first child gets.
    fn share(&self, first: usize, second: usize, k: usize) -> usize {
        best_share(&self.nodes[first], &self.nodes[second], k).0
    }
}

/// The cheapest way to share `k` trees among two children: the share of the first one, and the cost.
#[inline]
fn best_share(first: &Subtree, second: &Subtree, k: usize) -> (usize, f32) {
    let mut best = (1, f32::INFINITY);
    for share in 1..k {
        let cost = first.forest[share - 1] + second.forest[k - share - 1];
        if cost < best.1 {
            best = (share, cost);
        }
    }
    best
}

impl Subtree {
    fn leaf(area: f32, count: usize) -> Self {
        let count = u32::try_from(count).unwrap_or(u32::MAX);
        Self {
            forest: [leaf_cost(area, count); LANES - 1],
            count,
            is_leaf: true,
        }
    }

    fn inner(area: f32, first: &Self, second: &Self, costs: &Costs) -> Self {
        let count = first.count.saturating_add(second.count);
        let (_, below) = best_share(first, second, LANES);
        let inner = area * costs.node + below;
        let leaf = if count as usize <= costs.max_leaf_size {
            leaf_cost(area, count)
        } else {
            f32::INFINITY
        };
        let mut forest = [inner.min(leaf); LANES - 1];
        for k in 2..LANES {
            forest[k - 1] = forest[k - 2].min(best_share(first, second, k).1);
        }
        Self {
            forest,
            count,
            is_leaf: leaf <= inner,
        }
    }
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
