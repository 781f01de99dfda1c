//! How a tree is built.

use tahko_geometry::Precision;
use thiserror::Error;

use crate::node::Node;

/// The axis that a policy without a cost model splits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AxisChoice {
    /// x at the root, then y, z, x and so on by depth.
    Cycling,
    /// The longest edge of the cell.
    Longest,
}

/// Where a cell is split.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum SplitPolicy {
    /// In the middle of the cell. The quickest build.
    SpatialMiddle(AxisChoice),
    /// At the median of the centres of the triangles' boxes: as many triangles on both sides. It makes the
    /// shallowest trees, and the slowest, since it cuts off no empty space.
    ObjectMedian(AxisChoice),
    /// Where the surface area heuristic expects the cheapest queries. Cells with more than 64 triangles in which no split
    /// is expected to pay are split in the middle.
    #[default]
    SurfaceArea,
}

impl SplitPolicy {
    /// All policies.
    pub const ALL: [Self; 5] = [
        Self::SpatialMiddle(AxisChoice::Cycling),
        Self::SpatialMiddle(AxisChoice::Longest),
        Self::ObjectMedian(AxisChoice::Cycling),
        Self::ObjectMedian(AxisChoice::Longest),
        Self::SurfaceArea,
    ];
}

/// How a [`KdTree`](crate::KdTree) is built. Begin with a preset and change single values:
///
/// ```
/// use tahko_kdtree::{AxisChoice, KdTreeOptions, SplitPolicy};
///
/// let options = KdTreeOptions::fast()
///     .with_split_policy(SplitPolicy::SpatialMiddle(AxisChoice::Cycling))
///     .with_max_leaf_size(16);
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct KdTreeOptions {
    /// Where a cell is split.
    pub split_policy: SplitPolicy,
    /// A cell with this many triangles or fewer is not split, at least 1. Leaves can be larger: where no
    /// split pays, at the largest depth, and where duplicates cannot be separated.
    pub max_leaf_size: usize,
    /// The largest number of splits between the root and a leaf, at most [`Self::MAX_DEPTH`]; `None` for
    /// `8 + 1.3 log2 n`.
    pub max_depth: Option<u32>,
    /// Cost of visiting an inner node, finite and not negative. Only the ratio to `intersection_cost` counts; a
    /// larger one makes larger leaves. For [`SplitPolicy::SurfaceArea`] and for the statistics.
    pub traversal_cost: f32,
    /// Cost of testing a triangle, finite and above 0.
    pub intersection_cost: f32,
    /// The factor on the cost of a split that cuts off an empty cell, above 0 and at most 1; a smaller one cuts off
    /// more empty space. For [`SplitPolicy::SurfaceArea`].
    pub empty_space_factor: f32,
    /// The largest number of list entries per triangle, at least 1 and finite. Subtrees share it in proportion to
    /// their triangles, and a cell that would need more than its share becomes a leaf. It bounds memory on
    /// input where many triangles straddle every plane; ordinary input stays far below the default.
    pub max_references_per_triangle: f32,
    /// How hits are decided.
    pub precision: Precision,
}

impl Default for KdTreeOptions {
    fn default() -> Self {
        Self::balanced()
    }
}

impl KdTreeOptions {
    /// The largest value of `max_depth`.
    pub const MAX_DEPTH: u32 = 1024;

    /// Splits the longest axis in the middle, down to 16 triangles: builds 2 to 5 times faster than the default, and
    /// queries took 1.1 to 1.5 times as long (measured on five scenes of 34 to 100 thousand triangles).
    #[must_use]
    pub const fn fast() -> Self {
        Self::balanced()
            .with_split_policy(SplitPolicy::SpatialMiddle(AxisChoice::Longest))
            .with_max_leaf_size(16)
    }

    /// The default: the surface area heuristic with the constants of Wald and Havran, down to 4 triangles.
    ///
    /// There is no preset beyond it: splitting down to single triangles saves 20 to 60 % of the triangle tests for 1.6
    /// to 3.5 times the nodes, and was not faster.
    #[must_use]
    pub const fn balanced() -> Self {
        Self {
            split_policy: SplitPolicy::SurfaceArea,
            max_leaf_size: 4,
            max_depth: None,
            traversal_cost: 15.0,
            intersection_cost: 20.0,
            empty_space_factor: 0.8,
            max_references_per_triangle: 16.0,
            precision: Precision::Exact,
        }
    }

    /// Sets [`split_policy`](Self::split_policy).
    #[must_use]
    pub const fn with_split_policy(mut self, split_policy: SplitPolicy) -> Self {
        self.split_policy = split_policy;
        self
    }

    /// Sets [`max_leaf_size`](Self::max_leaf_size).
    #[must_use]
    pub const fn with_max_leaf_size(mut self, max_leaf_size: usize) -> Self {
        self.max_leaf_size = max_leaf_size;
        self
    }

    /// Sets [`max_depth`](Self::max_depth).
    #[must_use]
    pub const fn with_max_depth(mut self, max_depth: Option<u32>) -> Self {
        self.max_depth = max_depth;
        self
    }

    /// Sets [`traversal_cost`](Self::traversal_cost) and [`intersection_cost`](Self::intersection_cost).
    #[must_use]
    pub const fn with_costs(mut self, traversal: f32, intersection: f32) -> Self {
        self.traversal_cost = traversal;
        self.intersection_cost = intersection;
        self
    }

    /// Sets [`empty_space_factor`](Self::empty_space_factor).
    #[must_use]
    pub const fn with_empty_space_factor(mut self, factor: f32) -> Self {
        self.empty_space_factor = factor;
        self
    }

    /// Sets [`max_references_per_triangle`](Self::max_references_per_triangle).
    #[must_use]
    pub const fn with_max_references_per_triangle(mut self, limit: f32) -> Self {
        self.max_references_per_triangle = limit;
        self
    }

    /// Sets [`precision`](Self::precision).
    #[must_use]
    pub const fn with_precision(mut self, precision: Precision) -> Self {
        self.precision = precision;
        self
    }

    /// Checks that every value is in its range.
    pub(crate) fn check(&self) -> Result<(), BuildError> {
        let refuse = |option, value, range| {
            Err(BuildError::OptionOutOfRange {
                option,
                value,
                range,
            })
        };
        if self.max_leaf_size == 0 {
            return refuse("max_leaf_size", 0.0, "at least 1");
        }
        if let Some(depth) = self.max_depth
            && depth > Self::MAX_DEPTH
        {
            return refuse("max_depth", f64::from(depth), "at most 1024");
        }
        let numbers = [
            (
                "traversal_cost",
                self.traversal_cost,
                0.0..=f32::MAX,
                "finite and not negative",
            ),
            (
                "intersection_cost",
                self.intersection_cost,
                f32::MIN_POSITIVE..=f32::MAX,
                "finite and above 0",
            ),
            (
                "empty_space_factor",
                self.empty_space_factor,
                f32::MIN_POSITIVE..=1.0,
                "above 0 and at most 1",
            ),
            (
                "max_references_per_triangle",
                self.max_references_per_triangle,
                1.0..=f32::MAX,
                "finite and at least 1",
            ),
        ];
        for (option, value, accepted, range) in numbers {
            if !accepted.contains(&value) {
                return refuse(option, f64::from(value), range);
            }
        }
        Ok(())
    }
}

/// Why a tree could not be built.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum BuildError {
    /// An option is outside its range.
    #[error("option {option} must be {range}, not {value}")]
    OptionOutOfRange {
        /// The name of the option.
        option: &'static str,
        /// Its value.
        value: f64,
        /// The range, in words.
        range: &'static str,
    },
    /// More nodes or list entries than a node can address.
    #[error(
        "the tree needs more than {limit} nodes or list entries; lower max_references_per_triangle or \
         max_depth, or raise max_leaf_size",
        limit = Node::MAX_OFFSET
    )]
    TooLarge,
}
