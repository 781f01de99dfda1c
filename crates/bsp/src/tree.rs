//! The public type.

use tahko_geometry::{Aabb, Precision, TriangleMesh, glam::DVec3};

use crate::build::{self, Subtree};
use crate::node::{Child, IN_PLANE, List, ListedTriangle, Node};
use crate::{BspOptions, BuildError};

/// A BSP tree over the triangles of a mesh.
///
/// Ask it through [`RayQuery`](tahko_geometry::RayQuery). It owns a copy of the triangles and does not borrow from the
/// mesh. Triangles without area are left out: they are never hit. Two trees are equal if they have equal nodes, lists,
/// triangles and options.
#[derive(Clone, Debug, PartialEq)]
pub struct BspTree {
    pub(crate) root: Child,
    pub(crate) nodes: Vec<Node>,
    pub(crate) leaves: Vec<List>,
    /// Indices of `triangles`.
    pub(crate) references: Vec<u32>,
    /// In the order in which they are first referred to.
    pub(crate) triangles: Vec<ListedTriangle>,
    pub(crate) depth: usize,
    /// How often a polygon was on both sides of a plane.
    pub(crate) straddlers: usize,
    /// How often a polygon was in a splitting plane for the first time.
    pub(crate) coplanar: usize,
    /// Triangles of the mesh, those without area included.
    pub(crate) primitives: usize,
    bounds: Aabb,
    options: BspOptions,
}

impl BspTree {
    /// Builds the tree of a mesh.
    ///
    /// The same mesh and options give the same tree, whatever the number of threads and with or without
    /// the `parallel` feature.
    ///
    /// Cost: with a sample of candidates, O(n) per level of the tree; about O(n log n) on ordinary meshes where
    /// planes can balance it. Memory: at most [`max_growth`](BspOptions::max_growth) references per triangle.
    ///
    /// # Errors
    /// If an option is out of its range.
    pub fn build(mesh: &TriangleMesh, options: &BspOptions) -> Result<Self, BuildError> {
        options.check()?;
        let mut tree = build::build(mesh, options);
        let triangles = in_order_of_reference(mesh, &mut tree.references);
        let depth = tree.depth();
        let Subtree {
            root,
            nodes,
            leaves,
            references,
            straddlers,
            coplanar,
        } = tree;
        Ok(Self {
            root,
            nodes,
            leaves,
            references,
            triangles,
            depth,
            straddlers,
            coplanar,
            primitives: mesh.len(),
            bounds: mesh.aabb(),
            options: options.clone(),
        })
    }

    /// The options that the tree was built with.
    #[must_use]
    pub const fn options(&self) -> &BspOptions {
        &self.options
    }

    /// The same tree with another precision of its queries: the build does not depend on it.
    #[must_use]
    pub const fn with_precision(mut self, precision: Precision) -> Self {
        self.options.precision = precision;
        self
    }

    /// The smallest box around all triangles; empty for none.
    #[must_use]
    pub const fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// The number of nodes, leaves included, and also the leaves without triangles, which take no memory.
    ///
    /// A node has two sides; what lies in its plane is a third child where there is something.
    /// Cost: O(nodes).
    #[must_use]
    pub fn node_count(&self) -> usize {
        self.nodes.len() + self.leaves.len() + self.empty_leaf_count()
    }

    pub(crate) fn empty_leaf_count(&self) -> usize {
        let sides = self
            .nodes
            .iter()
            .flat_map(|node| &node.children[..IN_PLANE]);
        let links = sides.chain([&self.root]);
        links.filter(|child| **child == Child::EMPTY).count()
    }

    /// Nodes on the longest way from the root to a leaf, both included.
    #[must_use]
    pub const fn depth(&self) -> usize {
        self.depth
    }
}

/// The triangles in the order in which they are first referred to, so that those of a leaf are close together.
/// References become indices of that list.
fn in_order_of_reference(mesh: &TriangleMesh, references: &mut [u32]) -> Vec<ListedTriangle> {
    const UNSEEN: u32 = u32::MAX;
    let mut places = vec![UNSEEN; mesh.len()];
    let mut triangles = Vec::with_capacity(mesh.len());
    for reference in references {
        let number = *reference;
        let place = &mut places[number as usize];
        if *place == UNSEEN {
            #[expect(
                clippy::cast_possible_truncation,
                reason = "meshes have at most 2^29 triangles"
            )]
            let next = triangles.len() as u32;
            *place = next;
            triangles.push(ListedTriangle {
                triangle: mesh.triangle(number as usize),
                number,
            });
        }
        *reference = *place;
    }
    triangles
}

/// The largest absolute coordinate of points in a box along each axis; zero for the empty box.
pub(crate) fn largest_coordinates(bounds: &Aabb) -> DVec3 {
    if bounds.is_empty() {
        DVec3::ZERO
    } else {
        bounds.min.abs().max(bounds.max.abs()).as_dvec3()
    }
}
