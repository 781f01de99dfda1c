//! The report as Markdown, which a terminal shows as well.

mod baseline;
mod claims;
mod exactness;
mod growth;
mod images;
mod scene;

use super::{Machine, Report};
use crate::baseline::Comparison;

/// The whole report; with a baseline, the comparison stands first.
pub(crate) fn page(report: &Report, comparison: Option<&Comparison>) -> String {
    let mut sections = vec![head(report)];
    sections.extend(comparison.map(baseline::section));
    sections.extend(report.scenes.iter().map(scene::section));
    sections.extend(exactness::section(&report.scenes));
    sections.extend(images::section(&report.scenes));
    sections.extend(growth::section(&report.growth));
    sections.extend(claims::section(&report.claims));
    sections.join("\n")
}

fn head(report: &Report) -> String {
    let Machine {
        processor,
        threads,
        system,
        compiler,
        version,
    } = &report.machine;
    let warning = if report.settings.quick {
        "A short run: its figures mean less than those of a full one.\n\n"
    } else {
        ""
    };
    format!(
        "# Speed against error\n\n{warning}\
         - tahko {version}, {compiler}\n\
         - {processor}, {threads} threads, {system}\n\
         - `{}`, {} rays of each class, {} rounds, {:.0} s\n\n\
         Rates are million rays per second, the median of rounds in which all take turns; spread is the largest minus the smallest, in per cent of the median. \
         Errors are per million audited rays, against exact answers in rational numbers. `t` errors are in units in the last place.\n",
        report.command, report.settings.rays, report.settings.rounds, report.seconds
    )
}
