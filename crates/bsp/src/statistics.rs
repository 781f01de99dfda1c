//! Statistics of a tree.

use tahko_geometry::{ExpectedVisits, Plane, TreeStatistics};

use crate::cell::Cell;
use crate::node::{Child, Link, List, ListedTriangle, Node};
use crate::{BspTree, Straddlers};

/// What is special about a BSP tree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct BspStatistics {
    /// How often a polygon was on both sides of a plane.
    pub straddlers: usize,
    /// Parts into which polygons were cut: two for each cut. None where straddlers are listed in both children.
    pub fragments: usize,
    /// Polygons and parts of them that lie in a splitting plane.
    pub coplanar: usize,
    /// Inner nodes whose planes are at right angles to an axis.
    pub axis_planes: usize,
    /// Leaves with more triangles than [`max_leaf_size`](crate::BspOptions::max_leaf_size): no plane was worth it,
    /// or a limit was reached.
    pub large_leaves: usize,
    /// Triangles in the largest leaf.
    pub largest_leaf: usize,
}

impl BspTree {
    /// What the tree looks like and what a random ray is expected to cost in it.
    ///
    /// Leaves without triangles count as nodes, though they take no memory, but not as visited: their parents mark them. Probabilities
    /// are ratios of the surface areas of the convex cells; the cell of what lies in a splitting plane is the cut, with two sides. Where the
    /// bounds have no area (all triangles on a line along an axis), every node counts as visited.
    /// Cost: O(nodes), some microseconds each.
    #[must_use]
    pub fn statistics(&self) -> TreeStatistics {
        let expected_visits = self.expected_visits();
        TreeStatistics {
            primitives: self.primitives,
            nodes: self.node_count(),
            leaves: self.leaves.len() + self.empty_leaf_count(),
            empty_leaves: self.empty_leaf_count(),
            depth: self.depth,
            references: self.references.len(),
            bytes: size_of::<Self>()
                + size_of::<Node>() * self.nodes.len()
                + size_of::<List>() * self.leaves.len()
                + size_of::<u32>() * self.references.len()
                + size_of::<ListedTriangle>() * self.triangles.len(),
            expected_visits,
            sah_cost: expected_visits.cost(self.options().traversal_cost),
        }
    }

    /// What is special about a BSP tree. Cost: O(nodes).
    #[must_use]
    pub fn bsp_statistics(&self) -> BspStatistics {
        let fragments = match self.options().straddlers {
            Straddlers::Split => 2 * self.straddlers,
            Straddlers::ListInBoth => 0,
        };
        let leaf_sizes = || self.leaves.iter().map(|leaf| leaf.count as usize);
        let max_leaf_size = self.options().max_leaf_size;
        BspStatistics {
            straddlers: self.straddlers,
            fragments,
            coplanar: self.coplanar,
            axis_planes: self
                .nodes
                .iter()
                .filter(|node| is_axis_plane(&node.plane))
                .count(),
            large_leaves: leaf_sizes().filter(|size| *size > max_leaf_size).count(),
            largest_leaf: leaf_sizes().max().unwrap_or(0),
        }
    }

    fn expected_visits(&self) -> ExpectedVisits {
        let mut visits = ExpectedVisits::default();
        if self.bounds().is_empty() {
            return visits;
        }
        let root = Cell::from_aabb(&self.bounds());
        let root_area = root.area();
        let mut pending: Vec<(Child, Cell)> = vec![(self.root, root)];
        while let Some((child, cell)) = pending.pop() {
            let probability = || ExpectedVisits::probability(cell.area(), root_area);
            match child.link() {
                Link::Empty => {}
                Link::Leaf(index) => {
                    visits.add_leaf(probability(), self.leaves[index].count as usize);
                }
                Link::Inner(index) => {
                    let node = &self.nodes[index];
                    visits.add_inner_node(probability());
                    pending.extend(node.children.into_iter().zip(cell.cut(&node.plane)));
                }
            }
        }
        visits
    }
}

fn is_axis_plane(plane: &Plane) -> bool {
    plane.normal.abs().max_element() == 1.0
}
