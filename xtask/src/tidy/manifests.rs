//! Rules about the packages: who depends on whom, and what stands once in the root manifest.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::Finding;
use crate::workspace::{Package, Workspace};

/// The packages of the workspace that a package may depend on.
const EDGES: &[(&str, &[&str])] = &[
    ("tahko-geometry", &[]),
    ("tahko-bsp", &["tahko-geometry"]),
    ("tahko-kdtree", &["tahko-geometry"]),
    ("tahko-bvh", &["tahko-geometry"]),
    (
        "tahko-tracer",
        &["tahko-bvh", "tahko-kdtree", "tahko-bsp", "tahko-geometry"],
    ),
    ("tahko-cli", &["tahko-tracer", "tahko-bench"]),
    (
        "tahko-bench",
        &[
            "tahko-tracer",
            "tahko-bvh",
            "tahko-kdtree",
            "tahko-bsp",
            "tahko-geometry",
        ],
    ),
    ("xtask", &[]),
];

/// Values that every member takes from the root manifest.
const INHERITED: [&str; 4] = ["version", "edition", "rust-version", "license"];

/// Structures know nothing of each other, so that a user picks one and pulls in only geometry. Tests may use a
/// package's own test support and that of geometry.
pub(super) fn dependency_edges(
    workspace: &Workspace,
    package: &Package,
    text: &str,
) -> Vec<Finding> {
    let is_member = |name: &str| workspace.packages.iter().any(|other| other.name == name);
    let Some((_, allowed)) = EDGES.iter().find(|(name, _)| *name == package.name) else {
        let message = format!("{} is not in the list of edges in xtask", package.name);
        return vec![Finding::new(&package.manifest, 1, message)];
    };
    let forbidden = forbidden(package, allowed, is_member).into_iter();
    forbidden
        .map(|dependency| {
            let line = text.lines().position(|line| line.starts_with(dependency));
            let message = format!("{} may not depend on {dependency}", package.name);
            Finding::new(&package.manifest, line.map_or(1, |line| line + 1), message)
        })
        .collect()
}

fn forbidden<'a>(
    package: &'a Package,
    allowed: &[&str],
    is_member: impl Fn(&str) -> bool,
) -> Vec<&'a str> {
    let for_tests = [package.name.as_str(), "tahko-geometry"];
    let dependencies = package.dependencies.iter().filter(|dependency| {
        let name = dependency.name.as_str();
        let is_allowed =
            allowed.contains(&name) || (dependency.is_dev && for_tests.contains(&name));
        is_member(name) && !is_allowed
    });
    dependencies
        .map(|dependency| dependency.name.as_str())
        .collect()
}

/// Versions, lints and package data stand once, in the root manifest.
pub(super) fn inheritance(file: &str, text: &str) -> Vec<Finding> {
    let manifest = match DeTable::parse(text) {
        Ok(manifest) => manifest.into_inner(),
        Err(error) => {
            let line = error.span().map_or(1, |span| line_at(text, span.start));
            return vec![Finding::new(file, line, error.message())];
        }
    };
    let mut findings = Vec::new();
    let package = table(&manifest, "package");
    for key in INHERITED {
        let value = package.and_then(|package| package.get(key));
        if !value.is_some_and(is_inherited) {
            let line = value.map_or(1, |value| line_at(text, value.span().start));
            findings.push(Finding::new(
                file,
                line,
                format!("lacks `{key}.workspace = true`"),
            ));
        }
    }
    if !manifest.get("lints").is_some_and(is_inherited) {
        findings.push(Finding::new(
            file,
            1,
            "lacks `workspace = true` under [lints]",
        ));
    }
    for (name, dependency) in dependencies(&manifest) {
        if !is_inherited(dependency) && !is_own_package(dependency) {
            let line = line_at(text, dependency.span().start);
            let message = format!("{name}: the version stands in the root manifest only");
            findings.push(Finding::new(file, line, message));
        }
    }
    findings
}

fn dependencies<'a>(
    manifest: &'a DeTable<'_>,
) -> impl Iterator<Item = (&'a str, &'a Spanned<DeValue<'a>>)> {
    let targets = table(manifest, "target").into_iter();
    let targets = targets.flat_map(|targets| targets.values());
    let targets = targets.filter_map(|target| target.get_ref().as_table());
    std::iter::once(manifest)
        .chain(targets)
        .flat_map(|section| {
            ["dependencies", "dev-dependencies", "build-dependencies"]
                .map(|kind| table(section, kind))
        })
        .flatten()
        .flatten()
        .map(|(name, value)| (name.get_ref().as_ref(), value))
}

fn table<'a>(parent: &'a DeTable<'_>, key: &str) -> Option<&'a DeTable<'a>> {
    parent.get(key)?.get_ref().as_table()
}

fn is_inherited(value: &Spanned<DeValue<'_>>) -> bool {
    let inherited = value
        .get_ref()
        .as_table()
        .and_then(|table| table.get("workspace"));
    inherited.and_then(|value| value.get_ref().as_bool()) == Some(true)
}

/// A package that names itself, to test with its own features.
fn is_own_package(value: &Spanned<DeValue<'_>>) -> bool {
    let path = value
        .get_ref()
        .as_table()
        .and_then(|table| table.get("path"));
    path.and_then(|path| path.get_ref().as_str()) == Some(".")
}

fn line_at(text: &str, offset: usize) -> usize {
    let before = text.get(..offset).unwrap_or(text);
    1 + before.matches('\n').count()
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;
    use crate::workspace::Dependency;

    /// Packages with the names of their dependencies, those for tests marked by a star.
    fn workspace(packages: &[(&str, &[&str])]) -> Workspace {
        let dependency = |name: &&str| Dependency {
            name: name.trim_end_matches('*').to_owned(),
            is_dev: name.ends_with('*'),
        };
        let package = |(name, dependencies): &(&str, &[&str])| Package {
            name: (*name).to_owned(),
            manifest: format!("{name}/Cargo.toml"),
            dependencies: dependencies.iter().map(dependency).collect(),
            ..Package::default()
        };
        Workspace {
            root: PathBuf::new(),
            target: PathBuf::new(),
            packages: packages.iter().map(package).collect(),
        }
    }

    fn messages(packages: &[(&str, &[&str])]) -> Vec<String> {
        let workspace = workspace(packages);
        let packages = workspace.packages.iter();
        packages
            .flat_map(|package| dependency_edges(&workspace, package, ""))
            .map(|finding| finding.message)
            .collect()
    }

    #[test]
    fn a_forbidden_edge_is_found_at_its_line() {
        let workspace = workspace(&[("tahko-bsp", &["tahko-bvh"]), ("tahko-bvh", &[])]);
        let text = "[dependencies]\nglam.workspace = true\ntahko-bvh.workspace = true\n";
        let findings = dependency_edges(&workspace, &workspace.packages[0], text);
        assert_eq!(findings[0].line, 3);
    }

    #[test]
    fn the_edges_of_the_design_are_allowed() {
        let packages: [(&str, &[&str]); 4] = [
            ("tahko-geometry", &["glam", "tahko-geometry*"]),
            ("tahko-bsp", &["tahko-geometry", "tahko-geometry*"]),
            ("tahko-tracer", &["tahko-bsp", "tahko-geometry"]),
            ("tahko-cli", &["tahko-tracer", "tahko-bench"]),
        ];
        assert!(messages(&packages).is_empty(), "{:?}", messages(&packages));
    }

    #[test]
    fn other_edges_are_named() {
        let packages: [(&str, &[&str]); 4] = [
            ("tahko-geometry", &[]),
            ("tahko-bsp", &["tahko-bvh*"]),
            ("tahko-bvh", &[]),
            ("xtask", &["tahko-geometry"]),
        ];
        assert_eq!(
            messages(&packages),
            [
                "tahko-bsp may not depend on tahko-bvh",
                "xtask may not depend on tahko-geometry"
            ]
        );
    }

    #[test]
    fn a_new_package_must_be_entered_in_the_list() {
        let found = messages(&[("tahko-octree", &[])]);
        assert_eq!(found, ["tahko-octree is not in the list of edges in xtask"]);
    }

    const GOOD: &str = "[package]\nversion.workspace = true\nedition.workspace = true\n\
        rust-version.workspace = true\nlicense.workspace = true\n\
        [lints]\nworkspace = true\n[dependencies]\na.workspace = true\n";

    fn lines(text: &str) -> Vec<usize> {
        let findings = inheritance("Cargo.toml", text);
        findings.iter().map(|finding| finding.line).collect()
    }

    #[test]
    fn a_manifest_that_inherits_everything_is_fine() {
        let own = format!("{GOOD}[dev-dependencies]\nb = {{ path = \".\" }}\n");
        assert_eq!(inheritance("Cargo.toml", &own), []);
    }

    #[test]
    fn versions_outside_the_root_manifest_are_found() {
        let text = format!(
            "{GOOD}b = \"1\"\nc = {{ version = \"2\" }}\n\
             [target.'cfg(unix)'.dependencies]\nd = \"3\"\ne = {{ workspace = true }}\n"
        );
        assert_eq!(lines(&text), [10, 11, 13]);
    }

    #[test]
    fn data_that_is_not_inherited_is_found() {
        let edition = GOOD.replace("edition.workspace = true", "edition = \"2024\"");
        assert_eq!(lines(&edition), [3]);
        let lints = GOOD.replace("[lints]\nworkspace = true\n", "");
        assert_eq!(lines(&lints), [1]);
    }

    #[test]
    fn a_manifest_that_is_not_toml_is_found() {
        assert_eq!(lines("[package]\nversion = \n"), [2]);
    }
}
