//! Statistics of a tree.

use tahko_geometry::TreeStatistics;

use crate::KdTree;
use crate::node::{Kind, Node};

/// What a random line through the bounds of a tree is expected to do, by the surface area heuristic.
///
/// These are the terms of Wald and Havran 2006, table 1: `E_T`, `E_L` and `E_I`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ExpectedVisits {
    /// Inner nodes visited: the sum of the areas of their cells over that of the root.
    pub inner_nodes: f64,
    /// Leaves visited.
    pub leaves: f64,
    /// Triangles tested, were each tested in every leaf that lists it.
    pub triangle_tests: f64,
}

impl KdTree {
    /// Size, shape and expected cost. Visits every node.
    ///
    /// The cost is that of [`expected_visits`](Self::expected_visits) with the tree's cost options.
    #[must_use]
    pub fn statistics(&self) -> TreeStatistics {
        let leaves = || self.nodes.iter().filter_map(|node| leaf_len(*node));
        let visits = self.expected_visits();
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
            sah_cost: cost_ratio * visits.inner_nodes + visits.triangle_tests,
        }
    }

    /// What a random line through the bounds is expected to do. Visits every node.
    ///
    /// In a tree whose bounds have no area, a line is taken to visit everything.
    #[must_use]
    pub fn expected_visits(&self) -> ExpectedVisits {
        let mut visits = ExpectedVisits::default();
        let root_area = self.bounds.half_area();
        let mut open = Vec::with_capacity(self.depth);
        if !self.nodes.is_empty() {
            open.push((0, self.bounds));
        }
        while let Some((node, cell)) = open.pop() {
            let probability = if root_area > 0.0 {
                cell.half_area() / root_area
            } else {
                1.0
            };
            match self.nodes[node].kind() {
                Kind::Leaf { count, .. } => {
                    visits.leaves += probability;
                    visits.triangle_tests += probability * count as f64;
                }
                Kind::Inner {
                    axis,
                    position,
                    first_child,
                } => {
                    visits.inner_nodes += probability;
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
