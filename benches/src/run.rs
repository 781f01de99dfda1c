//! One run: what the arguments ask for, into a report.

use std::path::PathBuf;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use anyhow::{Context, Result, ensure};
use tahko_tracer::accelerator::StructureKind;
use tahko_tracer::generate::Generator;
use tahko_tracer::geometry::Precision;
use tahko_tracer::geometry::simd::AvailableSimd;
use tahko_tracer::load::load_scene;
use tahko_tracer::scene::Scene;

use crate::arguments::{Arguments, Section, or_all};
use crate::contender::Recipe;
use crate::measure::{self, Course, Pools};
use crate::progress::Progress;
use crate::report::{
    Claim, GrowthCurve, ImageRow, RayClass, Report, SCHEMA, SceneReport, Settings,
};
use crate::structures::{Interface, Preset, Structure};
use crate::{claims, growth, images, machine, scenes, timing};

/// How much is measured.
#[derive(Clone, Debug)]
struct Effort {
    scene: measure::Effort,
    images: images::Effort,
    /// The largest number of triangles, and the generators.
    growth: (u32, &'static [Generator]),
    claims: claims::Effort,
}

/// The generators of a short look at growth: clustered spheres, an even surface, and triangles for which boxes fail.
const FEW_GENERATORS: [Generator; 3] = [
    Generator::Sphereflake,
    Generator::Terrain,
    Generator::Needles,
];

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
                images: images::Effort::SMOKE,
                growth: (1_000, &FEW_GENERATORS),
                claims: claims::Effort::Smoke,
            }
        } else if arguments.quick {
            Self {
                scene: scene(1 << 14, 5, 15, 1 << 10, 0.2),
                images: images::Effort::QUICK,
                growth: (31_623, &FEW_GENERATORS),
                claims: claims::Effort::Quick,
            }
        } else {
            Self {
                scene: scene(1 << 16, 7, 50, 1 << 12, 1.0),
                images: images::Effort::FULL,
                growth: (1_000_000, &Generator::ALL),
                claims: claims::Effort::Full,
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
    let run = Run {
        arguments,
        effort: Effort::of(arguments),
        pools: Pools::new()?,
        progress: Progress::new(),
    };
    let scenes = run.scenes()?;
    let (rays, rounds) = (run.effort.scene.rays, run.effort.scene.timing.rounds);
    Ok(Report {
        schema: SCHEMA,
        command: command(),
        started,
        seconds: start.elapsed().as_secs_f64(),
        machine: machine::describe(run.pools.threads()),
        settings: Settings {
            quick: arguments.quick || arguments.smoke,
            rays,
            rounds,
        },
        scenes,
        growth: run.growth()?,
        claims: run.claims()?,
    })
}

/// What all sections of a run share.
struct Run<'a> {
    arguments: &'a Arguments,
    effort: Effort,
    pools: Pools,
    progress: Progress,
}

impl Run<'_> {
    fn wants(&self, section: Section) -> bool {
        self.arguments.sections.contains(&section)
    }

    /// The sections speed and images.
    fn scenes(&self) -> Result<Vec<SceneReport>> {
        let wants_speed = self.wants(Section::Speed);
        if !wants_speed && !self.wants(Section::Images) {
            return Ok(Vec::new());
        }
        let files = files(self.arguments)?;
        let recipes = if wants_speed {
            recipes(self.arguments)?
        } else {
            Vec::new()
        };
        let classes = or_all(&self.arguments.classes, &RayClass::ALL);
        let advance = || self.progress.advance();
        let course = Course {
            recipes: &recipes,
            classes: &classes,
            effort: &self.effort.scene,
            pools: &self.pools,
            advance: &advance,
        };
        // Pictures take about as long as so many turns.
        let of_images = if self.wants(Section::Images) {
            IMAGE_UNITS
        } else {
            0
        };
        let of_scene = course.turns() + of_images;
        self.progress.begin(of_scene * files.len() as u64);
        let mut reports = Vec::new();
        for (index, file) in files.iter().enumerate() {
            let name = scenes::name(file);
            let scene = match load_scene(file) {
                Ok((scene, _)) => scene,
                // Of a whole folder some files may be unfit; one that was named is a mistake.
                Err(error) if !self.arguments.scenes.contains(file) => {
                    self.progress.say_that(&format!("left out: {error}"));
                    continue;
                }
                Err(error) => return Err(error.into()),
            };
            let (triangles, count) = (scene.mesh().len(), files.len());
            self.progress.say(&format!(
                "{name}, {triangles} triangles ({} of {count})",
                index + 1
            ));
            let mut report = course
                .measure(&name, &scene)
                .with_context(|| name.clone())?;
            if self.wants(Section::Images) {
                report.images = self.images(&name, &scene)?;
            }
            self.progress.set(of_scene * (index as u64 + 1));
            reports.push(report);
        }
        self.progress.end();
        Ok(reports)
    }

    /// The section growth.
    fn growth(&self) -> Result<Vec<GrowthCurve>> {
        if !self.wants(Section::Growth) {
            return Ok(Vec::new());
        }
        let (largest, generators) = self.effort.growth;
        let largest = self.arguments.largest.unwrap_or(largest);
        let progress = |what: &str| self.progress.say(what);
        growth::measure(largest, generators, &progress)
    }

    /// The section claims.
    fn claims(&self) -> Result<Vec<Claim>> {
        if !self.wants(Section::Claims) {
            return Ok(Vec::new());
        }
        claims::measure(self.effort.claims, &|what| self.progress.say(what))
    }

    /// The section images of a scene.
    fn images(&self, name: &str, scene: &Scene) -> Result<Vec<ImageRow>> {
        let mut built = Vec::new();
        for kind in or_all(&self.arguments.structures, &StructureKind::ALL) {
            let interface = [Interface::Single];
            let structure = Structure::new(kind, Preset::Balanced, &Precision::ALL, &interface);
            let structure = structure.filter(|one| scene.mesh().len() <= one.max_triangles());
            if let Some(structure) = structure {
                let threads = self.pools.threads();
                let tree = self
                    .pools
                    .install(|| structure.build(scene.mesh(), threads))?;
                built.push((kind, tree));
            }
        }
        let candidates = built.iter().flat_map(|(kind, tree)| {
            let queries = tree
                .contenders
                .iter()
                .filter_map(|contender| contender.query());
            queries.map(|query| images::Candidate {
                kind: *kind,
                precision: query.precision(),
                query,
            })
        });
        let candidates: Vec<_> = candidates.collect();
        let folder = self.arguments.out.join("pictures");
        let measure =
            || images::measure(name, scene, &candidates, &self.effort.images, Some(&folder));
        self.pools.install(measure)
    }
}

/// Turns that the pictures of a scene take about as long as.
const IMAGE_UNITS: u64 = 200;

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
    let levels = or_all(&arguments.simd, &[AvailableSimd::best().level()]);
    for level in &levels {
        ensure!(
            level.is_available(),
            "this processor has no {}",
            level.name()
        );
    }
    let mut recipes: Vec<Box<dyn Recipe>> = Vec::new();
    for kind in or_all(&arguments.structures, &StructureKind::ALL) {
        for preset in &arguments.presets {
            for format in &arguments.node_formats {
                let structure = Structure::new(kind, *preset, &precisions, &arguments.interfaces);
                let structure = structure.and_then(|structure| structure.with_node_format(*format));
                let is_named = !arguments.structures.is_empty();
                let structure =
                    structure.map(|structure| structure.named(is_named).with_levels(&levels));
                recipes.extend(structure.map(|structure| Box::new(structure) as Box<dyn Recipe>));
            }
        }
    }
    ensure!(
        !recipes.is_empty(),
        "none of these structures has such a preset"
    );
    #[cfg(feature = "peers")]
    if arguments.peers {
        recipes.extend(crate::peers::recipes(&arguments.libraries)?);
    }
    #[cfg(not(feature = "peers"))]
    ensure!(
        !arguments.peers,
        "this program was built without the feature `peers`: use `cargo xtask bench --peers`"
    );
    Ok(recipes)
}
