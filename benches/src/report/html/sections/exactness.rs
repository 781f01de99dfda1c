//! What exactness costs: the exact precision against the others, round by round.

use std::collections::BTreeMap;

use maud::{Markup, html};

use super::super::chart::dots::{self, Dot, Row as DotRow};
use super::super::chart::{figure, legend};
use super::super::class;
use super::super::context::{Context, geometric_mean};
use super::super::format::{NOTHING, count, number};
use super::super::mark::{Mark, Shape};
use super::super::mistakes::Mistakes;
use super::super::scale::Domain;
use super::super::table::{Cell, Column, Row, folded, table};
use crate::report::{Contender, RayClass, Sample, SceneReport, TraceRow};

/// The precisions that the exact one is compared with.
pub(super) const OTHERS: [&str; 2] = ["watertight", "fast"];
const EXACT: &str = "exact";

/// The exact precision against another one of the same structure, on the same rays in the same rounds.
#[derive(Clone, Debug)]
pub(super) struct Comparison<'a> {
    scene: &'a SceneReport,
    exact: &'a TraceRow,
    other: &'a TraceRow,
    /// The precision of `other`.
    pub(super) to: &'static str,
    /// Speed of the exact one as a part of the other's.
    pub(super) ratio: Sample,
}

/// All comparisons, in the order of the report.
pub(super) fn comparisons<'a>(context: &Context<'a>) -> Vec<Comparison<'a>> {
    let mut found = Vec::new();
    for scene in &context.report.scenes {
        for exact in scene
            .traces
            .iter()
            .filter(|row| row.contender.precision == EXACT)
        {
            for to in OTHERS {
                let contender = Contender {
                    precision: to.to_owned(),
                    ..exact.contender.clone()
                };
                let mut others = scene.traces.iter().filter(|row| {
                    row.contender == contender
                        && row.class == exact.class
                        && row.threads == exact.threads
                });
                let Some(other) = others.next() else { continue };
                let ratio = exact.rate.ratios(&other.rate);
                let is_measured = ratio
                    .values()
                    .iter()
                    .all(|ratio| ratio.is_finite() && *ratio > 0.0);
                if is_measured && !ratio.values().is_empty() {
                    found.push(Comparison {
                        scene,
                        exact,
                        other,
                        to,
                        ratio,
                    });
                }
            }
        }
    }
    found
}

pub(super) fn body(context: &Context<'_>) -> Option<Markup> {
    let comparisons = comparisons(context);
    if comparisons.is_empty() {
        return None;
    }
    let grey = |to: &str| Mark {
        colour: 3,
        shape: Shape::of(to),
        is_hollow: false,
    };
    let entries = OTHERS.map(|to| (grey(to), html! { "exact relative to " (to) }));
    let groups = groups(context, &comparisons);
    let domain = dots::domain(groups.iter().flat_map(|(_, rows)| rows));
    Some(html! {
        p {
            "How fast the exact precision is, relative to the watertight and the fast one of the same structure: 1× is as fast, less is slower. "
            "Both were timed in the same rounds, and the ratio is taken round by round, so that what disturbs both cancels. On " (context.on_threads())
            "; the marker is the geometric mean over the scenes, the line spans them."
        }
        div.key { (legend(&entries)) }
        div.charts {
            @if let Some(domain) = domain {
                @for (class, rows) in &groups { (chart(*class, &domain, rows)) }
            }
        }
        (folded(&html! { "Each scene, with errors" }, false, &scene_table(context, &comparisons)))
    })
}

/// A row for each structure, for each class.
fn groups(context: &Context<'_>, comparisons: &[Comparison<'_>]) -> Vec<(RayClass, Vec<DotRow>)> {
    let mut groups = Vec::new();
    for class in RayClass::ALL {
        let mut structures: BTreeMap<&Contender, Vec<&Comparison<'_>>> = BTreeMap::new();
        for comparison in comparisons {
            let exact = comparison.exact;
            if exact.class == class && exact.threads == context.threads {
                structures
                    .entry(&exact.contender)
                    .or_default()
                    .push(comparison);
            }
        }
        let rows = structures.into_iter().map(|(contender, group)| DotRow {
            name: context.names.without_precision(contender),
            dots: OTHERS
                .iter()
                .filter_map(|to| dot(context, contender, &group, to))
                .collect(),
        });
        let rows: Vec<DotRow> = rows.collect();
        if !rows.is_empty() {
            groups.push((class, rows));
        }
    }
    groups
}

fn chart(class: RayClass, domain: &Domain, rows: &[DotRow]) -> Markup {
    let name = class.name();
    let title = format!("Speed of the exact precision, {name} rays");
    let titles = rows
        .iter()
        .flat_map(|row| &row.dots)
        .map(|dot| dot.title.as_str());
    let description = titles.collect::<Vec<_>>().join("; ");
    let chart = dots::dots(
        &title,
        &description,
        "speed relative to the other precision",
        domain,
        rows,
    );
    figure(&format!("{} rays", class::capital(name)), &chart, &html! {})
}

fn dot(
    context: &Context<'_>,
    contender: &Contender,
    group: &[&Comparison<'_>],
    to: &str,
) -> Option<Dot> {
    let medians: Vec<f64> = group
        .iter()
        .filter(|comparison| comparison.to == to)
        .map(|comparison| comparison.ratio.median())
        .collect();
    let (low, high) = (
        medians.iter().copied().reduce(f64::min)?,
        medians.iter().copied().reduce(f64::max)?,
    );
    let value = geometric_mean(medians);
    Some(Dot {
        mark: Mark {
            shape: Shape::of(to),
            ..context.mark(contender)
        },
        value,
        ends: (low, high),
        title: format!(
            "{}, exact relative to {to}: {}× (scenes: {}× to {}×)",
            context.names.without_precision(contender),
            number(value),
            number(low),
            number(high)
        ),
    })
}

fn scene_table(context: &Context<'_>, comparisons: &[Comparison<'_>]) -> Markup {
    let columns = [
        Column::text("structure", "Structure and preset"),
        Column::text("scene", "Scene"),
        Column::text("rays", "Class of rays"),
        Column::number("threads", "Threads that traced"),
        Column::text(
            "relative to",
            "The precision that the exact one is compared with",
        ),
        Column::number("speed", "Median of the ratios of the rounds"),
        Column::number("lowest", "Smallest ratio of a round"),
        Column::number("highest", "Largest ratio of a round"),
        Column::number(
            "wrong / M, exact",
            "Wrong answers per million of the exact precision",
        ),
        Column::number(
            "wrong / M, other",
            "Wrong answers per million of the other precision",
        ),
    ];
    let rows: Vec<Row> = comparisons
        .iter()
        .map(|comparison| Row {
            cells: cells(context, comparison),
            is_best: false,
        })
        .collect();
    table(
        "The exact precision relative to others, scene by scene",
        &columns,
        &rows,
    )
}

fn cells(context: &Context<'_>, comparison: &Comparison<'_>) -> Vec<Cell> {
    let Comparison {
        scene,
        exact,
        other,
        to,
        ratio,
    } = comparison;
    let times = |value: f64| match number(value) {
        text if text == NOTHING => text,
        text => format!("{text}×"),
    };
    let mistakes = |row: &TraceRow| Cell::from(Mistakes::of(&row.errors).short());
    vec![
        Cell::new(context.badge(
            &exact.contender,
            &context.names.without_precision(&exact.contender),
        )),
        Cell::text(&scene.name),
        Cell::text(exact.class.name()),
        count(exact.threads).into(),
        Cell::text(to),
        times(ratio.median()).into(),
        times(ratio.low()).into(),
        times(ratio.high()).into(),
        mistakes(exact),
        mistakes(other),
    ]
}
