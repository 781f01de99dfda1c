//! What a structure looks like and what it costs.

/// Statistics of a built structure.
///
/// Costs follow the surface area heuristic: a random ray that meets the bounds of the structure visits a
/// node with a probability equal to the ratio of the areas of their bounding polytopes.
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
    /// Expected cost of a random ray, in units of one triangle test.
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

fn ratio(total: usize, count: usize) -> f64 {
    if count == 0 {
        0.0
    } else {
        total as f64 / count as f64
    }
}
