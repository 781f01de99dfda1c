//! Depth of BSP trees and the growth of polygons by splitting, for every splitter.
//!
//! The literature's worst case is a scene on which every BSP tree has of the order of `n^2` fragments; for ordinary scenes and random planes it
//! expects no more than `n log n`. A series of trees holds to that if its list entries grow no faster than `n log n` does between the same sizes, and no
//! tree was kept small by the limit on entries.

use anyhow::Result;
use tahko_bsp::{BspOptions, BspTree, Splitter, Straddlers};
use tahko_tracer::generate::Generator;
use tahko_tracer::geometry::TriangleMesh;

use super::{Effort, range_text, verdict};
use crate::report::{Claim, Fit, Verdict};
use crate::{fit, generated, table};

/// Small facets of a smooth surface, larger polygons in many directions, and thin triangles that reach through the whole scene: the shape of the
/// worst case.
const GENERATORS: [Generator; 3] = [Generator::Terrain, Generator::Gears, Generator::Needles];

const SPLITTERS: [(&str, Splitter); 6] = [
    ("first", Splitter::First),
    ("random", Splitter::Random),
    ("most balanced", Splitter::MostBalanced),
    ("fewest splits", Splitter::FewestSplits),
    ("weighted", Splitter::WEIGHTED),
    ("surface area", Splitter::SurfaceArea),
];

const STRADDLERS: [(&str, Straddlers); 2] = [
    ("split", Straddlers::Split),
    ("list in both", Straddlers::ListInBoth),
];

/// Limits far above what ordinary scenes need, so that the trees show what the policies do.
const MAX_DEPTH: usize = 256;
const MAX_GROWTH: f64 = BspOptions::MAX_GROWTH;

/// An exponent may exceed that of `n log n` by so much: trees of the same policy scatter.
const EXPONENT_TOLERANCE: f64 = 0.05;

/// A tree with more than this part of the entries that the limit allows was kept small by it: nodes become leaves where they exceed their share.
const LIMITED: f64 = 0.5;

/// The needles grow to a part of the size of the ordinary scenes: their trees are much larger.
const PART_OF_NEEDLES: u32 = 20;

/// Trees of growing scenes.
struct Series {
    generator: Generator,
    splitter: &'static str,
    straddlers: &'static str,
    trees: Vec<Tree>,
}

#[derive(Clone)]
struct Tree {
    triangles: usize,
    depth: usize,
    nodes: usize,
    fragments: usize,
    references: usize,
    largest_leaf: usize,
}

impl Tree {
    fn build(mesh: &TriangleMesh, splitter: Splitter, straddlers: Straddlers) -> Result<Self> {
        let options = BspOptions::default()
            .with_splitter(splitter)
            .with_straddlers(straddlers)
            .with_max_depth(MAX_DEPTH)
            .with_max_growth(MAX_GROWTH);
        let tree = BspTree::build(mesh, &options)?;
        let (statistics, special) = (tree.statistics(), tree.bsp_statistics());
        Ok(Self {
            triangles: mesh.len(),
            depth: statistics.depth,
            nodes: statistics.nodes,
            fragments: special.fragments,
            references: statistics.references,
            largest_leaf: special.largest_leaf,
        })
    }

    fn per_triangle(&self, count: usize) -> f64 {
        count as f64 / self.triangles as f64
    }

    /// The depth in units of that of a balanced tree.
    fn relative_depth(&self) -> f64 {
        self.depth as f64 / (self.triangles as f64).log2()
    }
}

impl Series {
    fn exponent(&self) -> Option<Fit> {
        let trees = self.trees.iter();
        let points: Vec<_> = trees
            .map(|tree| (tree.triangles as f64, tree.references as f64))
            .collect();
        fit::power_law(&points)
    }

    /// Whether the entries grow no faster than is expected; `None` for fewer than three sizes.
    fn holds(&self) -> Option<bool> {
        let trees = self.trees.iter();
        let places: Vec<f64> = trees.map(|tree| tree.triangles as f64).collect();
        let expected = fit::exponent_of(|n| n * n.ln(), &places)?;
        let entries = self.trees.iter();
        let most = entries.map(|tree| tree.per_triangle(tree.references));
        let most = most.fold(0.0, f64::max);
        Some(holds(self.exponent()?.exponent, expected, most))
    }

    /// A row for each tree; the last one has the exponent.
    fn rows(&self) -> impl Iterator<Item = Vec<String>> {
        let last = self.trees.len().saturating_sub(1);
        self.trees.iter().enumerate().map(move |(index, tree)| {
            let exponent = if index == last { self.exponent() } else { None };
            vec![
                self.generator.name().to_owned(),
                self.splitter.to_owned(),
                self.straddlers.to_owned(),
                tree.triangles.to_string(),
                tree.depth.to_string(),
                format!("{:.2}", tree.relative_depth()),
                table::three_digits(tree.per_triangle(tree.nodes)),
                table::three_digits(tree.per_triangle(tree.fragments)),
                table::three_digits(tree.per_triangle(tree.references)),
                tree.largest_leaf.to_string(),
                fit::text(exponent),
            ]
        })
    }
}

/// Whether entries with a fitted exponent, and at most so many per triangle, grow no faster than is expected.
fn holds(exponent: f64, expected: f64, most: f64) -> bool {
    exponent <= expected + EXPONENT_TOLERANCE && most < LIMITED * MAX_GROWTH
}

pub(super) fn measure(effort: Effort, progress: &dyn Fn(&str)) -> Result<Claim> {
    let ordinary = effort.pick([1000, 3162, 10_000], [400, 1300, 3000], [100, 200, 400]);
    let needles = ordinary.map(|count| count / PART_OF_NEEDLES);
    let mut series = Vec::new();
    for generator in GENERATORS {
        let wanted = if generator == Generator::Needles {
            needles
        } else {
            ordinary
        };
        let sizes = generated::sizes(generator, &wanted)?;
        let meshes: Vec<TriangleMesh> = sizes
            .into_iter()
            .map(|size| generated::mesh(generator, size))
            .collect::<Result<_>>()?;
        for (splitter_name, splitter) in SPLITTERS {
            progress(&format!(
                "growth of BSP trees: {generator}, {splitter_name}"
            ));
            for (straddlers_name, straddlers) in STRADDLERS {
                let trees = meshes.iter();
                series.push(Series {
                    generator,
                    splitter: splitter_name,
                    straddlers: straddlers_name,
                    trees: trees
                        .map(|mesh| Tree::build(mesh, splitter, straddlers))
                        .collect::<Result<_>>()?,
                });
            }
        }
    }
    Ok(claim(&series))
}

fn claim(series: &[Series]) -> Claim {
    let header = [
        "scene",
        "splitter",
        "straddlers",
        "triangles",
        "depth",
        "depth / log2 n",
        "nodes per triangle",
        "fragments per triangle",
        "entries per triangle",
        "largest leaf",
        "exponent of entries",
    ];
    Claim {
        title: "Growth of BSP trees".to_owned(),
        claim: "A BSP tree of n polygons of an ordinary scene has O(n log n) fragments and a depth of the order of log n; there are scenes on \
                which every tree has of the order of n^2."
            .to_owned(),
        source: "Paterson and Yao, Efficient binary space partitions for hidden-surface removal and solid modeling, DCG 5, 1990; \
                 Fuchs, Kedem and Naylor, On visible surface generation by a priori tree structures, SIGGRAPH 1980"
            .to_owned(),
        verdict: judge(series),
        finding: finding(series),
        header: header.map(str::to_owned).to_vec(),
        rows: series.iter().flat_map(Series::rows).collect(),
    }
}

/// Confirmed if every ordinary scene holds to `n log n`, partly if some do. The needles are no ordinary scene: they do not count.
fn judge(series: &[Series]) -> Verdict {
    verdict::of(ordinary(series).filter_map(Series::holds))
}

fn ordinary(series: &[Series]) -> impl Iterator<Item = &Series> + Clone {
    series
        .iter()
        .filter(|series| series.generator != Generator::Needles)
}

fn finding(series: &[Series]) -> String {
    let exponents = |series: &Series| series.exponent().map(|fit| fit.exponent);
    let needles = series
        .iter()
        .filter(|series| series.generator == Generator::Needles);
    let depths = |series: &Series| series.trees.last().map(Tree::relative_depth);
    let best = ordinary(series).filter(|series| series.splitter == "surface area");
    let entries = |series: &Series| {
        let largest = series.trees.last();
        largest.map(|tree| tree.per_triangle(tree.references))
    };
    let held = ordinary(series).filter_map(Series::holds);
    let unsplit = needles
        .clone()
        .filter(|series| series.splitter == "surface area")
        .filter_map(|series| series.trees.last())
        .max_by_key(|tree| tree.largest_leaf);
    let (largest_leaf, triangles) =
        unsplit.map_or((0, 0), |tree| (tree.largest_leaf, tree.triangles));
    format!(
        "{} of {} series of trees over ordinary scenes grew no faster than n log n: their entries grew by powers of {} of n (surface area \
         heuristic: {}), and the largest trees were {} times as deep as log2 n. Over the needles the powers were {}, and the largest trees \
         had {} entries per triangle. With the surface area heuristic, the largest leaf over them has {} of {} triangles.",
        held.clone().filter(|holds| *holds).count(),
        held.count(),
        range_text(ordinary(series).filter_map(exponents), 2),
        range_text(best.filter_map(exponents), 2),
        range_text(ordinary(series).filter_map(depths), 1),
        range_text(needles.clone().filter_map(exponents), 2),
        range_text(needles.clone().filter_map(entries), 1),
        largest_leaf,
        triangles,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn growth_holds_below_n_log_n_unless_the_limit_made_it_so() {
        assert!(holds(1.1, 1.12, 3.0));
        assert!(holds(1.12 + EXPONENT_TOLERANCE, 1.12, 3.0));
        assert!(!holds(1.3, 1.12, 3.0), "too fast");
        assert!(!holds(1.0, 1.12, 0.9 * MAX_GROWTH), "limited");
    }

    #[test]
    fn ordinary_scenes_are_judged_and_the_needles_are_not() {
        let series = |generator, factor: usize| {
            // The number of entries per triangle grows by the factor from one size to the next.
            let tree = |(triangles, power): (usize, u32)| Tree {
                triangles,
                depth: 10,
                nodes: triangles,
                fragments: 0,
                references: triangles * factor.pow(power),
                largest_leaf: 1,
            };
            Series {
                generator,
                splitter: "first",
                straddlers: "split",
                trees: [(1000, 0), (10_000, 1), (100_000, 2)].map(tree).to_vec(),
            }
        };
        let flat = || series(Generator::Terrain, 1);
        let steep = || series(Generator::Gears, 3);
        let needles = || series(Generator::Needles, 10);
        assert_eq!(judge(&[flat(), needles()]), Verdict::Confirmed);
        assert_eq!(judge(&[flat(), steep()]), Verdict::PartlyConfirmed);
        assert_eq!(judge(&[steep(), needles()]), Verdict::NotConfirmed);
        let mut short = flat();
        short.trees.truncate(2);
        assert_eq!(short.holds(), None, "two points have no slope");
    }
}
