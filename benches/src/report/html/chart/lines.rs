//! Points joined by lines.

use maud::{Markup, Render as _, html};

use super::super::mark::{Mark, Px, Shape};
use super::{Frame, tooltip};

/// A line.
#[derive(Clone, Debug, PartialEq)]
pub(in super::super) struct Series {
    pub(in super::super) mark: Mark,
    /// Places, and what is shown on pointing at them.
    pub(in super::super) points: Vec<(f64, f64, String)>,
}

/// A point of a line and what is shown on pointing at it.
type Place<'a> = (f64, f64, &'a String);

/// The lines in the frame.
pub(in super::super) fn lines(frame: &Frame<'_>, series: &[Series]) -> Markup {
    let placed = series.iter().map(|series| {
        let points = series.points.iter();
        let places: Vec<Place<'_>> = points
            .filter_map(|(x, y, title)| Some((frame.place_x(*x)?, frame.place_y(*y)?, title)))
            .collect();
        (series, places)
    });
    let placed: Vec<_> = placed.collect();
    let content = html! {
        @for (series, places) in &placed {
            @if places.len() > 1 {
                polyline class={ "line c" (series.mark.colour) (dashes(series.mark.shape)) } points=(joined(places)) {}
            }
        }
        @for (series, places) in &placed {
            @for (x, y, title) in places {
                (tooltip(title, &series.mark.at(*x, *y, false)))
            }
        }
    };
    frame.svg(&content)
}

/// The line tells the precision too, where markers lie on one another.
const fn dashes(shape: Shape) -> &'static str {
    match shape {
        Shape::Circle | Shape::Diamond => "",
        Shape::Square => " dashed",
        Shape::Triangle => " dotted",
    }
}

fn joined(places: &[Place<'_>]) -> String {
    let places = places
        .iter()
        .map(|(x, y, _)| format!("{},{}", Px(*x).render().0, Px(*y).render().0));
    places.collect::<Vec<_>>().join(" ")
}
