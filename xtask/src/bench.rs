//! `cargo xtask bench`: the benchmark program with the optimisation that its figures are meant for.

use std::ffi::OsString;
use std::process::ExitCode;

use anyhow::Context;

use crate::workspace::Workspace;

#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Arguments of the benchmark program (`--help` lists them)
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    pub(crate) arguments: Vec<OsString>,
}

/// Runs the benchmark program and gives its exit code.
pub(crate) fn run(workspace: &Workspace, arguments: &Arguments) -> anyhow::Result<ExitCode> {
    let status = workspace
        .cargo()
        .args(["run", "--release", "--package", "tahko-bench", "--"])
        .args(&arguments.arguments)
        .status()
        .context("cannot start cargo")?;
    Ok(match status.code().map(u8::try_from) {
        Some(Ok(code)) => ExitCode::from(code),
        // Ended by a signal, or with a code that no exit code here can express.
        _ => ExitCode::FAILURE,
    })
}
