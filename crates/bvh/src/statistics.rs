//! Statistics of a tree.

use tahko_geometry::{Aabb, ExpectedVisits, TreeStatistics, TriangleBlock};

use crate::Bvh;
use crate::wide::{Child, Kind};

impl Bvh {
    /// What the tree looks like and what a random ray is expected to cost in it.
    ///
    /// The cost of an inner node, with its up to eight box tests, is `traversal_cost / intersection_cost`. Where the bounds have no area (all
    /// triangles on a line along an axis), every node counts as visited. Cost: O(n).
    #[must_use]
    pub fn statistics(&self) -> TreeStatistics {
        let layout = self.layout();
        let expected_visits = self.expected_visits();
        let references = layout.blocks.iter().flat_map(TriangleBlock::triangles);
        TreeStatistics {
            primitives: layout.triangle_count,
            nodes: layout.node_count(),
            leaves: layout.node_count() - layout.nodes.len(),
            empty_leaves: 0,
            depth: layout.depth,
            references: references.count(),
            bytes: layout.bytes(),
            expected_visits,
            sah_cost: expected_visits.cost(self.inner_node_cost()),
        }
    }

    /// What an inner node costs, in triangle tests.
    pub(crate) fn inner_node_cost(&self) -> f64 {
        self.options().traversal_cost / self.options().intersection_cost
    }

    fn expected_visits(&self) -> ExpectedVisits {
        let layout = self.layout();
        let mut visits = ExpectedVisits::default();
        let root_area = layout.bounds.half_area();
        let mut add = |bounds: &Aabb, child: Child| {
            // A box that is rounded outward may leave the bounds, in which lines are counted.
            let visited = bounds.intersection(layout.bounds);
            let probability = ExpectedVisits::probability(visited.half_area(), root_area);
            match child.kind() {
                Kind::Inner(_) => visits.add_inner_node(probability),
                Kind::Leaf(first) => {
                    let blocks = layout.leaf_blocks(first).iter();
                    let count = blocks.flat_map(TriangleBlock::triangles).count();
                    visits.add_leaf(probability, count);
                }
            }
        };
        if layout.root != Child::NOTHING {
            add(&layout.bounds, layout.root);
        }
        for node in layout.nodes.iter() {
            for (bounds, child) in node.children() {
                add(&bounds, child);
            }
        }
        visits
    }
}
