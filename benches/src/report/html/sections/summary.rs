//! The most important findings in a paragraph, computed from the report.

use std::collections::BTreeSet;

use maud::{Markup, html};

use super::super::context::{Context, Overall, geometric_mean, median};
use super::super::format::{count, number, percent, seconds};
use super::super::mark::OWN_LIBRARY;
use super::super::mistakes::Mistakes;
use super::{builds, exactness};
use crate::report::{Contender, RayClass};

pub(in super::super) fn paragraph(context: &Context<'_>) -> Markup {
    html! {
        p.summary {
            (measured(context)) " "
            (fastest(context)) " "
            (free_of_errors(context)) " "
            (exactness_cost(context)) " "
            (cheapest(context))
        }
    }
}

/// What was compared with what.
fn measured(context: &Context<'_>) -> Markup {
    let scenes = &context.report.scenes;
    let contenders = traced(context);
    let libraries: BTreeSet<&str> = contenders
        .iter()
        .map(|contender| contender.library.as_str())
        .filter(|library| *library != OWN_LIBRARY)
        .collect();
    let triangles = || scenes.iter().map(|scene| scene.triangles);
    let (least, most) = (
        triangles().min().unwrap_or(0),
        triangles().max().unwrap_or(0),
    );
    html! {
        "This page compares " (amount(contenders.len(), "contender")) " on " (amount(scenes.len(), "scene"))
        @if most > 0 { " with " (count(least)) @if most > least { " to " (count(most)) } " triangles" }
        @if !libraries.is_empty() {
            ", among them " (amount(libraries.len(), "other library").replace("librarys", "libraries"))
        }
        "."
    }
}

/// The fastest without a wrong answer, and the fastest of all.
fn fastest(context: &Context<'_>) -> Markup {
    let Some(class) = context.main_class() else {
        return html! {};
    };
    let field = context.field(class);
    let clean = field
        .shown
        .iter()
        .find(|overall| overall.mistakes.is_clean());
    let first = field.shown.first();
    let name = |overall: &Overall<'_>| context.names.full(overall.contender);
    let rate = |overall: &Overall<'_>| format!("{} million rays per second", number(overall.rate));
    html! {
        @if let Some(clean) = clean {
            "On " (class.name()) " rays and " (context.on_threads()) ", the fastest without a wrong answer is "
            strong { (name(clean)) } " with " strong { (rate(clean)) } " (geometric mean over " (amount(field.scenes, "scene")) "; "
            (clean.mistakes.words()) ")"
            @match first {
                Some(first) if first.contender == clean.contender => { "; no other contender is faster." }
                Some(first) => { "; the fastest of all is " strong { (name(first)) } " with " (number(first.rate)) " and " (first.mistakes.words()) "." }
                None => { "." }
            }
        } @else if let Some(first) = first {
            "On " (class.name()) " rays, every contender gave wrong answers; the fastest is " strong { (name(first)) } " with "
            (rate(first)) " and " (first.mistakes.words()) "."
        }
    }
}

/// Who gave no wrong answer at all, of those that answered every class of rays: packets leave out the hard ones.
fn free_of_errors(context: &Context<'_>) -> Markup {
    let rows = || context.report.scenes.iter().flat_map(|scene| &scene.traces);
    let classes: BTreeSet<RayClass> = rows().map(|row| row.class).collect();
    let mut contenders = traced(context);
    contenders.retain(|contender| {
        let own = rows().filter(|row| row.contender == **contender);
        own.map(|row| row.class).collect::<BTreeSet<_>>() == classes
    });
    let clean: Vec<&&Contender> = contenders
        .iter()
        .filter(|contender| {
            let own = rows().filter(|row| row.contender == ***contender);
            own.map(|row| &row.errors).collect::<Mistakes>().is_clean()
        })
        .collect();
    let own = clean
        .iter()
        .filter(|contender| contender.library == OWN_LIBRARY);
    let names: Vec<String> = own.map(|contender| context.names.full(contender)).collect();
    let others = clean.len() - names.len();
    html! {
        @if !contenders.is_empty() {
            "Of the " (contenders.len()) " that answered rays of every class, " @if clean.is_empty() { "none" } @else { (clean.len()) } " gave no wrong answer to any audited "
            "ray of any class"
            @if !names.is_empty() && names.len() <= 8 {
                ": tahko’s " (names.join(", "))
                @if others > 0 { ", and " (others) " of other libraries" }
            }
            "."
        }
    }
}

fn exactness_cost(context: &Context<'_>) -> Markup {
    let comparisons = exactness::comparisons(context);
    let middle = |to: &str| {
        let ratios = comparisons.iter().filter(|comparison| comparison.to == to);
        median(ratios.map(|comparison| comparison.ratio.median()).collect())
    };
    let against: Vec<String> = exactness::OTHERS
        .iter()
        .filter_map(|to| {
            Some(format!(
                "{} of the speed of the {to} one",
                percent(middle(to)?)
            ))
        })
        .collect();
    html! {
        @if !against.is_empty() {
            "The exact precision runs at " (against.join(" and ")) " (medians over structures, scenes and classes)."
        }
    }
}

/// What is built fastest and needs the least memory.
fn cheapest(context: &Context<'_>) -> Markup {
    let builds = builds::overall(context);
    let fastest = builds
        .iter()
        .filter(|(_, builds)| builds.iter().all(|build| build.seconds.median() > 0.0));
    let fastest = fastest
        .map(|(contender, builds)| {
            (
                contender,
                geometric_mean(builds.iter().map(|build| build.seconds.median())),
            )
        })
        .min_by(|a, b| a.1.total_cmp(&b.1));
    let smallest = builds
        .iter()
        .filter_map(|(contender, builds)| {
            let bytes: Option<Vec<f64>> = builds
                .iter()
                .map(|build| build.bytes_per_triangle)
                .collect();
            Some((contender, median(bytes?)?))
        })
        .min_by(|a, b| a.1.total_cmp(&b.1));
    html! {
        @if let Some((contender, time)) = fastest {
            "Built fastest is " (context.names.build(contender)) " (" (seconds(time)) " on one thread, geometric mean)"
            @if smallest.is_none() { "." }
        }
        @if let Some((contender, bytes)) = smallest {
            @if fastest.is_some() { "; the" } @else { "The" }
            " least memory takes " (context.names.build(contender)) " (" (number(bytes)) " bytes per triangle)."
        }
    }
}

/// Those that traced rays.
fn traced<'a>(context: &Context<'a>) -> BTreeSet<&'a Contender> {
    let rows = context.report.scenes.iter().flat_map(|scene| &scene.traces);
    rows.map(|row| &row.contender).collect()
}

/// `one scene`, `3 scenes`.
fn amount(number: usize, of: &str) -> String {
    match number {
        1 => format!("one {of}"),
        _ => format!("{} {of}s", count(number)),
    }
}
