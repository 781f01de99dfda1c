//! How much memory a build needs.

use super::node::BuildNode;
use super::reference::Reference;
use super::{LEAF_SIZE, TriangleNumber};
use crate::node::{LeafTriangle, Siblings};
use crate::{BuildMethod, BvhOptions};

impl BvhOptions {
    /// The bytes that a build over some triangles is expected to hold at a time, at most, beside the mesh.
    ///
    /// It is a sum over the lists that are alive together, for trees with `1 + 1 / max_leaf_size` nodes per triangle (leaf
    /// sizes above 4 count as 4), while meshes that were measured need 0.6 to 0.9 at the default. With the defaults it
    /// is 124 bytes per triangle. A mesh nearly all of whose splits cut off single triangles may need up to 1.4 times as much.
    #[must_use]
    pub fn build_memory(&self, triangles: usize) -> u64 {
        let triangles = triangles as u64;
        let leaf_size = self.max_leaf_size.clamp(1, LEAF_SIZE) as u64;
        let nodes = triangles + triangles.div_ceil(leaf_size);
        let number_bytes = triangles * size::<TriangleNumber>();
        let node_bytes = nodes * size::<BuildNode>();
        // The nodes stand in blocks before they stand in one list.
        let build = 2 * node_bytes
            + match self.method {
                // The numbers in two orders, and up to 192 bytes for each cluster of about sixteen triangles.
                BuildMethod::Clusters => 2 * number_bytes + 12 * triangles,
                BuildMethod::TopDown => triangles * size::<Reference>(),
            };
        let layout = number_bytes + node_bytes + layout_bytes(triangles, nodes);
        build.max(layout) + SMALL
    }
}

/// What the layout of a tree takes.
const fn layout_bytes(triangles: u64, nodes: u64) -> u64 {
    nodes.div_ceil(2) * size::<Siblings>() + triangles * size::<LeafTriangle>()
}

/// For lists whose length does not grow with the mesh.
const SMALL: u64 = 64 << 10;

const fn size<T>() -> u64 {
    size_of::<T>() as u64
}
