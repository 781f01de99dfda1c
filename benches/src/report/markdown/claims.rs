//! Statements of the literature.

use crate::report::{Claim, Verdict};
use crate::table::markdown;

/// Each claim with what was found; `None` for none.
pub(super) fn section(claims: &[Claim]) -> Option<String> {
    let mut text = "## Claims of the literature, measured\n".to_owned();
    for claim in claims {
        let verdict = match claim.verdict {
            Verdict::Confirmed => "Confirmed",
            Verdict::PartlyConfirmed => "Partly confirmed",
            Verdict::NotConfirmed => "Not confirmed",
        };
        let Claim {
            title,
            claim: statement,
            source,
            finding,
            ..
        } = claim;
        let header: Vec<&str> = claim.header.iter().map(String::as_str).collect();
        let table = markdown(&header, claim.rows.clone(), 1);
        text += &format!(
            "\n### {title}\n\n> {statement} ({source})\n\n**{verdict}.** {finding}\n\n{table}"
        );
    }
    (!claims.is_empty()).then_some(text)
}
