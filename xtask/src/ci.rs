//! `cargo xtask ci`: all checks in the order in which they are likely to fail fast.
//!
//! The minimum Rust version is not built here: with a newer toolchain than `rust-version` nothing more can
//! be done than clippy's `incompatible_msrv`, which is on by default and runs with the others; it knows the
//! standard library's version numbers but not the language's.

use std::fmt::{self, Display};
use std::fs;
use std::process::Command;
use std::time::Instant;

use anyhow::Context;
use clap::builder::PossibleValuesParser;

use crate::table;
use crate::workspace::Workspace;

/// The two commands on the README's first screen. They run here as they stand there.
pub(crate) const README_COMMANDS: [&str; 2] = [
    "cargo run --release -- render scenes/cornell.ron -o cornell.png",
    "cargo test --workspace",
];

/// The steps in their order.
pub(crate) const STEPS: &[Step] = &[
    Step::new("fmt", "cargo fmt --all -- --check"),
    Step::new(
        "clippy",
        "cargo clippy --workspace --all-targets -- -D warnings",
    ),
    Step::new(
        "clippy-sequential",
        "cargo clippy -p tahko-geometry -p tahko-bsp -p tahko-kdtree -p tahko-bvh \
         --no-default-features --all-targets -- -D warnings",
    ),
    Step::new("tidy", "cargo xtask tidy"),
    Step {
        product: Some("cornell.png"),
        ..Step::new("readme", README_COMMANDS[0])
    },
    Step::new("test", README_COMMANDS[1]),
    Step {
        environment: Some(("RUSTDOCFLAGS", "-D warnings")),
        ..Step::new("doc", "cargo doc --workspace --no-deps")
    },
    Step::new("examples", "cargo build --workspace --examples"),
    Step::new("golden", "cargo xtask golden"),
    Step::new("bench", "cargo xtask bench --smoke"),
    // Each criterion bench once, without timing, in the profile of the tests. For one package alone cargo would choose other features, and compile nearly all again.
    Step::new("criterion", "cargo test --workspace --bench=*"),
];

/// A command that must succeed.
#[derive(Debug)]
pub(crate) struct Step {
    name: &'static str,
    /// Words separated by spaces; none contains one.
    pub(crate) command: &'static str,
    environment: Option<(&'static str, &'static str)>,
    /// A file in the workspace's root that the command must write; it is removed afterwards.
    product: Option<&'static str>,
}

#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Begin at this step
    #[arg(long, value_name = "STEP", value_parser = names())]
    from: Option<String>,
    /// Run this step alone
    #[arg(long, value_name = "STEP", value_parser = names(), conflicts_with = "from")]
    only: Option<String>,
}

fn names() -> PossibleValuesParser {
    PossibleValuesParser::new(STEPS.iter().map(|step| step.name))
}

/// Runs the steps up to the first failure, prints the time of each, and says whether all passed.
pub(crate) fn run(workspace: &Workspace, arguments: &Arguments) -> anyhow::Result<bool> {
    let steps = selected(arguments);
    let mut rows = vec![["step", "seconds", "result"].map(String::from)];
    let mut failed = None;
    for step in steps {
        if failed.is_some() {
            rows.push([step.name, "", "not run"].map(String::from));
            continue;
        }
        eprintln!("\n$ {step}");
        let start = Instant::now();
        let result = step.run(workspace);
        let seconds = format!("{:.1}", start.elapsed().as_secs_f64());
        eprintln!("{}: {seconds} s", step.name);
        let verdict = if result.is_ok() { "ok" } else { "failed" };
        rows.push([step.name.into(), seconds, verdict.into()]);
        failed = result.err().map(|error| (step, error));
    }
    println!("\n{}", table::render(&rows).trim_end());
    if let Some((step, error)) = &failed {
        eprintln!("ci failed at step `{}`: {error:#}", step.name);
        eprintln!("repeat it with: cargo xtask ci --only {}", step.name);
    }
    Ok(failed.is_none())
}

fn selected(arguments: &Arguments) -> Vec<&'static Step> {
    let before = |step: &&Step| matches!(&arguments.from, Some(from) if from != step.name);
    let wanted = |step: &&Step| !matches!(&arguments.only, Some(only) if only != step.name);
    let steps = STEPS.iter().skip_while(before);
    steps.filter(wanted).collect()
}

impl Step {
    const fn new(name: &'static str, command: &'static str) -> Self {
        Self {
            name,
            command,
            environment: None,
            product: None,
        }
    }

    fn run(&self, workspace: &Workspace) -> anyhow::Result<()> {
        let product = self.product.map(|product| workspace.root.join(product));
        if let Some(product) = product.as_ref().filter(|product| product.exists()) {
            // Otherwise a file from before would pass for this command's work.
            fs::remove_file(product).with_context(|| format!("cannot remove {product:?}"))?;
        }
        let mut words = self.command.split_whitespace();
        let program = words.next().context("the step has no command")?;
        let status = Command::new(program)
            .args(words)
            .envs(self.environment)
            .current_dir(&workspace.root)
            .status()
            .with_context(|| format!("cannot start {program}"))?;
        anyhow::ensure!(status.success(), "`{self}` ended with {status}");
        if let Some(product) = product {
            let size = fs::metadata(&product).map_or(0, |metadata| metadata.len());
            anyhow::ensure!(size > 0, "`{self}` did not write {product:?}");
            fs::remove_file(&product).with_context(|| format!("cannot remove {product:?}"))?;
        }
        Ok(())
    }
}

impl Display for Step {
    /// The line to type in a shell.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some((variable, value)) = self.environment {
            write!(formatter, "{variable}='{value}' ")?;
        }
        formatter.write_str(self.command)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names_of(from: Option<&str>, only: Option<&str>) -> Vec<&'static str> {
        let arguments = Arguments {
            from: from.map(String::from),
            only: only.map(String::from),
        };
        let steps = selected(&arguments);
        steps.iter().map(|step| step.name).collect()
    }

    #[test]
    fn step_names_are_unique() {
        let mut names = names_of(None, None);
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), STEPS.len());
    }

    #[test]
    fn from_leaves_out_the_steps_before_and_only_all_others() {
        assert_eq!(
            names_of(Some("golden"), None),
            ["golden", "bench", "criterion"]
        );
        assert_eq!(names_of(None, Some("tidy")), ["tidy"]);
    }

    #[test]
    fn a_step_is_shown_as_typed() {
        let doc = STEPS.iter().find(|step| step.name == "doc").unwrap();
        assert_eq!(
            doc.to_string(),
            "RUSTDOCFLAGS='-D warnings' cargo doc --workspace --no-deps"
        );
    }

    #[test]
    fn a_step_fails_with_its_command_and_without_its_product() {
        let workspace = Workspace {
            root: std::env::temp_dir(),
            target: std::env::temp_dir(),
            packages: Vec::new(),
        };
        // This git command says nothing, and its exit code tells whether a name is well formed.
        const GOOD: &str = "git check-ref-format a/b";
        const BAD: &str = "git check-ref-format a..b";
        assert!(
            Step::new("good", GOOD).run(&workspace).is_ok(),
            "a good name"
        );
        let error_of = |step: Step| step.run(&workspace).unwrap_err().to_string();
        let bad = error_of(Step::new("bad", BAD));
        assert!(
            bad.starts_with("`git check-ref-format a..b` ended"),
            "{bad}"
        );
        let missing = error_of(Step {
            product: Some("no-such-product.png"),
            ..Step::new("missing", GOOD)
        });
        assert!(missing.contains("did not write"), "{missing}");
    }
}
