//! Build options.

use tahko_geometry::Precision;
use thiserror::Error;

/// How a [`Bvh`](crate::Bvh) is built: start from a preset and change what matters.
///
/// ```
/// use tahko_bvh::BvhOptions;
/// use tahko_geometry::Precision;
///
/// let options = BvhOptions::fast().with_precision(Precision::Fast).with_max_leaf_size(8);
/// assert_eq!(options.method, BvhOptions::fast().method);
/// assert_eq!(options.max_leaf_size, 8);
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct BvhOptions {
    /// How the queries decide hits.
    pub precision: Precision,
    /// How the tree is built.
    pub method: BuildMethod,
    /// Bins per axis in which candidate splits are counted, 2 to 64. More bins find cheaper splits;
    /// the build time grows slowly with them. Nodes of few triangles use fewer.
    pub bins: usize,
    /// Nodes of at most this many triangles, 0 to 256, try every split between sorted centroids
    /// instead of bins: cheaper trees for a longer build.
    pub sweep_size: usize,
    /// How many references to triangles a build with spatial splits may make, as a multiple of the number of triangles: 1 to
    /// [`MAX_SPATIAL_SPLIT_BUDGET`](Self::MAX_SPATIAL_SPLIT_BUDGET); 1 means no spatial splits. Large or long triangles are then listed by several leaves, which
    /// makes cheaper trees of meshes that have such, for a longer build. Evenly tessellated meshes use little of the budget. Only for
    /// [`TopDown`](BuildMethod::TopDown).
    pub spatial_split_budget: f64,
    /// How many pieces long thin diagonal triangles may be cut in before the tree is built, as a multiple of the number of triangles: 1 to
    /// [`MAX_PRESPLIT_BUDGET`](Self::MAX_PRESPLIT_BUDGET); 1 means no pieces. The box of such a triangle is as large as if it were full; where many lie in each other, rays test all of them, and each
    /// piece of the triangles' length has a smaller box. Triangles are cut only as far as the boxes which a random line is expected to meet become so much fewer
    /// that it pays, and not at all in meshes where that is little (scans, interiors, terrains): those have the same tree with any budget. Otherwise time and memory of the build and
    /// the size of the tree grow with the pieces, and rays need less time in about the same proportion, until other costs prevail. Spatial splits come on top, as long as there are not
    /// twice their budget of references. Only for [`TopDown`](BuildMethod::TopDown).
    pub presplit_budget: f64,
    /// Rounds in which the finished tree is improved by moving subtrees to cheaper places, 0 to
    /// [`MAX_REINSERTION_ROUNDS`](Self::MAX_REINSERTION_ROUNDS). The first two bring most of what there is to gain; a round that finds nothing is the last.
    pub reinsertion_rounds: usize,
    /// The most triangles in a leaf, 1 to 255. Leaves are smaller where that is cheaper: the build makes leaves of at most 4, and the
    /// layout joins those that are cheaper together. Queries test eight triangles at a time.
    pub max_leaf_size: usize,
    /// Cost of visiting an inner node; positive and finite. Only its ratio to `intersection_cost` matters: the larger, the
    /// fewer nodes. In the finished tree it is the cost of a node with up to eight children against that of a block of up to eight
    /// triangles. A build from the top weighs a node with two children against a triangle by it, and the [statistics](crate::Bvh::statistics) a node
    /// with up to eight children against a triangle.
    pub traversal_cost: f64,
    /// Cost of a triangle test, or of one of up to eight triangles at a time; positive and finite.
    pub intersection_cost: f64,
    /// How the boxes of nodes are stored.
    pub node_format: NodeFormat,
}

/// How a tree is built.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum BuildMethod {
    /// Neighbours on a space-filling curve merge into clusters, bottom up; the clusters are split top down. The costs do not
    /// matter to the build, only to what is made of its tree.
    Clusters,
    /// Nodes are split top down where the surface area heuristic finds it cheapest.
    TopDown,
}

/// How the boxes of nodes are stored. The answers are the same, bit for bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum NodeFormat {
    /// As they are, in f32: 256 bytes for a node of up to eight children.
    Full,
    /// Rounded outward to 8 bits of the extent of the node: 96 bytes, which makes trees 8 % smaller. Measured against the other format, rays visit 3 to 12 % more nodes,
    /// and to decode a node takes a third more instructions: up to a seventh slower in trees that fit the caches, about as fast in trees of 100 MB and more. An object that
    /// is tiny beside its surroundings costs more: in the node that it shares with them its parts have boxes as large as a step of their grid.
    Quantised,
}

impl NodeFormat {
    /// All formats, the most precise one first.
    pub const ALL: [Self; 2] = [Self::Full, Self::Quantised];

    /// The name in reports and on command lines: `full` or `quantised`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Full => "full",
            Self::Quantised => "quantised",
        }
    }
}

/// Why a tree was not built.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum BuildError {
    /// A whole-numbered option is out of its range.
    #[error("option {option} is {given}, but must be from {least} to {most}")]
    OutOfRange {
        /// Name of the field in [`BvhOptions`].
        option: &'static str,
        /// Its value.
        given: usize,
        /// The smallest value allowed.
        least: usize,
        /// The largest value allowed.
        most: usize,
    },
    /// A budget is out of its range, or NaN.
    #[error("option {option} is {given}, but must be from 1 to {most}")]
    InvalidBudget {
        /// Name of the field in [`BvhOptions`].
        option: &'static str,
        /// Its value.
        given: f64,
        /// The largest value allowed.
        most: f64,
    },
    /// The build was cancelled through its [`BuildControl`](crate::BuildControl).
    #[error("the build was cancelled")]
    Cancelled,
    /// The build would need more memory than its [`BuildControl`](crate::BuildControl) allows.
    #[error("the build needs about {needed} bytes, but only {allowed} are allowed")]
    MemoryLimit {
        /// Estimate of the bytes needed.
        needed: u64,
        /// The bytes allowed.
        allowed: u64,
    },
    /// A cost is zero, negative, infinite or NaN.
    #[error("option {option} is {given}, but must be positive and finite")]
    InvalidCost {
        /// Name of the field in [`BvhOptions`].
        option: &'static str,
        /// Its value.
        given: f64,
    },
}

impl BvhOptions {
    /// The largest value of [`bins`](Self::bins).
    pub const MAX_BINS: usize = 64;
    /// The largest value of [`sweep_size`](Self::sweep_size).
    pub const MAX_SWEEP_SIZE: usize = 256;
    /// The largest value of [`spatial_split_budget`](Self::spatial_split_budget).
    pub const MAX_SPATIAL_SPLIT_BUDGET: f64 = 2.0;
    /// The largest value of [`presplit_budget`](Self::presplit_budget).
    pub const MAX_PRESPLIT_BUDGET: f64 = 32.0;
    /// The largest value of [`reinsertion_rounds`](Self::reinsertion_rounds).
    pub const MAX_REINSERTION_ROUNDS: usize = 64;
    /// The largest value of [`max_leaf_size`](Self::max_leaf_size).
    pub const MAX_LEAF_SIZE: usize = 255;

    /// The shortest build: clusters. Measured against the default, two fifths of the time, and trees whose nodes and blocks
    /// cost 3 to 14 % more.
    #[must_use]
    pub const fn fast() -> Self {
        Self {
            method: BuildMethod::Clusters,
            ..Self::balanced()
        }
    }

    /// The default: 16 bins.
    #[must_use]
    pub const fn balanced() -> Self {
        Self {
            precision: Precision::Exact,
            method: BuildMethod::TopDown,
            bins: 16,
            sweep_size: 0,
            spatial_split_budget: 1.0,
            presplit_budget: 1.0,
            reinsertion_rounds: 0,
            max_leaf_size: 8,
            // Measured in trees with eight children per node: ratios of 0.7, 1 and 1.5 give the same trees within 1 %.
            traversal_cost: 1.5,
            intersection_cost: 1.0,
            node_format: NodeFormat::Full,
        }
    }

    /// The cheapest tree: 32 bins, every split tried in nodes of up to 8 triangles, spatial splits, pieces of slivers and reinsertion. Measured against the
    /// default, two to three times the build time, and trees whose nodes and blocks cost 6 to 18 % less in interiors, 3 % on a scan. Where slivers as long as the scene are cut in pieces, up to
    /// eight times the memory, and rays 6 to 10 times as fast.
    #[must_use]
    pub fn high_quality() -> Self {
        Self {
            bins: 32,
            sweep_size: 8,
            spatial_split_budget: 1.3,
            presplit_budget: 8.0,
            reinsertion_rounds: 3,
            ..Self::balanced()
        }
    }

    /// Sets [`precision`](Self::precision).
    #[must_use]
    pub const fn with_precision(mut self, precision: Precision) -> Self {
        self.precision = precision;
        self
    }

    /// Sets [`method`](Self::method).
    #[must_use]
    pub const fn with_method(mut self, method: BuildMethod) -> Self {
        self.method = method;
        self
    }

    /// Sets [`bins`](Self::bins).
    #[must_use]
    pub const fn with_bins(mut self, bins: usize) -> Self {
        self.bins = bins;
        self
    }

    /// Sets [`sweep_size`](Self::sweep_size).
    #[must_use]
    pub const fn with_sweep_size(mut self, sweep_size: usize) -> Self {
        self.sweep_size = sweep_size;
        self
    }

    /// Sets [`spatial_split_budget`](Self::spatial_split_budget).
    #[must_use]
    pub const fn with_spatial_split_budget(mut self, spatial_split_budget: f64) -> Self {
        self.spatial_split_budget = spatial_split_budget;
        self
    }

    /// Sets [`presplit_budget`](Self::presplit_budget).
    #[must_use]
    pub const fn with_presplit_budget(mut self, presplit_budget: f64) -> Self {
        self.presplit_budget = presplit_budget;
        self
    }

    /// Sets [`reinsertion_rounds`](Self::reinsertion_rounds).
    #[must_use]
    pub const fn with_reinsertion_rounds(mut self, reinsertion_rounds: usize) -> Self {
        self.reinsertion_rounds = reinsertion_rounds;
        self
    }

    /// Sets [`max_leaf_size`](Self::max_leaf_size).
    #[must_use]
    pub const fn with_max_leaf_size(mut self, max_leaf_size: usize) -> Self {
        self.max_leaf_size = max_leaf_size;
        self
    }

    /// Sets [`traversal_cost`](Self::traversal_cost) and [`intersection_cost`](Self::intersection_cost).
    #[must_use]
    pub const fn with_costs(mut self, traversal_cost: f64, intersection_cost: f64) -> Self {
        self.traversal_cost = traversal_cost;
        self.intersection_cost = intersection_cost;
        self
    }

    /// Sets [`node_format`](Self::node_format).
    #[must_use]
    pub const fn with_node_format(mut self, node_format: NodeFormat) -> Self {
        self.node_format = node_format;
        self
    }

    /// Checks every option against its range.
    pub(crate) fn check(&self) -> Result<(), BuildError> {
        for (option, given, least, most) in [
            ("bins", self.bins, 2, Self::MAX_BINS),
            ("sweep_size", self.sweep_size, 0, Self::MAX_SWEEP_SIZE),
            (
                "reinsertion_rounds",
                self.reinsertion_rounds,
                0,
                Self::MAX_REINSERTION_ROUNDS,
            ),
            ("max_leaf_size", self.max_leaf_size, 1, Self::MAX_LEAF_SIZE),
        ] {
            if !(least..=most).contains(&given) {
                return Err(BuildError::OutOfRange {
                    option,
                    given,
                    least,
                    most,
                });
            }
        }
        for (option, given, most) in [
            (
                "spatial_split_budget",
                self.spatial_split_budget,
                Self::MAX_SPATIAL_SPLIT_BUDGET,
            ),
            (
                "presplit_budget",
                self.presplit_budget,
                Self::MAX_PRESPLIT_BUDGET,
            ),
        ] {
            if !(1.0..=most).contains(&given) {
                return Err(BuildError::InvalidBudget {
                    option,
                    given,
                    most,
                });
            }
        }
        for (option, given) in [
            ("traversal_cost", self.traversal_cost),
            ("intersection_cost", self.intersection_cost),
        ] {
            if !(given > 0.0 && given.is_finite()) {
                return Err(BuildError::InvalidCost { option, given });
            }
        }
        Ok(())
    }
}

impl Default for BvhOptions {
    /// [`BvhOptions::balanced`].
    fn default() -> Self {
        Self::balanced()
    }
}
