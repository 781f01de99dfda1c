//! What colours and shapes stand for.

use maud::{Markup, html};

use super::super::chart::legend;
use super::super::context::Context;
use super::super::mark::{Mark, Shape};
use crate::report::Contender;

/// The colours of some contenders.
pub(super) fn colours<'a>(
    context: &Context<'_>,
    contenders: impl IntoIterator<Item = &'a Contender>,
) -> Markup {
    let mut structures: Vec<(Mark, Markup)> = Vec::new();
    let mut known: Vec<String> = Vec::new();
    for contender in contenders {
        let name = context.names.structure(contender);
        if !known.contains(&name) {
            let mark = context.mark(contender);
            structures.push((
                Mark {
                    shape: Shape::Circle,
                    is_hollow: false,
                    ..mark
                },
                html! { (name) },
            ));
            known.push(name);
        }
    }
    structures.sort_by_key(|(mark, _)| mark.colour);
    html! { div.key { (named("Colour: structure", &structures)) } }
}

/// The colours and shapes of some contenders.
pub(super) fn colours_and_shapes<'a>(
    context: &Context<'_>,
    contenders: impl Iterator<Item = &'a Contender> + Clone,
) -> Markup {
    let marks: Vec<Mark> = contenders
        .clone()
        .map(|contender| context.mark(contender))
        .collect();
    let grey = |shape, is_hollow| Mark {
        colour: 3,
        shape,
        is_hollow,
    };
    let is_there = |shape: Shape| marks.iter().any(|mark| mark.shape == shape);
    let known = Shape::ALL.iter().filter(|(shape, _)| is_there(*shape));
    let mut shapes: Vec<(Mark, Markup)> = known
        .map(|(shape, name)| (grey(*shape, false), html! { (name) }))
        .collect();
    if marks.iter().any(|mark| mark.is_hollow) {
        shapes.push((
            grey(Shape::Circle, true),
            html! { "hollow: many rays in a call" },
        ));
    }
    html! {
        (colours(context, contenders))
        div.key { (named("Shape: precision", &shapes)) }
    }
}

fn named(name: &str, entries: &[(Mark, Markup)]) -> Markup {
    html! { span.key-name { (name) } (legend(entries)) }
}
