//! The choices that the build leaves to its user.

/// Which splitting plane a node takes among its candidates.
///
/// Front, back, coplanar and straddling polygons are counted for each candidate plane. Ties go to the
/// candidate that comes first. Where candidates times polygons exceed a million, the candidates are ranked by an evenly
/// spread part of the polygons.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Splitter {
    /// The plane of the node's first polygon: no choice at all, and the shortest build. The tree follows the
    /// order of the mesh.
    First,
    /// The plane of a random polygon. By Paterson and Yao (1990) the expected number of
    /// fragments is O(n log n) in the plane and O(n^2) in space.
    Random,
    /// The least difference between the numbers in front and behind; then the fewest straddlers.
    MostBalanced,
    /// The fewest straddlers; then the least difference between the numbers in front and behind.
    FewestSplits,
    /// The least sum of both, each times its weight. Weights are finite and not negative, and one is positive.
    Weighted {
        /// Weight of the difference between the numbers in front and behind.
        balance: f64,
        /// Weight of the number of straddlers.
        splits: f64,
    },
    /// The least expected cost of a ray by the surface area heuristic, measured on the convex polytopes into
    /// which planes cut the bounds. A node becomes a leaf where no plane pays. Source: Ize, Wald, Parker,
    /// "Ray tracing with the BSP tree", 2008; differs in sampling the candidates and in cutting the polygons.
    SurfaceArea,
}

impl Splitter {
    /// [`Weighted`](Self::Weighted) with a straddler as bad as eight polygons of imbalance.
    pub const WEIGHTED: Self = Self::Weighted {
        balance: 1.0,
        splits: 8.0,
    };
}

/// The planes that a polygon offers as candidates to the splitters that compare several
/// ([`First`](Splitter::First) and [`Random`](Splitter::Random) use the polygon's own plane always).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SplittingPlanes {
    /// The polygon's own plane: the classic BSP tree. On convex shapes every plane has everything on one side, and
    /// the depth limit ends the build.
    Polygons,
    /// Its own plane and the planes through its edges at right angles to it.
    PolygonsAndEdges,
    /// These, the planes through its outermost points at right angles to the axes, and those around
    /// all polygons of the node.
    PolygonsEdgesAndAxes,
}

/// How many polygons of a node offer candidate planes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Candidates {
    /// At most this many, at least one: random ones, evenly spread over the node's list.
    Sample(usize),
    /// Every polygon: the most thorough, and slower to build than a small sample by an order of magnitude or more.
    All,
}

/// What becomes of a polygon that lies on both sides of a splitting plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Straddlers {
    /// It is cut, and each part goes on by itself: a cell lists the triangles that are in it.
    Split,
    /// It goes to both sides whole: quicker per node, but cells list triangles that only their planes meet.
    ListInBoth,
}
