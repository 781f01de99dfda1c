//! Writes the nodes and blocks that a collapse chose.

use tahko_geometry::simd::LANES;
use tahko_geometry::{Aabb, TriangleBlock, TriangleMesh, size_of_bounds};

use super::collapse::{Collapse, Root};
use super::{Child, Nodes, WideBvh, WideNode, huge_pages};
use crate::NodeFormat;
use crate::build::{BinaryTree, Link};
use crate::parallel::collect_into;

/// A node whose children are still to be written.
struct Pending {
    /// Its place in the binary tree.
    source: usize,
    /// Where it stands as a child: the node, and the lane; `None` for the root.
    parent: Option<(usize, usize)>,
    depth: usize,
}

/// A part of the list of triangle numbers that becomes blocks.
type Leaves = Vec<std::ops::Range<usize>>;

struct Emitter<'a> {
    tree: &'a BinaryTree,
    nodes: Vec<WideNode>,
    /// For each block, its triangles in `numbers`.
    blocks: Leaves,
    /// The triangles of the leaves.
    numbers: Vec<u32>,
    /// Whether a block is followed by another of its leaf.
    continues: Vec<bool>,
    /// Nodes below a leaf that are still to be listed: empty between leaves.
    below_leaf: Vec<usize>,
}

/// The layout of a tree. Cost: O(n).
pub(super) fn emit(
    tree: &BinaryTree,
    collapse: &Collapse,
    mesh: &TriangleMesh,
    format: NodeFormat,
) -> WideBvh {
    let mut emitter = Emitter {
        tree,
        nodes: Vec::new(),
        blocks: std::iter::once(0..0).collect(),
        numbers: Vec::with_capacity(tree.references.len()),
        continues: vec![false],
        below_leaf: Vec::new(),
    };
    let mut layout = WideBvh {
        root: Child::NOTHING,
        bounds: Aabb::EMPTY,
        size: 0.0,
        nodes: Nodes::Full(Vec::new()),
        blocks: Vec::new(),
        depth: 0,
        triangle_count: mesh.len(),
    };
    if !tree.is_empty() {
        layout.bounds = tree.node(0).0;
        emitter.add_nodes(collapse, &mut layout);
        layout.nodes = Nodes::new(std::mem::take(&mut emitter.nodes), format);
        layout.size = size_of_bounds(&layout.outer_bounds());
    }
    let (blocks, numbers, continues) = (&emitter.blocks, &emitter.numbers, &emitter.continues);
    layout.blocks = huge_pages::with_capacity(blocks.len());
    collect_into(&mut layout.blocks, blocks.len(), |index| {
        let numbers = &numbers[blocks[index].clone()];
        let block = TriangleBlock::new(
            numbers
                .iter()
                .map(|number| (*number, mesh.triangle(*number as usize))),
        );
        if continues[index] {
            block.continued()
        } else {
            block
        }
    });
    layout
}

impl Emitter<'_> {
    fn add_nodes(&mut self, collapse: &Collapse, layout: &mut WideBvh) {
        let root = collapse.root();
        layout.depth = 1;
        if root.is_leaf {
            layout.root = self.add_leaf(root.index);
            return;
        }
        let mut pending = vec![Pending {
            source: 0,
            parent: None,
            depth: 1,
        }];
        let mut children: Vec<Root> = Vec::new();
        while let Some(next) = pending.pop() {
            let index = self.nodes.len();
            match next.parent {
                Some((parent, lane)) => self.nodes[parent].children[lane] = Child::inner(index),
                None => layout.root = Child::inner(index),
            }
            children.clear();
            collapse.children(self.tree, next.source, &mut children);
            let depth = next.depth + 1;
            layout.depth = layout.depth.max(depth);
            let mut node = WideNode::EMPTY;
            let first_pending = pending.len();
            for (lane, child) in children.iter().enumerate() {
                let (bounds, _) = self.tree.node(child.index);
                let place = if child.is_leaf {
                    self.add_leaf(child.index)
                } else {
                    pending.push(Pending {
                        source: child.index,
                        parent: Some((index, lane)),
                        depth,
                    });
                    Child::NOTHING
                };
                node.set(lane, &bounds, place);
            }
            // The first child is popped first, and follows its parent.
            pending[first_pending..].reverse();
            self.nodes.push(node);
        }
    }

    /// Adds the blocks of all triangles below a node.
    fn add_leaf(&mut self, index: usize) -> Child {
        let first = self.numbers.len();
        self.below_leaf.push(index);
        while let Some(index) = self.below_leaf.pop() {
            match self.tree.node(index).1 {
                Link::Inner([first, second]) => self.below_leaf.extend([second, first]),
                Link::Leaf { first, count } => {
                    let references = &self.tree.references[first..][..count];
                    self.numbers
                        .extend(references.iter().map(|reference| reference.number()));
                }
            }
        }
        // Spatial splits may have listed a triangle in several of the leaves that are now one.
        self.numbers[first..].sort_unstable();
        let mut end = first;
        for place in first..self.numbers.len() {
            if place == first || self.numbers[place] != self.numbers[end - 1] {
                self.numbers[end] = self.numbers[place];
                end += 1;
            }
        }
        self.numbers.truncate(end);
        let child = Child::leaf(self.blocks.len());
        let mut start = first;
        while start < end {
            let stop = end.min(start + LANES);
            self.blocks.push(start..stop);
            self.continues.push(stop < end);
            start = stop;
        }
        child
    }
}

#[cfg(test)]
mod tests;
