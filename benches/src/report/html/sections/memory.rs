//! Memory that queries need.

use std::collections::BTreeMap;

use maud::{Markup, html};

use super::super::chart::bars::{Bar, bars};
use super::super::chart::figure;
use super::super::context::{Context, median};
use super::super::format::number;
use super::super::mark::Mark;
use super::super::mark::Shape;
use crate::report::Contender;

pub(super) fn body(context: &Context<'_>) -> Option<Markup> {
    let mut builds: BTreeMap<String, (&Contender, Vec<f64>)> = BTreeMap::new();
    for build in context.report.scenes.iter().flat_map(|scene| &scene.builds) {
        if let Some(bytes) = build
            .bytes_per_triangle
            .filter(|bytes| bytes.is_finite() && *bytes > 0.0)
        {
            let name = context.names.build(&build.contender);
            builds
                .entry(name)
                .or_insert((&build.contender, Vec::new()))
                .1
                .push(bytes);
        }
    }
    let mut rows: Vec<Bar> = builds
        .into_iter()
        .filter_map(|(name, (contender, bytes))| bar(context, name, contender, bytes))
        .collect();
    rows.sort_by(|a, b| a.value.total_cmp(&b.value));
    let description = rows
        .iter()
        .map(|bar| bar.title.as_str())
        .collect::<Vec<_>>()
        .join("; ");
    let chart = bars(
        "Memory per triangle",
        &description,
        "bytes per triangle",
        &rows,
    )?;
    Some(html! {
        p { "Bytes that queries need, per triangle of the mesh: triangles, nodes and whatever else. Libraries that do not tell are missing." }
        (figure("Median over the scenes; the line spans them", &chart, &html! {}))
    })
}

fn bar(context: &Context<'_>, name: String, contender: &Contender, bytes: Vec<f64>) -> Option<Bar> {
    let ends = (
        bytes.iter().copied().reduce(f64::min)?,
        bytes.iter().copied().reduce(f64::max)?,
    );
    let scenes = bytes.len();
    let value = median(bytes)?;
    Some(Bar {
        title: format!(
            "{name}: {} bytes per triangle ({} to {} on {scenes} scenes)",
            number(value),
            number(ends.0),
            number(ends.1)
        ),
        name,
        mark: Mark {
            shape: Shape::Square,
            ..context.mark(contender)
        },
        value,
        ends,
    })
}
