//! Where a kd-tree splits, and what that is worth to a random ray.

use std::hint::black_box;

use anyhow::Result;
use tahko_geometry::oracle::Oracle;
use tahko_kdtree::{AxisChoice, KdTree, KdTreeOptions, SplitPolicy};
use tahko_tracer::generate::Generator;
use tahko_tracer::geometry::{QueryCounts, RayQuery, TreeStatistics, TriangleMesh};

use super::{Effort, header_with_errors, range_text, turns, verdict};
use crate::report::{Claim, Errors, Sample, Verdict};
use crate::{check, errors, generated, table};

/// Small objects in much empty space, a closed surface, and objects of one size evenly spread: where a cost model matters most, and least.
const GENERATORS: [Generator; 3] = [Generator::Tree, Generator::Terrain, Generator::Lattice];

const POLICIES: [(&str, SplitPolicy); 5] = [
    (
        "spatial middle, cycling",
        SplitPolicy::SpatialMiddle(AxisChoice::Cycling),
    ),
    (
        "spatial middle, longest",
        SplitPolicy::SpatialMiddle(AxisChoice::Longest),
    ),
    (
        "object median, cycling",
        SplitPolicy::ObjectMedian(AxisChoice::Cycling),
    ),
    (
        "object median, longest",
        SplitPolicy::ObjectMedian(AxisChoice::Longest),
    ),
    ("surface area", SplitPolicy::SurfaceArea),
];

/// The policy that the others are compared with: the last one.
const SURFACE_AREA: usize = POLICIES.len() - 1;

/// List entries per triangle that a tree may have: more than any policy needs here, so that all of them end where they want to.
const MAX_ENTRIES: f32 = 200.0;

/// A measured tree.
struct Row {
    generator: Generator,
    policy: usize,
    statistics: TreeStatistics,
    node_visits: f64,
    triangle_tests: f64,
    nanoseconds: Sample,
    /// Time of a round divided by that of the surface area heuristic in the same round.
    relative: Sample,
    errors: Errors,
}

impl Row {
    fn cells(&self) -> Vec<String> {
        let mut cells = vec![
            self.generator.name().to_owned(),
            POLICIES[self.policy].0.to_owned(),
            self.statistics.primitives.to_string(),
            self.statistics.depth.to_string(),
            table::three_digits(self.statistics.references_per_primitive()),
            table::three_digits(self.node_visits),
            table::three_digits(self.triangle_tests),
            table::three_digits(self.nanoseconds.median()),
            format!("{:.2}", self.relative.median()),
            format!("{:.2} to {:.2}", self.relative.low(), self.relative.high()),
        ];
        cells.extend(check::error_cells(&self.errors));
        cells
    }
}

pub(super) fn measure(effort: Effort, progress: &dyn Fn(&str)) -> Result<Claim> {
    let wanted = effort.pick(30_000, 5000, 300);
    let mut rows = Vec::new();
    for generator in GENERATORS {
        for size in generated::sizes(generator, &[wanted])? {
            let mesh = generated::mesh(generator, size)?;
            progress(&format!(
                "split policies of kd-trees: {generator}, {} triangles",
                mesh.len()
            ));
            rows.extend(of_scene(generator, &mesh, effort)?);
        }
    }
    Ok(claim(&rows))
}

fn claim(rows: &[Row]) -> Claim {
    let others = |median: bool| {
        let name = if median { "object" } else { "spatial" };
        let rows = rows
            .iter()
            .filter(move |row| POLICIES[row.policy].0.starts_with(name));
        rows.map(|row| row.relative.median())
    };
    let visits = |policy: usize| {
        let rows = rows.iter().filter(move |row| row.policy == policy);
        rows.map(|row| row.node_visits + row.triangle_tests)
    };
    let ratios: Vec<f64> = rows
        .iter()
        .filter(|row| row.policy != SURFACE_AREA)
        .map(|row| row.relative.median())
        .collect();
    Claim {
        title: "Where a kd-tree splits".to_owned(),
        claim: "Splitting by the surface area heuristic makes rays cheaper than splitting in the spatial middle or at the object median.".to_owned(),
        source: "MacDonald and Booth, Heuristics for ray tracing using space subdivision, The Visual Computer 6, 1990; Havran, Heuristic ray \
                 shooting algorithms, PhD thesis, Prague, 2000"
            .to_owned(),
        verdict: judge(&ratios),
        finding: format!(
            "A random ray took {} times as long in trees split in the spatial middle as with the surface area heuristic, and {} times \
             in trees split at the object median; it cost {} node visits and triangle tests with the heuristic.",
            range_text(others(false), 2),
            range_text(others(true), 2),
            range_text(visits(SURFACE_AREA), 0),
        ),
        header: header_with_errors(&[
            "scene",
            "splits",
            "triangles",
            "depth",
            "entries per triangle",
            "nodes per ray",
            "triangle tests per ray",
            "ns per ray",
            "relative to surface area",
            "range",
        ]),
        rows: rows.iter().map(Row::cells).collect(),
    }
}

/// The heuristic is better where another policy takes longer in the median of the rounds.
fn judge(ratios: &[f64]) -> Verdict {
    verdict::of(ratios.iter().map(|ratio| *ratio > 1.0))
}

fn of_scene(generator: Generator, mesh: &TriangleMesh, effort: Effort) -> Result<Vec<Row>> {
    let options = |(_, policy)| {
        KdTreeOptions::default()
            .with_split_policy(policy)
            .with_max_references_per_triangle(MAX_ENTRIES)
    };
    let trees: Vec<KdTree> = POLICIES
        .into_iter()
        .map(|policy| KdTree::build(mesh, &options(policy)))
        .collect::<Result<_, _>>()?;
    let rays = check::random_rays(&mesh.aabb(), effort.pick(1 << 13, 1 << 11, 1 << 6));
    let audited = effort.pick(1 << 10, 1 << 8, 1 << 5);
    let exact = errors::exact_answers(&Oracle::new(mesh), &rays[..audited]);
    let seconds = turns::seconds::<{ POLICIES.len() }>(effort.pick(9, 5, 1), |policy| {
        for ray in &rays {
            black_box(trees[policy].closest_hit(ray));
        }
    });
    let surface_area = &seconds[SURFACE_AREA];
    let trees = trees.iter().zip(&seconds).enumerate();
    trees
        .map(|(policy, (tree, seconds))| {
            let (name, _) = POLICIES[policy];
            let errors = check::errors(tree, &rays[..audited], &exact);
            check::require_exact(&errors, &format!("the kd-tree split by {name}"))?;
            let mut counts = QueryCounts::default();
            for ray in &rays {
                tree.closest_hit_counted(ray, &mut counts);
            }
            let per_ray = |total: f64| total / rays.len() as f64;
            let values = seconds.values().iter();
            let nanoseconds = values.map(|seconds| per_ray(seconds * 1e9)).collect();
            Ok(Row {
                generator,
                policy,
                statistics: tree.statistics(),
                node_visits: per_ray(counts.node_visits as f64),
                triangle_tests: per_ray(counts.triangle_tests as f64),
                nanoseconds: Sample::new(nanoseconds),
                relative: seconds.ratios(surface_area),
                errors,
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_heuristic_has_to_win_everywhere() {
        assert_eq!(judge(&[1.3, 1.01]), Verdict::Confirmed);
        assert_eq!(judge(&[1.3, 0.9]), Verdict::PartlyConfirmed);
        assert_eq!(judge(&[1.0, 0.9]), Verdict::NotConfirmed);
    }

    #[test]
    fn the_heuristic_is_the_last_policy() {
        assert_eq!(POLICIES[SURFACE_AREA].1, SplitPolicy::SurfaceArea);
        assert_eq!(POLICIES.map(|(_, policy)| policy), SplitPolicy::ALL);
    }
}
