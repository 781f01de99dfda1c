//! The nodes of a layout, in the format that the options name.

use tahko_geometry::simd::LANES;

use super::node::Node;
use super::quantised::QuantisedNode;
use super::{Kind, WideNode};
use crate::{NodeFormat, huge_pages};

/// Nodes of one format. What is not a search reads them decoded.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Nodes {
    Full(Vec<WideNode>),
    Quantised(Vec<QuantisedNode>),
}

impl Nodes {
    /// Children stand behind their parents. Cost: O(n).
    pub(super) fn new(list: Vec<WideNode>, format: NodeFormat) -> Self {
        match format {
            NodeFormat::Full => Self::Full(list),
            NodeFormat::Quantised => Self::Quantised(quantised(list)),
        }
    }

    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Full(nodes) => nodes.len(),
            Self::Quantised(nodes) => nodes.len(),
        }
    }

    /// Their memory, in bytes.
    pub(super) fn bytes(&self) -> usize {
        match self {
            Self::Full(nodes) => size_of_val(&**nodes),
            Self::Quantised(nodes) => size_of_val(&**nodes),
        }
    }

    /// A node; its index must be in range.
    pub(crate) fn at(&self, index: usize) -> WideNode {
        match self {
            Self::Full(nodes) => nodes[index].decoded(),
            Self::Quantised(nodes) => nodes[index].decoded(),
        }
    }

    /// Changes a node, for tests.
    #[cfg(test)]
    pub(crate) fn change(&mut self, index: usize, change: impl FnOnce(&mut WideNode)) {
        let mut node = self.at(index);
        change(&mut node);
        match self {
            Self::Full(nodes) => nodes[index] = node,
            Self::Quantised(nodes) => nodes[index] = QuantisedNode::new(&node),
        }
    }

    /// Adds a node that no other one has as its child, for tests.
    #[cfg(test)]
    pub(crate) fn push_copy(&mut self, index: usize) {
        match self {
            Self::Full(nodes) => nodes.push(nodes[index]),
            Self::Quantised(nodes) => nodes.push(nodes[index]),
        }
    }

    /// All nodes in their order.
    pub(crate) fn iter(
        &self,
    ) -> impl DoubleEndedIterator<Item = WideNode> + ExactSizeIterator + '_ {
        (0..self.len()).map(|index| self.at(index))
    }
}

/// Nodes with boxes rounded outward. Those of a node contain the rounded boxes of its children, so that here, too, boxes are nested.
fn quantised(mut list: Vec<WideNode>) -> Vec<QuantisedNode> {
    let mut nodes = huge_pages::with_capacity(list.len());
    nodes.resize(list.len(), QuantisedNode::new(&WideNode::EMPTY));
    for index in (0..list.len()).rev() {
        let mut node = list[index];
        for lane in 0..LANES {
            let child = node.children[lane];
            if let Kind::Inner(place) = child.kind() {
                node.set(lane, &list[place].outer_bounds(), child);
            }
        }
        nodes[index] = QuantisedNode::new(&node);
        list[index] = nodes[index].decoded();
    }
    nodes
}
