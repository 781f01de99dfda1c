//! `tahko verify`.

use anyhow::{Result, anyhow, bail};
use tahko_bench::audit::{self, AuditOptions, Example, Mistake, Report, Run, Stage};
use tahko_tracer::geometry::Ray;
use tahko_tracer::load::load_mesh;

use crate::args::VerifyArguments;
use crate::audit_report;
use crate::output;
use crate::progress::Progress;
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &VerifyArguments, terminal: &Terminal) -> Result<()> {
    let progress = terminal.progress();
    let path = &arguments.mesh;
    let name = path.display().to_string();
    progress.phase(&format!("reading {name}"));
    let (mesh, notes) = load_mesh(path)?;
    terminal.notes(&notes);
    let options = AuditOptions::default()
        .with_rays(arguments.rays)
        .with_seed(arguments.seed);
    let show = |step: audit::Progress| show(step, progress);
    let report =
        audit::audit(&mesh, &options, &show).map_err(|source| anyhow!("{name}: {source}"))?;
    progress.clear();
    let text = if arguments.json {
        audit_report::to_json(&name, &report)?
    } else {
        audit_report::to_table(&name, &report)
    };
    output::write_stdout(|writer| Ok(writeln!(writer, "{text}")?))?;
    check(&report)
}

/// Shows how far the audit is, and the time left.
fn show(step: audit::Progress, progress: &Progress) {
    if step.done == 0 {
        progress.count("verifying", step.total);
    }
    let stage = match step.stage {
        Stage::Reference => "computing exact answers".to_owned(),
        Stage::Structure(structure, precision) => {
            format!("asking {} at {}", structure.name(), precision.name())
        }
    };
    progress.rename(&stage);
    progress.set(step.done);
}

/// An error that names the mistakes of the exact precision, if there are any, and a ray on which they show.
fn check(report: &Report) -> Result<()> {
    let mut broken = report.broken_promises();
    let Some((run, example)) = broken.find_map(|run| Some((run, run.example.as_ref()?))) else {
        return Ok(());
    };
    let (structure, precision) = (run.structure.name(), run.precision.name());
    let others = match broken.count() {
        0 => String::new(),
        count => format!(" (and {count} more of the structures)"),
    };
    bail!(
        "{structure}{others} is wrong at {precision} on {} of {} rays: {}; {}; the ray: {}",
        run.all.wrong_rays,
        run.rays,
        mistakes(run),
        answers(example, structure),
        csv_line(&example.ray),
    );
}

/// What kinds of mistakes there are, with their numbers.
fn mistakes(run: &Run) -> String {
    let kinds = Mistake::ALL.into_iter();
    let counts = kinds.map(|mistake| (run.all.count(mistake), mistake.plural()));
    let parts: Vec<String> = counts
        .filter(|(count, _)| *count > 0)
        .map(|(count, name)| format!("{count} {name}"))
        .collect();
    parts.join(", ")
}

/// What the right answer to a ray is, and what a structure said.
fn answers(example: &Example, structure: &str) -> String {
    let kinds: Vec<&str> = example.mistakes.iter().map(|kind| kind.plural()).collect();
    let describe = |hit: Option<(u32, f32)>| match hit {
        Some((triangle, t)) => format!("triangle {triangle} at t = {t}"),
        None => "nothing".to_owned(),
    };
    let exact = describe(example.exact);
    let given = describe(example.given.map(|hit| (hit.primitive, hit.t)));
    format!(
        "for example ({}) a ray that hits {exact}, and {structure} says {given}",
        kinds.join(", ")
    )
}

/// A ray as `tahko query` reads it, to the bit.
fn csv_line(ray: &Ray) -> String {
    let Ray {
        origin: o,
        direction: d,
        t_min,
        t_max,
    } = ray;
    let numbers = [o.x, o.y, o.z, d.x, d.y, d.z, *t_min, *t_max];
    numbers.map(|number| number.to_string()).join(",")
}
