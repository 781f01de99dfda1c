//! The command line.

use std::path::PathBuf;

use clap::builder::{PathBufValueParser, PossibleValuesParser, TypedValueParser};
use clap::error::ErrorKind;
use clap::{Args, CommandFactory, Parser, Subcommand, value_parser};
use tahko_bench::audit;
use tahko_tracer::accelerator::StructureKind;
use tahko_tracer::film::FilmFormat;
use tahko_tracer::geometry::Precision;
use tahko_tracer::render::{DEFAULT_DEPTH, Integrator, MAX_SIDE};

#[derive(Debug, Parser)]
#[command(name = "tahko", version, about, after_help = EXAMPLES, propagate_version = true, max_term_width = 100)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Render a scene into a PNG or OpenEXR picture
    #[command(after_help = RENDER_EXAMPLES)]
    Render(RenderArguments),
    /// Find the closest hits of the rays of a CSV file
    #[command(after_help = QUERY_FORMATS)]
    Query(QueryArguments),
    /// Show what a scene holds and what the structures over it look like
    #[command(after_help = INSPECT_EXAMPLES)]
    Inspect(InspectArguments),
    /// Hold all structures and precisions against exact answers
    #[command(after_help = VERIFY_EXAMPLES)]
    Verify(VerifyArguments),
}

const EXAMPLES: &str = "\
Examples:
  tahko render scenes/cornell.ron -o cornell.png
  tahko query bunny.ply --rays rays.csv --out hits.csv
  tahko inspect truck.glb --accel all
  tahko verify bunny.ply

Scenes and meshes: .ron, .gltf, .glb, .obj, .ply, .stl
Exit codes: 0 success, 1 error, 2 wrong usage, 130 after Ctrl-C";

const RENDER_EXAMPLES: &str = "\
Examples:
  tahko render scenes/cornell.ron -o cornell.png
  tahko render truck.glb -o truck.exr --width 1920 --height 1080 --spp 16
  tahko render bunny.ply -o bunny.png --accel kdtree --stats bunny.json

direct follows light from its source to the diffuse surface that is seen; whitted also follows
it through mirrors and glass. The picture is the same with every structure and thread count.";

const QUERY_FORMATS: &str = "\
RAYS.csv has the header  ox,oy,oz,dx,dy,dz,tmin,tmax  and a ray per line: origin, direction of
any length but zero, and the closed interval of t, counted in lengths of the direction; tmax may
be inf. HITS.csv has the header  ray,hit,t,triangle,u,v  and a line per ray in the same order:
number of the ray from 0, hit 0 or 1, and for hits t, the number of the triangle in the file, and
the weights of its second and third vertex.

Examples:
  tahko query bunny.ply --rays rays.csv --out hits.csv
  generate-rays | tahko query bunny.ply --rays - --out - | less";

const INSPECT_EXAMPLES: &str = "\
Examples:
  tahko inspect scenes/cornell.ron
  tahko inspect bunny.ply --accel bvh --json";

const VERIFY_EXAMPLES: &str = "\
Random, edge-aimed, vertex-aimed, grazing and axis-parallel rays over the mesh are asked of every
structure at every precision, and the answers held against brute force in rational numbers. On
large meshes brute force, which tests every triangle, gets fewer rays than the trees. Exit code 0
means that the exact precision made no mistake; otherwise standard error shows a ray on which
it did, as a line for tahko query --rays.

Examples:
  tahko verify bunny.ply
  tahko verify truck.glb --rays 100000 --seed 2
  tahko verify scenes/cornell.ron --json > report.json";

/// What all commands understand.
#[derive(Clone, Debug, Args)]
pub(crate) struct CommonArguments {
    /// Number of threads; as many as there are processors if not given
    #[arg(long, value_name = "N", value_parser = threads_parser())]
    pub(crate) threads: Option<usize>,
    /// Print errors only
    #[arg(short, long)]
    pub(crate) quiet: bool,
}

#[derive(Debug, Args)]
pub(crate) struct RenderArguments {
    /// Scene or mesh to render
    #[arg(value_name = "SCENE")]
    pub(crate) scene: PathBuf,
    /// Picture to write: .png (8 bits, sRGB) or .exr (32-bit floats, linear)
    #[arg(short, long, value_name = "PICTURE", value_parser = picture_parser())]
    pub(crate) output: PathBuf,
    /// Structure to use
    #[arg(long, value_name = "NAME", default_value = StructureKind::Bvh.name(), value_parser = structure_parser())]
    pub(crate) accel: StructureKind,
    /// How hits are decided: fast may err at edges, watertight leaves no gaps, exact is always right
    #[arg(long, value_name = "NAME", default_value = Precision::default().name(), value_parser = precision_parser())]
    pub(crate) precision: Precision,
    /// Kinds of light to follow
    #[arg(long, value_name = "NAME", default_value = "whitted", value_parser = ["direct", "whitted"])]
    integrator: String,
    /// How often whitted reflects or refracts a ray [default: 8]
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(0..=1024))]
    depth: Option<u32>,
    /// Width of the picture in pixels
    #[arg(long, value_name = "W", default_value_t = 640, value_parser = side_parser())]
    pub(crate) width: u32,
    /// Height of the picture in pixels
    #[arg(long, value_name = "H", default_value_t = 480, value_parser = side_parser())]
    pub(crate) height: u32,
    /// Samples per pixel
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = value_parser!(u32).range(1..=65536))]
    pub(crate) spp: u32,
    /// Where the samples of a pixel lie, if several
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) seed: u64,
    /// Count what the rays cost, which takes time, and write it as JSON
    #[arg(long, value_name = "FILE.json")]
    pub(crate) stats: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) common: CommonArguments,
}

impl RenderArguments {
    pub(crate) fn integrator(&self) -> Integrator {
        if self.integrator == "direct" {
            Integrator::Direct
        } else {
            let max_depth = self.depth.unwrap_or(DEFAULT_DEPTH);
            Integrator::Whitted { max_depth }
        }
    }
}

#[derive(Debug, Args)]
pub(crate) struct QueryArguments {
    /// Mesh or scene whose triangles are hit
    #[arg(value_name = "MESH")]
    pub(crate) mesh: PathBuf,
    /// Rays to read; - for standard input
    #[arg(long, value_name = "RAYS.csv")]
    pub(crate) rays: PathBuf,
    /// Hits to write; - for standard output
    #[arg(long, value_name = "HITS.csv")]
    pub(crate) out: PathBuf,
    /// Structure to use
    #[arg(long, value_name = "NAME", default_value = StructureKind::Bvh.name(), value_parser = structure_parser())]
    pub(crate) accel: StructureKind,
    /// How hits are decided: fast may err at edges, watertight leaves no gaps, exact is always right
    #[arg(long, value_name = "NAME", default_value = Precision::default().name(), value_parser = precision_parser())]
    pub(crate) precision: Precision,
    #[command(flatten)]
    pub(crate) common: CommonArguments,
}

#[derive(Debug, Args)]
pub(crate) struct InspectArguments {
    /// Scene or mesh to look at
    #[arg(value_name = "SCENE")]
    pub(crate) scene: PathBuf,
    /// Structure to build, or all of them one after the other
    #[arg(long, value_name = "NAME", default_value = ALL_STRUCTURES, value_parser = structures_parser())]
    pub(crate) accel: Structures,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) common: CommonArguments,
}

#[derive(Debug, Args)]
pub(crate) struct VerifyArguments {
    /// Mesh or scene whose triangles are hit
    #[arg(value_name = "MESH")]
    pub(crate) mesh: PathBuf,
    /// Number of rays, of which each of the five kinds gets a fifth
    #[arg(long, value_name = "N", default_value_t = audit::DEFAULT_RAYS, value_parser = rays_parser())]
    pub(crate) rays: usize,
    /// What the rays are made from: the same number gives the same rays
    #[arg(long, value_name = "N", default_value_t = audit::DEFAULT_SEED)]
    pub(crate) seed: u64,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) common: CommonArguments,
}

/// One structure or all of them.
#[derive(Clone, Debug)]
pub(crate) struct Structures(pub(crate) Vec<StructureKind>);

const ALL_STRUCTURES: &str = "all";

impl Arguments {
    pub(crate) const fn common(&self) -> &CommonArguments {
        match &self.command {
            Command::Render(arguments) => &arguments.common,
            Command::Query(arguments) => &arguments.common,
            Command::Inspect(arguments) => &arguments.common,
            Command::Verify(arguments) => &arguments.common,
        }
    }

    /// Finds arguments that are right one by one, but not together.
    pub(crate) fn check(&self) -> Result<(), clap::Error> {
        let Command::Render(arguments) = &self.command else {
            return Ok(());
        };
        if arguments.depth.is_some() && arguments.integrator() == Integrator::Direct {
            let message =
                "--depth cannot be used with --integrator direct, which follows no reflections";
            return Err(Self::command().error(ErrorKind::ArgumentConflict, message));
        }
        Ok(())
    }
}

fn find_structure(name: &str) -> Option<StructureKind> {
    let mut all = StructureKind::ALL.into_iter();
    all.find(|kind| kind.name() == name)
}

fn structure_parser() -> impl TypedValueParser<Value = StructureKind> {
    PossibleValuesParser::new(StructureKind::ALL.map(StructureKind::name))
        .map(|name| find_structure(&name).expect("one of the possible values"))
}

fn structures_parser() -> impl TypedValueParser<Value = Structures> {
    let names = StructureKind::ALL.map(StructureKind::name).into_iter();
    PossibleValuesParser::new(names.chain([ALL_STRUCTURES])).map(|name| {
        let one = find_structure(&name).map(|kind| vec![kind]);
        Structures(one.unwrap_or_else(|| StructureKind::ALL.to_vec()))
    })
}

fn precision_parser() -> impl TypedValueParser<Value = Precision> {
    PossibleValuesParser::new(Precision::ALL.map(Precision::name)).map(|name| {
        let mut all = Precision::ALL.into_iter();
        all.find(|precision| precision.name() == name)
            .expect("one of the possible values")
    })
}

fn side_parser() -> impl TypedValueParser<Value = u32> {
    value_parser!(u32).range(1..=i64::from(MAX_SIDE))
}

fn rays_parser() -> impl TypedValueParser<Value = usize> {
    value_parser!(u32)
        .range(1..=10_000_000)
        .map(|rays| rays as usize)
}

fn threads_parser() -> impl TypedValueParser<Value = usize> {
    value_parser!(u16).range(1..=1024).map(usize::from)
}

fn picture_parser() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|path| FilmFormat::from_path(&path).map(|_| path))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(line: &str) -> Result<Arguments, clap::Error> {
        let arguments = Arguments::try_parse_from(line.split_whitespace())?;
        arguments.check().map(|()| arguments)
    }

    #[test]
    fn the_definition_is_consistent_and_help_fits_a_screen() {
        Arguments::command().debug_assert();
        for name in ["render", "query", "inspect", "verify"] {
            let error = parse(&format!("tahko {name} -h")).unwrap_err();
            let help = error.to_string();
            assert_eq!(error.kind(), ErrorKind::DisplayHelp);
            assert!(help.lines().count() <= 48, "{help}");
            assert!(help.lines().all(|line| line.len() <= 100), "{help}");
        }
    }

    #[test]
    fn the_default_of_depth_is_what_the_help_says() {
        let mut command = Arguments::command();
        let render = command.find_subcommand_mut("render").unwrap();
        let help = render.render_help().to_string();
        assert!(
            help.contains(&format!("[default: {DEFAULT_DEPTH}]")),
            "{help}"
        );
    }

    #[test]
    fn every_name_of_a_structure_and_precision_is_understood() {
        for structure in StructureKind::ALL {
            for precision in Precision::ALL {
                let (structure_name, precision_name) = (structure.name(), precision.name());
                let line = format!(
                    "tahko render a.ron -o a.png --accel {structure_name} --precision {precision_name}"
                );
                let Command::Render(arguments) = parse(&line).unwrap().command else {
                    panic!("not render");
                };
                assert_eq!(
                    (arguments.accel, arguments.precision),
                    (structure, precision)
                );
            }
        }
        let Command::Inspect(arguments) = parse("tahko inspect a.ron").unwrap().command else {
            panic!("not inspect");
        };
        assert_eq!(arguments.accel.0, StructureKind::ALL);
    }

    #[test]
    fn values_out_of_range_and_contradictions_are_wrong_usage() {
        for wrong in [
            "tahko render a.ron",
            "tahko render a.ron -o a.jpg",
            "tahko render a.ron -o a.png --width 0",
            "tahko render a.ron -o a.png --height 16385",
            "tahko render a.ron -o a.png --spp 0",
            "tahko render a.ron -o a.png --threads 0",
            "tahko render a.ron -o a.png --accel octree",
            "tahko render a.ron -o a.png --integrator direct --depth 2",
            "tahko query a.ply --rays rays.csv",
            "tahko verify a.ply --rays 0",
            "tahko verify a.ply --seed -1",
            "tahko",
        ] {
            assert_eq!(parse(wrong).unwrap_err().exit_code(), 2, "{wrong}");
        }
    }
}
