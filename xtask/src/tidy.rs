//! `cargo xtask tidy`: the repository's own rules, as far as a machine can check them.
//!
//! A rule is a function that takes texts and gives findings, so that each has a test with small strings.

mod code;
mod files;
mod manifests;
mod project;
mod rust;

use std::fmt::{self, Display};
use std::fs;

use anyhow::Context;

use crate::workspace::Workspace;
use code::RustFile;

/// A place where a rule is broken.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Finding {
    file: String,
    /// Counted from one; the first line where the whole file is meant.
    line: usize,
    message: String,
}

impl Finding {
    fn new(file: &str, line: usize, message: impl Into<String>) -> Self {
        Self {
            file: file.to_owned(),
            line,
            message: message.into(),
        }
    }
}

impl Display for Finding {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            file,
            line,
            message,
        } = self;
        write!(formatter, "{file}:{line}: {message}")
    }
}

/// Prints every finding and says whether there is none.
pub(crate) fn run(workspace: &Workspace) -> anyhow::Result<bool> {
    let files = workspace.files()?;
    let mut findings = Vec::new();
    for package in &workspace.packages {
        let text = read(workspace, &package.manifest)?;
        findings.extend(manifests::dependency_edges(workspace, package, &text));
        findings.extend(manifests::inheritance(&package.manifest, &text));
    }
    for file in &files {
        let bytes =
            fs::read(workspace.root.join(file)).with_context(|| format!("reading {file}"))?;
        findings.extend(files::size(file, bytes.len()));
        if !files::is_text(file) {
            continue;
        }
        let Ok(text) = String::from_utf8(bytes) else {
            findings.push(Finding::new(file, 1, "not UTF-8"));
            continue;
        };
        findings.extend(files::white_space(file, &text));
        if file.ends_with(".rs") {
            findings.extend(files::length(file, &text));
            findings.extend(rust::all(&RustFile::new(file, &text)));
        }
    }
    findings.extend(forbidden_unsafe(workspace)?);
    findings.extend(project::all(workspace, &files)?);
    findings.sort();
    for finding in &findings {
        println!("{finding}");
    }
    let (files, findings) = (files.len(), findings.len());
    eprintln!("tidy: {files} files, {findings} findings");
    Ok(findings == 0)
}

fn forbidden_unsafe(workspace: &Workspace) -> anyhow::Result<Vec<Finding>> {
    let mut findings = Vec::new();
    let packages = workspace.packages.iter();
    let safe = packages.filter(|package| rust::SAFE_PACKAGES.contains(&package.name.as_str()));
    for root in safe.flat_map(|package| &package.crate_roots) {
        let text = read(workspace, root)?;
        findings.extend(rust::forbids_unsafe(&RustFile::new(root, &text)));
    }
    Ok(findings)
}

fn read(workspace: &Workspace, file: &str) -> anyhow::Result<String> {
    fs::read_to_string(workspace.root.join(file)).with_context(|| format!("reading {file}"))
}
