//! Rendering a scene in all ways that must agree.

use std::fmt::{self, Display};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::Context;

use super::compare;
use super::scenes::Scene;
use crate::workspace::Workspace;

const STRUCTURES: [&str; 4] = ["brute", "bsp", "kdtree", "bvh"];
const WIDTH: &str = "160";
const HEIGHT: &str = "120";
/// It contains the other integrator, `direct`.
const INTEGRATOR: &str = "whitted";

/// How exactly a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Precision {
    Fast,
    Watertight,
    Exact,
}

/// One way to render a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Case {
    pub(super) structure: &'static str,
    pub(super) precision: Precision,
    pub(super) threads: usize,
}

/// What came of it.
#[derive(Debug)]
pub(super) struct Rendered {
    pub(super) case: Case,
    pub(super) file: PathBuf,
    /// The bytes of the PNG file, or why there is none.
    pub(super) png: Result<Vec<u8>, String>,
}

/// The built `tahko` program.
#[derive(Debug)]
pub(super) struct Program {
    path: PathBuf,
}

impl Precision {
    pub(super) const ALL: [Self; 3] = [Self::Fast, Self::Watertight, Self::Exact];

    /// The one whose picture is the golden image.
    pub(super) const GOLDEN: Self = Self::Exact;

    fn name(self) -> &'static str {
        match self {
            Self::Fast => "fast",
            Self::Watertight => "watertight",
            Self::Exact => "exact",
        }
    }
}

impl Case {
    /// Every structure at every precision: trees at the golden one on one thread and on `all_threads`, at the others, whose threads divide the same work, on one
    /// or the other in turn. The first of a precision is brute force, the reference for the others: on all threads, as it takes nearly all of the time.
    pub(super) fn all(all_threads: usize) -> Vec<Self> {
        let mut cases = Vec::new();
        for precision in Precision::ALL {
            for (index, structure) in STRUCTURES.into_iter().enumerate() {
                let both = [1, all_threads];
                let threads = match (structure, precision) {
                    ("brute", _) => &both[1..],
                    (_, Precision::GOLDEN) => &both[..],
                    _ => &both[index % 2..][..1],
                };
                cases.extend(threads.iter().map(|threads| Self {
                    structure,
                    precision,
                    threads: *threads,
                }));
            }
        }
        cases
    }

    /// The name of its files, without ending.
    pub(super) fn file_name(&self) -> String {
        let (structure, precision) = (self.structure, self.precision.name());
        format!("{precision}-{structure}-{}", self.threads)
    }
}

impl Display for Case {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (structure, precision) = (self.structure, self.precision.name());
        let threads = self.threads;
        write!(formatter, "{structure} {precision} (--threads {threads})")
    }
}

impl Program {
    pub(super) fn build(workspace: &Workspace) -> anyhow::Result<Self> {
        let mut build = workspace.cargo();
        build.args([
            "build",
            "--release",
            "--package",
            "tahko-cli",
            "--bin",
            "tahko",
        ]);
        let path = Workspace::build_program(&mut build, "tahko");
        path.map(|path| Self { path })
            .context("building the program that renders")
    }

    /// Renders into a file of the folder.
    pub(super) fn render(
        &self,
        workspace: &Workspace,
        scene: &Scene,
        case: &Case,
        folder: &Path,
    ) -> Rendered {
        let file = folder.join(format!("{}.png", case.file_name()));
        let mut command = Command::new(&self.path);
        command
            .current_dir(&workspace.root)
            .stdin(Stdio::null())
            // A panic is one line among the messages; who looks for its cause repeats the case alone.
            .env("RUST_BACKTRACE", "0")
            .args(["render", &scene.file, "-o"])
            .arg(&file)
            .args(["--accel", case.structure])
            .args(["--precision", case.precision.name()])
            .args(["--width", WIDTH, "--height", HEIGHT])
            .args(["--threads", &case.threads.to_string()])
            .args(["--integrator", INTEGRATOR]);
        let png = succeed(&mut command).and_then(|()| read_picture(&file));
        Rendered {
            case: *case,
            file,
            png,
        }
    }
}

fn read_picture(file: &Path) -> Result<Vec<u8>, String> {
    let png =
        fs::read(file).map_err(|error| format!("wrote no picture {}: {error}", file.display()))?;
    compare::decode(&png).map_err(|error| format!("{}: {error:#}", file.display()))?;
    Ok(png)
}

/// Runs a command; if it fails, gives its messages.
fn succeed(command: &mut Command) -> Result<(), String> {
    let output = command
        .output()
        .map_err(|error| format!("cannot start {:?}: {error}", command.get_program()))?;
    if output.status.success() {
        return Ok(());
    }
    let messages = String::from_utf8_lossy(&output.stderr);
    let messages = messages.trim();
    Err(format!("ended with {}: {messages}", output.status))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cases_are_all_combinations_and_files_do_not_collide() {
        let cases = Case::all(8);
        assert_eq!(cases.len(), 15);
        let mut names: Vec<String> = cases.iter().map(Case::file_name).collect();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), 15);
        assert_eq!(names[0], "exact-brute-8");
    }

    #[test]
    fn a_file_that_is_not_a_picture_is_refused_with_its_name() {
        let error = read_picture(Path::new("Cargo.toml")).unwrap_err();
        assert!(error.starts_with("Cargo.toml: not a PNG"), "{error}");
        let error = read_picture(Path::new("no-such.png")).unwrap_err();
        assert!(error.contains("wrote no picture no-such.png"), "{error}");
    }

    #[test]
    fn a_failing_program_is_reported_with_its_messages() {
        let messages = succeed(Command::new("cargo").arg("no-such-command")).unwrap_err();
        assert!(messages.contains("no-such-command"), "{messages}");
        let absent = succeed(&mut Command::new("no-such-program")).unwrap_err();
        assert!(absent.contains("cannot start"), "{absent}");
    }
}
