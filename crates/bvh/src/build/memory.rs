//! How much memory a build needs.

use tahko_geometry::TriangleMesh;

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
    ///
    /// A mesh of slivers that are worth [pieces](Self::presplit_budget) needs that for each piece: up to `presplit_budget` times as much, but no more than the
    /// [limit](crate::BuildControl::with_memory_limit) of the build. How many there are is known before they are made, and of all other meshes that there are none.
    #[must_use]
    pub fn build_memory(&self, triangles: usize) -> u64 {
        self.build_memory_in_pieces(triangles, triangles)
    }

    /// Whether leaves may list parts of triangles, where the build begins with some pieces of triangles.
    pub(crate) const fn has_parts(&self, triangles: usize, pieces: usize) -> bool {
        matches!(self.method, BuildMethod::TopDown)
            && (self.spatial_split_budget > 1.0 || pieces > triangles)
    }

    /// The most references of a tree whose build begins with some pieces of triangles. Where there are far more pieces than triangles already, spatial splits
    /// are left out: measured on slivers of many kinds, they gain rays nothing to a tenth there, for three times the build time.
    pub(super) fn most_references(&self, triangles: usize, pieces: usize) -> usize {
        match self.method {
            BuildMethod::Clusters => pieces,
            BuildMethod::TopDown => {
                let on_top = pieces as f64 * self.spatial_split_budget;
                let most = 2.0 * triangles as f64 * self.spatial_split_budget;
                to_count(on_top.min(most)).clamp(pieces, TriangleMesh::MAX_TRIANGLES.max(pieces))
            }
        }
    }

    /// The most pieces in which some triangles may be cut: within the budget, within a limit of memory, and as many as can be numbered. At least as many as
    /// there are triangles.
    pub(super) fn most_pieces(&self, triangles: usize, memory_limit: Option<u64>) -> usize {
        let most = to_count(triangles as f64 * self.presplit_budget);
        let most = most.min(TriangleMesh::MAX_TRIANGLES).max(triangles);
        let Some(limit) = memory_limit else {
            return most;
        };
        let fits = |pieces| self.build_memory_in_pieces(triangles, pieces) <= limit;
        // The estimate grows with the pieces; those of no more than the triangles are within the limit, or there would be no build.
        let (mut fitting, mut too_many) = (triangles, most + 1);
        while fitting + 1 < too_many {
            let middle = fitting + (too_many - fitting) / 2;
            if fits(middle) {
                fitting = middle;
            } else {
                too_many = middle;
            }
        }
        fitting
    }

    /// The same where the build begins with some pieces of triangles, as many as there are triangles or more.
    pub(crate) fn build_memory_in_pieces(&self, triangles: usize, pieces: usize) -> u64 {
        let references = self.most_references(triangles, pieces) as u64;
        let has_parts = self.has_parts(triangles, pieces);
        let pieces = pieces as u64;
        let leaf_size = self.max_leaf_size.clamp(1, LEAF_SIZE) as u64;
        let nodes = if has_parts {
            2 * references
        } else {
            references + references.div_ceil(leaf_size)
        };
        let number_bytes = references * size::<TriangleNumber>();
        let node_bytes = nodes * size::<BuildNode>();
        let build = match self.method {
            // The nodes stand in blocks before they stand in one list, and up to 128 bytes for each cluster of about sixteen triangles.
            BuildMethod::Clusters => 2 * node_bytes + number_bytes + 8 * pieces,
            BuildMethod::TopDown if has_parts => {
                node_bytes + references * size::<Reference>() + number_bytes
            }
            BuildMethod::TopDown => 2 * node_bytes + pieces * size::<Reference>(),
        };
        let reinsertion = if self.reinsertion_rounds > 0 {
            // Pairs of the upper part of the tree, for a moment twice: one for some six references.
            number_bytes + node_bytes + 32 * references
        } else {
            0
        };
        let layout = layout_bytes(references, nodes, self.max_leaf_size, self.node_format);
        let layout = number_bytes + node_bytes + layout;
        build.max(reinsertion).max(layout) + SMALL
    }
}

/// A number of triangles times a budget, rounded down.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a budget is a small multiple of a number of triangles"
)]
const fn to_count(references: f64) -> usize {
    references as usize
}

/// For lists whose length does not grow with the mesh.
const SMALL: u64 = 64 << 10;

const fn size<T>() -> u64 {
    size_of::<T>() as u64
}
