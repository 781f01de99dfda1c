//! Errors of whole pictures, and how they converge.

use maud::{Markup, html};

use super::super::chart::lines::{Series, lines};
use super::super::chart::{Axis, Frame, figure, legend};
use super::super::context::Context;
use super::super::format::{count, number, seconds, short, short_seconds};
use super::super::mark::{Mark, Palette};
use super::super::scale::Domain;
use super::super::table::{Cell, Column, Row, folded, table};
use crate::report::{ImageRow, SceneReport};

pub(super) fn body(context: &Context<'_>) -> Option<Markup> {
    let scenes = context.report.scenes.iter();
    let scenes: Vec<&SceneReport> = scenes.filter(|scene| !scene.images.is_empty()).collect();
    if scenes.is_empty() {
        return None;
    }
    Some(html! {
        p {
            "The error of a picture has two parts: noise, which falls with the number of samples, and wrong answers, which do not. The "
            "charts show "
            "the difference to the exact picture with many samples, against the time that the picture took on all threads: further down is "
            "closer, to the left is "
            "faster. The table also has the difference to the exact precision’s picture with as many samples, which is the part of the "
            "wrong answers alone."
        }
        div.charts {
            @for scene in &scenes { @if let Some(chart) = chart(scene) { (chart) } }
        }
        @for scene in &scenes {
            (folded(&html! { "The figures of " strong { (scene.name) } }, false, &figures(scene)))
        }
    })
}

/// A line for each structure and precision.
fn series(scene: &SceneReport) -> Vec<(String, Series)> {
    let mut found: Vec<(String, Series)> = Vec::new();
    for row in &scene.images {
        for (structure, time) in row.structures.iter().zip(&row.seconds) {
            let name = format!("{structure} {}", row.precision);
            let title = format!(
                "{name}, {} samples: {}, RMSE {}",
                row.samples,
                seconds(*time),
                number(row.rmse_reference)
            );
            let point = (*time, row.rmse_reference, title);
            match found.iter_mut().find(|(known, _)| *known == name) {
                Some((_, series)) => series.points.push(point),
                None => {
                    let mark = Palette::own(structure, &row.precision);
                    found.push((
                        name,
                        Series {
                            mark,
                            points: vec![point],
                        },
                    ));
                }
            }
        }
    }
    for (_, series) in &mut found {
        series.points.sort_by(|a, b| a.0.total_cmp(&b.0));
    }
    found.sort_by_key(|(_, series)| (series.mark.colour, series.mark.shape));
    found
}

fn chart(scene: &SceneReport) -> Option<Markup> {
    let (names, series): (Vec<String>, Vec<Series>) = series(scene).into_iter().unzip();
    let places = || series.iter().flat_map(|series| &series.points);
    let frame = Frame {
        title: &format!("{}: error of the picture against time", scene.name),
        description: "A line for each structure and precision; the table of figures below has the same values.",
        x: Axis {
            name: "time of the picture →",
            domain: Domain::logarithmic(places().map(|point| point.0))?,
            tick: short_seconds,
        },
        y: Axis {
            name: "RMSE to the exact picture with many samples",
            domain: Domain::logarithmic(places().map(|point| point.1))?,
            tick: short,
        },
        band: None,
    };
    let names = names.iter().map(|name| html! { (name) });
    let marks = series.iter().map(|series| series.mark);
    let entries: Vec<(Mark, Markup)> = marks.zip(names).collect();
    Some(figure(
        &scene.name,
        &lines(&frame, &series),
        &legend(&entries),
    ))
}

fn figures(scene: &SceneReport) -> Markup {
    let columns = [
        Column::text("precision", "Precision"),
        Column::text(
            "structures",
            "Those that give this very picture, bit for bit; and the seconds that each took",
        ),
        Column::number("samples", "Samples per pixel"),
        Column::number(
            "RMSE, precision",
            "Root mean square difference to the exact precision’s picture with as many samples",
        ),
        Column::number("FLIP, precision", "Mean FLIP to the same"),
        Column::number(
            "RMSE, reference",
            "Root mean square difference to the exact picture with many samples",
        ),
        Column::number("FLIP, reference", "Mean FLIP to the same"),
    ];
    let rows: Vec<Row> = scene
        .images
        .iter()
        .map(|row| Row {
            cells: cells(row),
            is_best: false,
        })
        .collect();
    table(
        &format!("{}: errors of pictures", scene.name),
        &columns,
        &rows,
    )
}

fn cells(row: &ImageRow) -> Vec<Cell> {
    let structures = html! {
        @for (index, (structure, time)) in row.structures.iter().zip(&row.seconds).enumerate() {
            @if index > 0 { ", " }
            span.who { (Palette::own(structure, &row.precision).in_text()) " " (structure) " " span.dim { (seconds(*time)) } }
        }
    };
    let is_same = row.rmse_precision == 0.0 && row.flip_precision == 0.0;
    vec![
        Cell::text(&row.precision),
        Cell::new(structures),
        count(usize::try_from(row.samples).unwrap_or(usize::MAX)).into(),
        Cell::from(number(row.rmse_precision)).with_tone(if is_same { "good" } else { "bad" }),
        number(row.flip_precision).into(),
        number(row.rmse_reference).into(),
        number(row.flip_reference).into(),
    ]
}
