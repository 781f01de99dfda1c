//! Nodes and blocks, as traversals get them.
#![allow(
    unsafe_code,
    reason = "a check of every index would be a tenth of the instructions of a ray"
)]

use tahko_geometry::TriangleBlock;

use super::{WideBvh, WideNode};

impl WideBvh {
    /// The node that a child stands for.
    #[inline(always)]
    pub(super) fn node(&self, index: usize) -> &WideNode {
        debug_assert!(index < self.nodes.len(), "child out of range");
        // SAFETY: `emit` alone makes layouts. It gives a child the index of a node that it adds later, or of a block that it has added, and nothing
        // changes them after it.
        unsafe { self.nodes.get_unchecked(index) }
    }

    /// The blocks from the first one of a leaf on.
    #[inline(always)]
    pub(super) fn blocks_from(&self, index: usize) -> &[TriangleBlock] {
        debug_assert!(index < self.blocks.len(), "leaf out of range");
        // SAFETY: as above.
        unsafe { self.blocks.get_unchecked(index..) }
    }
}
