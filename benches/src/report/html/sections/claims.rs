//! Statements of the literature and what became of them.

use maud::{Markup, html};

use super::super::context::Context;
use super::super::table::folded;
use crate::report::{Claim, Verdict};

pub(super) fn body(context: &Context<'_>) -> Option<Markup> {
    let claims = &context.report.claims;
    (!claims.is_empty()).then(|| {
        html! {
            p { "What papers and documentation say, held against the measurements of this run." }
            @for claim in claims { (article(claim)) }
        }
    })
}

fn article(claim: &Claim) -> Markup {
    let (badge, class) = match claim.verdict {
        Verdict::Confirmed => ("✓ confirmed", "badge good"),
        Verdict::PartlyConfirmed => ("◐ partly confirmed", "badge partly"),
        Verdict::NotConfirmed => ("✗ not confirmed", "badge bad"),
    };
    html! {
        article.claim {
            h3 { (claim.title) " " span class=(class) { (badge) } }
            blockquote { (claim.claim) " " cite { "— " (claim.source) } }
            p { strong { "Found: " } (claim.finding) }
            @if !claim.rows.is_empty() {
                (folded(&html! { "The measurements" }, false, &measurements(claim)))
            }
        }
    }
}

/// The columns are the claim's own; those whose cells are all numbers stand to the right.
fn measurements(claim: &Claim) -> Markup {
    let is_number = |column: usize| {
        let mut cells = claim.rows.iter().filter_map(|row| row.get(column));
        cells.all(|cell| {
            cell.starts_with(|first: char| first.is_ascii_digit() || "+-–−".contains(first))
        })
    };
    let class = |column: usize| is_number(column).then_some("n");
    html! {
        div.scroll tabindex="0" role="region" aria-label=(claim.title) {
            table {
                caption { (claim.title) }
                thead { tr { @for (column, name) in claim.header.iter().enumerate() { th scope="col" class=[class(column)] { (name) } } } }
                tbody {
                    @for row in &claim.rows {
                        tr { @for (column, cell) in row.iter().enumerate() { td class=[class(column)] { (cell) } } }
                    }
                }
            }
        }
    }
}
