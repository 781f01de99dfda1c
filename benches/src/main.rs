//! `tahko-bench`: speed, and in the same row the error that was measured in the same run.
//!
//! `cargo xtask bench` runs this program. Tables go to stdout, progress to stderr.
#![forbid(unsafe_code)]
#![expect(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a command line program"
)]

mod exactness;
mod growth;
mod oracle;
mod rays;
mod scenes;
mod table;

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Result;
use clap::Parser;

/// Measures all structures over scenes: build time, memory, rays per second, tests per ray, and errors.
#[derive(Debug, Parser)]
#[command(
    version,
    after_help = "Examples:\n  \
    cargo xtask bench                          all scenes of scenes/\n  \
    cargo xtask bench --scene my.glb           a file of your own\n  \
    cargo xtask bench --exactness              what the exact precision costs\n  \
    cargo xtask bench --growth > growth.md     build time and memory for n = 1e3 to 1e6"
)]
struct Arguments {
    /// A scene or mesh to measure instead of those in scenes/; may be repeated.
    #[arg(long = "scene", value_name = "FILE")]
    scenes: Vec<PathBuf>,
    /// Few rays and short rounds, to see that everything works: the figures mean little.
    #[arg(long)]
    quick: bool,
    /// Measure what exactness costs: time relative to the fast precision, errors, and which arithmetic decided.
    #[arg(long, conflicts_with = "growth")]
    exactness: bool,
    /// Measure how build time and memory grow with the number of triangles, instead of tracing scenes.
    #[arg(long)]
    growth: bool,
    /// The largest number of triangles for --growth.
    #[arg(
        long,
        value_name = "N",
        default_value_t = 1_000_000,
        requires = "growth"
    )]
    largest: u32,
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<()> {
    if arguments.growth {
        let largest = if arguments.quick {
            2_000
        } else {
            arguments.largest
        };
        return growth::print(largest);
    }
    let effort = if arguments.quick {
        scenes::Effort::QUICK
    } else {
        scenes::Effort::FULL
    };
    let files = if arguments.scenes.is_empty() {
        scenes::shipped()?
    } else {
        arguments.scenes.clone()
    };
    if arguments.exactness {
        let effort = if arguments.quick {
            exactness::Effort::QUICK
        } else {
            exactness::Effort::FULL
        };
        return exactness::print(&files, &effort);
    }
    for file in files {
        scenes::measure(&file, &effort)?;
    }
    Ok(())
}
