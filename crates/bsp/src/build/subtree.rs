//! Subtrees, built apart and joined.

use tahko_geometry::Plane;

use crate::node::{BACK, Child, FRONT, Link, List, Node};

/// The lists of a subtree, in preorder: a node's own entries come before those of its front child, and those
/// before its back child's. So it does not show which subtrees were built apart.
#[derive(Debug)]
pub(crate) struct Subtree {
    pub(crate) root: Child,
    pub(crate) nodes: Vec<Node>,
    pub(crate) leaves: Vec<List>,
    /// Ids of polygons.
    pub(crate) references: Vec<u32>,
    /// How often a polygon was on both sides of a plane.
    pub(crate) straddlers: usize,
}

/// A link of a subtree: the root's, or one of a node's.
#[derive(Clone, Copy, Debug)]
pub(super) enum Place {
    Root,
    Child { node: usize, side: usize },
}

impl Subtree {
    pub(super) const fn new() -> Self {
        Self {
            root: Child::EMPTY,
            nodes: Vec::new(),
            leaves: Vec::new(),
            references: Vec::new(),
            straddlers: 0,
        }
    }

    /// Appends a leaf and links it.
    pub(super) fn add_leaf(&mut self, place: Place, ids: impl ExactSizeIterator<Item = u32>) {
        if ids.len() > 0 {
            let list = self.add_references(ids);
            self.leaves.push(list);
            self.link(place, Child::leaf(self.leaves.len() - 1));
        }
    }

    /// Appends a node with empty children and links it; its index.
    pub(super) fn add_node(
        &mut self,
        place: Place,
        plane: Plane,
        coplanar: impl ExactSizeIterator<Item = u32>,
    ) -> usize {
        let coplanar = self.add_references(coplanar);
        let index = self.nodes.len();
        self.nodes.push(Node {
            plane,
            children: [Child::EMPTY; 2],
            coplanar,
        });
        self.link(place, Child::inner(index));
        index
    }

    /// Appends another subtree and links its root.
    pub(super) fn add_subtree(&mut self, place: Place, other: Self) {
        let (nodes, leaves) = (self.nodes.len(), self.leaves.len());
        let references = self.references.len();
        let moved_list = |list: List| List {
            first: list.first + length_bits(references),
            ..list
        };
        self.nodes.extend(other.nodes.into_iter().map(|node| Node {
            children: node.children.map(|child| child.moved(nodes, leaves)),
            coplanar: moved_list(node.coplanar),
            ..node
        }));
        self.leaves.extend(other.leaves.into_iter().map(moved_list));
        self.references.extend(other.references);
        self.straddlers += other.straddlers;
        self.link(place, other.root.moved(nodes, leaves));
    }

    /// Nodes on the longest way from the root to a leaf, both included.
    pub(crate) fn depth(&self) -> usize {
        // Parents come before their children.
        let mut depths = vec![1; self.nodes.len()];
        let mut deepest = 1;
        for (index, node) in self.nodes.iter().enumerate() {
            deepest = deepest.max(depths[index] + 1);
            for child in [FRONT, BACK].map(|side| node.children[side].link()) {
                if let Link::Inner(child) = child {
                    depths[child] = depths[index] + 1;
                }
            }
        }
        deepest
    }

    fn link(&mut self, place: Place, child: Child) {
        match place {
            Place::Root => self.root = child,
            Place::Child { node, side } => self.nodes[node].children[side] = child,
        }
    }

    fn add_references(&mut self, ids: impl ExactSizeIterator<Item = u32>) -> List {
        let list = List {
            first: length_bits(self.references.len()),
            count: length_bits(ids.len()),
        };
        self.references.extend(ids);
        list
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "the budget allows at most 2^31 references"
)]
fn length_bits(length: usize) -> u32 {
    length as u32
}
