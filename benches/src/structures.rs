//! The project's own structures as contenders.

use std::sync::Arc;
use std::time::Instant;

use anyhow::{Context, Result};
use clap::ValueEnum;
use tahko_bsp::{BspOptions, BspTree};
use tahko_bvh::{Bvh, BvhOptions, NodeFormat};
use tahko_kdtree::{KdTree, KdTreeOptions};
use tahko_tracer::accelerator::StructureKind;
use tahko_tracer::geometry::simd::{AvailableSimd, SimdLevel};
use tahko_tracer::geometry::{
    BruteForce, Hit, Precision, Ray, RayQuery, TreeStatistics, TriangleMesh,
};

use crate::contender::{Built, Contender, Recipe};
use crate::report::{self, TreeRow};

/// The name of the project among the libraries.
pub(crate) const LIBRARY: &str = "tahko";

/// Presets of build options; a structure may not have all.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "snake_case")]
pub(crate) enum Preset {
    /// The shortest build.
    Fast,
    /// The default.
    Balanced,
    /// The fewest visits and tests.
    HighQuality,
}

impl Preset {
    const fn name(self) -> &'static str {
        match self {
            Self::Fast => "fast",
            Self::Balanced => "balanced",
            Self::HighQuality => "high_quality",
        }
    }
}

/// Ways of asking a structure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Interface {
    /// A call per ray.
    Single,
    /// A call for many rays.
    Batch,
}

impl Interface {
    const fn name(self) -> &'static str {
        match self {
            Self::Single => "single",
            Self::Batch => "batch",
        }
    }
}

/// A structure with a preset, asked at some precisions in some ways.
#[derive(Clone, Debug)]
pub(crate) struct Structure {
    kind: StructureKind,
    preset: Preset,
    precisions: Vec<Precision>,
    interfaces: Vec<Interface>,
    /// Instructions of the traversal, for a structure that has a choice.
    levels: Vec<SimdLevel>,
    /// How nodes are stored, for a structure that has a choice.
    node_format: NodeFormat,
    is_named: bool,
}

/// The name of the instructions of structures that have no choice.
const SCALAR: &str = "scalar";

impl Structure {
    /// `None` if the structure has no such preset. There are precisions and interfaces.
    pub(crate) fn new(
        kind: StructureKind,
        preset: Preset,
        precisions: &[Precision],
        interfaces: &[Interface],
    ) -> Option<Self> {
        let exists = match kind {
            StructureKind::Brute => preset == Preset::Balanced,
            StructureKind::KdTree => preset != Preset::HighQuality,
            StructureKind::Bsp | StructureKind::Bvh => true,
        };
        exists.then(|| Self {
            kind,
            preset,
            precisions: precisions.to_vec(),
            interfaces: interfaces.to_vec(),
            levels: vec![AvailableSimd::best().level()],
            node_format: NodeFormat::Full,
            is_named: false,
        })
    }

    /// Asked with some instructions, all of which the processor has, in place of the best ones.
    pub(crate) fn with_levels(mut self, levels: &[SimdLevel]) -> Self {
        self.levels = levels.to_vec();
        self
    }

    /// With another format of nodes than the default. `None` for a structure that has no choice.
    pub(crate) fn with_node_format(mut self, format: NodeFormat) -> Option<Self> {
        let has_choice = self.kind == StructureKind::Bvh || format == NodeFormat::Full;
        self.node_format = format;
        has_choice.then_some(self)
    }

    /// The preset's name in reports: other formats of nodes than the default count as presets of their own.
    fn preset_name(&self) -> String {
        match self.node_format {
            NodeFormat::Full => self.preset.name().to_owned(),
            format => format!("{}_{}", self.preset.name(), format.name()),
        }
    }

    /// The instructions that it is asked with; one entry for a structure that has no choice.
    fn levels(&self) -> &[SimdLevel] {
        if self.kind == StructureKind::Bvh {
            &self.levels
        } else {
            &[SimdLevel::Portable]
        }
    }

    /// Tells whether the user asked for it by name, and so for its time.
    pub(crate) const fn named(mut self, is_named: bool) -> Self {
        self.is_named = is_named;
        self
    }

    /// Builds the tree alone.
    fn tree(&self, mesh: &TriangleMesh) -> Result<Tree> {
        Ok(match self.kind {
            StructureKind::Brute => Tree::Brute(BruteForce::new(mesh, Precision::default())),
            StructureKind::Bsp => Tree::Bsp(BspTree::build(mesh, &bsp_options(self.preset))?),
            StructureKind::KdTree => {
                Tree::KdTree(KdTree::build(mesh, &kdtree_options(self.preset))?)
            }
            StructureKind::Bvh => {
                let options = bvh_options(self.preset).with_node_format(self.node_format);
                Tree::Bvh(Bvh::build(mesh, &options)?)
            }
        })
    }

    /// The tree for each precision, level and interface.
    fn contenders<T>(
        &self,
        tree: &T,
        asked_with: fn(T, Precision, SimdLevel) -> Result<T>,
    ) -> Result<Vec<Box<dyn Contender>>>
    where
        T: RayQuery + Clone + Send + 'static,
    {
        let mut contenders: Vec<Box<dyn Contender>> = Vec::new();
        for precision in &self.precisions {
            for level in self.levels() {
                let structure = Arc::new(asked_with(tree.clone(), *precision, *level)?);
                for interface in &self.interfaces {
                    let structure = Arc::clone(&structure);
                    contenders.push(match interface {
                        Interface::Single => Box::new(Single(structure)),
                        Interface::Batch => Box::new(Batch(structure)),
                    });
                }
            }
        }
        Ok(contenders)
    }
}

/// BSP trees are built over larger meshes only if they are asked for by name: they take minutes.
const MAX_BSP_TRIANGLES: usize = 300_000;

/// The end-point overlap is computed up to this product of the number of triangles and the SAH cost, which its time grows with: some seconds.
const MAX_OVERLAP_EFFORT: f64 = 1e8;

impl Recipe for Structure {
    fn max_triangles(&self) -> usize {
        if self.kind == StructureKind::Bsp && !self.is_named {
            MAX_BSP_TRIANGLES
        } else {
            usize::MAX
        }
    }

    fn names(&self) -> Vec<report::Contender> {
        let mut names = Vec::new();
        for precision in &self.precisions {
            for level in self.levels() {
                for interface in &self.interfaces {
                    names.push(report::Contender {
                        library: LIBRARY.to_owned(),
                        structure: self.kind.name().to_owned(),
                        preset: self.preset_name(),
                        precision: precision.name().to_owned(),
                        simd: simd_name(self.kind, *level).to_owned(),
                        interface: interface.name().to_owned(),
                    });
                }
            }
        }
        names
    }

    fn build(&self, mesh: &TriangleMesh, _threads: usize) -> Result<Built> {
        let tree = self.tree(mesh)?;
        let (contenders, statistics) = match &tree {
            Tree::Brute(tree) => (
                self.contenders(
                    tree,
                    |tree, precision, _| Ok(tree.with_precision(precision)),
                )?,
                tree.statistics(),
            ),
            Tree::Bsp(tree) => (
                self.contenders(
                    tree,
                    |tree, precision, _| Ok(tree.with_precision(precision)),
                )?,
                tree.statistics(),
            ),
            Tree::KdTree(tree) => (
                self.contenders(
                    tree,
                    |tree, precision, _| Ok(tree.with_precision(precision)),
                )?,
                tree.statistics(),
            ),
            Tree::Bvh(tree) => (self.contenders(tree, bvh_asked_with)?, tree.statistics()),
        };
        let end_point_overlap = match &tree {
            Tree::Bvh(tree) => {
                let effort = statistics.sah_cost * statistics.primitives as f64;
                (effort <= MAX_OVERLAP_EFFORT).then(|| tree.end_point_overlap())
            }
            // Cells do not overlap.
            Tree::KdTree(_) | Tree::Bsp(_) => Some(0.0),
            Tree::Brute(_) => None,
        };
        Ok(Built {
            contenders,
            bytes: Some(statistics.bytes),
            tree: Some(tree_row(&statistics, end_point_overlap)),
        })
    }

    fn time_build(&self, mesh: &TriangleMesh, _threads: usize) -> Result<f64> {
        let start = Instant::now();
        let tree = self.tree(mesh)?;
        let seconds = start.elapsed().as_secs_f64();
        drop(tree);
        Ok(seconds)
    }
}

/// The name of the instructions that a structure is asked with.
pub(crate) const fn simd_name(kind: StructureKind, level: SimdLevel) -> &'static str {
    match kind {
        StructureKind::Bvh => level.name(),
        StructureKind::Brute | StructureKind::Bsp | StructureKind::KdTree => SCALAR,
    }
}

fn bvh_asked_with(bvh: Bvh, precision: Precision, level: SimdLevel) -> Result<Bvh> {
    let bvh = bvh.with_precision(precision).with_simd(level);
    bvh.with_context(|| format!("this processor has no {}", level.name()))
}

enum Tree {
    Brute(BruteForce),
    Bsp(BspTree),
    KdTree(KdTree),
    Bvh(Bvh),
}

fn bsp_options(preset: Preset) -> BspOptions {
    match preset {
        Preset::Fast => BspOptions::fast(),
        Preset::Balanced => BspOptions::balanced(),
        Preset::HighQuality => BspOptions::high_quality(),
    }
}

fn kdtree_options(preset: Preset) -> KdTreeOptions {
    match preset {
        Preset::Fast => KdTreeOptions::fast(),
        Preset::Balanced | Preset::HighQuality => KdTreeOptions::balanced(),
    }
}

fn bvh_options(preset: Preset) -> BvhOptions {
    match preset {
        Preset::Fast => BvhOptions::fast(),
        Preset::Balanced => BvhOptions::balanced(),
        Preset::HighQuality => BvhOptions::high_quality(),
    }
}

fn tree_row(statistics: &TreeStatistics, end_point_overlap: Option<f64>) -> TreeRow {
    TreeRow {
        nodes: statistics.nodes,
        depth: statistics.depth,
        references_per_triangle: statistics.references_per_primitive(),
        sah_cost: statistics.sah_cost,
        end_point_overlap,
        expected_inner_nodes: statistics.expected_visits.inner_nodes,
        expected_leaves: statistics.expected_visits.leaves,
        expected_triangle_tests: statistics.expected_visits.triangle_tests,
    }
}

/// Asked ray by ray.
struct Single<T>(Arc<T>);

impl<T: RayQuery + Send> Contender for Single<T> {
    fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.0.closest_hit(ray);
        }
    }

    fn any_hits(&self, rays: &[Ray], found: &mut [bool]) {
        for (ray, found) in rays.iter().zip(found) {
            *found = self.0.any_hit(ray);
        }
    }

    fn query(&self) -> Option<&dyn RayQuery> {
        Some(&*self.0)
    }
}

/// Asked many rays at once.
struct Batch<T>(Arc<T>);

impl<T: RayQuery + Send> Contender for Batch<T> {
    fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        self.0.closest_hits(rays, hits);
    }

    fn any_hits(&self, rays: &[Ray], found: &mut [bool]) {
        self.0.any_hits(rays, found);
    }

    fn query(&self) -> Option<&dyn RayQuery> {
        Some(&*self.0)
    }
}
