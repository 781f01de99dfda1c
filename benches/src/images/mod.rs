//! Errors of whole pictures: how far the rounding of a precision is from the exact picture, next to how far the number of samples is from the
//! limit. `docs/image-error.md` says what the numbers mean.

mod flip;
mod maps;
mod picture;
mod rmse;

use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};
use tahko_tracer::accelerator::StructureKind;
use tahko_tracer::film::Film;
use tahko_tracer::geometry::{Precision, RayQuery};
use tahko_tracer::render::{DEFAULT_DEPTH, Integrator, RenderControl, RenderOptions, render};
use tahko_tracer::scene::Scene;

use crate::report::{ImageRow, Sample};
use flip::{ErrorMap, Flip, PIXELS_PER_DEGREE, Seen};
use picture::Picture;
use rmse::rmse;

/// How much is measured.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Effort {
    width: u32,
    height: u32,
    /// Pictures have 1, 2, 4, ... samples per pixel up to this.
    most_samples: u32,
    /// Samples per pixel of the reference.
    reference_samples: u32,
    /// Rounds in which structures and precisions take turns at few samples. Many samples have one round: a long time is a mean already.
    rounds: u32,
    /// A structure whose picture is expected to take longer is left out, unless it is the fastest at its precision.
    turn: Duration,
    /// Triangle tests that brute force may spend on a picture with one sample per pixel.
    brute_tests: f64,
}

impl Effort {
    pub(crate) const FULL: Self = Self {
        width: 160,
        height: 120,
        most_samples: 16,
        reference_samples: 64,
        rounds: 3,
        turn: Duration::from_millis(250),
        brute_tests: 3e7,
    };
    pub(crate) const QUICK: Self = Self {
        width: 64,
        height: 48,
        most_samples: 4,
        reference_samples: 32,
        rounds: 1,
        turn: Duration::from_millis(250),
        brute_tests: 1e7,
    };
    /// To see that everything works.
    pub(crate) const SMOKE: Self = Self {
        width: 16,
        height: 12,
        most_samples: 2,
        reference_samples: 8,
        ..Self::QUICK
    };

    fn options(&self, samples: u32, seed: u64) -> RenderOptions {
        RenderOptions {
            width: self.width,
            height: self.height,
            samples,
            seed,
            integrator: Integrator::Whitted {
                max_depth: DEFAULT_DEPTH,
            },
            count: false,
        }
    }
}

/// Of the pictures that are measured.
const SEED: u64 = 0;

/// Of the reference: its samples are at other places, or the pictures would be nearer to it than to the limit.
const REFERENCE_SEED: u64 = 1;

/// A structure at a precision.
#[derive(Clone, Copy)]
pub(crate) struct Candidate<'a> {
    pub(crate) kind: StructureKind,
    pub(crate) precision: Precision,
    pub(crate) query: &'a dyn RayQuery,
}

/// Renders the scene with all candidates and compares the pictures with the exact ones.
///
/// The last candidate at the exact precision renders the reference. Pictures and maps of errors go to the folder, if there is one; `name` is the
/// scene's.
///
/// # Errors
/// If no candidate is exact, structures at the same precision give different pictures, or a file cannot be written.
pub(crate) fn measure(
    name: &str,
    scene: &Scene,
    candidates: &[Candidate<'_>],
    effort: &Effort,
    folder: Option<&Path>,
) -> Result<Vec<ImageRow>> {
    let studio = Studio {
        name,
        scene,
        effort,
        folder,
        flip: Flip::new(PIXELS_PER_DEGREE),
    };
    if let Some(folder) = folder {
        std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    }
    let exact = candidates
        .iter()
        .rfind(|candidate| candidate.precision == Precision::Exact)
        .with_context(|| format!("{name}: no structure at the exact precision"))?;
    let options = effort.options(effort.reference_samples, REFERENCE_SEED);
    let (film, statistics) = render(scene, exact.query, &options, &RenderControl::default())?;
    let reference = studio.look(&film);
    studio.save("reference", &reference.picture)?;
    let rays = statistics.rays() as f64 / f64::from(effort.reference_samples);
    let brute_tests = rays * scene.mesh().len() as f64;
    let mut taking_part: Vec<Candidate<'_>> = candidates
        .iter()
        .filter(|one| one.kind != StructureKind::Brute || brute_tests <= effort.brute_tests)
        .copied()
        .collect();

    let mut rows = Vec::new();
    let all_samples = std::iter::successors(Some(1u32), |samples| samples.checked_mul(2));
    for samples in all_samples.take_while(|samples| *samples <= effort.most_samples) {
        let rendered = studio.render_in_turns(&taking_part, samples)?;
        rows.extend(studio.rows(&rendered, samples, &reference)?);
        taking_part = affordable(&rendered, effort.turn);
    }
    Ok(rows)
}

/// Those that are fast enough for twice as many samples, and the fastest at each precision.
fn affordable<'a>(rendered: &[Rendered<'a>], turn: Duration) -> Vec<Candidate<'a>> {
    let mut affordable = Vec::new();
    for one in rendered {
        let seconds = one.seconds.median();
        let fastest = rendered
            .iter()
            .filter(|other| other.candidate.precision == one.candidate.precision)
            .all(|other| seconds <= other.seconds.median());
        if fastest || 2.0 * seconds <= turn.as_secs_f64() {
            affordable.push(one.candidate);
        }
    }
    affordable
}

/// What the pictures of a scene have in common.
struct Studio<'a> {
    name: &'a str,
    scene: &'a Scene,
    effort: &'a Effort,
    folder: Option<&'a Path>,
    flip: Flip,
}

/// A picture and how it looks.
struct Looked {
    picture: Picture,
    seen: Seen,
}

/// What a candidate rendered, and the seconds it took in each round.
struct Rendered<'a> {
    candidate: Candidate<'a>,
    film: Film,
    seconds: Sample,
}

impl Studio<'_> {
    /// One row for each precision.
    fn rows(
        &self,
        rendered: &[Rendered<'_>],
        samples: u32,
        reference: &Looked,
    ) -> Result<Vec<ImageRow>> {
        let groups = by_precision(rendered)
            .with_context(|| format!("{}, {samples} samples per pixel", self.name))?;
        let looked: Vec<Looked> = groups
            .iter()
            .map(|group| self.look(&group[0].film))
            .collect();
        let exact = groups
            .iter()
            .position(|group| group[0].candidate.precision == Precision::Exact);
        let exact = &looked[exact.context("brute force alone is exact, and takes too long")?];
        groups
            .iter()
            .zip(&looked)
            .map(|(group, looked)| {
                let precision = group[0].candidate.precision.name();
                let to_exact = looked.seen.difference(&exact.seen);
                let to_reference = looked.seen.difference(&reference.seen);
                let stem = format!("{precision}-{samples}");
                self.save(&stem, &looked.picture)?;
                self.save_map(&format!("{stem}-flip"), &to_reference)?;
                self.save_map(&format!("{stem}-flip-precision"), &to_exact)?;
                Ok(ImageRow {
                    structures: group
                        .iter()
                        .map(|one| one.candidate.kind.name().to_owned())
                        .collect(),
                    precision: precision.to_owned(),
                    samples,
                    seconds: group.iter().map(|one| one.seconds.median()).collect(),
                    rmse_precision: rmse(&looked.picture, &exact.picture),
                    flip_precision: to_exact.mean(),
                    rmse_reference: rmse(&looked.picture, &reference.picture),
                    flip_reference: to_reference.mean(),
                })
            })
            .collect()
    }

    /// Another candidate begins in each round, so that none is always the one that finds cold caches.
    fn render_in_turns<'a>(
        &self,
        candidates: &[Candidate<'a>],
        samples: u32,
    ) -> Result<Vec<Rendered<'a>>> {
        let options = self.effort.options(samples, SEED);
        let mut films = vec![None; candidates.len()];
        let mut seconds = vec![Sample::default(); candidates.len()];
        let cheap = self.effort.most_samples / (4 * samples);
        let rounds = self.effort.rounds.min(cheap).max(1);
        for round in 0..rounds as usize {
            for turn in 0..candidates.len() {
                let index = (turn + round) % candidates.len();
                let start = Instant::now();
                let query = candidates[index].query;
                let (film, _) = render(self.scene, query, &options, &RenderControl::default())?;
                seconds[index].push(start.elapsed().as_secs_f64());
                films[index] = Some(film);
            }
        }
        let rendered = candidates.iter().zip(films).zip(seconds);
        Ok(rendered
            .filter_map(|((candidate, film), seconds)| {
                Some(Rendered {
                    candidate: *candidate,
                    film: film?,
                    seconds,
                })
            })
            .collect())
    }

    fn look(&self, film: &Film) -> Looked {
        let picture = Picture::displayed(film, self.scene.exposure());
        let seen = self.flip.see(&picture);
        Looked { picture, seen }
    }

    fn save(&self, what: &str, picture: &Picture) -> Result<()> {
        match self.folder {
            Some(folder) => picture.save(&folder.join(format!("{}-{what}.png", self.name))),
            None => Ok(()),
        }
    }

    fn save_map(&self, what: &str, map: &ErrorMap) -> Result<()> {
        self.save(what, &maps::colored(map))
    }
}

/// Groups what was rendered at one precision: that is one picture, as all structures give the same answers.
fn by_precision<'a, 'b>(rendered: &'b [Rendered<'a>]) -> Result<Vec<Vec<&'b Rendered<'a>>>> {
    let mut groups = Vec::new();
    for precision in Precision::ALL {
        let group: Vec<_> = rendered
            .iter()
            .filter(|one| one.candidate.precision == precision)
            .collect();
        let Some(first) = group.first() else {
            continue;
        };
        for other in &group[1..] {
            let differing = differing_pixels(&first.film, &other.film);
            if differing > 0 {
                let [first, other] = [first, other].map(|one| one.candidate.kind.name());
                bail!(
                    "{first} and {other} give different pictures at the {} precision: {differing} pixels differ",
                    precision.name()
                );
            }
        }
        groups.push(group);
    }
    Ok(groups)
}

/// Pixels whose bits are not the same.
fn differing_pixels(a: &Film, b: &Film) -> usize {
    let bits = |film: &Film| -> Vec<[u32; 3]> {
        let pixels = film.pixels().iter();
        pixels
            .map(|pixel| pixel.to_array().map(f32::to_bits))
            .collect()
    };
    bits(a)
        .iter()
        .zip(bits(b))
        .filter(|(a, b)| **a != *b)
        .count()
}

#[cfg(test)]
mod tests;
