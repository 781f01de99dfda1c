//! The tree.

use tahko_geometry::{Aabb, Precision, Triangle, TriangleMesh};

use crate::node::Node;
use crate::{BuildError, KdTreeOptions, build};

/// A kd-tree over the triangles of a mesh.
///
/// The tree keeps copies of the triangles, in the order in which its leaves first list them. Memory per
/// triangle: 40 bytes, plus 4 for each list entry and 8 for each node.
///
/// ```
/// use tahko_geometry::{Ray, RayQuery, TriangleMesh, glam::Vec3};
/// use tahko_kdtree::{KdTree, KdTreeOptions};
///
/// let mesh = TriangleMesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]])?;
/// let tree = KdTree::build(&mesh, &KdTreeOptions::default())?;
/// let hit = tree.closest_hit(&Ray::new(Vec3::new(0.25, 0.25, 2.0), Vec3::NEG_Z));
/// assert_eq!(hit.map(|hit| (hit.t, hit.primitive)), Some((2.0, 0)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct KdTree {
    /// The root first; none for a tree that lists no triangles.
    pub(crate) nodes: Vec<Node>,
    /// The lists of the leaves one after the other: indices in `triangles`.
    pub(crate) references: Vec<u32>,
    pub(crate) triangles: Vec<Triangle>,
    /// The numbers of the triangles in the mesh.
    pub(crate) primitives: Vec<u32>,
    /// The cell of the root.
    pub(crate) bounds: Aabb,
    /// Nodes on the longest way from the root to a leaf.
    pub(crate) depth: usize,
    /// Triangles of the mesh, those that the tree does not list included.
    pub(crate) mesh_len: usize,
    pub(crate) options: KdTreeOptions,
}

impl KdTree {
    /// Builds a tree over all triangles of a mesh; a mesh without triangles gives a tree that is never hit.
    ///
    /// With the feature `parallel` on the current rayon pool; the tree is the same for every number of threads.
    /// The surface area heuristic takes `O(n log n)` time where few triangles straddle each plane, and never more than in
    /// proportion to [`max_references_per_triangle`](KdTreeOptions::max_references_per_triangle) times the depth.
    ///
    /// # Errors
    /// If an option is outside its range, or the tree would have more than 2^30 nodes or list entries.
    pub fn build(mesh: &TriangleMesh, options: &KdTreeOptions) -> Result<Self, BuildError> {
        options.check()?;
        let built = build::build(mesh, options)?;
        let mut tree = Self {
            nodes: built.nodes,
            references: built.references,
            triangles: Vec::new(),
            primitives: Vec::new(),
            bounds: built.bounds,
            depth: built.depth,
            mesh_len: mesh.len(),
            options: options.clone(),
        };
        tree.order_triangles(mesh);
        Ok(tree)
    }

    /// Copies the triangles in the order in which the leaves list them, so that a leaf's triangles are mostly
    /// neighbours in memory, and makes the lists refer to the copies.
    fn order_triangles(&mut self, mesh: &TriangleMesh) {
        const UNSEEN: u32 = u32::MAX;
        let mut places = vec![UNSEEN; mesh.len()];
        for reference in &mut self.references {
            let place = &mut places[*reference as usize];
            if *place == UNSEEN {
                #[expect(clippy::cast_possible_truncation, reason = "at most MAX_TRIANGLES")]
                let next = self.triangles.len() as u32;
                *place = next;
                self.triangles.push(mesh.triangle(*reference as usize));
                self.primitives.push(*reference);
            }
            *reference = *place;
        }
    }

    /// The box around all triangles that can be hit; empty if there are none.
    #[must_use]
    pub const fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Nodes on the longest way from the root to a leaf, both included; 0 for a tree without nodes.
    #[must_use]
    pub const fn depth(&self) -> usize {
        self.depth
    }

    /// All nodes, leaves included.
    #[must_use]
    pub fn node_count(&self) -> usize {
        self.nodes.len()
    }

    /// The same tree with another precision of its queries: the build does not depend on it.
    #[must_use]
    pub const fn with_precision(mut self, precision: Precision) -> Self {
        self.options.precision = precision;
        self
    }

    /// How hits are decided.
    #[must_use]
    pub const fn precision(&self) -> Precision {
        self.options.precision
    }
}
