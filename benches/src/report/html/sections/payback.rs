//! After how many rays a slower build has paid for itself.

use maud::{Markup, html};

use super::super::chart::figure;
use super::super::chart::strips::{Piece, Strip, strips};
use super::super::context::Context;
use super::super::envelope::{Line, Stretch, lower};
use super::super::format::{number, rays, seconds};
use super::super::table::{Cell, Column, Row, folded, table};
use super::builds::Choice;
use crate::report::{RayClass, SceneReport};

/// Which contenders may be chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Among {
    /// Those that gave no wrong answer on the scene and class.
    Clean,
    All,
}

impl Among {
    const fn name(self) -> &'static str {
        match self {
            Self::Clean => "without a wrong answer",
            Self::All => "any error",
        }
    }

    const fn heading(self) -> &'static str {
        match self {
            Self::Clean => "among those without a wrong answer",
            Self::All => "among all, with whatever errors",
        }
    }
}

/// The cheapest choices for a scene, from few rays to many.
type Best<'a> = Vec<(Choice<'a>, Stretch)>;

pub(super) fn body(
    context: &Context<'_>,
    scenes: &[(&SceneReport, Vec<Choice<'_>>)],
    class: RayClass,
) -> Markup {
    let charts = [Among::Clean, Among::All].map(|among| {
        let rows: Vec<Strip> = scenes.iter().filter_map(|(scene, choices)| strip(context, scene, &best(choices, among))).collect();
        let title = format!("The cheapest choice for a number of {} rays, {}", class.name(), among.name());
        let description = "For each scene, which structure needs the least time in all, from few rays to many; the table below has the same values.";
        let chart = strips(&title, description, "rays traced with one build", &rows);
        let heading = format!("For {} rays, {}", class.name(), among.heading());
        chart.map(|chart| figure(&heading, &chart, &html! {}))
    });
    html! {
        h3 { "What to take for how many rays" }
        p {
            "Time in all is the build plus the rays, each on one thread. With few rays the fastest build is the cheapest; with more, a "
            "slower build with "
            "faster rays overtakes it."
        }
        div.charts { @for chart in charts.iter().flatten() { (chart) } }
        (folded(&html! { "The figures" }, false, &figures(context, scenes)))
    }
}

fn best<'a>(choices: &[Choice<'a>], among: Among) -> Best<'a> {
    let choices = choices.iter().copied();
    let candidates: Vec<Choice<'a>> = choices
        .filter(|choice| among == Among::All || choice.mistakes().is_clean())
        .collect();
    let lines: Vec<Line> = candidates
        .iter()
        .map(|choice| Line {
            build: choice.build_seconds(),
            ray: choice.ray_nanoseconds() * 1e-9,
        })
        .collect();
    lower(&lines)
        .into_iter()
        .map(|stretch| (candidates[stretch.line], stretch))
        .collect()
}

fn strip(context: &Context<'_>, scene: &SceneReport, best: &Best<'_>) -> Option<Strip> {
    let pieces = best.iter().map(|(choice, stretch)| {
        let name = context.names.full(&choice.trace.contender);
        Piece {
            mark: context.mark(&choice.trace.contender),
            title: format!("{name}: {}, {}", range(stretch), choice.mistakes().words()),
            labels: [name, context.names.structure(&choice.trace.contender)],
            from: stretch.from,
            to: stretch.to,
        }
    });
    let pieces: Vec<Piece> = pieces.collect();
    (!pieces.is_empty()).then(|| Strip {
        name: scene.name.clone(),
        pieces,
    })
}

fn range(stretch: &Stretch) -> String {
    match (stretch.from > 0.0, stretch.to.is_finite()) {
        (false, false) => "for any number of rays".to_owned(),
        (false, true) => format!("up to {} rays", rays(stretch.to)),
        (true, false) => format!("from {} rays on", rays(stretch.from)),
        (true, true) => format!("from {} to {} rays", rays(stretch.from), rays(stretch.to)),
    }
}

fn figures(context: &Context<'_>, scenes: &[(&SceneReport, Vec<Choice<'_>>)]) -> Markup {
    let columns = [
        Column::text("contender", "Structure, preset and precision"),
        Column::text("scene", "Scene"),
        Column::text(
            "chosen among",
            "All contenders, or those without a wrong answer on this scene and class",
        ),
        Column::text(
            "cheapest",
            "For how many rays it needs the least time in all",
        ),
        Column::number("build", "From the mesh to the first ray, on one thread"),
        Column::number("ns per ray", "Nanoseconds per ray"),
        Column::number("wrong / M", "Wrong answers per million audited rays"),
    ];
    let mut rows = Vec::new();
    for (scene, choices) in scenes {
        for among in [Among::Clean, Among::All] {
            rows.extend(best(choices, among).iter().map(|(choice, stretch)| Row {
                cells: vec![
                    Cell::new(context.badge(
                        &choice.trace.contender,
                        &context.names.full(&choice.trace.contender),
                    )),
                    Cell::text(&scene.name),
                    Cell::text(among.name()),
                    range(stretch).into(),
                    seconds(choice.build_seconds()).into(),
                    number(choice.ray_nanoseconds()).into(),
                    choice.mistakes().short().into(),
                ],
                is_best: false,
            }));
        }
    }
    table("The cheapest choice for a number of rays", &columns, &rows)
}
