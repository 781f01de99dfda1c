//! The command line.

use std::path::{Path, PathBuf};

use clap::{Parser, ValueEnum};
use tahko_bvh::NodeFormat;
use tahko_tracer::accelerator::StructureKind;
use tahko_tracer::geometry::Precision;
use tahko_tracer::geometry::simd::SimdLevel;

use crate::report::RayClass;
use crate::structures::{Interface, Preset};

/// Measures speed and, in the same run and the same rows, the error
///
/// Every structure is built over every scene and traces several classes of rays at several precisions, taking turns. Answers are held against exact
/// ones in rational numbers. Tables go to stdout, progress to stderr; report.json, report.md and report.html go to the folder --out.
///
/// Exit code: 0 if the exact precision made no error and all structures agree, 1 if not, 2 if the run was impossible.
#[derive(Debug, Parser)]
#[command(
    name = "cargo xtask bench",
    bin_name = "cargo xtask bench",
    version,
    after_help = "Examples:\n  \
    cargo xtask bench --quick                       three scenes, a few minutes\n  \
    cargo xtask bench                               all scenes of scenes/, about half an hour\n  \
    cargo xtask bench --scene my.glb --sections speed --structures bvh,kdtree\n  \
    cargo xtask bench --peers --scene my.glb        other libraries beside ours\n  \
    cargo xtask bench --quick --baseline old/report.json\n  \
    cargo xtask bench --sections growth             build time and memory for n = 1e3 to 1e6"
)]
pub(crate) struct Arguments {
    /// A scene or mesh to measure instead of those in scenes/, or a folder of them with all below; may be repeated
    #[arg(long = "scene", value_name = "FILE")]
    pub(crate) scenes: Vec<PathBuf>,
    /// Three scenes, fewer rays and shorter rounds: under five minutes on two processors
    #[arg(long)]
    pub(crate) quick: bool,
    /// Tiny, to see in seconds that everything works: the figures mean nothing
    #[arg(long, conflicts_with = "quick")]
    pub(crate) smoke: bool,
    /// What to measure
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_values_t = Section::ALL)]
    pub(crate) sections: Vec<Section>,
    /// Structures
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = structure)]
    pub(crate) structures: Vec<StructureKind>,
    /// Build presets, of which not every structure has all
    #[arg(
        long,
        value_name = "LIST",
        value_delimiter = ',',
        default_value = "balanced"
    )]
    pub(crate) presets: Vec<Preset>,
    /// How the BVH stores its nodes; others than the default are presets of their own in the report
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = node_format, default_value = "full")]
    pub(crate) node_formats: Vec<NodeFormat>,
    /// Precisions
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = precision)]
    pub(crate) precision: Vec<Precision>,
    /// Instructions of the traversal, for structures that have a choice [default: the best that the processor has]
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = simd)]
    pub(crate) simd: Vec<SimdLevel>,
    /// Ways of handing rays over
    #[arg(
        long,
        value_name = "LIST",
        value_delimiter = ',',
        default_value = "single"
    )]
    pub(crate) interfaces: Vec<Interface>,
    /// Classes of rays
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = class)]
    pub(crate) classes: Vec<RayClass>,
    /// Rays of each class
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) rays: Option<u32>,
    /// Measure other libraries beside ours (needs the feature `peers`, which `cargo xtask bench` turns on)
    #[arg(long)]
    pub(crate) peers: bool,
    /// Which other libraries; tinybvh and tinybvh-hq are named only where they survive: they crash on some scenes
    #[arg(long, value_name = "LIST", value_delimiter = ',', requires = "peers", default_values_t = Library::USUAL)]
    pub(crate) libraries: Vec<Library>,
    /// The largest number of triangles of the section growth
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1000..))]
    pub(crate) largest: Option<u32>,
    /// The folder that the reports are written to
    #[arg(long, value_name = "DIR", default_value_os_t = default_folder())]
    pub(crate) out: PathBuf,
    /// An earlier report.json to compare with
    #[arg(long, value_name = "FILE")]
    pub(crate) baseline: Option<PathBuf>,
}

/// The parts of a report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Section {
    /// Speed, work and errors of rays, and builds.
    Speed,
    /// Errors of whole pictures.
    Images,
    /// How build time, memory and rays grow with the number of triangles.
    Growth,
    /// Statements of the literature.
    Claims,
}

impl Section {
    const ALL: [Self; 4] = [Self::Speed, Self::Images, Self::Growth, Self::Claims];
}

impl std::fmt::Display for Section {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(match self {
            Self::Speed => "speed",
            Self::Images => "images",
            Self::Growth => "growth",
            Self::Claims => "claims",
        })
    }
}

/// Other libraries to measure beside ours.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Library {
    /// Embree 4, from a shared library.
    Embree,
    /// obvhs.
    Obvhs,
    /// bvh.
    Bvh,
    /// parry3d.
    Parry3d,
    /// tinybvh with its plain build.
    Tinybvh,
    /// tinybvh with spatial splits.
    TinybvhHq,
}

impl Library {
    /// All of them.
    #[cfg(all(test, feature = "peers"))]
    pub(crate) const ALL: [Self; 6] = [
        Self::Embree,
        Self::Obvhs,
        Self::Bvh,
        Self::Parry3d,
        Self::Tinybvh,
        Self::TinybvhHq,
    ];

    /// Those that have not been seen to end the program.
    const USUAL: [Self; 4] = [Self::Embree, Self::Obvhs, Self::Bvh, Self::Parry3d];
}

impl std::fmt::Display for Library {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(match self {
            Self::Embree => "embree",
            Self::Obvhs => "obvhs",
            Self::Bvh => "bvh",
            Self::Parry3d => "parry3d",
            Self::Tinybvh => "tinybvh",
            Self::TinybvhHq => "tinybvh-hq",
        })
    }
}

fn default_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .with_file_name("target")
        .join("bench")
}

fn structure(name: &str) -> Result<StructureKind, String> {
    named(name, &StructureKind::ALL, StructureKind::name)
}

fn precision(name: &str) -> Result<Precision, String> {
    named(name, &Precision::ALL, Precision::name)
}

fn node_format(name: &str) -> Result<NodeFormat, String> {
    named(name, &NodeFormat::ALL, NodeFormat::name)
}

fn simd(name: &str) -> Result<SimdLevel, String> {
    named(name, &SimdLevel::ALL, SimdLevel::name)
}

fn class(name: &str) -> Result<RayClass, String> {
    named(name, &RayClass::ALL, RayClass::name)
}

/// The item with a name.
fn named<T: Copy>(name: &str, all: &[T], name_of: fn(T) -> &'static str) -> Result<T, String> {
    let found = all.iter().copied().find(|item| name_of(*item) == name);
    found.ok_or_else(|| {
        let names: Vec<&str> = all.iter().map(|item| name_of(*item)).collect();
        format!("there are {}", names.join(", "))
    })
}

/// A list, or all of its kind where none was named.
pub(crate) fn or_all<T: Copy>(list: &[T], all: &[T]) -> Vec<T> {
    if list.is_empty() { all } else { list }.to_vec()
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    fn parse(words: &[&str]) -> Result<Arguments, clap::Error> {
        Arguments::try_parse_from([&["bench"], words].concat())
    }

    #[test]
    fn the_definition_of_the_arguments_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn everything_is_measured_with_the_default_preset_unless_told_otherwise() {
        let arguments = parse(&[]).unwrap();
        assert_eq!(arguments.sections, Section::ALL);
        assert_eq!(arguments.presets, [Preset::Balanced]);
        assert_eq!(
            or_all(&arguments.structures, &StructureKind::ALL),
            StructureKind::ALL
        );
    }

    #[test]
    fn lists_are_separated_by_commas() {
        let words = [
            "--structures",
            "bvh,kdtree",
            "--precision=exact",
            "--classes",
            "edge,random",
        ];
        let arguments = parse(&words).unwrap();
        assert_eq!(
            arguments.structures,
            [StructureKind::Bvh, StructureKind::KdTree]
        );
        assert_eq!(arguments.precision, [Precision::Exact]);
        assert_eq!(arguments.classes, [RayClass::Edge, RayClass::Random]);
    }

    #[test]
    fn an_unknown_name_is_answered_with_the_known_ones() {
        let error = parse(&["--structures", "octree"]).unwrap_err().to_string();
        assert!(
            error.contains("there are brute, bsp, kdtree, bvh"),
            "{error}"
        );
        let error = parse(&["--node-formats", "half"]).unwrap_err().to_string();
        assert!(error.contains("there are full, quantised"), "{error}");
        let error = parse(&["--simd", "sse"]).unwrap_err().to_string();
        assert!(error.contains("portable"), "{error}");
    }
}
