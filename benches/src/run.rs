//! One run: what the arguments ask for, into a report.

use std::path::PathBuf;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use anyhow::{Context, Result, ensure};
use tahko_tracer::accelerator::StructureKind;
use tahko_tracer::geometry::Precision;
use tahko_tracer::load::load_scene;

use crate::arguments::{Arguments, Section, or_all};
use crate::contender::Recipe;
use crate::measure::{self, Course, Pools};
use crate::progress::Progress;
use crate::report::{RayClass, Report, SCHEMA, SceneReport, Settings};
use crate::structures::Structure;
use crate::{machine, scenes, timing};

/// How much is measured.
#[derive(Clone, Debug)]
struct Effort {
    scene: measure::Effort,
}

impl Effort {
    fn of(arguments: &Arguments) -> Self {
        let scene = |rays, rounds, turn, audited, build_seconds| measure::Effort {
            rays: arguments.rays.map_or(rays, |rays| rays as usize),
            timing: timing::Effort {
                rounds,
                turn: Duration::from_millis(turn),
            },
            audited,
            build_seconds,
        };
        if arguments.smoke {
            Self {
                scene: scene(1 << 8, 1, 1, 1 << 6, 0.0),
            }
        } else if arguments.quick {
            Self {
                scene: scene(1 << 14, 5, 15, 1 << 10, 0.2),
            }
        } else {
            Self {
                scene: scene(1 << 16, 7, 50, 1 << 12, 1.0),
            }
        }
    }
}

/// Measures what the arguments ask for.
pub(crate) fn run(arguments: &Arguments) -> Result<Report> {
    let start = Instant::now();
    let started = SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .map_or(0, |time| time.as_secs());
    let effort = Effort::of(arguments);
    let pools = Pools::new()?;
    let files = files(arguments)?;
    let recipes = recipes(arguments)?;
    let scenes = scenes_of(arguments, &effort, &files, &recipes, &pools)?;
    Ok(Report {
        schema: SCHEMA,
        command: command(),
        started,
        seconds: start.elapsed().as_secs_f64(),
        machine: machine::describe(pools.threads()),
        settings: Settings {
            quick: arguments.quick || arguments.smoke,
            rays: effort.scene.rays,
            rounds: effort.scene.timing.rounds,
        },
        scenes,
        growth: Vec::new(),
        claims: Vec::new(),
    })
}

/// The program's arguments as they were given.
fn command() -> String {
    let words = std::env::args().skip(1);
    std::iter::once("bench".to_owned())
        .chain(words)
        .collect::<Vec<_>>()
        .join(" ")
}

fn files(arguments: &Arguments) -> Result<Vec<PathBuf>> {
    if !arguments.scenes.is_empty() {
        scenes::expand(&arguments.scenes)
    } else if arguments.quick || arguments.smoke {
        Ok(scenes::quick())
    } else {
        scenes::shipped()
    }
}

/// Everything that is built over each scene.
fn recipes(arguments: &Arguments) -> Result<Vec<Box<dyn Recipe>>> {
    let precisions = or_all(&arguments.precision, &Precision::ALL);
    let mut recipes: Vec<Box<dyn Recipe>> = Vec::new();
    for kind in or_all(&arguments.structures, &StructureKind::ALL) {
        for preset in &arguments.presets {
            let structure = Structure::new(kind, *preset, &precisions, &arguments.interfaces);
            let is_named = !arguments.structures.is_empty();
            let structure = structure.map(|structure| structure.named(is_named));
            recipes.extend(structure.map(|structure| Box::new(structure) as Box<dyn Recipe>));
        }
    }
    ensure!(
        !recipes.is_empty(),
        "none of these structures has such a preset"
    );
    #[cfg(feature = "peers")]
    if arguments.peers {
        recipes.extend(crate::peers::recipes()?);
    }
    #[cfg(not(feature = "peers"))]
    ensure!(
        !arguments.peers,
        "this program was built without the feature `peers`: use `cargo xtask bench --peers`"
    );
    Ok(recipes)
}

fn scenes_of(
    arguments: &Arguments,
    effort: &Effort,
    files: &[PathBuf],
    recipes: &[Box<dyn Recipe>],
    pools: &Pools,
) -> Result<Vec<SceneReport>> {
    let wants = |section| arguments.sections.contains(&section);
    if !wants(Section::Speed) && !wants(Section::Images) {
        return Ok(Vec::new());
    }
    let classes = or_all(&arguments.classes, &RayClass::ALL);
    let progress = Progress::new();
    let advance = || progress.advance();
    let course = Course {
        recipes,
        classes: &classes,
        effort: &effort.scene,
        pools,
        advance: &advance,
    };
    progress.begin(course.turns() * files.len() as u64);
    let mut reports = Vec::new();
    for (index, file) in files.iter().enumerate() {
        let (scene, _) = load_scene(file)?;
        let name = scenes::name(file);
        progress.say(&format!(
            "{name}, {} triangles ({} of {})",
            scene.mesh().len(),
            index + 1,
            files.len()
        ));
        let report = course
            .measure(&name, &scene)
            .with_context(|| name.clone())?;
        progress.set(course.turns() * (index as u64 + 1));
        reports.push(report);
    }
    progress.end();
    Ok(reports)
}
