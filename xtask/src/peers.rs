//! `cargo xtask peers`: Embree for the benchmark's comparison with other libraries.
//!
//! The other libraries are Rust packages behind a feature. Embree is a large C++ project with its own build, so a built one comes from the
//! Python package index, into a virtual environment in the target folder.

use std::env;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};

use anyhow::{Context, bail};

use crate::workspace::Workspace;

/// The Python package that brings the library; it has builds for Linux, macOS and Windows.
const PACKAGE: &str = "embreex==4.4.0.post1";

/// Notes the library's path in the folder; the benchmark program reads it too.
const NOTE: &str = "embree-library.txt";

/// Installs Embree, unless it is there, and prints the path of the library.
pub(crate) fn run(workspace: &Workspace) -> anyhow::Result<()> {
    let library = match installed(workspace) {
        Some(library) => library,
        None => install(&folder(workspace))?,
    };
    println!("{}", library.display());
    Ok(())
}

/// The library, if it was installed before.
pub(crate) fn installed(workspace: &Workspace) -> Option<PathBuf> {
    noted(&folder(workspace))
}

fn folder(workspace: &Workspace) -> PathBuf {
    workspace.target.join("peers")
}

fn noted(folder: &Path) -> Option<PathBuf> {
    let note = fs::read_to_string(folder.join(NOTE)).ok()?;
    let library = PathBuf::from(note.trim());
    library.is_file().then_some(library)
}

fn install(folder: &Path) -> anyhow::Result<PathBuf> {
    let environment = folder.join("python");
    eprintln!("installing {PACKAGE} in {} ...", environment.display());
    make_environment(&environment)?;
    let mut pip = Command::new(python_in(&environment));
    pip.args([
        "-m",
        "pip",
        "install",
        "--quiet",
        "--disable-pip-version-check",
    ])
    .arg(PACKAGE);
    let installed = status_of(&mut pip).context("cannot start pip")?;
    if !installed.success() {
        bail!(
            "pip cannot install {PACKAGE} ({installed}); it needs the network, and a system for which the package is built. \
             EMBREE_LIB=FILE names another Embree 4"
        );
    }
    let library = find_library(&environment)
        .with_context(|| format!("searching {}", environment.display()))?
        .with_context(|| format!("{PACKAGE} brings no library of Embree 4"))?;
    let note = folder.join(NOTE);
    let text = format!("{}\n", library.display());
    fs::write(&note, text).with_context(|| format!("writing {}", note.display()))?;
    Ok(library)
}

fn make_environment(environment: &Path) -> anyhow::Result<()> {
    // `--clear` replaces what an interrupted run may have left.
    let mut venv = Command::new(PYTHON);
    venv.args(["-m", "venv", "--clear"]).arg(environment);
    let made = match status_of(&mut venv) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            bail!(
                "there is no {PYTHON}: install Python 3, or name an Embree 4 with EMBREE_LIB=FILE"
            )
        }
        made => made.with_context(|| format!("cannot start {PYTHON}"))?,
    };
    if !made.success() {
        bail!(
            "{PYTHON} makes no virtual environment ({made}); some systems have its module `venv` in a package of its own"
        );
    }
    Ok(())
}

const PYTHON: &str = if cfg!(windows) { "python" } else { "python3" };

fn python_in(environment: &Path) -> PathBuf {
    environment.join(if cfg!(windows) {
        "Scripts/python.exe"
    } else {
        "bin/python"
    })
}

/// Runs a command whose output is for people: stdout has only the path.
fn status_of(command: &mut Command) -> io::Result<ExitStatus> {
    let output = command
        .stdout(Stdio::piped())
        .stderr(Stdio::inherit())
        .output()?;
    eprint!("{}", String::from_utf8_lossy(&output.stdout));
    Ok(output.status)
}

/// The file of Embree 4 below a folder: wheels put it into folders with the names of their packers.
fn find_library(folder: &Path) -> io::Result<Option<PathBuf>> {
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder)? {
            let entry = entry?;
            let kind = entry.file_type()?;
            if kind.is_dir() {
                folders.push(entry.path());
            } else if kind.is_file() && is_library(&entry.file_name().to_string_lossy()) {
                return Ok(Some(entry.path()));
            }
        }
    }
    Ok(None)
}

fn is_library(name: &str) -> bool {
    let is_embree = name.trim_start_matches("lib").starts_with("embree4");
    is_embree
        && [".so", ".dylib", ".dll"]
            .iter()
            .any(|ending| name.contains(ending))
}

/// What a run of the benchmark with other libraries needs beyond one without.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct BenchSettings {
    /// A folder of its own, so that the other flags do not make the normal build start over.
    pub(crate) target: PathBuf,
    /// Peers choose their instruction set when they are compiled.
    pub(crate) rust_flags: String,
    /// The value for `EMBREE_LIB`, if the user has not set it.
    pub(crate) embree: Option<PathBuf>,
}

impl BenchSettings {
    pub(crate) fn new(workspace: &Workspace) -> Self {
        let user_flags = env::var("RUSTFLAGS").unwrap_or_default();
        let embree = match env::var_os("EMBREE_LIB") {
            Some(_) => None,
            None => installed(workspace),
        };
        Self {
            target: workspace.target.join("native"),
            rust_flags: with_native_processor(&user_flags),
            embree,
        }
    }
}

fn with_native_processor(flags: &str) -> String {
    format!("{flags} -C target-cpu=native")
        .trim_start()
        .to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn libraries_are_known_by_their_names() {
        for name in [
            "libembree4-4aef3270.so.4",
            "libembree4.4.dylib",
            "embree4.dll",
        ] {
            assert!(is_library(name), "{name}");
        }
        for name in ["libtbb.so.12", "libembree3.so", "embree4.lib", "embree4.py"] {
            assert!(!is_library(name), "{name}");
        }
    }

    #[test]
    fn the_library_is_found_in_a_folder_below() {
        let folder = tempfile::tempdir().unwrap();
        let below = folder.path().join("lib/embreex.libs");
        fs::create_dir_all(&below).unwrap();
        fs::write(below.join("libtbb.so.12"), "").unwrap();
        assert_eq!(find_library(folder.path()).unwrap(), None);
        let library = below.join("libembree4-0.so.4");
        fs::write(&library, "").unwrap();
        assert_eq!(find_library(folder.path()).unwrap(), Some(library));
    }

    #[test]
    fn a_note_of_a_file_that_is_gone_counts_for_nothing() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(noted(folder.path()), None);
        let library = folder.path().join("libembree4.so");
        fs::write(folder.path().join(NOTE), format!("{}\n", library.display())).unwrap();
        assert_eq!(noted(folder.path()), None);
        fs::write(&library, "").unwrap();
        assert_eq!(noted(folder.path()), Some(library));
    }

    #[test]
    fn flags_of_the_user_are_kept() {
        assert_eq!(with_native_processor(""), "-C target-cpu=native");
        let flags = with_native_processor("-C debuginfo=2");
        assert_eq!(flags, "-C debuginfo=2 -C target-cpu=native");
    }
}
