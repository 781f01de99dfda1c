//! The part of a rendering's time that goes into intersection tests, without a structure.
//!
//! A clock around each query would cost more than a query of a small scene. Instead, the rendering's queries are recorded. Then three things are
//! timed in turns, on one thread: the whole rendering; the recorded queries alone, answered by brute force; and the rest, which is the same rendering with its answers
//! taken from the recording. The share is `queries / (queries + rest)`, which scatters less than a difference to the whole would.

use std::hint::black_box;

use anyhow::{Result, ensure};
use tahko_geometry::oracle::Oracle;
use tahko_tracer::film::Film;
use tahko_tracer::generate::Generator;
use tahko_tracer::geometry::{BruteForce, Precision, Ray, RayQuery};
use tahko_tracer::render::{
    DEFAULT_DEPTH, Integrator, RenderControl, RenderOptions, RenderStatistics, render,
};
use tahko_tracer::scene::Scene;

use super::tape::{Asked, Tape};
use super::{Effort, header_with_errors, range_text, turns, verdict};
use crate::report::{Claim, Errors, Sample, Verdict};
use crate::{check, errors, generated, table};

/// With mirrors (balls), with glass (mount), and with neither (tetra).
const GENERATORS: [Generator; 3] = [Generator::Balls, Generator::Mount, Generator::Tetra];

/// The share that every scene has to reach.
const LEAST: f64 = 0.75;
/// The share that the largest scene of each generator has to reach.
const LEAST_OF_LARGEST: f64 = 0.95;

/// A measured rendering.
struct Row {
    generator: Generator,
    triangles: usize,
    precision: Precision,
    is_largest: bool,
    queries: usize,
    whole: Sample,
    queries_alone: Sample,
    rest: Sample,
    errors: Errors,
}

impl Row {
    /// The median of the rounds' shares.
    fn share(&self) -> f64 {
        let rounds = self.queries_alone.values().iter().zip(self.rest.values());
        Sample::new(rounds.map(|(alone, rest)| alone / (alone + rest)).collect()).median()
    }

    fn cells(&self) -> Vec<String> {
        let milliseconds = |sample: &Sample| table::three_digits(sample.median() * 1e3);
        let mut cells = vec![
            self.generator.name().to_owned(),
            self.precision.name().to_owned(),
            self.triangles.to_string(),
            self.queries.to_string(),
            milliseconds(&self.whole),
            milliseconds(&self.queries_alone),
            milliseconds(&self.rest),
            format!("{:.1}", 100.0 * self.share()),
        ];
        cells.extend(check::error_cells(&self.errors));
        cells
    }
}

pub(super) fn measure(effort: Effort, progress: &dyn Fn(&str)) -> Result<Claim> {
    let wanted: &[u32] = effort.pick(&[16, 100, 1000, 3000], &[16, 100, 1000], &[16]);
    let thread = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let mut rows = Vec::new();
    for generator in GENERATORS {
        let sizes = generated::sizes(generator, wanted)?;
        for (index, size) in sizes.iter().enumerate() {
            let scene = generated::scene(generator, *size)?;
            progress(&format!(
                "share of intersection tests: {generator}, {} triangles",
                scene.mesh().len()
            ));
            for precision in [Precision::Fast, Precision::Exact] {
                let row = thread.install(|| row(&scene, generator, precision, effort))?;
                rows.push(Row {
                    is_largest: index + 1 == sizes.len(),
                    ..row
                });
            }
        }
    }
    Ok(claim(&rows))
}

fn claim(rows: &[Row]) -> Claim {
    let shares = |is_largest: bool| {
        let rows = rows.iter().filter(move |row| row.is_largest == is_largest);
        rows.map(|row| 100.0 * row.share())
    };
    let all: Vec<(f64, bool)> = rows
        .iter()
        .map(|row| (row.share(), row.is_largest))
        .collect();
    Claim {
        title: "Share of intersection tests".to_owned(),
        claim: "Without a structure, 75 % of a rendering's time goes into intersection tests in simple scenes, and over 95 % in complex \
                ones."
            .to_owned(),
        source: "Whitted, An improved illumination model for shaded display, CACM 23(6), 1980".to_owned(),
        verdict: judge(&all),
        finding: format!(
            "By brute force, {} % of the time went into ray/triangle tests in the largest scenes, and {} % in the smaller ones.",
            range_text(shares(true), 1),
            range_text(shares(false), 1)
        ),
        header: header_with_errors(&[
            "scene",
            "precision",
            "triangles",
            "rays",
            "rendering ms",
            "queries alone ms",
            "rest ms",
            "share %",
        ]),
        rows: rows.iter().map(Row::cells).collect(),
    }
}

/// Shares, and whether they are of the largest scene of a generator.
fn judge(shares: &[(f64, bool)]) -> Verdict {
    verdict::of(shares.iter().map(|(share, is_largest)| {
        let least = if *is_largest { LEAST_OF_LARGEST } else { LEAST };
        *share >= least
    }))
}

/// Measures on the current thread.
fn row(scene: &Scene, generator: Generator, precision: Precision, effort: Effort) -> Result<Row> {
    let structure = BruteForce::new(scene.mesh(), precision);
    let side = effort.pick(64, 40, 12);
    let picture = |query: &dyn RayQuery| picture(scene, query, side);
    let tape = Tape::record(&structure);
    let (film, statistics) = picture(&tape)?;
    let recording = tape.into_recording();
    ensure!(
        recording.len() as u64 == statistics.rays(),
        "the rendering of {generator} asked what was not recorded"
    );
    let (replayed, _) = picture(&Tape::play(&structure, &recording))?;
    ensure!(
        replayed == film,
        "the rendering of {generator} asks in another order when it is repeated"
    );

    // It succeeded twice above, and does again.
    let draw = |query: &dyn RayQuery| {
        black_box(picture(query).is_ok());
    };
    let [whole, queries_alone, rest] = turns::seconds(effort.pick(7, 3, 1), |task| match task {
        0 => draw(&structure),
        1 => answer(&structure, &recording),
        _ => draw(&Tape::play(&structure, &recording)),
    });
    let errors = errors(scene, &structure, &recording, effort)?;
    Ok(Row {
        generator,
        triangles: scene.mesh().len(),
        precision,
        is_largest: false,
        queries: recording.len(),
        whole,
        queries_alone,
        rest,
        errors,
    })
}

fn picture(scene: &Scene, query: &dyn RayQuery, side: u32) -> Result<(Film, RenderStatistics)> {
    let options = RenderOptions {
        width: side,
        height: side,
        integrator: Integrator::Whitted {
            max_depth: DEFAULT_DEPTH,
        },
        ..RenderOptions::default()
    };
    Ok(render(scene, query, &options, &RenderControl::default())?)
}

fn answer(query: &dyn RayQuery, recording: &[Asked]) {
    for asked in recording {
        match asked {
            Asked::Closest(ray, _) => {
                black_box(query.closest_hit(ray));
            }
            Asked::Any(ray, _) => {
                black_box(query.any_hit(ray));
            }
        }
    }
}

/// The errors of the closest hits on some of the rendering's rays, evenly spread.
fn errors(
    scene: &Scene,
    structure: &BruteForce,
    recording: &[Asked],
    effort: Effort,
) -> Result<Errors> {
    let audited = effort.pick(1000, 200, 50);
    let step = (recording.len() / audited).max(1);
    let rays: Vec<Ray> = recording
        .iter()
        .step_by(step)
        .map(|asked| *asked.ray())
        .collect();
    let exact = errors::exact_answers(&Oracle::new(scene.mesh()), &rays);
    let errors = check::errors(structure, &rays, &exact);
    if structure.precision() == Precision::Exact {
        check::require_exact(&errors, "brute force")?;
    }
    Ok(errors)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_scenes_have_to_reach_more_than_small_ones() {
        assert_eq!(judge(&[(0.8, false), (0.97, true)]), Verdict::Confirmed);
        assert_eq!(
            judge(&[(0.8, false), (0.9, true)]),
            Verdict::PartlyConfirmed
        );
        assert_eq!(
            judge(&[(0.6, false), (0.97, true)]),
            Verdict::PartlyConfirmed
        );
        assert_eq!(judge(&[(0.6, false), (0.8, true)]), Verdict::NotConfirmed);
    }
}
