//! The layout with two children per node, made from a [`BinaryTree`].

use tahko_geometry::{Aabb, TriangleMesh};

use crate::build::{BinaryTree, Link};
use crate::node::{LeafTriangle, Node, Siblings};
use crate::parallel::collect;

/// Nodes and triangles as queries read them.
///
/// Siblings stand depth first: those of a first child follow those that it is part of, so the way down often
/// stays on neighbouring cache lines. Triangles stand in the order of the leaves.
///
/// Nodes are numbered for messages: the root is 0, the siblings at index `i` are `2i + 1` and `2i + 2`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Bvh2 {
    /// `None` for a tree over no triangles.
    pub(crate) root: Option<Node>,
    pub(crate) siblings: Vec<Siblings>,
    pub(crate) triangles: Vec<LeafTriangle>,
    /// Nodes on the longest way from the root to a leaf.
    pub(crate) depth: usize,
}

/// An inner node whose children are still to be laid out.
struct Pending {
    /// Its children in the binary tree.
    children: [usize; 2],
    /// Its number in the layout.
    number: usize,
    depth: usize,
}

impl Bvh2 {
    /// Lays out a tree over the triangles of a mesh. Cost: O(n).
    pub(crate) fn new(tree: &BinaryTree, mesh: &TriangleMesh) -> Self {
        let mut layout = Self {
            root: None,
            siblings: Vec::with_capacity(tree.inner_count),
            triangles: collect(tree.references.len(), |index| {
                let number = tree.references[index].number();
                LeafTriangle {
                    triangle: mesh.triangle(number as usize),
                    number,
                }
            }),
            depth: 0,
        };
        if !tree.is_empty() {
            layout.add_nodes(tree);
        }
        layout
    }

    fn add_nodes(&mut self, tree: &BinaryTree) {
        let mut pending = Vec::new();
        self.root = Some(make_node(tree, 0, 0, 1, &mut pending));
        self.depth = 1;
        while let Some(Pending {
            children: [first, second],
            number,
            depth,
        }) = pending.pop()
        {
            let index = self.siblings.len();
            let place = |node: &mut Node| *node = Node::inner(&node.bounds(), to_u32(index));
            if number == 0 {
                self.root.iter_mut().for_each(place);
            } else {
                place(&mut self.siblings[(number - 1) / 2].0[(number - 1) % 2]);
            }
            // The first child is pushed last: it is popped next, and its children follow here.
            let depth = depth + 1;
            let second = make_node(tree, second, 2 * index + 2, depth, &mut pending);
            let first = make_node(tree, first, 2 * index + 1, depth, &mut pending);
            self.siblings.push(Siblings([first, second]));
            self.depth = self.depth.max(depth);
        }
    }

    /// All nodes: the root first, the others in the order of their numbers.
    pub(crate) fn nodes(&self) -> impl Iterator<Item = &Node> {
        let others = self.siblings.iter().flat_map(|siblings| &siblings.0);
        self.root.iter().chain(others)
    }

    pub(crate) fn node_count(&self) -> usize {
        usize::from(self.root.is_some()) + 2 * self.siblings.len()
    }

    pub(crate) fn bounds(&self) -> Aabb {
        self.root.map_or(Aabb::EMPTY, |root| root.bounds())
    }
}

/// The layout of a node; an inner node goes on the list of those that wait for the place of their children.
fn make_node(
    tree: &BinaryTree,
    index: usize,
    number: usize,
    depth: usize,
    pending: &mut Vec<Pending>,
) -> Node {
    match tree.node(index) {
        (bounds, Link::Leaf { first, count }) => Node::leaf(&bounds, to_u32(first), to_u32(count)),
        (bounds, Link::Inner(children)) => {
            pending.push(Pending {
                children,
                number,
                depth,
            });
            Node::inner(&bounds, u32::MAX)
        }
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "meshes have at most 2^29 triangles, and trees fewer inner nodes"
)]
fn to_u32(index: usize) -> u32 {
    debug_assert!(index <= TriangleMesh::MAX_TRIANGLES, "{index} is too large");
    index as u32
}
