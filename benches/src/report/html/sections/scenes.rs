//! All figures of each scene: a speed never without its error.

use maud::{Markup, html};

use super::super::context::{Context, threads_in_words};
use super::super::format::{NOTHING, count, number, percent, short};
use super::super::mistakes::Mistakes;
use super::super::table::{Cell, Column, Row, folded, table};
use crate::report::{Errors, RayClass, SceneReport, TraceRow, Work};

const COLUMNS: [Column; 16] = [
    Column::text("contender", "Structure, preset and precision"),
    Column::number("threads", "Threads that traced"),
    Column::number("Mrays/s", "Million rays per second: median of the rounds"),
    Column::number(
        "spread",
        "Largest minus smallest round, as a part of the median",
    ),
    Column::number("wrong / M", "Wrong answers per million audited rays"),
    Column::number(
        "false hits",
        "Audited rays: a hit where the ray hits nothing",
    ),
    Column::number(
        "false misses",
        "Audited rays: no hit where the ray hits something",
    ),
    Column::number(
        "wrong triangle",
        "Audited rays: another triangle than the closest",
    ),
    Column::number(
        "far off",
        "Of the wrong triangles: t is off by more than a thousandth",
    ),
    Column::number("audited", "Rays that were compared with the exact answer"),
    Column::number(
        "t error, ulp",
        "Error of t where the triangle is right: median, 99.9 %, largest",
    ),
    Column::number("nodes", "Node visits per ray"),
    Column::number("box tests", "Tests against boxes and planes per ray"),
    Column::number("triangle tests", "Triangle tests per ray"),
    Column::number(
        "f32 / f64 / exp.",
        "Exact precision: what settled its triangle tests: f32, f64, expansions",
    ),
    Column::text("way", "Instruction set and how rays are handed over"),
];

pub(super) fn body(context: &Context<'_>) -> Option<Markup> {
    let scenes: Vec<&SceneReport> = context
        .report
        .scenes
        .iter()
        .filter(|scene| !scene.traces.is_empty())
        .collect();
    if scenes.is_empty() {
        return None;
    }
    Some(html! {
        p {
            "Marked: " span.best-sample { "the fastest without a wrong answer" } ", for each number of threads. Errors are numbers of "
            "audited rays, "
            "per million in the column “wrong / M”."
        }
        @for (index, scene) in scenes.iter().enumerate() {
            (folded(&html! { strong { (scene.name) } ", " (count(scene.triangles)) " triangles" }, index == 0, &tables(context, scene, index == 0)))
        }
    })
}

fn tables(context: &Context<'_>, scene: &SceneReport, is_open: bool) -> Markup {
    let main = context.main_class();
    html! {
        @for note in &scene.notes {
            p { (note) }
        }
        @for class in RayClass::ALL {
            @let rows = sorted(scene, class);
            @if !rows.is_empty() {
                (folded(&headline(context, class, &rows), is_open && main == Some(class), &class_table(context, scene, class, &rows)))
            }
        }
    }
}

/// By threads, then the fastest first.
fn sorted(scene: &SceneReport, class: RayClass) -> Vec<&TraceRow> {
    let mut rows: Vec<&TraceRow> = scene
        .traces
        .iter()
        .filter(|row| row.class == class)
        .collect();
    rows.sort_by(|a, b| {
        let by_rate = b.rate.median().total_cmp(&a.rate.median());
        a.threads.cmp(&b.threads).then(by_rate)
    });
    rows
}

/// The fastest row without an error at a number of threads.
fn best<'a>(rows: &[&'a TraceRow], threads: usize) -> Option<&'a TraceRow> {
    let clean = rows.iter().copied();
    let mut clean =
        clean.filter(|row| row.threads == threads && Mistakes::of(&row.errors).is_clean());
    clean.next().filter(|row| row.rate.median() > 0.0)
}

fn headline(context: &Context<'_>, class: RayClass, rows: &[&TraceRow]) -> Markup {
    html! {
        (class.name()) " rays"
        @if let Some(best) = best(rows, context.threads) {
            span.aside {
                "fastest without a wrong answer: " (context.badge(&best.contender, &context.names.full(&best.contender)))
                ", " (number(best.rate.median())) " Mrays/s on " (threads_in_words(best.threads))
            }
        }
    }
}

fn class_table(
    context: &Context<'_>,
    scene: &SceneReport,
    class: RayClass,
    rows: &[&TraceRow],
) -> Markup {
    let fastest = |threads: usize| {
        let rates = rows.iter().filter(|row| row.threads == threads);
        rates.map(|row| row.rate.median()).fold(0.0, f64::max)
    };
    let cells: Vec<Row> = rows
        .iter()
        .map(|row| Row {
            cells: row_cells(context, row, fastest(row.threads)),
            is_best: best(rows, row.threads) == Some(*row),
        })
        .collect();
    table(
        &format!("{}, {} rays", scene.name, class.name()),
        &COLUMNS,
        &cells,
    )
}

fn row_cells(context: &Context<'_>, row: &TraceRow, fastest: f64) -> Vec<Cell> {
    let rate = row.rate.median();
    let name = context.names.full(&row.contender);
    let mut cells = vec![
        Cell::new(context.badge(&row.contender, &name)),
        count(row.threads).into(),
        Cell::from(number(rate)).with_bar(rate / fastest),
        percent(row.rate.spread()).into(),
    ];
    cells.extend(error_cells(&row.errors));
    cells.extend(work_cells(row.work.as_ref()));
    let way = format!("{}, {}", row.contender.simd, row.contender.interface);
    cells.push(way.into());
    cells
}

fn error_cells(errors: &Errors) -> Vec<Cell> {
    let mistakes = Mistakes::of(errors);
    let tone = match mistakes.per_million() {
        None => "unknown",
        Some(_) if mistakes.wrong == 0 => "good",
        Some(_) => "bad",
    };
    let known = |value: usize| {
        if errors.audited > 0 {
            count(value)
        } else {
            NOTHING.to_owned()
        }
    };
    let ulp = errors.t_ulp.map_or_else(
        || NOTHING.to_owned(),
        |ulp| {
            [ulp.median, ulp.quantile_999, ulp.largest]
                .map(short)
                .join(" / ")
        },
    );
    vec![
        Cell::from(mistakes.short()).with_tone(tone),
        known(errors.false_hits).into(),
        known(errors.false_misses).into(),
        known(errors.wrong_triangles).into(),
        known(errors.far_off).into(),
        count(errors.audited).into(),
        ulp.into(),
    ]
}

fn work_cells(work: Option<&Work>) -> Vec<Cell> {
    let Some(work) = work else {
        return vec![Cell::text(NOTHING); 4];
    };
    let settled = [
        work.settled_by_f32,
        work.settled_by_f64,
        work.settled_by_expansions,
    ];
    let settled = if settled.iter().all(|part| *part == 0.0) {
        NOTHING.to_owned()
    } else {
        settled.map(percent).join(" / ")
    };
    let means = [work.node_visits, work.bound_tests, work.triangle_tests];
    let mut cells: Vec<Cell> = means.into_iter().map(|mean| number(mean).into()).collect();
    cells.push(settled.into());
    cells
}
