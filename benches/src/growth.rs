//! How build time, memory and the cost of rays grow with the number of triangles.

use std::hint::black_box;
use std::time::{Duration, Instant};

use anyhow::Result;
use tahko_bench::audit::Closest;
use tahko_geometry::oracle::Oracle;
use tahko_tracer::accelerator::{Accelerator, StructureKind};
use tahko_tracer::generate::Generator;
use tahko_tracer::geometry::simd::AvailableSimd;
use tahko_tracer::geometry::{Precision, QueryCounts, Ray, RayQuery, TriangleMesh};

use crate::report::{Contender, GrowthCurve, GrowthPoint, Sample};
use crate::structures::simd_name;
use crate::{check, errors, fit, generated};

const STRUCTURES: [StructureKind; 3] = [
    StructureKind::Bsp,
    StructureKind::KdTree,
    StructureKind::Bvh,
];
/// BSP trees are measured up to this number of triangles: no scene of the step of 100 000 has more.
const LARGEST_BSP: usize = 150_000;
/// Up to this number of triangles, the best of three builds counts; beyond it there is one.
const LARGEST_REPEATED: usize = 200_000;
/// Random rays of a point.
const RAYS: usize = 1 << 13;
/// Of these, the ones whose node visits and tests are counted.
const COUNTED: usize = 1 << 10;
/// Of these, the ones whose errors are counted, as far as [`ORACLE_TESTS`] go.
const AUDITED: usize = 1 << 8;
const MIN_AUDITED: usize = 16;
/// Triangle tests that the exact reference may spend on a point.
const ORACLE_TESTS: usize = 200_000_000;
/// Rounds in which the rays are traced.
const ROUNDS: usize = 5;
/// A round ends after this time, with the rays traced by then.
const TURN: Duration = Duration::from_millis(20);

/// A curve for each generator and structure: n from 1000 to `largest` in half decades, as near as the generator comes to it.
///
/// # Errors
/// If a structure does not answer exactly.
pub(crate) fn measure(
    largest: u32,
    generators: &[Generator],
    progress: &dyn Fn(&str),
) -> Result<Vec<GrowthCurve>> {
    let mut curves = Vec::new();
    for generator in generators {
        let mut points = [(); STRUCTURES.len()].map(|()| Vec::new());
        for size in generated::sizes(*generator, &steps(largest))? {
            let scene = Measured::new(generated::mesh(*generator, size)?);
            progress(&format!("{generator}: {} triangles", scene.mesh.len()));
            for (kind, points) in STRUCTURES.into_iter().zip(&mut points) {
                if kind != StructureKind::Bsp || scene.mesh.len() <= LARGEST_BSP {
                    points.push(scene.point(kind)?);
                }
            }
        }
        for (kind, points) in STRUCTURES.into_iter().zip(points) {
            curves.push(curve(*generator, kind, points));
        }
    }
    Ok(curves)
}

/// 1000, 3162, 10000, 31623 and so on.
fn steps(largest: u32) -> Vec<u32> {
    let half_decades = (6..20).map(|half_decade| 10f64.powf(f64::from(half_decade) / 2.0));
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "at most 10^9.5"
    )]
    let steps = half_decades.map(|count| count.round() as u32);
    steps.take_while(|count| *count <= largest).collect()
}

fn curve(generator: Generator, kind: StructureKind, points: Vec<GrowthPoint>) -> GrowthCurve {
    let exponent = |value: fn(&GrowthPoint) -> f64| {
        let points = points.iter();
        let points: Vec<_> = points
            .map(|point| (point.triangles as f64, value(point)))
            .collect();
        fit::power_law(&points)
    };
    GrowthCurve {
        generator: generator.name().to_owned(),
        contender: Contender {
            library: "tahko".to_owned(),
            structure: kind.name().to_owned(),
            preset: "balanced".to_owned(),
            precision: Precision::default().name().to_owned(),
            simd: simd_name(kind, AvailableSimd::best().level()).to_owned(),
            interface: "single".to_owned(),
        },
        build_exponent: exponent(|point| point.build_seconds),
        ray_exponent: exponent(|point| point.ray_nanoseconds),
        points,
    }
}

/// A scene with rays and their exact answers.
struct Measured {
    mesh: TriangleMesh,
    rays: Vec<Ray>,
    /// Those of the first rays.
    exact: Vec<Option<Closest>>,
}

impl Measured {
    fn new(mesh: TriangleMesh) -> Self {
        let rays = check::random_rays(&mesh.aabb(), RAYS);
        let audited = (ORACLE_TESTS / mesh.len().max(1)).clamp(MIN_AUDITED, AUDITED);
        let exact = errors::exact_answers(&Oracle::new(&mesh), &rays[..audited]);
        Self { mesh, rays, exact }
    }

    fn point(&self, kind: StructureKind) -> Result<GrowthPoint> {
        let built = self.build(kind)?;
        let statistics = built.statistics();
        let errors = check::errors(built.query(), &self.rays[..self.exact.len()], &self.exact);
        check::require_exact(&errors, kind.name())?;
        let mut counts = QueryCounts::default();
        for ray in &self.rays[..COUNTED] {
            built.query().closest_hit_counted(ray, &mut counts);
        }
        let nanoseconds = (0..ROUNDS).map(|_| nanoseconds_per_ray(built.query(), &self.rays));
        Ok(GrowthPoint {
            triangles: self.mesh.len(),
            build_seconds: built.build_time().as_secs_f64(),
            bytes_per_triangle: statistics.bytes_per_primitive(),
            nodes: statistics.nodes,
            depth: statistics.depth,
            references_per_triangle: statistics.references_per_primitive(),
            sah_cost: statistics.sah_cost,
            ray_nanoseconds: Sample::new(nanoseconds.collect()).median(),
            ray_node_visits: counts.node_visits as f64 / COUNTED as f64,
            ray_triangle_tests: counts.triangle_tests as f64 / COUNTED as f64,
            errors,
        })
    }

    /// The quickest of a few builds.
    fn build(&self, kind: StructureKind) -> Result<Accelerator> {
        let mut best = Accelerator::build(kind, Precision::default(), &self.mesh)?;
        if self.mesh.len() <= LARGEST_REPEATED {
            for _ in 0..2 {
                let again = Accelerator::build(kind, Precision::default(), &self.mesh)?;
                if again.build_time() < best.build_time() {
                    best = again;
                }
            }
        }
        Ok(best)
    }
}

/// Traces rays one by one on this thread until they or the time of a turn end.
fn nanoseconds_per_ray(query: &dyn RayQuery, rays: &[Ray]) -> f64 {
    let start = Instant::now();
    let mut traced = 0;
    for rays in rays.chunks(64) {
        for ray in rays {
            black_box(query.closest_hit(ray));
        }
        traced += rays.len();
        if start.elapsed() > TURN {
            break;
        }
    }
    start.elapsed().as_secs_f64() * 1e9 / traced as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_half_decades() {
        assert_eq!(steps(10_000), [1000, 3162, 10_000]);
        assert!(steps(999).is_empty());
    }

    #[test]
    fn a_curve_of_three_points_has_exponents_and_exact_answers() {
        let curves = measure(10_000, &[Generator::Terrain], &|_| {}).unwrap();
        assert_eq!(curves.len(), STRUCTURES.len());
        for curve in curves {
            assert_eq!(curve.points.len(), 3, "{}", curve.contender.structure);
            assert!(curve.build_exponent.is_some() && curve.ray_exponent.is_some());
            for point in curve.points {
                assert_eq!(check::mistakes(&point.errors), 0);
                assert!(point.errors.hits > 0 && point.ray_triangle_tests > 0.0);
            }
        }
    }
}
