//! Prints what an audit found, as a table or as JSON.

use anyhow::Result;
use comfy_table::{CellAlignment, Table, presets};
use serde_json::{Map, Value, json};
use tahko_bench::audit::{Errors, Example, Mistake, RayKind, Report, Run};
use tahko_tracer::accelerator::StructureKind;
use tahko_tracer::geometry::{Precision, Ray};

use crate::terminal::printable;

/// The mistakes with a column of their own; the others are exceptional and share one.
const COLUMNS: [Mistake; 5] = [
    Mistake::FalseHit,
    Mistake::FalseMiss,
    Mistake::Leak,
    Mistake::WrongTriangle,
    Mistake::InexactT,
];
const OTHERS: [Mistake; 4] = [
    Mistake::InexactWeights,
    Mistake::AnyHit,
    Mistake::Batch,
    Mistake::Crossings,
];

/// The number of a kind of ray among the errors of a run; `None` for all kinds.
type KindIndex = Option<usize>;

pub(crate) fn to_table(name: &str, report: &Report) -> String {
    let mut lines = vec![
        format!("mesh       {}", printable(name)),
        format!("triangles  {}", report.triangles),
        format!("rays       {} (seed {})", report.rays, report.seed),
    ];
    lines.extend(brute_force_note(report));
    lines.push(String::new());
    let table = table(report).to_string();
    lines.extend(table.lines().map(|line| line.trim_end().to_owned()));
    lines.extend([String::new(), verdict(report)]);
    lines.join("\n")
}

/// Brute force on a large mesh gets fewer rays.
fn brute_force_note(report: &Report) -> Option<String> {
    let is_brute = |run: &&Run| run.structure == StructureKind::Brute;
    let brute = report.runs.iter().find(is_brute)?;
    (brute.rays < report.rays).then(|| {
        let rays = brute.rays;
        format!("brute      the first {rays} rays only: each costs a test per triangle")
    })
}

fn verdict(report: &Report) -> String {
    let exact: Vec<&str> = report
        .broken_promises()
        .map(|run| run.structure.name())
        .collect();
    if exact.is_empty() {
        "exact: no mistake".to_owned()
    } else {
        format!("exact: WRONG in {}", exact.join(", "))
    }
}

/// For each precision the errors of all rays, then those by kind. Structures with the same errors share a row.
fn table(report: &Report) -> Table {
    let mut header = vec!["precision", "rays", "structures", "number"];
    header.extend(COLUMNS.map(Mistake::plural));
    header.extend(["others", "t ulp: median", "99.9 %", "max"]);
    let text_columns = 3;
    let mut table = Table::new();
    table.load_style(presets::NOTHING).set_header(header);
    let kinds = std::iter::once(None).chain((0..RayKind::ALL.len()).map(Some));
    let kinds: Vec<KindIndex> = kinds.collect();
    for precision in Precision::ALL {
        for kind in &kinds {
            for (structures, errors) in groups(report, precision, *kind) {
                table.add_row(row(precision, *kind, &structures, errors));
            }
        }
    }
    for (index, column) in table.column_iter_mut().enumerate() {
        column.set_padding(if index == 0 { (0, 1) } else { (1, 1) });
        if index >= text_columns {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    table
}

fn errors_of(run: &Run, kind: KindIndex) -> &Errors {
    kind.map_or(&run.all, |kind| &run.kinds[kind])
}

/// The different errors at a precision, each with the structures that have them.
fn groups(report: &Report, precision: Precision, kind: KindIndex) -> Vec<(Vec<&str>, &Errors)> {
    let mut groups: Vec<(Vec<&str>, &Errors)> = Vec::new();
    let runs = report.runs.iter().filter(|run| run.precision == precision);
    for run in runs {
        let (name, errors) = (run.structure.name(), errors_of(run, kind));
        match groups.iter_mut().find(|(_, other)| *other == errors) {
            Some((names, _)) => names.push(name),
            None => groups.push((vec![name], errors)),
        }
    }
    groups
}

fn row(precision: Precision, kind: KindIndex, structures: &[&str], errors: &Errors) -> Vec<String> {
    let mut cells = vec![
        precision.name().to_owned(),
        kind.map_or("all", |kind| RayKind::ALL[kind].name())
            .to_owned(),
        structures.join(" "),
        errors.rays.to_string(),
    ];
    cells.extend(COLUMNS.map(|mistake| count(errors, mistake)));
    let others = OTHERS.map(|mistake| errors.count(mistake));
    cells.push(others.iter().sum::<usize>().to_string());
    cells.extend(errors.t_errors.map_or([const { String::new() }; 3], |t| {
        [t.median, t.quantile_999, t.largest].map(ulps)
    }));
    cells
}

/// Short for small errors and for enormous ones, which are those of a `t` that is exactly zero.
fn ulps(error: f64) -> String {
    if error < 1e4 {
        format!("{error:.3}")
    } else {
        format!("{error:.1e}")
    }
}

/// A number and, if it is not zero, what that is per million rays.
fn count(errors: &Errors, mistake: Mistake) -> String {
    match errors.count(mistake) {
        0 => "0".to_owned(),
        count => format!("{count} ({:.0}/M)", errors.per_million(mistake)),
    }
}

pub(crate) fn to_json(name: &str, report: &Report) -> Result<String> {
    let runs: Vec<Value> = report.runs.iter().map(run_to_json).collect();
    Ok(serde_json::to_string_pretty(&json!({
        "mesh": name,
        "triangles": report.triangles,
        "rays": report.rays,
        "seed": report.seed,
        "exact_is_exact": report.broken_promises().next().is_none(),
        "runs": runs,
    }))?)
}

fn run_to_json(run: &Run) -> Value {
    let to_json = |errors: &Errors| errors_to_json(errors, run.has_crossings);
    let kinds = RayKind::ALL.iter().zip(&run.kinds);
    let kinds: Map<String, Value> = kinds
        .map(|(kind, errors)| (key(kind.name()), to_json(errors)))
        .collect();
    json!({
        "structure": run.structure.name(),
        "precision": run.precision.name(),
        "all": to_json(&run.all),
        "kinds": kinds,
        "example": run.example.as_ref().map(example_to_json),
    })
}

fn example_to_json(example: &Example) -> Value {
    let hit =
        |hit: Option<(u32, f32)>| hit.map(|(triangle, t)| json!({"triangle": triangle, "t": t}));
    json!({
        "ray": csv_line(&example.ray),
        "kind": key(example.kind.name()),
        "mistakes": example.mistakes.iter().map(|mistake| key(mistake.plural())).collect::<Vec<_>>(),
        "exact": hit(example.exact),
        "given": hit(example.given.map(|hit| (hit.primitive, hit.t))),
    })
}

/// A ray as `tahko query` reads it, to the bit.
pub(crate) fn csv_line(ray: &Ray) -> String {
    let Ray {
        origin: o,
        direction: d,
        t_min,
        t_max,
    } = ray;
    let numbers = [o.x, o.y, o.z, d.x, d.y, d.z, *t_min, *t_max];
    numbers.map(|number| number.to_string()).join(",")
}

/// A name as it is written in JSON.
fn key(name: &str) -> String {
    name.replace([' ', '-'], "_")
}

fn errors_to_json(errors: &Errors, has_crossings: bool) -> Value {
    let mut value = Map::new();
    value.insert("rays".to_owned(), errors.rays.into());
    value.insert("hits".to_owned(), errors.hits.into());
    for mistake in Mistake::ALL {
        let key = key(mistake.plural());
        let is_known = has_crossings || mistake != Mistake::Crossings;
        let per_million = is_known.then(|| errors.per_million(mistake));
        value.insert(format!("{key}_per_million"), per_million.into());
        value.insert(key, is_known.then(|| errors.count(mistake)).into());
    }
    let t_errors = errors.t_errors.map(|t| {
        json!({
            "median": t.median,
            "quantile_999": t.quantile_999,
            "max": t.largest,
        })
    });
    value.insert("t_error_ulps".to_owned(), t_errors.into());
    value.into()
}
