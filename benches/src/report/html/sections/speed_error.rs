//! Speed against error: a chart for each class of rays.

use maud::{Markup, html};

use super::super::chart::scatter::{Point, scatter};
use super::super::chart::{Axis, Frame, figure};
use super::super::context::{Context, Field, same_build};
use super::super::format::{count, number, short};
use super::super::scale::Domain;
use super::super::{class, pareto};
use super::key;
use crate::report::{Contender, RayClass};

pub(super) fn body(context: &Context<'_>) -> Option<Markup> {
    let fields: Vec<(RayClass, Field<'_>)> = context
        .classes()
        .into_iter()
        .map(|class| (class, context.field(class)))
        .collect();
    let charts: Vec<Markup> = fields
        .iter()
        .filter_map(|(class, field)| panel(context, *class, field))
        .collect();
    let all = fields.iter().flat_map(|(_, field)| &field.shown);
    let shown: Vec<&Contender> = all.map(|overall| overall.contender).collect();
    if charts.is_empty() {
        return None;
    }
    Some(html! {
        p {
            "To the right is faster, further down is fewer wrong answers: the best place is the lower right corner. The dashed steps join the "
            "contenders that no other beats in both. All on " (context.on_threads()) ". Point at a marker for its figures."
        }
        (key::colours_and_shapes(context, shown.iter().copied()))
        div.charts { @for chart in &charts { (chart) } }
    })
}

fn panel(context: &Context<'_>, class: RayClass, field: &Field<'_>) -> Option<Markup> {
    let rate = |index: usize| field.shown[index].mistakes.per_million().unwrap_or(0.0);
    let places: Vec<(f64, f64)> = (0..field.shown.len())
        .map(|index| (field.shown[index].rate, rate(index)))
        .collect();
    let front = pareto::front(&places);
    let mut named: Vec<String> = Vec::new();
    let points: Vec<Point> = field
        .shown
        .iter()
        .zip(places.iter().zip(&front))
        .map(|(overall, ((x, y), is_strong))| {
            let name = context.names.full(overall.contender);
            let structure = context.names.structure(overall.contender);
            // The fastest without an error of each structure has a name too.
            let is_first = overall.mistakes.is_clean() && !named.contains(&structure);
            if is_first {
                named.push(structure);
            }
            Point {
                x: *x,
                y: *y,
                mark: context.mark(overall.contender),
                title: format!(
                    "{name}: {} Mrays/s, {}",
                    number(*x),
                    overall.mistakes.words()
                ),
                label: (*is_strong || is_first).then_some(name),
                is_strong: *is_strong,
            }
        })
        .collect();
    let audited = field
        .shown
        .iter()
        .map(|overall| overall.mistakes.audited)
        .min()?;
    // One wrong answer is the least that could be seen, so the axis shows it also where nobody is that good.
    let least = 1e6 / audited as f64;
    let band = format!("none found in {} rays", count(audited));
    let name = class.name();
    let frame = Frame {
        title: &format!("Speed against error, {name} rays"),
        description: &description(context, field),
        x: Axis {
            name: "million rays per second →",
            domain: Domain::logarithmic(places.iter().map(|place| place.0))?,
            tick: short,
        },
        y: Axis {
            name: "↓ wrong answers per million rays",
            domain: Domain::logarithmic(places.iter().map(|place| place.1).chain([least]))?,
            tick: short,
        },
        band: Some(&band),
    };
    Some(figure(
        &format!("{} rays", class::capital(name)),
        &scatter(&frame, &points),
        &left_out(context, field),
    ))
}

/// The chart in words.
fn description(context: &Context<'_>, field: &Field<'_>) -> String {
    let lines = field.shown.iter().map(|overall| {
        format!(
            "{}: {} million rays per second, {}",
            context.names.full(overall.contender),
            number(overall.rate),
            overall.mistakes.words()
        )
    });
    lines.collect::<Vec<_>>().join("; ")
}

/// Who is missing in the chart, and why.
fn left_out(context: &Context<'_>, field: &Field<'_>) -> Markup {
    let mut names: Vec<String> = Vec::new();
    for (contender, scenes) in &field.left_out {
        let is_partly_shown = || {
            let mut shown = field.shown.iter();
            shown.any(|overall| same_build(overall.contender, contender))
        };
        let who = if is_partly_shown() {
            context.names.full(contender)
        } else {
            context.names.build(contender)
        };
        let name = format!("{who} ({scenes} of {} scenes)", field.scenes);
        if !names.contains(&name) {
            names.push(name);
        }
    }
    html! {
        @if !names.is_empty() {
            p.note { "Left out, as not measured and audited on all scenes: " (names.join(", ")) "." }
        }
    }
}
