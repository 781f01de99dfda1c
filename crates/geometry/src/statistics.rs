//! What a structure looks like and what it costs.

/// Statistics of a built structure.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TreeStatistics {
    /// Triangles that the structure was built from.
    pub primitives: usize,
    /// All nodes, leaves included.
    pub nodes: usize,
    /// Nodes without children.
    pub leaves: usize,
    /// Leaves without triangles.
    pub empty_leaves: usize,
    /// Nodes on the longest way from the root to a leaf, both included; 0 for a structure without nodes.
    pub depth: usize,
    /// Entries in the lists of triangles; more than `primitives` where triangles are listed several times.
    pub references: usize,
    /// Memory that queries need, in bytes, the copies of the triangles included.
    pub bytes: usize,
    /// What a random line is expected to visit.
    pub expected_visits: ExpectedVisits,
    /// The cost of these visits in units of one triangle test, with the cost of an inner node that the tree was built with.
    pub sah_cost: f64,
}

impl TreeStatistics {
    /// How often a triangle is listed on average; 0 for a structure over no triangles.
    #[must_use]
    pub fn references_per_primitive(&self) -> f64 {
        ratio(self.references, self.primitives)
    }

    /// Memory per triangle in bytes; 0 for a structure over no triangles.
    #[must_use]
    pub fn bytes_per_primitive(&self) -> f64 {
        ratio(self.bytes, self.primitives)
    }
}

/// What a random line that meets the bounds of a structure is expected to visit, by the surface area heuristic.
///
/// Such a line meets a convex cell inside the bounds with a probability equal to the ratio of their surface areas, so each
/// number is a sum of these ratios. The line is endless and hits nothing: a ray that ends at a hit or begins inside
/// the bounds visits less. `inner_nodes + leaves` is what [`QueryCounts::node_visits`](crate::QueryCounts::node_visits) counts, and
/// `triangle_tests` is its namesake there.
///
/// Source: Wald, Havran, *On building fast kd-trees for ray tracing, and on doing that in O(N log N)*, 2006, table 1: `E_T`, `E_L`
/// and `E_I`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ExpectedVisits {
    /// Inner nodes (`E_T`).
    pub inner_nodes: f64,
    /// Leaves (`E_L`), empty ones included where queries count them as visited.
    pub leaves: f64,
    /// Triangle tests (`E_I`), were each triangle tested in every leaf that lists it.
    pub triangle_tests: f64,
}

impl ExpectedVisits {
    /// The probability of a cell, given surface areas. Bounds without area leave it undefined: then every cell counts as visited.
    #[must_use]
    pub fn probability(area: f64, bounds_area: f64) -> f64 {
        if bounds_area > 0.0 {
            area / bounds_area
        } else {
            1.0
        }
    }

    /// Adds an inner node that is visited with a probability.
    pub fn add_inner_node(&mut self, probability: f64) {
        self.inner_nodes += probability;
    }

    /// Adds a leaf that is visited with a probability and lists some triangles.
    pub fn add_leaf(&mut self, probability: f64, triangles: usize) {
        self.leaves += probability;
        self.triangle_tests += probability * triangles as f64;
    }

    /// The cost in units of one triangle test, given that of an inner node.
    #[must_use]
    pub fn cost(&self, inner_node_cost: f64) -> f64 {
        inner_node_cost * self.inner_nodes + self.triangle_tests
    }
}

fn ratio(total: usize, count: usize) -> f64 {
    if count == 0 {
        0.0
    } else {
        total as f64 / count as f64
    }
}
