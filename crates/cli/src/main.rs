//! `tahko`: renders, queries, inspects and verifies scenes through four space-partitioning structures.
//!
//! This program only parses arguments, shows progress and prints; all work is done by `tahko-tracer` and, for `verify`, by
//! `tahko-bench`.
//! Exit codes: 0 for success, 1 for an error, 2 for wrong usage, 130 after Ctrl-C.
#![forbid(unsafe_code)]

mod args;
mod audit_report;
mod hits;
mod inspect;
mod interrupt;
mod output;
mod progress;
mod query;
mod rays;
mod render;
mod structure;
mod terminal;
mod verify;

use std::process::ExitCode;

use anyhow::{Result, anyhow};
use clap::Parser;

use args::{Arguments, Command};
use terminal::Terminal;

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    if let Err(error) = arguments.check() {
        error.exit();
    }
    let terminal = Terminal::new(arguments.common().quiet);
    let outcome = run(&arguments, &terminal);
    terminal.progress().clear();
    if interrupt::requested() {
        return ExitCode::from(interrupt::EXIT_CODE);
    }
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        // Nobody reads any more: there is nothing left to do.
        Err(error) if output::is_closed_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            terminal.error(&error);
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments, terminal: &Terminal) -> Result<()> {
    interrupt::install(terminal.progress().clone())?;
    let threads = arguments.common().threads.unwrap_or(0);
    // Everything runs inside the pool, so that its size holds for loading and building, too.
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .stack_size(STACK_BYTES)
        .build()
        .map_err(|source| anyhow!("cannot start the threads: {source}"))?
        .install(|| match &arguments.command {
            Command::Render(arguments) => render::run(arguments, terminal),
            Command::Query(arguments) => query::run(arguments, terminal),
            Command::Inspect(arguments) => inspect::run(arguments, terminal),
            Command::Verify(arguments) => verify::run(arguments, terminal),
        })
}

/// The stack of a worker thread: as large as that of the main thread is on most systems.
const STACK_BYTES: usize = 8 << 20;
