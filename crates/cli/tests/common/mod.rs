//! Runs the program in a folder of its own.

#![allow(dead_code, reason = "every test file uses a part of this")]
#![expect(
    clippy::unwrap_used,
    clippy::missing_assert_message,
    reason = "these are parts of tests"
)]

pub(crate) mod wait;

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

/// A folder for one test.
pub(crate) struct Sandbox {
    folder: TempDir,
}

/// What a run printed and how it ended.
pub(crate) struct Run {
    pub(crate) code: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Sandbox {
    pub(crate) fn new() -> Self {
        Self {
            folder: tempfile::tempdir().unwrap(),
        }
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, contents: impl AsRef<[u8]>) {
        fs::write(self.path(name), contents).unwrap();
    }

    pub(crate) fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    pub(crate) fn read_text(&self, name: &str) -> String {
        String::from_utf8(self.read(name)).unwrap()
    }

    /// The names of all files, sorted.
    pub(crate) fn files(&self) -> Vec<String> {
        let entries = self.folder.path().read_dir().unwrap();
        let name = |entry: std::io::Result<fs::DirEntry>| entry.unwrap().file_name();
        let mut names: Vec<_> = entries
            .map(|entry| name(entry).into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    /// The program, to be run in the folder.
    pub(crate) fn command(&self, line: &str) -> Command {
        let mut command = program();
        command
            .args(line.split_whitespace())
            .current_dir(self.folder.path());
        command
    }

    pub(crate) fn run(&self, line: &str) -> Run {
        Run::from(self.command(line).stdin(Stdio::null()).output().unwrap())
    }

    /// Runs with a text on standard input.
    pub(crate) fn run_with_input(&self, line: &str, input: &str) -> Run {
        let mut child = self
            .command(line)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        child
            .stdin
            .take()
            .unwrap()
            .write_all(input.as_bytes())
            .unwrap();
        Run::from(child.wait_with_output().unwrap())
    }
}

pub(crate) fn program() -> Command {
    Command::new(env!("CARGO_BIN_EXE_tahko"))
}

impl From<Output> for Run {
    fn from(output: Output) -> Self {
        Self {
            code: output.status.code(),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }
}

impl Run {
    /// Success, and nothing that belongs on a terminal only.
    pub(crate) fn succeeds(self) -> Self {
        assert_eq!(self.code, Some(0), "{}", self.stderr);
        self.assert_plain();
        self
    }

    /// Failure with one message that contains all of `parts`, and nothing on stdout.
    pub(crate) fn fails(self, code: i32, parts: &[&str]) -> Self {
        assert_eq!(self.code, Some(code), "{}", self.stderr);
        assert_eq!(self.stdout, "");
        assert!(!self.stderr.contains("panicked"), "{}", self.stderr);
        assert_eq!(self.stderr.matches("error:").count(), 1, "{}", self.stderr);
        for part in parts {
            assert!(
                self.stderr.contains(part),
                "'{part}' is not in: {}",
                self.stderr
            );
        }
        self.assert_plain();
        self
    }

    fn assert_plain(&self) {
        let is_plain = |character: char| character == '\n' || !character.is_control();
        assert!(self.stderr.chars().all(is_plain), "{:?}", self.stderr);
    }
}

/// A mesh as PLY text.
pub(crate) fn ply(vertices: &[[f32; 3]], triangles: &[[usize; 3]]) -> String {
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        vertices.len(),
        triangles.len()
    );
    for [x, y, z] in vertices {
        text += &format!("{x} {y} {z}\n");
    }
    for [a, b, c] in triangles {
        text += &format!("3 {a} {b} {c}\n");
    }
    text
}

/// Two right triangles with legs of length 1 at the origin: number 0 in the plane z = 0, number 1 in z = 2.
pub(crate) fn two_triangles() -> String {
    let at = |z: f32| [[0.0, 0.0, z], [1.0, 0.0, z], [0.0, 1.0, z]];
    ply(&[at(0.0), at(2.0)].concat(), &[[0, 1, 2], [3, 4, 5]])
}

/// A height field of `2 * side * side` triangles with hills.
pub(crate) fn hills(side: usize) -> String {
    let corners = side + 1;
    let height = |x: usize, y: usize| ((x * x + 3 * y) % 7) as f32 / 4.0;
    let vertices: Vec<_> = (0..corners * corners)
        .map(|index| (index % corners, index / corners))
        .map(|(x, y)| [x as f32, height(x, y), y as f32])
        .collect();
    let triangles: Vec<_> = (0..side * side)
        .map(|index| index / side * corners + index % side)
        .flat_map(|a| {
            [
                [a, a + corners, a + 1],
                [a + 1, a + corners, a + corners + 1],
            ]
        })
        .collect();
    ply(&vertices, &triangles)
}

/// The files below a folder with one of some extensions, sorted.
pub(crate) fn files_below(folder: &Path, extensions: &[&str]) -> Vec<PathBuf> {
    let mut files = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in folder.read_dir().unwrap() {
            let path = entry.unwrap().path();
            let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
            if path.is_dir() {
                folders.push(path);
            } else if extensions.iter().any(|wanted| extension == *wanted) {
                files.push(path);
            }
        }
    }
    files.sort();
    files
}
