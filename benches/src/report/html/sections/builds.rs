//! Build time against trace time, a chart for each scene.

use std::collections::{BTreeMap, BTreeSet};

use maud::{Markup, html};

use super::super::chart::scatter::{Point, scatter};
use super::super::chart::{Axis, Frame, figure};
use super::super::context::{Context, same_build};
use super::super::format::{count, number, seconds, short, short_seconds};
use super::super::mistakes::Mistakes;
use super::super::pareto;
use super::super::scale::Domain;
use super::super::table::{Cell, Column, Row, folded, table};
use super::{key, payback};
use crate::report::{BuildRow, Contender, RayClass, SceneReport, TraceRow};

/// A build, and the fastest way to trace with it at one precision.
#[derive(Clone, Copy, Debug)]
pub(super) struct Choice<'a> {
    pub(super) build: &'a BuildRow,
    pub(super) trace: &'a TraceRow,
}

impl Choice<'_> {
    pub(super) fn build_seconds(&self) -> f64 {
        self.build.seconds.median()
    }

    pub(super) fn ray_nanoseconds(&self) -> f64 {
        1e3 / self.trace.rate.median()
    }

    pub(super) const fn mistakes(&self) -> Mistakes {
        Mistakes::of(&self.trace.errors)
    }
}

/// What there is to choose on a scene: for each build and precision, the fastest way to trace the class.
pub(super) fn choices<'a>(
    context: &Context<'a>,
    scene: &'a SceneReport,
    class: RayClass,
) -> Vec<Choice<'a>> {
    let mut found: BTreeMap<(usize, &str), Choice<'a>> = BTreeMap::new();
    for (index, build) in scene.builds.iter().enumerate() {
        for trace in context.traces_of(scene, build, class) {
            let choice = Choice { build, trace };
            let is_measured = choice.build_seconds() > 0.0 && choice.ray_nanoseconds().is_finite();
            let key = (index, trace.contender.precision.as_str());
            let is_faster = |known: &Choice<'_>| known.ray_nanoseconds() > choice.ray_nanoseconds();
            if is_measured && found.get(&key).is_none_or(is_faster) {
                found.insert(key, choice);
            }
        }
    }
    found.into_values().collect()
}

/// The builds that all scenes with builds have.
pub(super) fn overall<'a>(context: &Context<'a>) -> Vec<(&'a Contender, Vec<&'a BuildRow>)> {
    let scenes = || {
        context
            .report
            .scenes
            .iter()
            .filter(|scene| !scene.builds.is_empty())
    };
    let first: Vec<&BuildRow> = scenes()
        .next()
        .map_or_else(Vec::new, |scene| scene.builds.iter().collect());
    let everywhere = first.into_iter().filter_map(|build| {
        let others = scenes().map(|scene| {
            scene
                .builds
                .iter()
                .find(|other| same_build(&other.contender, &build.contender))
        });
        Some((&build.contender, others.collect::<Option<Vec<_>>>()?))
    });
    everywhere.collect()
}

pub(super) fn body(context: &Context<'_>) -> Option<Markup> {
    let class = context.main_class()?;
    let scenes = context.report.scenes.iter();
    let scenes: Vec<(&SceneReport, Vec<Choice<'_>>)> = scenes
        .map(|scene| (scene, choices(context, scene, class)))
        .filter(|(_, choices)| !choices.is_empty())
        .collect();
    if scenes.is_empty() {
        return None;
    }
    let name = class.name();
    let all = scenes.iter().flat_map(|(_, choices)| choices);
    let shown: Vec<&Contender> = all.map(|choice| &choice.trace.contender).collect();
    Some(html! {
        p {
            "Seconds to build on one thread, against nanoseconds per " (name) " ray on " (context.on_threads()) ": to the left is built faster, "
            "further down is traced faster. For each build and precision, the fastest way to hand over rays. The dashed steps join those "
            "that no other "
            "beats in both."
        }
        (key::colours_and_shapes(context, shown.iter().copied()))
        div.charts {
            @for (scene, choices) in &scenes { @if let Some(chart) = chart(context, scene, choices, class) { (chart) } }
        }
        (folded(&html! { "The figures" }, false, &figures(context, &scenes)))
        (payback::body(context, &scenes, class))
    })
}

fn chart(
    context: &Context<'_>,
    scene: &SceneReport,
    choices: &[Choice<'_>],
    class: RayClass,
) -> Option<Markup> {
    // The front is where more is better in the first and less in the second.
    let places: Vec<(f64, f64)> = choices
        .iter()
        .map(|choice| (-choice.build_seconds(), choice.ray_nanoseconds()))
        .collect();
    let points: Vec<Point> = choices
        .iter()
        .zip(pareto::front(&places))
        .map(|(choice, is_strong)| point(context, choice, is_strong))
        .collect();
    let ray_axis = format!("↓ nanoseconds per {} ray", class.name());
    let frame = Frame {
        title: &format!("Build time against trace time, {}", scene.name),
        description: "A point for each build and precision; the table of figures below has the same values.",
        x: Axis {
            name: "← build time",
            domain: Domain::logarithmic(choices.iter().map(Choice::build_seconds))?,
            tick: short_seconds,
        },
        y: Axis {
            name: &ray_axis,
            domain: Domain::logarithmic(choices.iter().map(Choice::ray_nanoseconds))?,
            tick: short,
        },
        band: None,
    };
    let heading = format!("{}, {} triangles", scene.name, count(scene.triangles));
    Some(figure(&heading, &scatter(&frame, &points), &html! {}))
}

fn point(context: &Context<'_>, choice: &Choice<'_>, is_strong: bool) -> Point {
    let name = context.names.full(&choice.trace.contender);
    Point {
        x: choice.build_seconds(),
        y: choice.ray_nanoseconds(),
        mark: context.mark(&choice.trace.contender),
        title: format!(
            "{name}: built in {}, {} ns per ray, {}",
            seconds(choice.build_seconds()),
            number(choice.ray_nanoseconds()),
            choice.mistakes().words()
        ),
        label: is_strong.then_some(name),
        is_strong,
    }
}

fn figures(context: &Context<'_>, scenes: &[(&SceneReport, Vec<Choice<'_>>)]) -> Markup {
    let columns = [
        Column::text("contender", "Structure, preset and precision"),
        Column::text("scene", "Scene"),
        Column::number(
            "build",
            "From the mesh to the first ray, on one thread: median",
        ),
        Column::number("build, all threads", "The same on all threads"),
        Column::number(
            "triangles/s",
            "Triangles built into the structure per second, on one thread",
        ),
        Column::number("ns per ray", "Nanoseconds per ray: median"),
        Column::number("wrong / M", "Wrong answers per million audited rays"),
    ];
    let pairs = || {
        scenes
            .iter()
            .flat_map(|(scene, choices)| choices.iter().map(move |choice| (scene, choice)))
    };
    let names: BTreeSet<String> = pairs().map(|(scene, _)| scene.name.clone()).collect();
    let rows: Vec<Row> = pairs()
        .map(|(scene, choice)| Row {
            cells: vec![
                Cell::new(context.badge(
                    &choice.trace.contender,
                    &context.names.full(&choice.trace.contender),
                )),
                Cell::text(&scene.name),
                seconds(choice.build_seconds()).into(),
                seconds(choice.build.seconds_all_threads.median()).into(),
                number(scene.triangles as f64 / choice.build_seconds()).into(),
                number(choice.ray_nanoseconds()).into(),
                choice.mistakes().short().into(),
            ],
            is_best: false,
        })
        .collect();
    let caption = format!("Build time and trace time on {} scenes", names.len());
    table(&caption, &columns, &rows)
}
