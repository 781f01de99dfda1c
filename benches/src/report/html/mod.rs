//! The report as one page, `report.html`: it needs neither network nor scripts.
//!
//! The page reads [`Report`] alone, and the same report gives the same bytes. It is HTML and well-formed XML at once but for its first lines,
//! which is what the tests parse. A section for which a report has no data is left out.

mod chart;
mod class;
mod context;
mod envelope;
mod format;
mod labels;
mod mark;
mod mistakes;
mod names;
mod page;
mod pareto;
mod scale;
mod sections;
mod table;

#[cfg(test)]
mod fixture;
#[cfg(test)]
mod tests;

use super::Report;

/// The whole page.
pub(crate) fn page(report: &Report) -> String {
    page::page(&context::Context::new(report)).into_string()
}
