//! `tahko render`.

use std::time::{Duration, Instant};

use anyhow::Result;
use serde::Serialize;
use tahko_tracer::accelerator::Accelerator;
use tahko_tracer::film::Film;
use tahko_tracer::load::load_scene;
use tahko_tracer::render::{Integrator, RenderControl, RenderOptions, RenderStatistics, render};
use tahko_tracer::scene::Scene;

use crate::args::RenderArguments;
use crate::structure::{self, StructureReport};
use crate::terminal::Terminal;
use crate::{interrupt, output};

pub(crate) fn run(arguments: &RenderArguments, terminal: &Terminal) -> Result<()> {
    check_outputs(arguments)?;
    let progress = terminal.progress();
    progress.phase(&format!("reading {}", arguments.scene.display()));
    let (scene, report) = load_scene(&arguments.scene)?;
    terminal.notes(&report);
    let (accel, precision) = (arguments.accel, arguments.precision);
    let accelerator = structure::build(accel, precision, scene.mesh(), &arguments.scene, progress)?;
    let (film, traced) = trace(arguments, terminal, &scene, &accelerator)?;

    progress.phase(&format!("writing {}", arguments.output.display()));
    let structure = StructureReport::new(accel, &accelerator);
    interrupt::shielded(|| film.save(&arguments.output, scene.exposure()))?;
    if let Some(path) = &arguments.stats {
        let report = RenderReport::new(arguments, &structure, &traced);
        output::write_file(path, |writer| {
            let text = serde_json::to_string_pretty(&report)?;
            Ok(writeln!(writer, "{text}")?)
        })?;
    }
    progress.clear();
    terminal.summary(&format!(
        "{}: {} triangles, {} built in {:.3} s, {} rays traced in {:.3} s",
        arguments.output.display(),
        structure.triangles,
        structure.name,
        structure.build_seconds,
        traced.statistics.rays(),
        traced.time.as_secs_f64(),
    ));
    Ok(())
}

fn check_outputs(arguments: &RenderArguments) -> Result<()> {
    let (scene, picture) = (&arguments.scene, &arguments.output);
    output::check(picture, &[scene])?;
    if let Some(stats) = &arguments.stats {
        output::check(stats, &[scene, picture])?;
    }
    Ok(())
}

/// How a rendering went.
struct Traced {
    statistics: RenderStatistics,
    time: Duration,
}

fn trace(
    arguments: &RenderArguments,
    terminal: &Terminal,
    scene: &Scene,
    accelerator: &Accelerator,
) -> Result<(Film, Traced)> {
    let options = RenderOptions {
        width: arguments.width,
        height: arguments.height,
        samples: arguments.spp,
        seed: arguments.seed,
        integrator: arguments.integrator(),
        count: arguments.stats.is_some(),
    };
    let control = RenderControl::default();
    let progress = terminal.progress();
    let pixels = u64::from(options.width) * u64::from(options.height);
    progress.count("rendering", pixels);
    let start = Instant::now();
    let (film, statistics) = progress.watch(
        || control.finished_pixels(),
        || render(scene, accelerator.query(), &options, &control),
    )?;
    let time = start.elapsed();
    Ok((film, Traced { statistics, time }))
}

/// The contents of the file that `--stats` asks for.
#[derive(Debug, Serialize)]
struct RenderReport<'a> {
    /// The scene file, as given.
    scene: String,
    /// The picture, as given.
    output: String,
    width: u32,
    height: u32,
    samples_per_pixel: u32,
    seed: u64,
    /// `direct` or `whitted`.
    integrator: &'static str,
    /// How often a ray may be reflected or refracted.
    max_depth: u32,
    /// `fast`, `watertight` or `exact`.
    precision: &'static str,
    /// Number of threads.
    threads: usize,
    /// What the structure looks like.
    structure: &'a StructureReport,
    /// Time of the rendering, in which every visit and test was counted: more than without `--stats`.
    render_seconds: f64,
    /// Rays by kind.
    rays: RayReport,
    /// What a ray cost on average.
    per_ray: CostReport,
}

#[derive(Debug, Serialize)]
struct RayReport {
    /// From the camera.
    camera: u64,
    /// Towards lights.
    shadow: u64,
    /// Reflected and refracted.
    secondary: u64,
    /// All of these.
    total: u64,
}

#[derive(Debug, Serialize)]
struct CostReport {
    /// Nodes visited, leaves included.
    node_visits: f64,
    /// Tests against boxes or planes.
    bound_tests: f64,
    /// Tests against triangles.
    triangle_tests: f64,
}

impl<'a> RenderReport<'a> {
    fn new(
        arguments: &RenderArguments,
        structure: &'a StructureReport,
        Traced { statistics, time }: &Traced,
    ) -> Self {
        let (integrator, max_depth) = match arguments.integrator() {
            Integrator::Direct => ("direct", 0),
            Integrator::Whitted { max_depth } => ("whitted", max_depth),
        };
        // A picture has at least one pixel, and so at least one ray.
        let per_ray = |count: u64| count as f64 / statistics.rays() as f64;
        let counts = &statistics.counts;
        Self {
            scene: arguments.scene.display().to_string(),
            output: arguments.output.display().to_string(),
            width: arguments.width,
            height: arguments.height,
            samples_per_pixel: arguments.spp,
            seed: arguments.seed,
            integrator,
            max_depth,
            precision: arguments.precision.name(),
            threads: rayon::current_num_threads(),
            structure,
            render_seconds: time.as_secs_f64(),
            rays: RayReport {
                camera: statistics.camera_rays,
                shadow: statistics.shadow_rays,
                secondary: statistics.secondary_rays,
                total: statistics.rays(),
            },
            per_ray: CostReport {
                node_visits: per_ray(counts.node_visits),
                bound_tests: per_ray(counts.bound_tests),
                triangle_tests: per_ray(counts.triangle_tests),
            },
        }
    }
}
