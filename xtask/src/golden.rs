//! `cargo xtask golden`: every scene, rendered with every structure, gives one and the same picture, and it is
//! the picture that somebody has looked at.
//!
//! Each scene is rendered small with every structure and precision, the exact one by trees on one thread and on all. At a precision
//! the files must agree byte for byte, as the structures give equal answers and the image does not depend on
//! threads. The exact picture is compared with the golden one within [`compare::CHANNEL_TOLERANCE`] and
//! [`compare::OUTLIERS`]; the fast one may be wrong at edges and is compared with [`compare::FAST_OUTLIERS`].

mod compare;
mod render;
mod report;
pub(crate) mod scenes;

use std::fs;
use std::path::Path;
use std::time::Instant;

use anyhow::{Context, bail};

use crate::table;
use crate::workspace::Workspace;
use render::{Case, Program, Rendered};
use report::Report;
use scenes::Scene;

#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Accept the pictures as they are now as the golden images
    #[arg(long)]
    bless: bool,
    /// Only this scene, by its file name without ending; may be given several times
    #[arg(long = "scene", value_name = "NAME")]
    scenes: Vec<String>,
    /// Keep all pictures under target/golden, also of scenes without failures
    #[arg(long)]
    keep: bool,
}

/// Renders and compares, prints a table, and says whether all is as it should be.
pub(crate) fn run(workspace: &Workspace, arguments: &Arguments) -> anyhow::Result<bool> {
    let pairing = scenes::pair(&workspace.files()?);
    if pairing.scenes.is_empty() {
        bail!(
            "there are no scenes in {}",
            workspace.root.join("scenes").display()
        );
    }
    let selected = select(&pairing.scenes, &arguments.scenes)?;
    let program = Program::build(workspace)?;
    let cases = Case::all(all_threads());

    let mut rows = vec![["scene", "cases", "seconds", "verdict"].map(String::from)];
    let mut passed = pairing.ambiguous.is_empty();
    for scene in selected {
        let folder = workspace.target.join("golden").join(&scene.name);
        let start = Instant::now();
        let report = check_scene(workspace, &program, scene, &cases, &folder, arguments)?;
        let seconds = format!("{:.1}", start.elapsed().as_secs_f64());
        eprintln!("{}: {} ({seconds} s)", scene.name, report.verdict);
        for problem in &report.problems {
            eprintln!("{problem}");
        }
        passed &= report.problems.is_empty();
        let count = cases.len().to_string();
        rows.push([scene.name.clone(), count, seconds, report.verdict]);
    }
    for file in &pairing.ambiguous {
        eprintln!("{file}: another scene has the same name, and so the same golden image");
    }
    if arguments.scenes.is_empty() {
        for golden in &pairing.stray_goldens {
            eprintln!("{golden}: belongs to no scene; remove it");
            passed = false;
        }
    }
    print!("{}", table::render(&rows));
    Ok(passed)
}

fn select<'a>(scenes: &'a [Scene], names: &[String]) -> anyhow::Result<Vec<&'a Scene>> {
    let exists = |name: &&String| scenes.iter().any(|scene| scene.name == **name);
    if let Some(unknown) = names.iter().find(|name| !exists(name)) {
        let known: Vec<&str> = scenes.iter().map(|scene| scene.name.as_str()).collect();
        bail!(
            "there is no scene {unknown}; there are: {}",
            known.join(" ")
        );
    }
    let wanted = |scene: &&Scene| names.is_empty() || names.contains(&scene.name);
    Ok(scenes.iter().filter(wanted).collect())
}

/// At least two, so that tiles run in parallel on a machine with one core, too.
fn all_threads() -> usize {
    std::thread::available_parallelism()
        .map_or(2, usize::from)
        .max(2)
}

fn check_scene(
    workspace: &Workspace,
    program: &Program,
    scene: &Scene,
    cases: &[Case],
    folder: &Path,
    arguments: &Arguments,
) -> anyhow::Result<Report> {
    if folder.exists() {
        fs::remove_dir_all(folder).with_context(|| format!("cannot empty {folder:?}"))?;
    }
    fs::create_dir_all(folder).with_context(|| format!("cannot make {folder:?}"))?;
    let rendered: Vec<Rendered> = cases
        .iter()
        .map(|case| program.render(workspace, scene, case, folder))
        .collect();

    let golden_file = workspace.root.join(scene.golden());
    let golden = if scene.has_golden {
        let bytes = fs::read(&golden_file);
        Some(bytes.with_context(|| format!("reading {}", scene.golden()))?)
    } else {
        None
    };
    let report = if arguments.bless {
        report::bless(&rendered, golden.as_deref(), &golden_file, folder)?
    } else {
        report::check(&rendered, golden.as_deref(), folder)?
    };
    if report.problems.is_empty() && !arguments.keep {
        fs::remove_dir_all(folder).with_context(|| format!("cannot remove {folder:?}"))?;
    }
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_are_selected_by_name_and_unknown_names_are_refused() {
        let files = ["scenes/a.ron", "scenes/b.ron"].map(String::from);
        let scenes = scenes::pair(&files).scenes;
        assert_eq!(select(&scenes, &[]).unwrap().len(), 2);
        let one = select(&scenes, &["b".to_owned()]).unwrap();
        assert_eq!(one[0].file, "scenes/b.ron");
        let error = select(&scenes, &["c".to_owned()]).unwrap_err().to_string();
        assert_eq!(error, "there is no scene c; there are: a b");
    }
}
