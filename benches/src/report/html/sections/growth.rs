//! How build time and trace time grow with the number of triangles.

use maud::{Markup, html};

use super::super::chart::lines::{Series, lines};
use super::super::chart::{Axis, Frame, figure, legend};
use super::super::context::Context;
use super::super::format::{count, number, rays, seconds, short, short_seconds};
use super::super::mark::Mark;
use super::super::mistakes::Mistakes;
use super::super::scale::Domain;
use super::super::table::{Cell, Column, Row, folded, table};
use crate::report::{Fit, GrowthCurve, GrowthPoint};

/// What a chart shows.
struct Quantity {
    name: &'static str,
    axis: &'static str,
    of: fn(&GrowthPoint) -> f64,
    exponent: fn(&GrowthCurve) -> Option<Fit>,
    tick: fn(f64) -> String,
    write: fn(f64) -> String,
}

const QUANTITIES: [Quantity; 2] = [
    Quantity {
        name: "build time",
        axis: "build time on all threads",
        of: |point| point.build_seconds,
        exponent: |curve| curve.build_exponent,
        tick: short_seconds,
        write: seconds,
    },
    Quantity {
        name: "time of a random ray",
        axis: "nanoseconds per random ray",
        of: |point| point.ray_nanoseconds,
        exponent: |curve| curve.ray_exponent,
        tick: short,
        write: |value| format!("{} ns", number(value)),
    },
];

pub(super) fn body(context: &Context<'_>) -> Option<Markup> {
    let curves = &context.report.growth;
    let mut generators: Vec<&str> = Vec::new();
    for curve in curves.iter().filter(|curve| !curve.points.is_empty()) {
        if !generators.contains(&curve.generator.as_str()) {
            generators.push(&curve.generator);
        }
    }
    if generators.is_empty() {
        return None;
    }
    let of = |generator: &str| {
        curves
            .iter()
            .filter(|curve| curve.generator == generator)
            .collect::<Vec<_>>()
    };
    Some(html! {
        p {
            "Both axes are logarithmic, so a power of the number of triangles is a straight line, and its exponent the slope. The exponents "
            "are fitted; "
            "the range is the 95 % confidence interval."
        }
        div.charts {
            @for generator in &generators {
                @for quantity in &QUANTITIES {
                    @if let Some(chart) = chart(context, generator, &of(generator), quantity) { (chart) }
                }
            }
        }
        (folded(&html! { "The figures" }, false, &figures(context, curves)))
    })
}

fn chart(
    context: &Context<'_>,
    generator: &str,
    curves: &[&GrowthCurve],
    quantity: &Quantity,
) -> Option<Markup> {
    let series: Vec<Series> = curves
        .iter()
        .map(|curve| {
            let name = context.names.full(&curve.contender);
            let points = curve.points.iter().map(|point| {
                let value = (quantity.of)(point);
                let title = format!(
                    "{name}, {} triangles: {}",
                    count(point.triangles),
                    (quantity.write)(value)
                );
                (point.triangles as f64, value, title)
            });
            Series {
                mark: context.mark(&curve.contender),
                points: points.collect(),
            }
        })
        .collect();
    let places = || series.iter().flat_map(|series| &series.points);
    let frame = Frame {
        title: &format!("{generator}: {} against triangles", quantity.name),
        description: "A line for each structure; the table of figures below has the same values.",
        x: Axis {
            name: "triangles →",
            domain: Domain::logarithmic(places().map(|point| point.0))?,
            tick: rays,
        },
        y: Axis {
            name: quantity.axis,
            domain: Domain::logarithmic(places().map(|point| point.1))?,
            tick: quantity.tick,
        },
        band: None,
    };
    let entries: Vec<(Mark, Markup)> = curves
        .iter()
        .map(|curve| {
            let name = context.names.full(&curve.contender);
            let exponent = exponent((quantity.exponent)(curve));
            (
                context.mark(&curve.contender),
                html! { (name) ": " (exponent) },
            )
        })
        .collect();
    let heading = format!("{generator}: {}", quantity.name);
    Some(figure(&heading, &lines(&frame, &series), &legend(&entries)))
}

fn exponent(fit: Option<Fit>) -> Markup {
    let fit = fit.filter(|fit| fit.exponent.is_finite());
    html! {
        @if let Some(Fit { exponent, uncertainty }) = fit {
            "n" sup { (format!("{exponent:.2}")) @if uncertainty.is_finite() { (format!(" ± {uncertainty:.2}")) } }
        } @else {
            "too few points for an exponent"
        }
    }
}

fn figures(context: &Context<'_>, curves: &[GrowthCurve]) -> Markup {
    let columns = [
        Column::text("contender", "Structure, preset and precision"),
        Column::text("generator", "Procedural scene"),
        Column::number("triangles", "Triangles of the scene"),
        Column::number("build", "Build time on all threads: the best of a few"),
        Column::number("ns per ray", "Nanoseconds per random ray, on one thread"),
        Column::number("wrong / M", "Wrong answers per million audited rays"),
        Column::number("bytes / triangle", "Memory that queries need"),
        Column::number("nodes", "Nodes of the tree"),
        Column::number("depth", "Longest way from the root to a leaf"),
        Column::number(
            "refs / triangle",
            "References to triangles in leaves, per triangle",
        ),
        Column::number(
            "SAH cost",
            "Expected cost by the surface area heuristic, in triangle tests",
        ),
        Column::number("node visits", "Per random ray"),
        Column::number("triangle tests", "Per random ray"),
    ];
    let pairs = curves
        .iter()
        .flat_map(|curve| curve.points.iter().map(move |point| (curve, point)));
    let rows: Vec<Row> = pairs
        .map(|(curve, point)| Row {
            cells: vec![
                Cell::new(context.badge(&curve.contender, &context.names.full(&curve.contender))),
                Cell::text(&curve.generator),
                count(point.triangles).into(),
                seconds(point.build_seconds).into(),
                number(point.ray_nanoseconds).into(),
                Mistakes::of(&point.errors).short().into(),
                number(point.bytes_per_triangle).into(),
                count(point.nodes).into(),
                count(point.depth).into(),
                number(point.references_per_triangle).into(),
                number(point.sah_cost).into(),
                number(point.ray_node_visits).into(),
                number(point.ray_triangle_tests).into(),
            ],
            is_best: false,
        })
        .collect();
    table("Growth", &columns, &rows)
}
