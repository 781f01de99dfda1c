//! The public type.

use tahko_geometry::{Aabb, TriangleMesh};

use crate::build::BinaryTree;
use crate::layout::Bvh2;
use crate::{BuildError, BvhOptions};

/// A bounding volume hierarchy over a triangle mesh.
///
/// Ask it through [`RayQuery`](tahko_geometry::RayQuery). It owns a copy of the triangles and does not borrow from the
/// mesh. Every triangle is listed once, degenerate ones included. Two trees are equal if they have equal nodes,
/// triangles and options.
#[derive(Clone, Debug, PartialEq)]
pub struct Bvh {
    layout: Bvh2,
    options: BvhOptions,
}

impl Bvh {
    /// Builds the tree of a mesh: top down, each node split where the surface area heuristic finds it cheapest.
    ///
    /// The same mesh and options give the same tree, whatever the number of threads and with or without
    /// the `parallel` feature. No way from the root to a leaf has more than 64 nodes.
    ///
    /// Cost: O(n log n) time; about 300 bytes per triangle during the build, about 100 after it.
    ///
    /// # Errors
    /// If an option is out of its range.
    pub fn build(mesh: &TriangleMesh, options: &BvhOptions) -> Result<Self, BuildError> {
        options.check()?;
        let tree = BinaryTree::build(mesh, options);
        Ok(Self {
            layout: Bvh2::new(&tree, mesh),
            options: options.clone(),
        })
    }

    /// The options that the tree was built with.
    #[must_use]
    pub const fn options(&self) -> &BvhOptions {
        &self.options
    }

    /// The smallest box around all triangles; empty for none.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.layout.bounds()
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

    pub(crate) const fn layout(&self) -> &Bvh2 {
        &self.layout
    }
}
