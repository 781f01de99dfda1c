//! How much memory a build needs.

use super::node::BuildNode;
use super::reference::Reference;
use super::{LEAF_SIZE, TriangleNumber};
use crate::wide::layout_bytes;
use crate::{BuildMethod, BvhOptions};

impl BvhOptions {
    /// The bytes that a build over some triangles is expected to hold at a time, at most, beside the mesh.
    ///
    /// It is a sum over the lists that are alive together, for trees of the binary build with `1 + 1 / max_leaf_size` nodes per reference (leaf
    /// sizes above 4 count as 4), all of the [`spatial_split_budget`](Self::spatial_split_budget) used, and leaves of the finished tree that hold
    /// three triangles or more where they may; meshes that were measured need 0.5 to 0.9 of it. A mesh nearly all of whose splits cut off single triangles may need
    /// more.
    #[must_use]
    pub fn build_memory(&self, triangles: usize) -> u64 {
        let triangles = triangles as u64;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "at most twice a number of triangles"
        )]
        let references = match self.method {
            BuildMethod::Clusters => triangles,
            BuildMethod::TopDown => (triangles as f64 * self.spatial_split_budget).ceil() as u64,
        };
        let has_spatial_splits = references > triangles;
        let leaf_size = self.max_leaf_size.clamp(1, LEAF_SIZE) as u64;
        let nodes = if has_spatial_splits {
            2 * references
        } else {
            references + references.div_ceil(leaf_size)
        };
        let number_bytes = references * size::<TriangleNumber>();
        let node_bytes = nodes * size::<BuildNode>();
        let build = match self.method {
            // The nodes stand in blocks before they stand in one list; the numbers in two orders, and up to 128 bytes for each cluster of
            // about sixteen triangles.
            BuildMethod::Clusters => 2 * node_bytes + 2 * number_bytes + 8 * triangles,
            BuildMethod::TopDown if has_spatial_splits => {
                node_bytes + references * size::<Reference>() + number_bytes
            }
            BuildMethod::TopDown => 2 * node_bytes + triangles * size::<Reference>(),
        };
        let reinsertion = if self.reinsertion_rounds > 0 {
            2 * (number_bytes + node_bytes) + 16 * references
        } else {
            0
        };
        let layout = layout_bytes(references, nodes, self.max_leaf_size, self.node_format);
        let layout = number_bytes + node_bytes + layout;
        build.max(reinsertion).max(layout) + SMALL
    }
}

/// For lists whose length does not grow with the mesh.
const SMALL: u64 = 64 << 10;

const fn size<T>() -> u64 {
    size_of::<T>() as u64
}
