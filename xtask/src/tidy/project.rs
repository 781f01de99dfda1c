//! Rules about the project's documents, scenes and checks.

use std::fs;

use super::Finding;
use crate::ci;
use crate::golden::scenes;
use crate::workspace::Workspace;

/// What a reader of the README sees without scrolling, about.
const FIRST_SCREEN: usize = 40;

/// All rules that look at one special file or at a folder.
pub(super) fn all(workspace: &Workspace, files: &[String]) -> anyhow::Result<Vec<Finding>> {
    let text = |file: &str| fs::read_to_string(workspace.root.join(file)).ok();
    let mut findings = Vec::new();
    findings.extend(readme_commands(text("README.md").as_deref()));
    findings.extend(checked_commands(ci::STEPS.iter().map(|step| step.command)));
    findings.extend(ci_run(text(".ci/run").as_deref()));
    findings.extend(changelog(text("CHANGELOG.md").as_deref()));
    findings.extend(golden_images(files));
    Ok(findings)
}

/// The README's first screen shows the two commands with which everybody begins.
fn readme_commands(readme: Option<&str>) -> Vec<Finding> {
    let file = "README.md";
    let Some(readme) = readme else {
        return vec![missing(file)];
    };
    let shown = |command: &str| {
        let mut lines = readme.lines().take(FIRST_SCREEN);
        lines.any(|line| line.trim().trim_start_matches("$ ") == command)
    };
    let absent = ci::README_COMMANDS.iter().filter(|command| !shown(command));
    absent
        .map(|command| {
            let message = format!("the first {FIRST_SCREEN} lines lack the line `{command}`");
            Finding::new(file, 1, message)
        })
        .collect()
}

/// What the README promises is run, to the letter.
fn checked_commands<'a>(steps: impl Iterator<Item = &'a str>) -> Vec<Finding> {
    let steps: Vec<&str> = steps.collect();
    let commands = ci::README_COMMANDS.iter();
    let absent = commands.filter(|command| !steps.contains(command));
    absent
        .map(|command| Finding::new("xtask/src/ci.rs", 1, format!("no step runs `{command}`")))
        .collect()
}

/// Continuous integration does what developers do.
fn ci_run(script: Option<&str>) -> Option<Finding> {
    let Some(script) = script else {
        return Some(missing(".ci/run"));
    };
    let calls = script
        .lines()
        .any(|line| line.trim_start_matches("exec ") == "cargo xtask ci");
    (!calls).then(|| Finding::new(".ci/run", 1, "does not call `cargo xtask ci`"))
}

/// Changes are written down when they land, not when a version is released.
fn changelog(changelog: Option<&str>) -> Option<Finding> {
    let file = "CHANGELOG.md";
    let Some(changelog) = changelog else {
        return Some(missing(file));
    };
    let has_section = changelog.lines().any(|line| {
        let title = line.strip_prefix("## ");
        title.is_some_and(|title| title.trim_matches(['[', ']']) == "Unreleased")
    });
    (!has_section).then(|| Finding::new(file, 1, "lacks the section `## [Unreleased]`"))
}

/// Every scene has a golden image and every golden image a scene.
fn golden_images(files: &[String]) -> Vec<Finding> {
    let pairing = scenes::pair(files);
    let mut findings = Vec::new();
    if pairing.scenes.is_empty() {
        findings.push(Finding::new("scenes", 1, "there are no scenes"));
    }
    for scene in pairing.scenes.iter().filter(|scene| !scene.has_golden) {
        let message = format!("has no golden image {}", scene.golden());
        findings.push(Finding::new(&scene.file, 1, message));
    }
    for golden in &pairing.stray_goldens {
        findings.push(Finding::new(golden, 1, "belongs to no scene"));
    }
    for file in &pairing.ambiguous {
        findings.push(Finding::new(file, 1, "another scene has the same name"));
    }
    findings
}

fn missing(file: &str) -> Finding {
    Finding::new(file, 1, "does not exist")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_readme_shows_both_commands_early() {
        let [render, test] = ci::README_COMMANDS;
        let early = format!("# tahko\n```sh\n{render}\n$ {test}\n```\n");
        assert_eq!(readme_commands(Some(&early)), []);
        let late = format!("{render}\n{}{test}\n", "\n".repeat(FIRST_SCREEN));
        assert_eq!(readme_commands(Some(&late)).len(), 1);
        assert_eq!(readme_commands(Some("")).len(), 2);
        assert_eq!(readme_commands(None), [missing("README.md")]);
    }

    #[test]
    fn the_commands_of_the_readme_are_steps() {
        let steps = ci::STEPS.iter().map(|step| step.command);
        assert_eq!(checked_commands(steps), []);
        assert_eq!(checked_commands(std::iter::empty()).len(), 2);
    }

    #[test]
    fn the_script_calls_the_command_and_does_not_only_mention_it() {
        assert_eq!(ci_run(Some("cd ..\nexec cargo xtask ci\n")), None);
        assert!(ci_run(Some("# cargo xtask ci\n")).is_some(), "a comment");
        assert!(ci_run(None).is_some(), "no script");
    }

    #[test]
    fn the_changelog_has_an_unreleased_section() {
        assert_eq!(changelog(Some("# Changes\n\n## [Unreleased]\n")), None);
        assert_eq!(changelog(Some("## Unreleased\n")), None);
        assert!(
            changelog(Some("# Changes\nUnreleased\n")).is_some(),
            "no title"
        );
        assert!(changelog(None).is_some(), "no changelog");
    }

    #[test]
    fn scenes_and_golden_images_come_in_pairs() {
        let files = ["scenes/a.ron", "scenes/golden/a.png"].map(String::from);
        assert_eq!(golden_images(&files), []);
        let files = ["scenes/a.ron", "scenes/golden/b.png"].map(String::from);
        assert_eq!(golden_images(&files).len(), 2);
        assert_eq!(golden_images(&[]).len(), 1);
    }
}
