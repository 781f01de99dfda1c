//! Developer commands: golden images, benchmarks, tidiness, continuous integration.
//!
//! Links nothing of the workspace: it runs cargo and the built programs. Results go to stdout, messages to
//! stderr; the exit code is 0 on success, 1 when a check failed, 2 on wrong usage or when a check could not run.
#![forbid(unsafe_code)]
#![expect(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a command line program"
)]

mod bench;
mod ci;
mod golden;
mod peers;
mod table;
mod tidy;
mod workspace;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use workspace::Workspace;

/// Developer commands of the tahko workspace
#[derive(Debug, Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Render every scene with every structure and compare with the golden images
    Golden(golden::Arguments),
    /// Check the repository's own rules
    Tidy,
    /// Run the benchmark program; all arguments are passed on, and `--peers` compiles other libraries in
    #[command(disable_help_flag = true)]
    Bench(bench::Arguments),
    /// Install Embree for `bench --peers`, and print the path of its library
    Peers,
    /// Run all checks, as continuous integration does
    Ci(ci::Arguments),
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(code) => code,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    let workspace = Workspace::load()?;
    match &arguments.command {
        Command::Golden(arguments) => golden::run(&workspace, arguments).map(passed),
        Command::Tidy => tidy::run(&workspace).map(passed),
        Command::Bench(arguments) => bench::run(&workspace, arguments),
        Command::Peers => peers::run(&workspace).map(|()| ExitCode::SUCCESS),
        Command::Ci(arguments) => ci::run(&workspace, arguments).map(passed),
    }
}

fn passed(passed: bool) -> ExitCode {
    ExitCode::from(u8::from(!passed))
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_definition_of_the_arguments_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn bench_passes_everything_on() {
        let words = ["xtask", "bench", "--quick", "--help", "cornell"];
        let Command::Bench(bench) = Arguments::parse_from(words).command else {
            panic!("not the bench command");
        };
        assert_eq!(bench.arguments, ["--quick", "--help", "cornell"]);
    }
}
