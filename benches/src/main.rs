//! `tahko-bench`: speed, and in the same row the error that was measured in the same run.
//!
//! `cargo xtask bench` runs this program. Tables go to stdout, progress to stderr, reports to a folder.
#![cfg_attr(not(feature = "peers"), forbid(unsafe_code))]
#![expect(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a command line program"
)]

mod arguments;
mod baseline;
mod check;
mod claims;
mod contender;
mod errors;
mod fit;
mod generated;
mod growth;
mod images;
mod machine;
mod measure;
#[cfg(feature = "peers")]
mod peers;
mod progress;
mod promises;
mod rays;
mod report;
mod run;
mod scenes;
mod structures;
mod table;
mod timing;

use std::io::Write as _;
use std::path::Path;
use std::process::ExitCode;

use anyhow::{Context, Result};
use clap::Parser;
use tahko_tracer::write_atomically;

use arguments::Arguments;

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(broken) if broken.is_empty() => ExitCode::SUCCESS,
        Ok(broken) => {
            for promise in broken {
                eprintln!("error: {promise}");
            }
            ExitCode::FAILURE
        }
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(2)
        }
    }
}

/// Measures, prints and writes; gives the promises that were broken.
fn run(arguments: &Arguments) -> Result<Vec<String>> {
    // What can go wrong with files goes wrong before the work, not after it.
    let baseline = arguments
        .baseline
        .as_deref()
        .map(baseline::load)
        .transpose()?;
    let folder = &arguments.out;
    std::fs::create_dir_all(folder)
        .with_context(|| format!("cannot make the folder {}", folder.display()))?;
    let report = run::run(arguments)?;
    let comparison = baseline.map(|baseline| baseline::compare(&report, &baseline));
    let page = report::markdown::page(&report, comparison.as_ref());
    println!("{page}");
    write(
        folder,
        "report.json",
        &format!("{}\n", serde_json::to_string_pretty(&report)?),
    )?;
    write(folder, "report.md", &page)?;
    write(folder, "report.html", &report::html::page(&report))?;
    Ok(promises::broken(&report))
}

fn write(folder: &Path, name: &str, text: &str) -> Result<()> {
    let file = folder.join(name);
    write_atomically(&file, |writer| writer.write_all(text.as_bytes()))
        .with_context(|| format!("cannot write {}", file.display()))?;
    eprintln!("wrote {}", file.display());
    Ok(())
}
