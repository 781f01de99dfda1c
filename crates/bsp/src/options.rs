//! Build options.

use tahko_geometry::Precision;
use thiserror::Error;

use crate::{Candidates, Splitter, SplittingPlanes, Straddlers};

/// How a [`BspTree`](crate::BspTree) is built: start from a preset and change what matters.
///
/// ```
/// use tahko_bsp::{BspOptions, Splitter, Straddlers};
///
/// let options = BspOptions::fast().with_straddlers(Straddlers::ListInBoth).with_max_leaf_size(8);
/// assert_eq!(options.splitter, Splitter::SurfaceArea);
/// assert_eq!(options.max_leaf_size, 8);
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct BspOptions {
    /// How the queries decide hits.
    pub precision: Precision,
    /// How the splitting plane of a node is chosen.
    pub splitter: Splitter,
    /// The planes that a polygon offers.
    pub planes: SplittingPlanes,
    /// How many polygons of a node offer planes. More find cheaper trees; the build time grows with them.
    /// The first and the random splitter take the first of them whose plane makes progress.
    pub candidates: Candidates,
    /// What becomes of polygons on both sides of a plane.
    pub straddlers: Straddlers,
    /// Nodes of at most this many polygons are not split, 1 to 65535.
    pub max_leaf_size: usize,
    /// The most planes on a way from the root to a leaf, 0 to 1000. Nodes at the limit become leaves of any size.
    pub max_depth: usize,
    /// The most entries in all lists of triangles, as a multiple of the number of polygons, 1 to 1000. Where
    /// splitting would exceed a node's share of it, the node becomes a leaf: this keeps meshes on which BSP trees
    /// grow quadratically in bounds.
    pub max_growth: f64,
    /// Cost of visiting an inner node in triangle tests, positive and finite: for [`Splitter::SurfaceArea`]
    /// and [`BspTree::statistics`](crate::BspTree::statistics).
    pub traversal_cost: f64,
    /// Start of the random choices. The same seed gives the same tree.
    pub seed: u64,
}

/// Why a tree was not built.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum BuildError {
    /// A whole-numbered option is out of its range.
    #[error("option {option} is {given}, but must be from {least} to {most}")]
    OutOfRange {
        /// Name of the field in [`BspOptions`].
        option: &'static str,
        /// Its value.
        given: usize,
        /// The smallest value allowed.
        least: usize,
        /// The largest value allowed.
        most: usize,
    },
    /// A cost, factor or weight is out of its range, or not a number.
    #[error("option {option} is {given}, but must be {expected}")]
    InvalidNumber {
        /// Name of the field in [`BspOptions`].
        option: &'static str,
        /// Its value.
        given: f64,
        /// What it may be.
        expected: &'static str,
    },
}

impl BspOptions {
    /// The largest value of [`max_leaf_size`](Self::max_leaf_size).
    pub const MAX_LEAF_SIZE: usize = 65535;
    /// The largest value of [`max_depth`](Self::max_depth).
    pub const MAX_DEPTH: usize = 1000;
    /// The largest value of [`max_growth`](Self::max_growth).
    pub const MAX_GROWTH: f64 = 1000.0;

    /// The shortest build: one polygon of a node offers planes.
    #[must_use]
    pub const fn fast() -> Self {
        Self {
            candidates: Candidates::Sample(1),
            max_leaf_size: 4,
            ..Self::balanced()
        }
    }

    /// The default: the surface area heuristic over the planes of four polygons, with straddlers split.
    #[must_use]
    pub const fn balanced() -> Self {
        Self {
            precision: Precision::Exact,
            splitter: Splitter::SurfaceArea,
            planes: SplittingPlanes::PolygonsEdgesAndAxes,
            candidates: Candidates::Sample(4),
            straddlers: Straddlers::Split,
            max_leaf_size: 2,
            max_depth: 64,
            max_growth: 8.0,
            traversal_cost: 1.0,
            seed: 0,
        }
    }

    /// The fewest triangle tests: the planes of sixteen polygons, and leaves of a single one.
    #[must_use]
    pub const fn high_quality() -> Self {
        Self {
            candidates: Candidates::Sample(16),
            max_leaf_size: 1,
            traversal_cost: 0.5,
            ..Self::balanced()
        }
    }

    /// Sets [`precision`](Self::precision).
    #[must_use]
    pub const fn with_precision(mut self, precision: Precision) -> Self {
        self.precision = precision;
        self
    }

    /// Sets [`splitter`](Self::splitter).
    #[must_use]
    pub const fn with_splitter(mut self, splitter: Splitter) -> Self {
        self.splitter = splitter;
        self
    }

    /// Sets [`planes`](Self::planes).
    #[must_use]
    pub const fn with_planes(mut self, planes: SplittingPlanes) -> Self {
        self.planes = planes;
        self
    }

    /// Sets [`candidates`](Self::candidates).
    #[must_use]
    pub const fn with_candidates(mut self, candidates: Candidates) -> Self {
        self.candidates = candidates;
        self
    }

    /// Sets [`straddlers`](Self::straddlers).
    #[must_use]
    pub const fn with_straddlers(mut self, straddlers: Straddlers) -> Self {
        self.straddlers = straddlers;
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
    pub const fn with_max_depth(mut self, max_depth: usize) -> Self {
        self.max_depth = max_depth;
        self
    }

    /// Sets [`max_growth`](Self::max_growth).
    #[must_use]
    pub const fn with_max_growth(mut self, max_growth: f64) -> Self {
        self.max_growth = max_growth;
        self
    }

    /// Sets [`traversal_cost`](Self::traversal_cost).
    #[must_use]
    pub const fn with_traversal_cost(mut self, traversal_cost: f64) -> Self {
        self.traversal_cost = traversal_cost;
        self
    }

    /// Sets [`seed`](Self::seed).
    #[must_use]
    pub const fn with_seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// Checks every option against its range.
    pub(crate) fn check(&self) -> Result<(), BuildError> {
        let sample = match self.candidates {
            Candidates::Sample(count) => count,
            Candidates::All => usize::MAX,
        };
        for (option, given, least, most) in [
            ("candidates", sample, 1, usize::MAX),
            ("max_leaf_size", self.max_leaf_size, 1, Self::MAX_LEAF_SIZE),
            ("max_depth", self.max_depth, 0, Self::MAX_DEPTH),
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
        self.check_numbers()
    }

    fn check_numbers(&self) -> Result<(), BuildError> {
        let check = |option, given: f64, is_valid: bool, expected| {
            let error = BuildError::InvalidNumber {
                option,
                given,
                expected,
            };
            if is_valid { Ok(()) } else { Err(error) }
        };
        let growth = self.max_growth;
        let in_range = (1.0..=Self::MAX_GROWTH).contains(&growth);
        check("max_growth", growth, in_range, "from 1 to 1000")?;
        let cost = self.traversal_cost;
        let is_cost = cost > 0.0 && cost.is_finite();
        check("traversal_cost", cost, is_cost, "positive and finite")?;
        if let Splitter::Weighted { balance, splits } = self.splitter {
            for weight in [balance, splits] {
                let is_weight = weight >= 0.0 && weight.is_finite() && balance + splits > 0.0;
                let expected = "weighted with finite weights, none negative and not both zero";
                check("splitter", weight, is_weight, expected)?;
            }
        }
        Ok(())
    }
}

impl Default for BspOptions {
    /// [`BspOptions::balanced`].
    fn default() -> Self {
        Self::balanced()
    }
}
