//! The workspace as cargo and git describe it.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, bail};
use serde_json::Value;

/// The packages of the workspace and its folders.
#[derive(Debug)]
pub(crate) struct Workspace {
    /// The folder of the root manifest.
    pub(crate) root: PathBuf,
    /// Where cargo puts what it builds.
    pub(crate) target: PathBuf,
    pub(crate) packages: Vec<Package>,
}

/// A member of the workspace. Paths are relative to the workspace, with forward slashes.
#[derive(Debug, Default)]
pub(crate) struct Package {
    pub(crate) name: String,
    pub(crate) manifest: String,
    pub(crate) dependencies: Vec<Dependency>,
    /// The root files of its library and programs.
    pub(crate) crate_roots: Vec<String>,
}

#[derive(Debug)]
pub(crate) struct Dependency {
    pub(crate) name: String,
    /// Only for tests, examples and benches.
    pub(crate) is_dev: bool,
}

impl Workspace {
    /// The workspace of the current folder.
    pub(crate) fn load() -> anyhow::Result<Self> {
        let mut command = Command::new("cargo");
        command.args(["metadata", "--no-deps", "--format-version", "1"]);
        Self::from_metadata(&output_of(&mut command)?)
            .context("unexpected output of `cargo metadata`")
    }

    fn from_metadata(metadata: &str) -> anyhow::Result<Self> {
        let metadata: Value = serde_json::from_str(metadata)?;
        let root = PathBuf::from(text(&metadata, "workspace_root")?);
        let packages = list(&metadata, "packages")?
            .iter()
            .map(|package| Package::from_metadata(package, &root))
            .collect::<anyhow::Result<_>>()?;
        let target = PathBuf::from(text(&metadata, "target_directory")?);
        Ok(Self {
            root,
            target,
            packages,
        })
    }

    /// A cargo command in the workspace's root.
    pub(crate) fn cargo(&self) -> Command {
        let mut command = Command::new("cargo");
        command.current_dir(&self.root);
        command
    }

    /// The files that git tracks or would track, which exist: sorted, relative, with forward slashes.
    pub(crate) fn files(&self) -> anyhow::Result<Vec<String>> {
        let mut command = Command::new("git");
        command.current_dir(&self.root).args([
            "ls-files",
            "-z",
            "--cached",
            "--others",
            "--exclude-standard",
        ]);
        let mut files: Vec<String> = output_of(&mut command)?
            .split_terminator('\0')
            .filter(|file| self.root.join(file).is_file())
            .map(String::from)
            .collect();
        files.sort();
        files.dedup();
        Ok(files)
    }

    /// Runs a `cargo build` and gives the path of the program that it makes.
    pub(crate) fn build_program(build: &mut Command, program: &str) -> anyhow::Result<PathBuf> {
        build
            .arg("--message-format=json-render-diagnostics")
            .stderr(std::process::Stdio::inherit());
        executable(&output_of(build)?, program)
            .with_context(|| format!("cargo named no executable for the program {program}"))
    }
}

impl Package {
    fn from_metadata(package: &Value, root: &Path) -> anyhow::Result<Self> {
        let relative = |path: &str| {
            let path = Path::new(path);
            let path = path.strip_prefix(root).unwrap_or(path);
            path.to_string_lossy().replace('\\', "/")
        };
        let dependencies = list(package, "dependencies")?
            .iter()
            .map(|dependency| {
                Ok(Dependency {
                    name: text(dependency, "name")?.to_owned(),
                    is_dev: dependency["kind"] == "dev",
                })
            })
            .collect::<anyhow::Result<_>>()?;
        let is_root = |target: &&Value| {
            let kinds = target["kind"].as_array();
            kinds.is_some_and(|kinds| kinds.iter().any(|kind| kind == "lib" || kind == "bin"))
        };
        let crate_roots = list(package, "targets")?
            .iter()
            .filter(is_root)
            .map(|target| text(target, "src_path").map(relative))
            .collect::<anyhow::Result<_>>()?;
        Ok(Self {
            name: text(package, "name")?.to_owned(),
            manifest: relative(text(package, "manifest_path")?),
            dependencies,
            crate_roots,
        })
    }
}

/// The standard output of a command that must succeed.
fn output_of(command: &mut Command) -> anyhow::Result<String> {
    let program = command.get_program().to_string_lossy().into_owned();
    let output = command
        .output()
        .with_context(|| format!("cannot start {program}"))?;
    if !output.status.success() {
        let messages = String::from_utf8_lossy(&output.stderr);
        bail!(
            "{command:?} failed ({})\n{}",
            output.status,
            messages.trim()
        );
    }
    String::from_utf8(output.stdout).with_context(|| format!("output of {program} is not UTF-8"))
}

/// The path of a program in the messages of `cargo build`.
fn executable(messages: &str, program: &str) -> Option<PathBuf> {
    let messages = messages
        .lines()
        .filter_map(|line| serde_json::from_str::<Value>(line).ok());
    let mut artifacts = messages.filter(|message| message["target"]["name"] == program);
    artifacts.find_map(|message| message["executable"].as_str().map(PathBuf::from))
}

fn text<'a>(value: &'a Value, key: &str) -> anyhow::Result<&'a str> {
    value[key]
        .as_str()
        .with_context(|| format!("no text `{key}`"))
}

fn list<'a>(value: &'a Value, key: &str) -> anyhow::Result<&'a Vec<Value>> {
    value[key]
        .as_array()
        .with_context(|| format!("no list `{key}`"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packages_are_read_from_the_metadata() {
        let metadata = r#"{"workspace_root": "/w", "target_directory": "/t", "packages": [{
            "name": "a", "manifest_path": "/w/crates/a/Cargo.toml",
            "dependencies": [{"name": "b", "kind": null}, {"name": "c", "kind": "dev"}],
            "targets": [{"kind": ["lib"], "src_path": "/w/crates/a/src/lib.rs"},
                        {"kind": ["test"], "src_path": "/w/crates/a/tests/t.rs"}]}]}"#;
        let workspace = Workspace::from_metadata(metadata).unwrap();
        let package = &workspace.packages[0];
        assert_eq!(package.manifest, "crates/a/Cargo.toml");
        assert_eq!(package.crate_roots, ["crates/a/src/lib.rs"]);
        let dev: Vec<bool> = package.dependencies.iter().map(|d| d.is_dev).collect();
        assert_eq!(dev, [false, true]);
    }

    #[test]
    fn metadata_without_packages_is_an_error_that_says_so() {
        let error = Workspace::from_metadata(r#"{"workspace_root": "/w"}"#).unwrap_err();
        assert_eq!(error.to_string(), "no list `packages`");
    }

    #[test]
    fn the_executable_is_the_one_of_the_program() {
        let messages = r#"{"target": {"name": "tahko_bvh"}, "executable": null}
{"target": {"name": "tahko"}, "executable": "/t/release/tahko"}
{"reason": "build-finished", "success": true}"#;
        let expected = PathBuf::from("/t/release/tahko");
        assert_eq!(executable(messages, "tahko"), Some(expected));
        assert_eq!(executable(messages, "other"), None);
    }
}
