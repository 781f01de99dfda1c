//! Statistics of a tree.

use tahko_geometry::{ExpectedVisits, TreeStatistics};

use crate::KdTree;
use crate::node::{Kind, Node};

impl KdTree {
    /// Size, shape and expected cost. Visits every node.
    ///
    /// Where the bounds have no area (all triangles on a line along an axis), every node counts as visited.
    #[must_use]
    pub fn statistics(&self) -> TreeStatistics {
        let leaves = || self.nodes.iter().filter_map(|node| leaf_len(*node));
        let expected_visits = self.expected_visits();
        let cost_ratio =
            f64::from(self.options.traversal_cost) / f64::from(self.options.intersection_cost);
        TreeStatistics {
            primitives: self.mesh_len,
            nodes: self.nodes.len(),
            leaves: leaves().count(),
            empty_leaves: leaves().filter(|len| *len == 0).count(),
            depth: self.depth,
            references: self.references.len(),
            bytes: size_of_val(self.nodes.as_slice())
                + size_of_val(self.references.as_slice())
                + size_of_val(self.triangles.as_slice())
                + size_of_val(self.primitives.as_slice()),
            expected_visits,
            sah_cost: expected_visits.cost(cost_ratio),
        }
    }

    fn expected_visits(&self) -> ExpectedVisits {
        let mut visits = ExpectedVisits::default();
        let root_area = self.bounds.half_area();
        let mut open = Vec::with_capacity(self.depth);
        if !self.nodes.is_empty() {
            open.push((0, self.bounds));
        }
        while let Some((node, cell)) = open.pop() {
            let probability = ExpectedVisits::probability(cell.half_area(), root_area);
            match self.nodes[node].kind() {
                Kind::Leaf { count, .. } => visits.add_leaf(probability, count),
                Kind::Inner {
                    axis,
                    position,
                    first_child,
                } => {
                    visits.add_inner_node(probability);
                    let [mut left, mut right] = [cell; 2];
                    left.max[axis as usize] = position;
                    right.min[axis as usize] = position;
                    open.extend([(first_child + 1, right), (first_child, left)]);
                }
            }
        }
        visits
    }
}

fn leaf_len(node: Node) -> Option<usize> {
    match node.kind() {
        Kind::Leaf { count, .. } => Some(count),
        Kind::Inner { .. } => None,
    }
}
