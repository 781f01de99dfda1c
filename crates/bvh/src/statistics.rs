//! Statistics of a tree.

use tahko_geometry::TreeStatistics;

use crate::Bvh;
use crate::node::{LeafTriangle, Node, Siblings};

impl Bvh {
    /// What the tree looks like and what a random ray is expected to cost in it.
    ///
    /// The cost of an inner node is `traversal_cost / intersection_cost`. Where the bounds have no area (all triangles
    /// on a line along an axis), every node counts as visited. Cost: O(n).
    #[must_use]
    pub fn statistics(&self) -> TreeStatistics {
        let layout = self.layout();
        let leaves = layout.nodes().filter(|node| node.is_leaf()).count();
        TreeStatistics {
            primitives: layout.triangles.len(),
            nodes: layout.node_count(),
            leaves,
            empty_leaves: 0,
            depth: layout.depth,
            references: layout.triangles.len(),
            bytes: size_of_val(&layout.root)
                + size_of::<Siblings>() * layout.siblings.len()
                + size_of::<LeafTriangle>() * layout.triangles.len(),
            sah_cost: self.sah_cost(),
        }
    }

    fn sah_cost(&self) -> f64 {
        let root_area = self.bounds().half_area();
        let inner_cost = self.options().traversal_cost / self.options().intersection_cost;
        let cost = |node: &Node| {
            let probability = if root_area > 0.0 {
                node.bounds().half_area() / root_area
            } else {
                1.0
            };
            let visit = if node.is_leaf() {
                node.count() as f64
            } else {
                inner_cost
            };
            probability * visit
        };
        self.layout().nodes().map(cost).sum()
    }
}
