//! Charts as SVG.
//!
//! A place in a chart comes from [`Domain::fraction`] only, which gives none for what is no number; such points are left out.

pub(super) mod bars;
pub(super) mod dots;
mod frame;
pub(super) mod lines;
pub(super) mod scatter;
pub(super) mod strips;

use maud::{Markup, html};

use super::mark::{Mark, Px};
use super::scale::Domain;

pub(super) use frame::{Axis, Frame};

/// Size of the text in charts; the style sheet says the same.
const FONT_SIZE: f64 = 12.0;

/// An SVG with its name and description for those who do not see it.
fn svg(title: &str, description: &str, width: f64, height: f64, content: &Markup) -> Markup {
    html! {
        svg.chart role="img" viewBox={ "0 0 " (Px(width)) " " (Px(height)) } xmlns="http://www.w3.org/2000/svg" aria-label=(title) {
            title { (title) }
            desc { (description) }
            (content)
        }
    }
}

fn text(class: &str, x: f64, y: f64, content: &str) -> Markup {
    html! { text class=(class) x=(Px(x)) y=(Px(y)) { (content) } }
}

fn line(class: &str, from: (f64, f64), to: (f64, f64)) -> Markup {
    html! { line class=(class) x1=(Px(from.0)) y1=(Px(from.1)) x2=(Px(to.0)) y2=(Px(to.1)) {} }
}

fn tooltip(title: &str, content: &Markup) -> Markup {
    html! { g.tip { title { (title) } (content) } }
}

/// A chart with a heading and, below it, whatever explains it.
pub(super) fn figure(heading: &str, chart: &Markup, below: &Markup) -> Markup {
    html! {
        figure {
            figcaption { (heading) }
            (chart)
            (below)
        }
    }
}

/// Markers and what they stand for.
pub(super) fn legend(entries: &[(Mark, Markup)]) -> Markup {
    html! {
        ul.legend {
            @for (mark, name) in entries {
                li { (mark.in_text()) " " (name) }
            }
        }
    }
}
