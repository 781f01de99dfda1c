//! Traces scenes through all structures.

use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};
use tahko_geometry::oracle::Oracle;
use tahko_tracer::accelerator::{Accelerator, StructureKind};
use tahko_tracer::geometry::{Precision, QueryCounts, Ray, RayQuery};
use tahko_tracer::load::load_scene;

use crate::oracle::{self, Errors};
use crate::rays::RayClass;
use crate::table;

/// How much is measured.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Effort {
    /// Rays of each class.
    rays: usize,
    /// Rounds in which the structures take turns.
    rounds: usize,
    /// Time after which a structure stops in a round, with the rays it has traced by then.
    turn: Duration,
    /// Triangle tests that the exact reference may spend on a class of rays.
    oracle_tests: usize,
}

impl Effort {
    pub(crate) const FULL: Self = Self {
        rays: 1 << 16,
        rounds: 7,
        turn: Duration::from_millis(100),
        oracle_tests: 200_000_000,
    };
    pub(crate) const QUICK: Self = Self {
        rays: 1 << 10,
        rounds: 1,
        turn: Duration::from_millis(2),
        oracle_tests: 2_000_000,
    };
}

/// Rays of a class whose errors are counted at least, however large the scene.
const MIN_AUDITED: usize = 16;

/// The scenes that ship with the project.
pub(crate) fn shipped() -> Result<Vec<PathBuf>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    let entries = folder
        .read_dir()
        .with_context(|| format!("{}", folder.display()))?;
    let mut files = entries
        .map(|entry| Ok(entry?.path()))
        .collect::<Result<Vec<_>>>()
        .with_context(|| format!("{}", folder.display()))?;
    files.retain(|path| {
        path.extension()
            .is_some_and(|extension| extension == "ron" || extension == "glb")
    });
    files.sort();
    if files.is_empty() {
        bail!("{}: no scenes", folder.display());
    }
    Ok(files)
}

/// A structure at a precision.
pub(crate) struct Contender {
    pub(crate) kind: StructureKind,
    pub(crate) precision: Precision,
    pub(crate) accelerator: Accelerator,
}

/// Builds all structures over a scene, traces all classes of rays and prints two tables.
pub(crate) fn measure(file: &Path, effort: &Effort) -> Result<()> {
    let name = file.file_name().unwrap_or_default().display();
    eprintln!("measuring {name} ...");
    let (scene, _) = load_scene(file)?;
    let mut contenders = Vec::new();
    for precision in Precision::ALL {
        for kind in StructureKind::ALL {
            let accelerator = Accelerator::build(kind, precision, scene.mesh())?;
            contenders.push(Contender {
                kind,
                precision,
                accelerator,
            });
        }
    }
    println!("## {name}, {} triangles\n", scene.mesh().len());
    print_builds(&contenders);
    let oracle = Oracle::new(scene.mesh());
    let mut rows = Vec::new();
    for class in RayClass::ALL {
        let tracer = contenders[contenders.len() - 1].accelerator.query();
        let rays = class.rays(&scene, tracer, effort.rays);
        if rays.is_empty() {
            continue;
        }
        let affordable = (effort.oracle_tests / scene.mesh().len().max(1)).max(MIN_AUDITED);
        let audited = &rays[..rays.len().min(affordable)];
        let answers: Vec<_> = audited.iter().map(|ray| oracle.closest_hit(ray)).collect();
        let rates = rates(&contenders, class, &rays, effort);
        let errors: Vec<Errors> = contenders
            .iter()
            .map(|contender| oracle::compare(contender.accelerator.query(), audited, &answers))
            .collect();
        check_agreement(&contenders, &errors).with_context(|| format!("{name}, {class:?} rays"))?;
        for ((contender, rates), errors) in contenders.iter().zip(rates).zip(&errors) {
            rows.push(row(contender, class, &rays, rates, errors));
        }
    }
    let header = [
        "rays",
        "precision",
        "structure",
        "Mrays/s",
        "spread %",
        "nodes/ray",
        "bounds/ray",
        "triangles/ray",
        "audited",
        "false misses",
        "false hits",
        "wrong triangles",
        "t error ulp",
    ];
    table::print(&header, rows, 3);
    Ok(())
}

/// Structures give the same answers at the same precision, so their errors are the same.
pub(crate) fn check_agreement(contenders: &[Contender], errors: &[Errors]) -> Result<()> {
    for (contender, errors_here) in contenders.iter().zip(errors) {
        let same_precision = |other: &&Contender| other.precision == contender.precision;
        let first = contenders.iter().position(|other| same_precision(&other));
        if first.is_some_and(|first| errors[first] != *errors_here) {
            let (structure, precision) = (contender.kind.name(), contender.precision.name());
            bail!(
                "{structure} at {precision} does not answer as the first structure does: {errors_here:?}"
            );
        }
    }
    Ok(())
}

/// One row per structure: the precision changes nothing about the tree.
fn print_builds(contenders: &[Contender]) {
    let header = [
        "structure",
        "build ms",
        "nodes",
        "depth",
        "references/triangle",
        "bytes/triangle",
        "SAH cost",
    ];
    let rows = contenders
        .iter()
        .filter(|contender| contender.precision == Precision::default())
        .map(
            |Contender {
                 kind, accelerator, ..
             }| {
                let statistics = accelerator.statistics();
                vec![
                    kind.name().to_owned(),
                    table::three_digits(accelerator.build_time().as_secs_f64() * 1e3),
                    statistics.nodes.to_string(),
                    statistics.depth.to_string(),
                    table::three_digits(statistics.references_per_primitive()),
                    table::three_digits(statistics.bytes_per_primitive()),
                    table::three_digits(statistics.sah_cost),
                ]
            },
        )
        .collect();
    table::print(&header, rows, 1);
}

/// Million rays per second: for each structure one value a round, taking turns.
fn rates(
    contenders: &[Contender],
    class: RayClass,
    rays: &[Ray],
    effort: &Effort,
) -> Vec<Vec<f64>> {
    let mut rates = vec![Vec::new(); contenders.len()];
    for _ in 0..effort.rounds {
        for (contender, rates) in contenders.iter().zip(&mut rates) {
            rates.push(rate(
                contender.accelerator.query(),
                class,
                rays,
                effort.turn,
            ));
        }
    }
    rates
}

/// Traces the rays one by one on this thread until they or the time end.
fn rate(query: &dyn RayQuery, class: RayClass, rays: &[Ray], turn: Duration) -> f64 {
    let start = Instant::now();
    let mut traced = 0;
    for rays in rays.chunks(64) {
        for ray in rays {
            if class == RayClass::Shadow {
                black_box(query.any_hit(ray));
            } else {
                black_box(query.closest_hit(ray));
            }
        }
        traced += rays.len();
        if start.elapsed() > turn {
            break;
        }
    }
    traced as f64 / start.elapsed().as_secs_f64() / 1e6
}

fn row(
    contender: &Contender,
    class: RayClass,
    rays: &[Ray],
    mut rates: Vec<f64>,
    errors: &Errors,
) -> Vec<String> {
    rates.sort_by(f64::total_cmp);
    let median = rates[rates.len() / 2];
    let spread = 100.0 * (rates[rates.len() - 1] - rates[0]) / median;
    let counted = &rays[..rays.len().min(1 << 12)];
    let mut counts = QueryCounts::default();
    for ray in counted {
        if class == RayClass::Shadow {
            contender
                .accelerator
                .query()
                .any_hit_counted(ray, &mut counts);
        } else {
            contender
                .accelerator
                .query()
                .closest_hit_counted(ray, &mut counts);
        }
    }
    let per_ray = |count: u64| table::three_digits(count as f64 / counted.len() as f64);
    vec![
        class.name().to_owned(),
        contender.precision.name().to_owned(),
        contender.kind.name().to_owned(),
        table::three_digits(median),
        format!("{spread:.0}"),
        per_ray(counts.node_visits),
        per_ray(counts.bound_tests),
        per_ray(counts.triangle_tests),
        errors.rays.to_string(),
        errors.false_misses.to_string(),
        errors.false_hits.to_string(),
        errors.wrong_triangles.to_string(),
        format!("{:.2}", errors.largest_t_error),
    ]
}
