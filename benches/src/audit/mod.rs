//! Audits all structures at all precisions against exact answers, on rays over the user's own mesh.
//!
//! Each ray is asked of every structure as a single query and in a batch, for the closest hit, any hit and (once per structure) all
//! crossings, and the answers are compared with those of [`Oracle`]. Brute force tests every triangle, so it gets
//! fewer rays of a large mesh: [`Run::rays`] says how many.

mod errors;
mod examine;
mod rays;
mod reference;

use std::sync::atomic::{AtomicU64, Ordering};

use tahko_geometry::oracle::Oracle;
use tahko_tracer::accelerator::{Accelerator, AcceleratorError, StructureKind};
use tahko_tracer::geometry::{Precision, TriangleMesh};

pub use errors::{Errors, Mistake, TErrors};
pub use examine::Example;
pub use rays::{RayKind, rays};
pub use reference::Closest;

/// How much is audited.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct AuditOptions {
    /// Number of rays, of which each kind gets a fifth.
    pub rays: usize,
    /// The same seed gives the same rays; more rays begin with those of fewer.
    pub seed: u64,
    /// Triangle tests that brute force may spend at each precision; it gets at least [`MIN_BRUTE_FORCE_RAYS`] rays.
    pub brute_force_tests: u64,
}

/// Rays that brute force answers, however large the mesh is and if there are as many.
pub const MIN_BRUTE_FORCE_RAYS: usize = 50;

/// Enough rays to see the errors of every precision; a mesh of 100 000 triangles takes about 10 s on two processors.
pub const DEFAULT_RAYS: usize = 10_000;

/// Any number would do.
pub const DEFAULT_SEED: u64 = 1;

impl Default for AuditOptions {
    fn default() -> Self {
        Self {
            rays: DEFAULT_RAYS,
            seed: DEFAULT_SEED,
            brute_force_tests: 50_000_000,
        }
    }
}

impl AuditOptions {
    /// Sets the number of rays.
    #[must_use]
    pub const fn with_rays(mut self, rays: usize) -> Self {
        self.rays = rays;
        self
    }

    /// Sets the seed.
    #[must_use]
    pub const fn with_seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// The first rays of the set that a structure answers.
    fn rays_of(&self, kind: StructureKind, mesh: &TriangleMesh, available: usize) -> usize {
        if kind != StructureKind::Brute {
            return available;
        }
        let tests_per_ray = examine::QUERIES_PER_RAY * mesh.len().max(1) as u64;
        let affordable = usize::try_from(self.brute_force_tests / tests_per_ray);
        available.min(affordable.unwrap_or(usize::MAX).max(MIN_BRUTE_FORCE_RAYS))
    }
}

/// How far an audit is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// What is being done.
    pub stage: Stage,
    /// Units of work that are done.
    pub done: u64,
    /// All units of work.
    pub total: u64,
}

/// The parts of an audit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Computing the exact answers.
    Reference,
    /// Building and asking a structure.
    Structure(StructureKind, Precision),
}

/// What an audit found.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Triangles of the mesh.
    pub triangles: usize,
    /// Rays in the set.
    pub rays: usize,
    /// What the rays were made from.
    pub seed: u64,
    /// Every structure at every precision.
    pub runs: Vec<Run>,
}

/// What a structure answered at a precision.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// The structure.
    pub structure: StructureKind,
    /// The precision.
    pub precision: Precision,
    /// How many rays were asked: the first of the set.
    pub rays: usize,
    /// Whether all crossings were asked for: at [`Precision::Exact`] only, since they do not depend on the precision.
    pub has_crossings: bool,
    /// Errors by kind of ray, in the order of [`RayKind::ALL`].
    pub kinds: Vec<Errors>,
    /// Errors of all kinds of rays.
    pub all: Errors,
    /// The first ray with a mistake.
    pub example: Option<Example>,
}

impl Report {
    /// The runs with mistakes at [`Precision::Exact`], which should have none.
    pub fn broken_promises(&self) -> impl Iterator<Item = &Run> {
        let is_broken = |run: &&Run| run.precision == Precision::Exact && run.all.wrong_rays > 0;
        self.runs.iter().filter(is_broken)
    }
}

/// Units of work per ray: computing an exact answer takes about as long as asking this many structures.
const REFERENCE_UNITS: u64 = 8;

/// Audits all structures, with their default options, at all precisions. One structure is in memory at a time; rays are
/// spread over the threads of rayon.
///
/// A mesh without triangles gets no rays.
///
/// # Errors
/// If a structure refuses the mesh.
pub fn audit(
    mesh: &TriangleMesh,
    options: &AuditOptions,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<Report, AcceleratorError> {
    let rays = rays(mesh, options.rays, options.seed);
    let plan: Vec<(StructureKind, Precision, usize)> = StructureKind::ALL
        .into_iter()
        .flat_map(|kind| Precision::ALL.map(|precision| (kind, precision)))
        .map(|(kind, precision)| (kind, precision, options.rays_of(kind, mesh, rays.len())))
        .collect();
    let asked: usize = plan.iter().map(|(_, _, count)| count).sum();
    let total = REFERENCE_UNITS * rays.len() as u64 + asked as u64;
    let done = AtomicU64::new(0);
    let advance = |stage, units| {
        let done = done.fetch_add(units, Ordering::Relaxed) + units;
        progress(Progress { stage, done, total });
    };

    advance(Stage::Reference, 0);
    let oracle = Oracle::new(mesh);
    let answers = reference::answers(&oracle, &rays, &|count| {
        advance(Stage::Reference, REFERENCE_UNITS * count);
    });
    drop(oracle);
    let mut runs = Vec::new();
    for (structure, precision, count) in plan {
        let stage = Stage::Structure(structure, precision);
        advance(stage, 0);
        let accelerator = Accelerator::build(structure, precision, mesh)?;
        let has_crossings = precision == Precision::Exact;
        let examined = examine::examine(
            accelerator.query(),
            &rays[..count],
            &answers[..count],
            has_crossings,
            &|count| advance(stage, count),
        );
        runs.push(Run {
            structure,
            precision,
            rays: count,
            has_crossings,
            kinds: examined.kinds,
            all: examined.all,
            example: examined.example,
        });
    }
    Ok(Report {
        triangles: mesh.len(),
        rays: rays.len(),
        seed: options.seed,
        runs,
    })
}

#[cfg(test)]
mod tests;
