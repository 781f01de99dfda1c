//! The public type.

use tahko_geometry::simd::{AvailableSimd, SimdLevel};
use tahko_geometry::{Aabb, Precision, TriangleMesh};

use crate::build::BinaryTree;
use crate::wide::{Costs, WideBvh};
use crate::{BuildError, BvhOptions};

/// A bounding volume hierarchy over a triangle mesh.
///
/// Ask it through [`RayQuery`](tahko_geometry::RayQuery). It owns a copy of the triangles and does not borrow from the
/// mesh. Every triangle is listed once, degenerate ones included. Two trees are equal if they have equal nodes,
/// triangles and options.
#[derive(Clone, Debug)]
pub struct Bvh {
    layout: WideBvh,
    options: BvhOptions,
    simd: AvailableSimd,
}

impl PartialEq for Bvh {
    fn eq(&self, other: &Self) -> bool {
        self.layout == other.layout && self.options == other.options
    }
}

impl Bvh {
    /// Builds the tree of a mesh: top down, each node split where the surface area heuristic finds it cheapest.
    ///
    /// The same mesh and options give the same tree, whatever the number of threads and with or without
    /// the `parallel` feature. No way from the root to a leaf has more than 64 nodes.
    ///
    /// Cost: O(n log n) time; about 210 bytes per triangle during the build, 70 to 105 after it.
    ///
    /// # Errors
    /// If an option is out of its range.
    pub fn build(mesh: &TriangleMesh, options: &BvhOptions) -> Result<Self, BuildError> {
        options.check()?;
        let tree = BinaryTree::build(mesh, options);
        Ok(Self {
            layout: WideBvh::new(&tree, mesh, &Costs::new(options)),
            options: options.clone(),
            simd: AvailableSimd::best(),
        })
    }

    /// The options that the tree was built with.
    #[must_use]
    pub const fn options(&self) -> &BvhOptions {
        &self.options
    }

    /// The same tree with another precision of its queries: the build does not depend on it.
    #[must_use]
    pub const fn with_precision(mut self, precision: Precision) -> Self {
        self.options.precision = precision;
        self
    }

    /// The same tree, asked with other instructions: the best ones that the processor has are the default. `None` if it does not have these.
    /// The answers are the same, bit for bit.
    #[must_use]
    pub fn with_simd(mut self, level: SimdLevel) -> Option<Self> {
        self.simd = level.available()?;
        Some(self)
    }

    /// The instructions that queries use.
    #[must_use]
    pub const fn simd_level(&self) -> SimdLevel {
        self.simd.level()
    }

    /// The smallest box around all triangles; empty for none.
    #[must_use]
    pub const fn bounds(&self) -> Aabb {
        self.layout.bounds
    }

    /// The number of nodes, leaves included.
    #[must_use]
    pub fn node_count(&self) -> usize {
        self.layout.node_count()
    }

    /// Nodes on the longest way from the root to a leaf, both included; 0 for a tree over no triangles.
    #[must_use]
    pub const fn depth(&self) -> usize {
        self.layout.depth
    }

    pub(crate) const fn layout(&self) -> &WideBvh {
        &self.layout
    }

    pub(crate) const fn simd(&self) -> AvailableSimd {
        self.simd
    }
}
