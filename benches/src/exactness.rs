//! What exactness costs and what it is worth: time relative to the fast precision, errors, and the rungs that decide.

use std::hint::black_box;
use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::{Context, Result};
use tahko_geometry::oracle::Oracle;
use tahko_tracer::accelerator::{Accelerator, StructureKind};
use tahko_tracer::geometry::{Precision, QueryCounts, Ray, RayQuery};
use tahko_tracer::load::load_scene;
use tahko_tracer::scene::Scene;

use crate::oracle::{self, Errors};
use crate::rays::RayClass;
use crate::scenes::{Contender, check_agreement};
use crate::table;

/// How much is measured.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Effort {
    /// Rays of each class.
    rays: usize,
    /// Rounds in which the precisions take turns on the same rays.
    rounds: usize,
    /// About how long a turn takes.
    turn: Duration,
    /// Rays of each class whose errors are counted.
    audited: usize,
}

impl Effort {
    pub(crate) const FULL: Self = Self {
        rays: 1 << 14,
        rounds: 15,
        turn: Duration::from_millis(40),
        audited: 1 << 12,
    };
    pub(crate) const QUICK: Self = Self {
        rays: 1 << 8,
        rounds: 1,
        turn: Duration::from_millis(1),
        audited: 1 << 6,
    };
}

/// Structures whose speed matters: brute force would take all the time.
const STRUCTURES: [StructureKind; 3] = [
    StructureKind::Bsp,
    StructureKind::KdTree,
    StructureKind::Bvh,
];

/// A ray, and whether any hit will do.
#[derive(Clone, Copy, Debug)]
struct Question {
    ray: Ray,
    any: bool,
}

/// Prints three tables over all scenes.
pub(crate) fn print(files: &[impl AsRef<Path>], effort: &Effort) -> Result<()> {
    let mut tables = Tables::default();
    for file in files {
        measure(file.as_ref(), effort, &mut tables)?;
    }
    tables.print();
    Ok(())
}

#[derive(Debug, Default)]
struct Tables {
    times: Vec<Vec<String>>,
    errors: Vec<Vec<String>>,
    rungs: Vec<Vec<String>>,
}

impl Tables {
    fn print(self) {
        println!("Time per ray relative to fast, the median of interleaved rounds:\n");
        let header = [
            "scene",
            "structure",
            "rays",
            "fast us/ray",
            "watertight",
            "exact",
            "exact / watertight",
        ];
        table::print(&header, self.times, 3);
        println!("Errors per million rays, the same for every structure:\n");
        let header = [
            "scene",
            "rays",
            "precision",
            "audited",
            "false misses",
            "false hits",
            "wrong triangles",
            "t error ulp",
        ];
        table::print(&header, self.errors, 3);
        println!(
            "Triangle tests of the exact precision with the BVH, by the rung that settled them:\n"
        );
        let header = [
            "scene",
            "rays",
            "tests/ray",
            "f32 %",
            "f64 %",
            "expansions %",
        ];
        table::print(&header, self.rungs, 2);
    }
}

fn measure(file: &Path, effort: &Effort, tables: &mut Tables) -> Result<()> {
    let (scene, _) = load_scene(file)?;
    let name = file.file_stem().unwrap_or_default().display().to_string();
    eprintln!("measuring {name}, {} triangles ...", scene.mesh().len());
    let mut contenders = Vec::new();
    for kind in STRUCTURES {
        for precision in Precision::ALL {
            contenders.push(Contender {
                kind,
                precision,
                accelerator: Accelerator::build(kind, precision, scene.mesh())?,
            });
        }
    }
    let oracle = Oracle::new(scene.mesh());
    for (rays_name, classes) in [
        (
            "ordinary",
            &[RayClass::Primary, RayClass::Shadow, RayClass::Random][..],
        ),
        ("aimed", &[RayClass::Aimed][..]),
    ] {
        let tracer = contenders[0].accelerator.query();
        let (questions, audited) = questions(&scene, tracer, classes, effort);
        for of_kind in contenders.chunks(Precision::ALL.len()) {
            let mut row = vec![
                name.clone(),
                of_kind[0].kind.name().to_owned(),
                rays_name.to_owned(),
            ];
            row.extend(relative_times(of_kind, &questions, effort));
            tables.times.push(row);
        }
        let answers: Vec<_> = audited.iter().map(|ray| oracle.closest_hit(ray)).collect();
        let errors: Vec<Errors> = contenders
            .iter()
            .map(|contender| oracle::compare(contender.accelerator.query(), &audited, &answers))
            .collect();
        check_agreement(&contenders, &errors)
            .with_context(|| format!("{name}, {rays_name} rays"))?;
        for (contender, errors) in contenders.iter().zip(&errors).take(Precision::ALL.len()) {
            tables
                .errors
                .push(error_row(&name, rays_name, contender.precision, errors));
        }
        let exact = contenders
            .iter()
            .rfind(|contender| contender.precision == Precision::Exact);
        if let Some(exact) = exact {
            tables.rungs.push(rung_row(
                &name,
                rays_name,
                exact.accelerator.query(),
                &questions,
            ));
        }
    }
    Ok(())
}

/// The rays of some classes in turn, and the first of each to be audited.
fn questions(
    scene: &Scene,
    tracer: &dyn RayQuery,
    classes: &[RayClass],
    effort: &Effort,
) -> (Vec<Question>, Vec<Ray>) {
    let mut questions = Vec::new();
    let mut audited = Vec::new();
    for class in classes {
        let rays = class.rays(scene, tracer, effort.rays);
        audited.extend_from_slice(&rays[..rays.len().min(effort.audited)]);
        let any = *class == RayClass::Shadow;
        questions.extend(rays.into_iter().map(|ray| Question { ray, any }));
    }
    (questions, audited)
}

/// The time per ray of the first contender in microseconds, those of the others relative to it, and that of the last relative to
/// the one before.
fn relative_times(
    contenders: &[Contender],
    questions: &[Question],
    effort: &Effort,
) -> Vec<String> {
    if questions.is_empty() {
        return vec!["-".to_owned(); contenders.len() + 1];
    }
    // As many rays as fit a turn, taken evenly from all classes.
    let all = time(
        contenders[0].accelerator.query(),
        questions.iter().step_by(7),
    );
    let step = (all * 7.0 / effort.turn.as_secs_f64()).ceil().max(1.0);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a small number from 1"
    )]
    let step = step as usize;
    let rays = questions.len().div_ceil(step);
    let mut rounds = Vec::new();
    for round in 0..effort.rounds {
        let mut times = vec![0.0; contenders.len()];
        // Another one begins in each round.
        for turn in 0..contenders.len() {
            let index = (turn + round) % contenders.len();
            let query = contenders[index].accelerator.query();
            times[index] = time(query, questions.iter().step_by(step));
        }
        rounds.push(times);
    }
    let last = contenders.len() - 1;
    let median = |of: &dyn Fn(&[f64]) -> f64| {
        let mut values: Vec<f64> = rounds.iter().map(|times| of(times)).collect();
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let mut cells = vec![table::three_digits(median(&|times| {
        times[0] / rays as f64 * 1e6
    }))];
    cells
        .extend((1..=last).map(|index| format!("{:.2}", median(&|times| times[index] / times[0]))));
    cells.push(format!(
        "{:.2}",
        median(&|times| times[last] / times[last - 1])
    ));
    cells
}

/// Seconds for some rays on this thread.
fn time<'a>(query: &dyn RayQuery, questions: impl Iterator<Item = &'a Question>) -> f64 {
    let start = Instant::now();
    for Question { ray, any } in questions {
        if *any {
            black_box(query.any_hit(ray));
        } else {
            black_box(query.closest_hit(ray));
        }
    }
    start.elapsed().as_secs_f64()
}

fn error_row(scene: &str, rays: &str, precision: Precision, errors: &Errors) -> Vec<String> {
    let per_million =
        |count: usize| format!("{:.0}", 1e6 * count as f64 / errors.rays.max(1) as f64);
    vec![
        scene.to_owned(),
        rays.to_owned(),
        precision.name().to_owned(),
        errors.rays.to_string(),
        per_million(errors.false_misses),
        per_million(errors.false_hits),
        per_million(errors.wrong_triangles),
        format!("{:.2}", errors.largest_t_error),
    ]
}

fn rung_row(scene: &str, rays: &str, query: &dyn RayQuery, questions: &[Question]) -> Vec<String> {
    let mut counts = QueryCounts::default();
    for Question { ray, any } in questions {
        if *any {
            query.any_hit_counted(ray, &mut counts);
        } else {
            query.closest_hit_counted(ray, &mut counts);
        }
    }
    let tests = counts.triangle_tests as f64;
    let share = |count: u64| format!("{:.4}", 100.0 * count as f64 / tests.max(1.0));
    vec![
        scene.to_owned(),
        rays.to_owned(),
        table::three_digits(tests / questions.len().max(1) as f64),
        share(counts.rungs.f32),
        share(counts.rungs.f64),
        share(counts.rungs.exact),
    ]
}
