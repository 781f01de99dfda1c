//! Measures all contenders on a scene: builds, speed, work and errors.

use std::time::{Duration, Instant};

use anyhow::Result;
use rayon::ThreadPool;
use tahko_geometry::oracle::Oracle;
use tahko_tracer::accelerator::{Accelerator, StructureKind};
use tahko_tracer::geometry::{Precision, QueryCounts, Ray, RayQuery, TriangleMesh};
use tahko_tracer::scene::Scene;

use crate::contender::{Built, Contender, Recipe};
use crate::errors::{Audit, Ties};
use crate::report::{self, BuildRow, RayClass, Sample, SceneReport, TraceRow, Work};
use crate::structures::LIBRARY;
use crate::timing::{self, Questions, Threads};

/// How much is measured on a scene.
#[derive(Clone, Debug)]
pub(crate) struct Effort {
    /// Rays of each class.
    pub(crate) rays: usize,
    pub(crate) timing: timing::Effort,
    /// Rays of each class whose errors are counted.
    pub(crate) audited: usize,
    /// Builds are repeated until they took as many seconds or there are [`MAX_BUILDS`], after one that does not count. With 0 there is one alone.
    pub(crate) build_seconds: f64,
}

/// Builds of a structure for each number of threads at most.
const MAX_BUILDS: usize = 5;
/// How long all threads work before anything is measured. Measured: of two new threads that had work for 20 ms at a time, both ran on one processor for the first 90 ms.
const WARM_UP: Duration = Duration::from_millis(250);
/// Rays whose work is counted at most.
const COUNTED: usize = 4096;

/// The thread pools that builds and rays run in.
pub(crate) struct Pools {
    one: ThreadPool,
    all: ThreadPool,
}

impl Pools {
    /// As many threads as there are processors, which the system has spread over these.
    pub(crate) fn new() -> Result<Self> {
        let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let all: ThreadPool = pool(0)?;
        let start = Instant::now();
        all.broadcast(|_| {
            while start.elapsed() < WARM_UP {
                std::hint::spin_loop();
            }
        });
        Ok(Self { one: pool(1)?, all })
    }

    /// Threads of the larger pool.
    pub(crate) fn threads(&self) -> usize {
        self.all.current_num_threads()
    }

    /// Does something on all threads.
    pub(crate) fn install<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        self.all.install(work)
    }

    /// What rays are traced on: one thread, and all if these are more.
    fn of_rays(&self) -> Vec<Threads<'_>> {
        let mut threads = vec![Threads::One];
        if self.threads() > 1 {
            threads.push(Threads::Pool(&self.all));
        }
        threads
    }
}

/// What is measured on a scene, with whom.
pub(crate) struct Course<'a> {
    pub(crate) recipes: &'a [Box<dyn Recipe>],
    pub(crate) classes: &'a [RayClass],
    pub(crate) effort: &'a Effort,
    pub(crate) pools: &'a Pools,
    /// Called after each of [`turns`](Self::turns).
    pub(crate) advance: &'a dyn Fn(),
}

/// A contender with its name.
struct Entrant {
    name: report::Contender,
    contender: Box<dyn Contender>,
}

impl Course<'_> {
    /// How often `advance` is called for a scene: once per contender, class, number of threads and round. Less where rays or answers are missing.
    pub(crate) fn turns(&self) -> u64 {
        let contenders: usize = self.recipes.iter().map(|recipe| recipe.names().len()).sum();
        let times = self.classes.len() * self.pools.of_rays().len() * self.effort.timing.rounds;
        (contenders * times) as u64
    }

    /// Measures a scene.
    pub(crate) fn measure(&self, name: &str, scene: &Scene) -> Result<SceneReport> {
        let mut report = SceneReport {
            name: name.to_owned(),
            triangles: scene.mesh().len(),
            builds: Vec::new(),
            traces: Vec::new(),
            images: Vec::new(),
            notes: Vec::new(),
        };
        let mut entrants = Vec::new();
        for recipe in self.recipes {
            if scene.mesh().len() > recipe.max_triangles() {
                report.notes.push(too_large(&**recipe));
                continue;
            }
            let (row, built) = self.build(&**recipe, scene.mesh())?;
            report.builds.extend(row);
            let named = recipe.names().into_iter().zip(built.contenders);
            entrants.extend(named.map(|(name, contender)| Entrant { name, contender }));
        }
        let tracer = self
            .pools
            .install(|| Accelerator::build(StructureKind::Bvh, Precision::Exact, scene.mesh()))?;
        let oracle = Oracle::new(scene.mesh());
        for class in self.classes {
            let rays = class.rays(scene, tracer.query(), self.effort.rays);
            if rays.is_empty() {
                report
                    .notes
                    .push(format!("There are no {} rays.", class.name()));
                continue;
            }
            let questions = Questions {
                class: *class,
                rays: &rays,
            };
            report
                .traces
                .extend(self.trace(&entrants, &oracle, questions));
        }
        Ok(report)
    }

    /// Times builds, and builds once more to keep it.
    fn build(&self, recipe: &dyn Recipe, mesh: &TriangleMesh) -> Result<(Option<BuildRow>, Built)> {
        let all = self.pools.threads();
        if self.effort.build_seconds > 0.0 {
            // One that does not count: memory that was never used before may take a virtual machine longer than all the rest.
            self.pools.install(|| recipe.time_build(mesh, all))?;
        }
        let seconds = self.build_seconds(recipe, mesh, &self.pools.one)?;
        let seconds_all_threads = self.build_seconds(recipe, mesh, &self.pools.all)?;
        let built = self.pools.install(|| recipe.build(mesh, all))?;
        let triangles = mesh.len().max(1) as f64;
        let row = recipe.names().into_iter().next().map(|contender| BuildRow {
            contender,
            seconds,
            seconds_all_threads,
            bytes_per_triangle: built.bytes.map(|bytes| bytes as f64 / triangles),
            tree: built.tree,
        });
        Ok((row, built))
    }

    fn build_seconds(
        &self,
        recipe: &dyn Recipe,
        mesh: &TriangleMesh,
        pool: &ThreadPool,
    ) -> Result<Sample> {
        let threads = pool.current_num_threads();
        let mut sample = Sample::default();
        let mut total = 0.0;
        while sample.values().is_empty()
            || (sample.values().len() < MAX_BUILDS && total < self.effort.build_seconds)
        {
            let seconds = pool.install(|| recipe.time_build(mesh, threads))?;
            total += seconds;
            sample.push(seconds);
        }
        Ok(sample)
    }

    /// One row per contender that answers the class, and per number of threads.
    fn trace(
        &self,
        entrants: &[Entrant],
        oracle: &Oracle,
        questions: Questions<'_>,
    ) -> Vec<TraceRow> {
        let Questions { class, rays } = questions;
        let entrants: Vec<&Entrant> = entrants
            .iter()
            .filter(|entrant| entrant.contender.answers(class))
            .collect();
        let contenders: Vec<&dyn Contender> =
            entrants.iter().map(|entrant| &*entrant.contender).collect();
        let audited = self.effort.audited;
        let audit = self
            .pools
            .install(|| Audit::new(oracle, class, rays, audited));
        let found: Vec<_> = entrants
            .iter()
            .map(|entrant| {
                let ties = if entrant.name.library == LIBRARY {
                    Ties::Smallest
                } else {
                    Ties::Any
                };
                let work = entrant
                    .contender
                    .query()
                    .map(|query| work(query, class, rays));
                (work, audit.errors(&*entrant.contender, ties))
            })
            .collect();
        let mut rows = Vec::new();
        for threads in self.pools.of_rays() {
            let timing = &self.effort.timing;
            let rates = timing::rates(&contenders, questions, threads, timing, self.advance);
            for ((entrant, rate), (work, errors)) in entrants.iter().zip(rates).zip(&found) {
                rows.push(TraceRow {
                    contender: entrant.name.clone(),
                    class,
                    threads: threads.count(),
                    rate,
                    work: *work,
                    errors: *errors,
                });
            }
        }
        rows
    }
}

fn too_large(recipe: &dyn Recipe) -> String {
    let names = recipe.names();
    let name = names.first().map_or("", |name| &name.structure);
    let most = recipe.max_triangles();
    format!(
        "{name} is left out: the scene has more than {most} triangles. Name it with --structures to measure it."
    )
}

/// What rays that are spread evenly over a set cost.
fn work(query: &dyn RayQuery, class: RayClass, rays: &[Ray]) -> Work {
    let mut counts = QueryCounts::default();
    let counted = rays.iter().step_by(rays.len().div_ceil(COUNTED) | 1);
    let number = counted.len().max(1) as f64;
    for ray in counted {
        if class.asks_any() {
            query.any_hit_counted(ray, &mut counts);
        } else {
            query.closest_hit_counted(ray, &mut counts);
        }
    }
    let tests = counts.triangle_tests.max(1) as f64;
    Work {
        node_visits: counts.node_visits as f64 / number,
        bound_tests: counts.bound_tests as f64 / number,
        triangle_tests: counts.triangle_tests as f64 / number,
        settled_by_f32: counts.rungs.f32 as f64 / tests,
        settled_by_f64: counts.rungs.f64 as f64 / tests,
        settled_by_expansions: counts.rungs.exact as f64 / tests,
    }
}
