//! Rounds of merging neighbours among clusters in a row.
//!
//! A round has three passes over lists that stay in the cache: which neighbours merge is seen from the areas of their unions alone; then the pairs that
//! merge become nodes; then boxes and trees close ranks. None of them has a branch on whether a cluster merges, which no processor could
//! predict.

use tahko_geometry::simd::LANES;

use super::node::{BuildNode, Link, to_u32};
use super::reference::{Bounds, CentroidScale};
use crate::BvhOptions;

/// What a node costs below the size of a leaf, in tests of a leaf. Less than a visit: the layout joins nodes of few children,
/// so all that another node takes is a place among eight.
const NODE_COST: f32 = 0.3;

/// What steers the merging.
pub(super) struct Rules {
    scale: CentroidScale,
    max_leaf_size: u32,
}

impl Rules {
    /// Leaves are as large as one test of a query, or as the options say.
    #[expect(clippy::cast_possible_truncation, reason = "at most a block")]
    pub(super) fn new(scale: CentroidScale, options: &BvhOptions) -> Self {
        let max_leaf_size = options.max_leaf_size.min(LANES) as u32;
        Self {
            scale,
            max_leaf_size,
        }
    }
}

/// Clusters in the order of a curve, each a subtree whose root is in no list yet, and the nodes below them.
pub(super) struct Clusters {
    boxes: Vec<Bounds>,
    trees: Vec<Tree>,
    /// Half areas of the boxes around each two neighbours, between infinities: one more than there are clusters, and the first is that before the
    /// first cluster.
    unions: Vec<f32>,
    /// Siblings side by side, below their parents' in time.
    nodes: Vec<BuildNode>,
    moves: Moves,
}

/// What a cluster is, beside its box.
#[derive(Clone, Copy)]
struct Tree {
    /// Leaves that a ray through the scene is expected to test in it, times the area of the scene; nodes in proportion.
    cost: f32,
    /// Its triangles are neighbours in the order of the curve.
    first: u32,
    count: u32,
    /// The place of the first child among the nodes, or [`LEAF`](Self::LEAF).
    child: u32,
}

impl Tree {
    const LEAF: u32 = u32::MAX;

    fn node(&self, bounds: &Bounds) -> BuildNode {
        let link = if self.child == Self::LEAF {
            Link::Leaf {
                first: self.first as usize,
                count: self.count as usize,
            }
        } else {
            Link::Inner([self.child as usize, self.child as usize + 1])
        };
        BuildNode::new(&bounds.to_aabb(), link)
    }
}

/// What happens in a round.
struct Moves {
    /// 1 for each cluster that takes the next one, 0 for others.
    takes_next: Vec<u32>,
    /// Clusters that stay or take the next one: twice their places, and 1 if they take it. Only the first ones mean something.
    kept: Vec<u32>,
    kept_count: usize,
    /// The places of those that take the next one. Only the first ones mean something.
    merged: Vec<u32>,
    merged_count: usize,
}

impl Clusters {
    /// A cluster for each of some boxes, of triangles that stand in a row from a place in the order on.
    pub(super) fn new(boxes: Vec<Bounds>, first: usize, rules: &Rules) -> Self {
        let trees = boxes
            .iter()
            .zip(to_u32(first)..)
            .map(|(bounds, first)| Tree {
                cost: rules.scale.half_area(bounds),
                first,
                count: 1,
                child: Tree::LEAF,
            });
        let trees = trees.collect();
        let between = boxes
            .windows(2)
            .map(|pair| rules.scale.half_area(&pair[0].union(pair[1])));
        let mut unions = Vec::with_capacity(boxes.len() + 1);
        unions.push(f32::INFINITY);
        unions.extend(between);
        unions.push(f32::INFINITY);
        let count = boxes.len();
        Self {
            boxes,
            trees,
            unions,
            nodes: Vec::with_capacity(count),
            moves: Moves {
                takes_next: vec![0; count],
                kept: vec![0; count],
                kept_count: 0,
                merged: vec![0; count],
                merged_count: 0,
            },
        }
    }

    pub(super) fn len(&self) -> usize {
        self.boxes.len()
    }

    /// Merges each two neighbours of which neither has a cheaper neighbour on its other side.
    ///
    /// On a tie a cluster at an even place takes the next one, a cluster at an odd place the one before: clusters that are all
    /// the same merge in pairs.
    pub(super) fn merge_neighbours(&mut self, rules: &Rules) {
        if self.len() > 1 {
            self.moves.choose(&self.unions);
            self.merge_trees(rules);
            self.close_ranks(rules);
        }
    }

    /// Makes a tree of each two that merge, in the place of the first.
    fn merge_trees(&mut self, rules: &Rules) {
        for place in &self.moves.merged[..self.moves.merged_count] {
            let place = *place as usize;
            let [first, second] = [self.trees[place], self.trees[place + 1]];
            let area = self.unions[place + 1];
            let count = first.count + second.count;
            let inner_cost = NODE_COST * area + first.cost + second.cost;
            // A leaf where that is cheaper than a node over both.
            let (cost, child) = if count <= rules.max_leaf_size && area <= inner_cost {
                (area, Tree::LEAF)
            } else {
                let child = to_u32(self.nodes.len());
                let nodes = [
                    first.node(&self.boxes[place]),
                    second.node(&self.boxes[place + 1]),
                ];
                self.nodes.extend(nodes);
                (inner_cost, child)
            };
            self.trees[place] = Tree {
                cost,
                first: first.first,
                count,
                child,
            };
        }
    }

    /// Moves boxes and trees to their new places, the boxes of pairs that merge as one.
    fn close_ranks(&mut self, rules: &Rules) {
        let count = self.moves.kept_count;
        // Of equal length, so that one check of an index is enough.
        let length = self.boxes.len();
        let trees = &mut self.trees[..length];
        let unions = &mut self.unions[..length];
        let boxes = &mut self.boxes[..length];
        let mut before = boxes[0];
        for (to, kept) in self.moves.kept[..count].iter().enumerate() {
            let from = (kept >> 1) as usize;
            let last = from + (kept & 1) as usize;
            let bounds = boxes[from].union(boxes[last]);
            boxes[to] = bounds;
            trees[to] = trees[from];
            unions[to] = rules.scale.half_area(&before.union(bounds));
            before = bounds;
        }
        self.unions[0] = f32::INFINITY;
        self.unions[count] = f32::INFINITY;
        self.unions.truncate(count + 1);
        self.boxes.truncate(count);
        self.trees.truncate(count);
    }

    /// The nodes below the clusters, and the clusters.
    pub(super) fn finish(mut self) -> (Vec<BuildNode>, Vec<BuildNode>) {
        let roots = self.trees.iter().zip(&self.boxes);
        let roots = roots.map(|(tree, bounds)| tree.node(bounds)).collect();
        self.nodes.shrink_to_fit();
        (self.nodes, roots)
    }
}

impl Moves {
    /// Which neighbours merge, by the areas of their unions: those whose area is smaller than that on either side. Two that overlap cannot both be.
    fn choose(&mut self, unions: &[f32]) {
        let count = unions.len() - 1;
        let takes_next = &mut self.takes_next[..count];
        // A loop without anything else, for vectors.
        let pairs = count - 1;
        let [before, here, after] = [0, 1, 2].map(|first| &unions[first..][..pairs]);
        let flags = &mut takes_next[..pairs];
        for place in 0..pairs {
            let here = here[place];
            let is_even = u32::from(place % 2 == 0);
            let is_less = |other| u32::from(here < other) | (u32::from(here == other) & is_even);
            flags[place] = is_less(before[place]) & is_less(after[place]);
        }
        takes_next[count - 1] = 0;
        let kept = &mut self.kept[..count];
        let merged = &mut self.merged[..count];
        let (mut kept_count, mut merged_count) = (0, 0);
        let mut is_taken = 0;
        for (place, takes_next) in (0u32..).zip(&*takes_next) {
            kept[kept_count] = place << 1 | takes_next;
            kept_count += 1 - is_taken;
            merged[merged_count] = place;
            is_taken = *takes_next as usize;
            merged_count += is_taken;
        }
        self.kept_count = kept_count;
        self.merged_count = merged_count;
    }
}

#[cfg(test)]
mod tests;
