//! What a run of the benchmark found, as it stands in `report.json`.
//!
//! The types here are the schema: `docs/benchmark-report.md` describes every field for readers of the file. Whoever changes their
//! meaning raises [`SCHEMA`]. Whatever shows a report (terminal, Markdown, HTML, comparison with a baseline) reads these types alone.

#[cfg(test)]
pub(crate) mod example;
pub(crate) mod html;
pub(crate) mod markdown;
mod sample;

use serde::{Deserialize, Serialize};

pub(crate) use sample::Sample;
pub(crate) use tahko_bench::audit::TErrors as Distribution;

/// The version of the schema.
pub(crate) const SCHEMA: u32 = 1;

/// A whole run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Report {
    /// [`SCHEMA`] of the program that wrote it.
    pub(crate) schema: u32,
    /// The arguments of the program.
    pub(crate) command: String,
    /// When the run began, in seconds since 1970 (UTC).
    pub(crate) started: u64,
    /// How long it took, in seconds.
    pub(crate) seconds: f64,
    pub(crate) machine: Machine,
    pub(crate) settings: Settings,
    pub(crate) scenes: Vec<SceneReport>,
    /// How build time and memory grow; empty if that was not asked for.
    pub(crate) growth: Vec<GrowthCurve>,
    /// Statements of the literature, measured; empty if that was not asked for.
    pub(crate) claims: Vec<Claim>,
}

/// What was measured on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Machine {
    /// Model name of the processor, as far as the system tells.
    pub(crate) processor: String,
    /// Threads that the measurement with all threads used.
    pub(crate) threads: usize,
    /// Operating system and architecture.
    pub(crate) system: String,
    /// Version of the compiler.
    pub(crate) compiler: String,
    /// Version and, where known, commit of the project.
    pub(crate) version: String,
}

/// How much was measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Settings {
    /// The figures are of a quick run, and mean less.
    pub(crate) quick: bool,
    /// Rays of each class.
    pub(crate) rays: usize,
    /// Rounds in which the contenders take turns.
    pub(crate) rounds: usize,
}

/// Who answered.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub(crate) struct Contender {
    /// `tahko`, or the name of another library.
    pub(crate) library: String,
    /// The structure: `brute`, `bsp`, `kdtree`, `bvh`, or what the other library calls its own.
    pub(crate) structure: String,
    /// The preset it was built with.
    pub(crate) preset: String,
    /// `fast`, `watertight`, `exact`, or what the other library calls its mode.
    pub(crate) precision: String,
    /// Instruction set of the traversal: `scalar` or, say, `avx2`.
    pub(crate) simd: String,
    /// How rays are handed over: `single` (a call per ray), `batch` or `packet16`.
    pub(crate) interface: String,
}

/// What was found on a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct SceneReport {
    /// The file's name without folder and ending.
    pub(crate) name: String,
    pub(crate) triangles: usize,
    /// One for each structure and preset.
    pub(crate) builds: Vec<BuildRow>,
    /// One for each contender, class of rays and number of threads.
    pub(crate) traces: Vec<TraceRow>,
    /// Errors of whole pictures; empty if they were not asked for.
    pub(crate) images: Vec<ImageRow>,
    /// What was left out, and why.
    pub(crate) notes: Vec<String>,
}

/// How a structure is built and what it looks like.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct BuildRow {
    /// The contender at the precision and interface that come first; builds do not depend on them.
    pub(crate) contender: Contender,
    /// Seconds from the indexed mesh to the first ray, on one thread.
    pub(crate) seconds: Sample,
    /// The same on all threads.
    pub(crate) seconds_all_threads: Sample,
    /// Memory that queries need; `None` where a library does not tell.
    pub(crate) bytes_per_triangle: Option<f64>,
    /// What the tree looks like; `None` for libraries that do not show it.
    pub(crate) tree: Option<TreeRow>,
}

/// A tree and its expected cost.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct TreeRow {
    pub(crate) nodes: usize,
    pub(crate) depth: usize,
    pub(crate) references_per_triangle: f64,
    /// Expected cost of a random ray that meets the bounds, in triangle tests (surface area heuristic).
    pub(crate) sah_cost: f64,
    /// End-point overlap (Aila, Karras, Laine 2013), in triangle tests; `None` where it was not computed.
    pub(crate) end_point_overlap: Option<f64>,
    /// Inner nodes that a random line through the bounds is expected to visit (`E_T` of Wald and Havran 2006).
    pub(crate) expected_inner_nodes: f64,
    /// Leaves likewise (`E_L`).
    pub(crate) expected_leaves: f64,
    /// Triangle tests likewise (`E_I`).
    pub(crate) expected_triangle_tests: f64,
}

/// The classes of rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum RayClass {
    /// Through the pixels of a picture, in tiles: closest hit.
    Primary,
    /// From the primary hits to the first light: any hit.
    Shadow,
    /// From the primary hits in random directions, as light bounces off a diffuse surface, in random order: closest hit.
    Diffuse,
    /// Through two random points of the scene's bounds, from the first: closest hit.
    Random,
    /// From random points through middles of edges: closest hit.
    Edge,
    /// From random points through vertices: closest hit.
    Vertex,
}

/// Speed, work and errors of a contender on a class of rays.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct TraceRow {
    pub(crate) contender: Contender,
    pub(crate) class: RayClass,
    pub(crate) threads: usize,
    /// Million rays per second, one value a round. The rounds of all rows of a scene, class and number of threads are the same rounds.
    pub(crate) rate: Sample,
    /// What a ray costs; `None` for other libraries.
    pub(crate) work: Option<Work>,
    pub(crate) errors: Errors,
}

/// Means per ray.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Work {
    pub(crate) node_visits: f64,
    /// Tests against boxes and planes.
    pub(crate) bound_tests: f64,
    pub(crate) triangle_tests: f64,
    /// Triangle tests of the exact precision that f32 settled, as a part of all; zero at other precisions, as are the next two.
    pub(crate) settled_by_f32: f64,
    /// Those that f64 settled.
    pub(crate) settled_by_f64: f64,
    /// Those that expansion arithmetic settled.
    pub(crate) settled_by_expansions: f64,
}

/// Differences from the exact answers: numbers of rays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Errors {
    /// Rays that were compared with the exact answer.
    pub(crate) audited: usize,
    /// Those that exactly hit something.
    pub(crate) hits: usize,
    /// A hit where the ray hits nothing.
    pub(crate) false_hits: usize,
    /// No hit where the ray hits something.
    pub(crate) false_misses: usize,
    /// Another triangle than the closest. A triangle that is hit at exactly the same `t` is not wrong for libraries that promise nothing about ties.
    pub(crate) wrong_triangles: usize,
    /// Of those, the ones whose `t` is off by more than a thousandth.
    pub(crate) far_off: usize,
    /// Errors of `t` where the triangle is right, in units in the last place; `None` where there are none or `t` is not asked for.
    pub(crate) t_ulp: Option<Distribution>,
}

impl Errors {
    /// A number of rays per million audited ones.
    pub(crate) fn per_million(&self, count: usize) -> f64 {
        1e6 * count as f64 / self.audited.max(1) as f64
    }
}

/// The error of a picture against the exact picture with many samples per pixel.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ImageRow {
    /// The structures that give this very picture, bit for bit.
    pub(crate) structures: Vec<String>,
    pub(crate) precision: String,
    /// Samples per pixel.
    pub(crate) samples: u32,
    /// Seconds that the picture took on all threads, for each of `structures`.
    pub(crate) seconds: Vec<f64>,
    /// Root of the mean squared difference of the displayed pixels (sRGB, 0 to 1) to the exact precision's picture with as many samples.
    pub(crate) rmse_precision: f64,
    /// Mean FLIP to the same.
    pub(crate) flip_precision: f64,
    /// Root of the mean squared difference to the exact picture with many samples: the convergence.
    pub(crate) rmse_reference: f64,
    /// Mean FLIP to the same.
    pub(crate) flip_reference: f64,
}

/// How a structure grows on the scenes of a generator.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct GrowthCurve {
    pub(crate) generator: String,
    pub(crate) contender: Contender,
    pub(crate) points: Vec<GrowthPoint>,
    /// Exponent of a power of the number of triangles, fitted to the build times; `None` for fewer than three points.
    pub(crate) build_exponent: Option<Fit>,
    /// The same for the time of a random ray.
    pub(crate) ray_exponent: Option<Fit>,
}

/// A measured point of a growth curve.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct GrowthPoint {
    pub(crate) triangles: usize,
    /// Build time on all threads, the best of a few.
    pub(crate) build_seconds: f64,
    pub(crate) bytes_per_triangle: f64,
    pub(crate) nodes: usize,
    pub(crate) depth: usize,
    pub(crate) references_per_triangle: f64,
    pub(crate) sah_cost: f64,
    /// Random rays, one thread: nanoseconds each.
    pub(crate) ray_nanoseconds: f64,
    pub(crate) ray_node_visits: f64,
    pub(crate) ray_triangle_tests: f64,
    /// Errors of the same rays against the oracle.
    pub(crate) errors: Errors,
}

/// A fitted exponent.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Fit {
    pub(crate) exponent: f64,
    /// Half of the 95 % confidence interval.
    pub(crate) uncertainty: f64,
}

/// A statement of the literature, held against measurements.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Claim {
    /// A short name.
    pub(crate) title: String,
    /// What is claimed, in a sentence.
    pub(crate) claim: String,
    /// Who claims it.
    pub(crate) source: String,
    pub(crate) verdict: Verdict,
    /// What was found, in a sentence with the figures.
    pub(crate) finding: String,
    /// The measurements behind it: a header and rows.
    pub(crate) header: Vec<String>,
    pub(crate) rows: Vec<Vec<String>>,
}

/// What became of a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Verdict {
    Confirmed,
    PartlyConfirmed,
    NotConfirmed,
}
