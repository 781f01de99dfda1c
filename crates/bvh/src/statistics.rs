//! Statistics of a tree.

use tahko_geometry::{ExpectedVisits, TreeStatistics};

use crate::Bvh;
use crate::node::{LeafTriangle, Siblings};

impl Bvh {
    /// What the tree looks like and what a random ray is expected to cost in it.
    ///
    /// The cost of an inner node is `traversal_cost / intersection_cost`. Where the bounds have no area (all triangles
    /// on a line along an axis), every node counts as visited. Cost: O(n).
    #[must_use]
    pub fn statistics(&self) -> TreeStatistics {
        let layout = self.layout();
        let expected_visits = self.expected_visits();
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
            expected_visits,
            sah_cost: expected_visits.cost(self.inner_node_cost()),
        }
    }

    /// What an inner node costs, in triangle tests.
    pub(crate) fn inner_node_cost(&self) -> f64 {
        self.options().traversal_cost / self.options().intersection_cost
    }

    fn expected_visits(&self) -> ExpectedVisits {
        let mut visits = ExpectedVisits::default();
        let root_area = self.bounds().half_area();
        for node in self.layout().nodes() {
            let probability = ExpectedVisits::probability(node.bounds().half_area(), root_area);
            if node.is_leaf() {
                visits.add_leaf(probability, node.count());
            } else {
                visits.add_inner_node(probability);
            }
        }
        visits
    }
}
