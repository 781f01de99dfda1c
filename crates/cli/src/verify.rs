//! `tahko verify`.

use anyhow::{Result, anyhow, bail};
use tahko_bench::audit::{self, AuditOptions, Example, Mistake, Report, Run, Stage};
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
        audit_report::csv_line(&example.ray),
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

#[cfg(test)]
mod tests {
    use tahko_tracer::geometry::{Precision, Ray, TriangleMesh, glam::Vec3};

    use super::*;

    /// The audit of a bumpy sheet, on which the fast precision errs.
    fn report() -> Report {
        let vertex = |index: u32| {
            let (x, y) = ((index % 20) as f32, (index / 20) as f32);
            Vec3::new(x, y, (1.3 * x + y * y).sin()) / 3.0
        };
        let squares = (0..380u32).filter(|corner| corner % 20 < 19);
        let triangles = squares.flat_map(|a| [[a, a + 1, a + 21], [a, a + 21, a + 20]]);
        let mesh = TriangleMesh::new((0..400).map(vertex).collect(), triangles.collect()).unwrap();
        let options = AuditOptions::default().with_rays(2000);
        audit::audit(&mesh, &options, &|_| {}).unwrap()
    }

    #[test]
    fn only_mistakes_of_the_exact_precision_are_an_error_and_a_ray_shows_them() {
        let mut report = report();
        check(&report).unwrap();
        let of = |precision| move |run: &&mut Run| run.precision == precision;
        for run in report.runs.iter_mut().filter(of(Precision::Exact)) {
            run.precision = Precision::Watertight;
        }
        check(&report).unwrap();
        for run in report.runs.iter_mut().filter(of(Precision::Fast)) {
            run.precision = Precision::Exact;
        }
        let message = check(&report).unwrap_err().to_string();
        let run = &report.runs[0];
        let example = run.example.as_ref().unwrap();
        assert!(
            message.contains("(and 3 more of the structures) is wrong"),
            "{message}"
        );
        let misses = format!("{} false misses", run.all.count(Mistake::FalseMiss));
        assert!(message.contains(&misses), "{message}");
        assert_eq!(message.lines().count(), 1, "{message}");
        let (_, ray) = message.rsplit_once("the ray: ").unwrap();
        assert_eq!(ray, audit_report::csv_line(&example.ray));
        assert_eq!(crate::rays::parse_ray(ray.as_bytes()), Ok(example.ray));
    }

    #[test]
    fn the_ray_is_written_to_the_bit() {
        let ray = Ray::with_interval(
            Vec3::new(-0.0, f32::MAX, f32::from_bits(1)),
            Vec3::new(0.1, 1e-30, -3.0),
            f32::NEG_INFINITY,
            f32::INFINITY,
        );
        let line = audit_report::csv_line(&ray);
        let read = crate::rays::parse_ray(line.as_bytes()).unwrap();
        assert_eq!(read, ray);
        assert!(read.origin.x.is_sign_negative(), "{line}");
    }
}
