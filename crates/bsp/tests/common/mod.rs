//! What the tests share: every way to build a tree.

use tahko_bsp::{BspOptions, BspTree, Candidates, Splitter, SplittingPlanes, Straddlers};
use tahko_geometry::TriangleMesh;

pub(crate) const SPLITTERS: [Splitter; 6] = [
    Splitter::First,
    Splitter::Random,
    Splitter::MostBalanced,
    Splitter::FewestSplits,
    Splitter::WEIGHTED,
    Splitter::SurfaceArea,
];

/// Small leaves, every splitter, both treatments of straddlers, and every set of planes and candidates at least once.
pub(crate) fn all_options() -> Vec<BspOptions> {
    let mut all = vec![
        BspOptions::fast(),
        BspOptions::balanced(),
        BspOptions::high_quality(),
        BspOptions::balanced().with_candidates(Candidates::All),
        BspOptions::balanced().with_planes(SplittingPlanes::PolygonsAndEdges),
        BspOptions::fast().with_max_depth(3),
        BspOptions::fast().with_max_growth(1.0),
    ];
    for splitter in SPLITTERS {
        for straddlers in [Straddlers::Split, Straddlers::ListInBoth] {
            let options = BspOptions::balanced()
                .with_splitter(splitter)
                .with_straddlers(straddlers)
                .with_planes(SplittingPlanes::Polygons)
                .with_max_leaf_size(1);
            all.push(options);
        }
    }
    all
}

pub(crate) fn build(mesh: &TriangleMesh, options: &BspOptions) -> BspTree {
    BspTree::build(mesh, options).expect("options in range")
}
