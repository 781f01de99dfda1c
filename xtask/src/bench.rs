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
    let peers = arguments
        .asks_for_peers()
        .then(|| BenchSettings::new(workspace));
    let mut build = workspace.cargo();
    complete_build(&mut build, peers.as_ref());
    let program = Workspace::build_program(&mut build, "tahko-bench")
        .context("building the benchmark program")?;
    let mut command = Command::new(program);
    command.current_dir(&workspace.root);
    complete_run(&mut command, arguments, peers.as_ref());
    let status = command.status().context("cannot start the program")?;
    Ok(match status.code().map(u8::try_from) {
        Some(Ok(code)) => ExitCode::from(code),
        // Ended by a signal, or with a code that no exit code here can express.
        _ => ExitCode::FAILURE,
    })
}

fn complete_build(build: &mut Command, peers: Option<&BenchSettings>) {
    build.args(["build", "--release", "--bin", "tahko-bench"]);
    // Cargo chooses the features of dependencies for all packages of a command together: with the command line program's, the libraries below both programs are the ones that
    // its own build made.
    build.args(["--package", "tahko-bench", "--package", "tahko-cli"]);
    if let Some(peers) = peers {
        build
            .args(["--features", "tahko-bench/peers", "--target-dir"])
            .arg(&peers.target)
            .env("RUSTFLAGS", &peers.rust_flags);
    }
}

fn complete_run(run: &mut Command, arguments: &Arguments, peers: Option<&BenchSettings>) {
    run.args(&arguments.arguments);
    if let Some(embree) = peers.and_then(|peers| peers.embree.as_ref()) {
        run.env("EMBREE_LIB", embree);
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;

    /// The arguments and the environment of the build and of the run, for some arguments of the benchmark.
    fn completed(arguments: &[&str], peers: Option<&BenchSettings>) -> [(String, String); 2] {
        let arguments = Arguments {
            arguments: arguments.iter().map(OsString::from).collect(),
        };
        let [mut build, mut run] = ["cargo", "tahko-bench"].map(Command::new);
        complete_build(&mut build, peers);
        complete_run(&mut run, &arguments, peers);
        [build, run].map(|command| {
            let words: Vec<_> = command
                .get_args()
                .map(|word| word.to_string_lossy())
                .collect();
            let environment = command.get_envs().map(|(name, value)| {
                let value = value.unwrap_or_default();
                format!("{}={}", name.display(), value.display())
            });
            (words.join(" "), environment.collect::<Vec<_>>().join(", "))
        })
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

    const NORMAL: &str =
        "build --release --bin tahko-bench --package tahko-bench --package tahko-cli";

    fn with_peers(embree: Option<PathBuf>) -> BenchSettings {
        BenchSettings {
            target: PathBuf::from("t/native"),
            rust_flags: "-C target-cpu=native".to_owned(),
            embree,
        }
    }

    #[test]
    fn a_run_without_peers_uses_the_normal_build() {
        let [(words, build), (arguments, run)] = completed(&["--quick"], None);
        assert_eq!(words, NORMAL);
        assert_eq!(arguments, "--quick");
        assert_eq!([build, run], ["", ""]);
    }

    #[test]
    fn a_run_with_peers_has_a_build_of_its_own() {
        let peers = with_peers(Some(PathBuf::from("libembree4.so")));
        let [(words, build), (arguments, run)] = completed(&["--peers", "--quick"], Some(&peers));
        assert_eq!(
            words,
            format!("{NORMAL} --features tahko-bench/peers --target-dir t/native")
        );
        assert_eq!(build, "RUSTFLAGS=-C target-cpu=native");
        assert_eq!(arguments, "--peers --quick");
        assert_eq!(run, "EMBREE_LIB=libembree4.so");
    }

    #[test]
    fn a_library_that_the_user_names_is_left_alone() {
        let [_, (_, run)] = completed(&["--peers"], Some(&with_peers(None)));
        assert_eq!(run, "");
    }
}
