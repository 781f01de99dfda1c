//! Subtrees, built apart and joined.

use tahko_geometry::Plane;

use crate::node::{Child, Link, List, Node};

/// The lists of a subtree, in preorder: a node comes before what is in front of it, then what is behind it, then what
/// is in its plane. So it does not show which subtrees were built apart.
#[derive(Debug)]
pub(crate) struct Subtree {
    pub(crate) root: Child,
    pub(crate) nodes: Vec<Node>,
    pub(crate) leaves: Vec<List>,
    /// Ids of polygons.
    pub(crate) references: Vec<u32>,
    /// How often a polygon was on both sides of a plane.
    pub(crate) straddlers: usize,
    /// How often a polygon was in a splitting plane for the first time.
    pub(crate) coplanar: usize,
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
            coplanar: 0,
        }
    }

    /// Appends a leaf and links it.
    pub(super) fn add_leaf(&mut self, place: Place, ids: impl ExactSizeIterator<Item = u32>) {
        if ids.len() > 0 {
            self.leaves.push(List {
                first: length_bits(self.references.len()),
                count: length_bits(ids.len()),
            });
            self.references.extend(ids);
            self.link(place, Child::leaf(self.leaves.len() - 1));
        }
    }

    /// Appends a node with empty children and links it; its index.
    pub(super) fn add_node(&mut self, place: Place, plane: Plane) -> usize {
        let index = self.nodes.len();
        self.nodes.push(Node {
            plane,
            children: [Child::EMPTY; 3],
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
            ..node
        }));
        self.leaves.extend(other.leaves.into_iter().map(moved_list));
        self.references.extend(other.references);
        self.straddlers += other.straddlers;
        self.coplanar += other.coplanar;
        self.link(place, other.root.moved(nodes, leaves));
    }

    /// Nodes on the longest way from the root to a leaf, both included.
    pub(crate) fn depth(&self) -> usize {
        // Parents come before their children.
        let mut depths = vec![1; self.nodes.len()];
        let mut deepest = 1;
        for (index, node) in self.nodes.iter().enumerate() {
            deepest = deepest.max(depths[index] + 1);
            for child in node.children {
                if let Link::Inner(child) = child.link() {
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
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "the budget allows at most 2^31 references"
)]
fn length_bits(length: usize) -> u32 {
    length as u32
}
