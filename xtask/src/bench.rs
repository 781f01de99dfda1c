//! `cargo xtask bench`: the benchmark program with the optimisation that its figures are meant for.

use std::ffi::OsString;
use std::process::{Command, ExitCode};

use anyhow::Context;

use crate::peers::BenchSettings;
use crate::workspace::Workspace;

#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Arguments of the benchmark program (`--help` lists them)
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    pub(crate) arguments: Vec<OsString>,
}

impl Arguments {
    /// Whether other libraries are asked for: they are compiled in only then.
    fn asks_for_peers(&self) -> bool {
        self.arguments.iter().any(|argument| argument == "--peers")
    }
}

/// Runs the benchmark program and gives its exit code.
pub(crate) fn run(workspace: &Workspace, arguments: &Arguments) -> anyhow::Result<ExitCode> {
    let mut command = workspace.cargo();
    let peers = arguments
        .asks_for_peers()
        .then(|| BenchSettings::new(workspace));
    complete(&mut command, arguments, peers.as_ref());
    let status = command.status().context("cannot start cargo")?;
    Ok(match status.code().map(u8::try_from) {
        Some(Ok(code)) => ExitCode::from(code),
        // Ended by a signal, or with a code that no exit code here can express.
        _ => ExitCode::FAILURE,
    })
}

fn complete(command: &mut Command, arguments: &Arguments, peers: Option<&BenchSettings>) {
    command.args(["run", "--release", "--package", "tahko-bench"]);
    if let Some(peers) = peers {
        command
            .args(["--features", "peers", "--target-dir"])
            .arg(&peers.target)
            .env("RUSTFLAGS", &peers.rust_flags);
        if let Some(embree) = &peers.embree {
            command.env("EMBREE_LIB", embree);
        }
    }
    command.arg("--").args(&arguments.arguments);
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;

    /// The arguments and the environment of the command for some arguments of the benchmark.
    fn completed(arguments: &[&str], peers: Option<&BenchSettings>) -> (String, String) {
        let arguments = Arguments {
            arguments: arguments.iter().map(OsString::from).collect(),
        };
        let mut command = Command::new("cargo");
        complete(&mut command, &arguments, peers);
        let words: Vec<_> = command
            .get_args()
            .map(|word| word.to_string_lossy())
            .collect();
        let environment = command.get_envs().map(|(name, value)| {
            let value = value.unwrap_or_default();
            format!("{}={}", name.display(), value.display())
        });
        (words.join(" "), environment.collect::<Vec<_>>().join(", "))
    }

    #[test]
    fn peers_are_asked_for_by_the_word_itself() {
        let asks = |words: &[&str]| {
            let arguments = words.iter().map(OsString::from).collect();
            Arguments { arguments }.asks_for_peers()
        };
        assert!(asks(&["--quick", "--peers"]), "at any place");
        assert!(!asks(&["--quick", "--peers-only", "peers"]), "other words");
    }

    #[test]
    fn a_run_without_peers_uses_the_normal_build() {
        let (words, environment) = completed(&["--quick"], None);
        assert_eq!(words, "run --release --package tahko-bench -- --quick");
        assert_eq!(environment, "");
    }

    #[test]
    fn a_run_with_peers_has_a_build_of_its_own() {
        let peers = BenchSettings {
            target: PathBuf::from("t/native"),
            rust_flags: "-C target-cpu=native".to_owned(),
            embree: Some(PathBuf::from("libembree4.so")),
        };
        let (words, environment) = completed(&["--peers", "--quick"], Some(&peers));
        assert_eq!(
            words,
            "run --release --package tahko-bench --features peers --target-dir t/native -- --peers --quick"
        );
        assert_eq!(
            environment,
            "EMBREE_LIB=libembree4.so, RUSTFLAGS=-C target-cpu=native"
        );
    }

    #[test]
    fn a_library_that_the_user_names_is_left_alone() {
        let peers = BenchSettings {
            target: PathBuf::from("t/native"),
            rust_flags: "-C target-cpu=native".to_owned(),
            embree: None,
        };
        let (_, environment) = completed(&["--peers"], Some(&peers));
        assert_eq!(environment, "RUSTFLAGS=-C target-cpu=native");
    }
}
