//! The layout with up to eight children per node, made from a [`BinaryTree`].

mod access;
mod batch;
mod choice;
mod collapse;
mod emit;
mod frustum;
mod leaf;
mod node;
mod nodes;
mod order;
mod packet;
mod packets;
mod plane_order;
mod quantised;
mod slabs;
mod stack;
mod traverse;
mod turns;

use tahko_geometry::{Aabb, TriangleBlock, TriangleMesh};

use crate::build::BinaryTree;
use crate::{BuildControl, BuildError, NodeFormat};

use self::collapse::Collapse;
pub(crate) use self::collapse::Costs;
pub(crate) use self::node::{Child, Kind, WideNode};
pub(crate) use self::nodes::Nodes;
use self::quantised::QuantisedNode;

/// Nodes and triangles as queries read them.
///
/// Nodes stand depth first: a node's first inner child follows it. The blocks of the leaves stand in the order in which they are met
/// there; block 0 is empty.
#[derive(Clone, Debug)]
pub(crate) struct WideBvh {
    /// Nothing for a tree over no triangles.
    pub(crate) root: Child,
    pub(crate) bounds: Aabb,
    /// The largest magnitude of a coordinate of the bounds and of all boxes.
    pub(crate) size: f32,
    /// Whether all nodes and blocks stay in the caches near the processor.
    pub(crate) is_cached: bool,
    pub(crate) nodes: Nodes,
    pub(crate) blocks: Vec<TriangleBlock>,
    /// Nodes on the longest way from the root to a leaf, both included.
    pub(crate) depth: usize,
    /// Triangles of the mesh.
    pub(crate) triangle_count: usize,
}

/// Trees up to this size, in bytes, stay in the caches near the processor: there is little to wait for. Measured with trees of 0.4 to 33 MB on a processor with 512 KiB of second level
/// cache, several rays in flight bring a quarter at 18 MB, and cost a tenth at 5 MB.
const CACHED: usize = 8 << 20;

/// Unused lanes hold NaN, so the coordinates of triangles are not compared as lanes are.
impl PartialEq for WideBvh {
    fn eq(&self, other: &Self) -> bool {
        let blocks = |bvh: &Self| bvh.blocks.len();
        let triangles = |bvh: &'_ Self| -> Vec<_> {
            bvh.blocks
                .iter()
                .flat_map(TriangleBlock::triangles)
                .collect()
        };
        self.root == other.root
            && self.nodes == other.nodes
            && blocks(self) == blocks(other)
            && triangles(self) == triangles(other)
    }
}

/// What the layout of a binary tree takes while it is made and afterwards, in bytes: the choices for all subtrees, lists of children,
/// and blocks and nodes, if leaves hold three triangles or more where they may.
pub(crate) const fn layout_bytes(
    references: u64,
    nodes: u64,
    max_leaf_size: usize,
    format: NodeFormat,
) -> u64 {
    let fill = if max_leaf_size < 3 {
        max_leaf_size as u64
    } else {
        3
    };
    let blocks = references.div_ceil(fill) + 1;
    let wide_nodes = blocks.div_ceil(3);
    // Lists of children grow to twice their length at most; tasks have a thousand references at least.
    let plans = 8 * (blocks + wide_nodes) + references / 8;
    // Quantised nodes are made of the others.
    let node_bytes = match format {
        NodeFormat::Full => size_of::<WideNode>(),
        NodeFormat::Quantised => size_of::<WideNode>() + size_of::<QuantisedNode>(),
    };
    nodes * Collapse::BYTES_PER_NODE
        + plans
        + wide_nodes * node_bytes as u64
        + blocks * size_of::<TriangleBlock>() as u64
}

impl WideBvh {
    /// The number of nodes and leaves that hold triangles.
    pub(crate) fn node_count(&self) -> usize {
        let leaves = self
            .blocks
            .iter()
            .skip(1)
            .filter(|block| !block.continues())
            .count();
        self.nodes.len() + leaves
    }

    /// Memory of nodes and triangles, in bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.nodes.bytes() + size_of_val(&*self.blocks)
    }

    /// The box that all boxes lie in: larger than the bounds where boxes are rounded outward.
    pub(crate) fn outer_bounds(&self) -> Aabb {
        match (&self.nodes, self.root.kind()) {
            (Nodes::Quantised(nodes), Kind::Inner(root)) if root < nodes.len() => {
                self.bounds.union(self.nodes.at(root).outer_bounds())
            }
            _ => self.bounds,
        }
    }

    /// The triangles of a leaf.
    pub(crate) fn leaf_blocks(&self, first: usize) -> &[TriangleBlock] {
        let blocks = &self.blocks[first..];
        let count = blocks.iter().take_while(|block| block.continues()).count() + 1;
        &blocks[..count]
    }

    /// Lays out a tree over the triangles of a mesh. Cost: O(n).
    ///
    /// # Errors
    /// If the build was cancelled.
    pub(crate) fn new(
        tree: &BinaryTree,
        mesh: &TriangleMesh,
        costs: &Costs,
        format: NodeFormat,
        control: &BuildControl,
    ) -> Result<Self, BuildError> {
        let collapse = Collapse::new(tree, costs);
        control.check()?;
        let layout = emit::emit(tree, &collapse, mesh, format);
        control.check()?;
        Ok(layout)
    }
}
