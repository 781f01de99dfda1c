//! How the tests that a ray costs grow with the number of triangles, for every structure.

use anyhow::Result;
use tahko_bench::audit::Closest;
use tahko_geometry::oracle::Oracle;
use tahko_tracer::accelerator::{Accelerator, StructureKind};
use tahko_tracer::generate::Generator;
use tahko_tracer::geometry::{Precision, QueryCounts, Ray, TriangleMesh};

use super::{Effort, header_with_errors, range_text, verdict};
use crate::report::{Claim, Errors, Fit, Verdict};
use crate::{check, errors, fit, generated, table};

/// Surfaces that get finer, and a space that fills up with objects of one size, which gets more opaque for a ray.
const GENERATORS: [Generator; 3] = [Generator::Terrain, Generator::Gears, Generator::Lattice];

/// A fitted exponent may exceed that of `log n` in the same range by so much. A tenth is a factor of 1.6 over two decades.
const EXPONENT_TOLERANCE: f64 = 0.1;

/// A structure on the growing scenes of a generator.
struct Series {
    generator: Generator,
    kind: StructureKind,
    points: Vec<Point>,
}

/// Means per ray.
#[derive(Clone, Copy)]
struct Point {
    triangles: usize,
    node_visits: f64,
    bound_tests: f64,
    triangle_tests: f64,
    errors: Errors,
}

impl Point {
    fn tests(&self) -> f64 {
        self.bound_tests + self.triangle_tests
    }
}

impl Series {
    fn exponent(&self) -> Option<Fit> {
        let points = self.points.iter();
        let points: Vec<_> = points
            .map(|point| (point.triangles as f64, point.tests()))
            .collect();
        fit::power_law(&points)
    }

    /// What `log n` looks like at the same places.
    fn expected(&self) -> Option<f64> {
        let places: Vec<f64> = self
            .points
            .iter()
            .map(|point| point.triangles as f64)
            .collect();
        fit::exponent_of(f64::ln, &places)
    }

    fn holds(&self) -> bool {
        holds(self.exponent().map(|fit| fit.exponent), self.expected())
    }

    fn is_tree(&self) -> bool {
        self.kind != StructureKind::Brute
    }

    /// A row for each size; the last one has the exponent.
    fn rows(&self) -> impl Iterator<Item = Vec<String>> {
        let last = self.points.len().saturating_sub(1);
        self.points.iter().enumerate().map(move |(index, point)| {
            let exponent = if index == last { self.exponent() } else { None };
            let mut cells = vec![
                self.generator.name().to_owned(),
                self.kind.name().to_owned(),
                point.triangles.to_string(),
                table::three_digits(point.node_visits),
                table::three_digits(point.bound_tests),
                table::three_digits(point.triangle_tests),
                table::three_digits(point.tests()),
                fit::text(exponent),
            ];
            cells.extend(check::error_cells(&point.errors));
            cells
        })
    }
}

fn holds(exponent: Option<f64>, expected: Option<f64>) -> bool {
    exponent
        .zip(expected)
        .is_some_and(|(exponent, expected)| exponent <= expected + EXPONENT_TOLERANCE)
}

pub(super) fn measure(effort: Effort, progress: &dyn Fn(&str)) -> Result<Claim> {
    let wanted: &[u32] = effort.pick(
        &[1000, 3162, 10_000, 31_623, 100_000],
        &[1000, 3162, 10_000],
        &[100, 200, 400],
    );
    let mut series = Vec::new();
    for generator in GENERATORS {
        let mut of_generator = StructureKind::ALL.map(|kind| Series {
            generator,
            kind,
            points: Vec::new(),
        });
        for size in generated::sizes(generator, wanted)? {
            let mesh = generated::mesh(generator, size)?;
            progress(&format!(
                "tests per ray: {generator}, {} triangles",
                mesh.len()
            ));
            let scene = Rays::new(&mesh, effort);
            for series in &mut of_generator {
                series.points.push(scene.point(series.kind, &mesh)?);
            }
        }
        series.extend(of_generator);
    }
    Ok(claim(&series))
}

fn claim(series: &[Series]) -> Claim {
    Claim {
        title: "Tests per ray".to_owned(),
        claim: "A structure reduces the tests that a ray costs from n to the order of log n.".to_owned(),
        source: "Common knowledge about trees; for evenly filled scenes, Szirmay-Kalos, Havran, Balazs and Szecsi, On the efficiency of \
                 ray-shooting acceleration schemes, SCCG 2002, expect even a constant"
            .to_owned(),
        verdict: judge(series),
        finding: finding(series),
        header: header_with_errors(&[
            "scene",
            "structure",
            "triangles",
            "nodes per ray",
            "bound tests per ray",
            "triangle tests per ray",
            "tests per ray",
            "exponent of tests",
        ]),
        rows: series.iter().flat_map(Series::rows).collect(),
    }
}

/// The trees are judged; brute force is what they are compared with.
fn judge(series: &[Series]) -> Verdict {
    let trees = series.iter().filter(|series| series.is_tree());
    verdict::of(trees.map(Series::holds))
}

fn finding(series: &[Series]) -> String {
    let trees = series.iter().filter(|series| series.is_tree());
    let exponent = |series: &Series| series.exponent().map(|fit| fit.exponent);
    let savings = |series: &Series| {
        let largest = series.points.last();
        largest.map(|point| point.triangles as f64 / point.tests())
    };
    let largest = |series: &Series| series.points.last().map(|point| point.triangles as f64);
    format!(
        "{} of {} series of trees grew as log n does, whose power would be {}: their tests per ray grew by powers of {} of n, and those \
         of brute force by {}. In the largest scenes ({} triangles) a tree saved all but one of {} tests.",
        trees.clone().filter(|series| series.holds()).count(),
        trees.clone().count(),
        range_text(trees.clone().filter_map(Series::expected), 2),
        range_text(trees.clone().filter_map(exponent), 2),
        range_text(
            series
                .iter()
                .filter(|series| !series.is_tree())
                .filter_map(exponent),
            2
        ),
        range_text(trees.clone().filter_map(largest), 0),
        range_text(trees.filter_map(savings), 0),
    )
}

/// Rays over a mesh with the exact answers of the first of them.
struct Rays {
    rays: Vec<Ray>,
    exact: Vec<Option<Closest>>,
}

/// Rays that brute force answers: it needs no more, as each costs the same.
const BRUTE_FORCE_RAYS: usize = 32;

impl Rays {
    fn new(mesh: &TriangleMesh, effort: Effort) -> Self {
        let rays = check::random_rays(&mesh.aabb(), effort.pick(1 << 12, 1 << 10, 1 << 6));
        let audited = effort.pick(1 << 9, 1 << 7, 1 << 5);
        let exact = errors::exact_answers(&Oracle::new(mesh), &rays[..audited]);
        Self { rays, exact }
    }

    fn point(&self, kind: StructureKind, mesh: &TriangleMesh) -> Result<Point> {
        let built = Accelerator::build(kind, Precision::Exact, mesh)?;
        let count = |available: usize| match kind {
            StructureKind::Brute => available.min(BRUTE_FORCE_RAYS),
            _ => available,
        };
        let audited = count(self.exact.len());
        let errors = check::errors(built.query(), &self.rays[..audited], &self.exact[..audited]);
        check::require_exact(&errors, kind.name())?;
        let rays = &self.rays[..count(self.rays.len())];
        let mut counts = QueryCounts::default();
        for ray in rays {
            built.query().closest_hit_counted(ray, &mut counts);
        }
        let per_ray = |count: u64| count as f64 / rays.len() as f64;
        Ok(Point {
            triangles: mesh.len(),
            node_visits: per_ray(counts.node_visits),
            bound_tests: per_ray(counts.bound_tests),
            triangle_tests: per_ray(counts.triangle_tests),
            errors,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(kind: StructureKind, tests: impl Fn(f64) -> f64) -> Series {
        let point = |triangles: usize| Point {
            triangles,
            node_visits: 0.0,
            bound_tests: 0.0,
            triangle_tests: tests(triangles as f64),
            errors: Errors::default(),
        };
        Series {
            generator: Generator::Terrain,
            kind,
            points: [1000, 10_000, 100_000].map(point).to_vec(),
        }
    }

    #[test]
    fn trees_are_judged_by_the_growth_of_a_logarithm() {
        let brute = || series(StructureKind::Brute, |n| n);
        let logarithmic = || series(StructureKind::Bvh, f64::ln);
        let root = || series(StructureKind::KdTree, f64::sqrt);
        assert_eq!(judge(&[brute(), logarithmic()]), Verdict::Confirmed);
        assert_eq!(judge(&[logarithmic(), root()]), Verdict::PartlyConfirmed);
        assert_eq!(judge(&[brute(), root()]), Verdict::NotConfirmed);
        let finding = finding(&[brute(), logarithmic()]);
        assert!(finding.starts_with("1 of 1 series"), "{finding}");
    }
}
