//! The sections of the page, in order.

mod builds;
mod claims;
mod exactness;
mod expected_cost;
mod growth;
mod guide;
mod key;
mod memory;
mod payback;
mod pictures;
mod scenes;
mod speed_error;
pub(super) mod summary;

use maud::Markup;

use super::context::Context;

/// A section.
#[derive(Clone, Debug)]
pub(super) struct Section {
    /// The target of links to it.
    pub(super) id: &'static str,
    pub(super) title: &'static str,
    pub(super) body: Markup,
}

/// Those for which the report has data.
pub(super) fn all(context: &Context<'_>) -> Vec<Section> {
    let sections = [
        (
            "speed-error",
            "Speed against error",
            speed_error::body(context),
        ),
        ("scenes", "All figures by scene", scenes::body(context)),
        (
            "exactness",
            "What exactness costs",
            exactness::body(context),
        ),
        (
            "builds",
            "Build time against trace time",
            builds::body(context),
        ),
        ("memory", "Memory", memory::body(context)),
        (
            "cost",
            "Expected against measured cost",
            expected_cost::body(context),
        ),
        (
            "growth",
            "Growth with the number of triangles",
            growth::body(context),
        ),
        ("pictures", "Pictures", pictures::body(context)),
        ("claims", "Claims of the literature", claims::body(context)),
        ("guide", "How to read this", Some(guide::body(context))),
    ];
    let present = sections.into_iter().filter_map(|(id, title, body)| {
        Some(Section {
            id,
            title,
            body: body?,
        })
    });
    present.collect()
}
