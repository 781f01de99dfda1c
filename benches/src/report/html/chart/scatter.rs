//! Points in a plane, with the front that nothing beats, or with a diagonal.

use maud::{Markup, html};

use super::super::labels::{Area, Labels};
use super::super::mark::{Mark, Px};
use super::{FONT_SIZE, Frame, line, text, tooltip};

/// Half of the height of a marker, with its outline.
const RADIUS: f64 = 7.0;
/// Between the lanes in the band of zeros.
const LANE: f64 = 11.0;

/// A point.
#[derive(Clone, Debug, PartialEq)]
pub(in super::super) struct Point {
    pub(in super::super) x: f64,
    /// Zero lies in the band, if the frame has one.
    pub(in super::super) y: f64,
    pub(in super::super) mark: Mark,
    /// Shown on pointing at it.
    pub(in super::super) title: String,
    /// Stands beside it, where there is room.
    pub(in super::super) label: Option<String>,
    /// It is on the front: larger, and joined with the others there.
    pub(in super::super) is_strong: bool,
}

/// The points in the frame, the strong ones above the others and joined by steps.
pub(in super::super) fn scatter(frame: &Frame<'_>, points: &[Point]) -> Markup {
    let placed = place(frame, points);
    let weak_first = || {
        let strong = placed.iter().filter(|placed| placed.0.is_strong);
        placed
            .iter()
            .filter(|placed| !placed.0.is_strong)
            .chain(strong)
    };
    let content = html! {
        (front(&placed))
        @for (point, x, y) in weak_first() {
            (tooltip(&point.title, &point.mark.at(*x, *y, point.is_strong)))
        }
        (labels(frame, &placed))
    };
    frame.svg(&content)
}

/// The points in a frame whose axes have the same unit, with the line on which both are equal.
pub(in super::super) fn against_diagonal(frame: &Frame<'_>, points: &[Point]) -> Markup {
    let placed = place(frame, points);
    let (x, y) = (frame.x.domain.ends(), frame.y.domain.ends());
    let ends =
        [x.0.max(y.0), x.1.min(y.1)].map(|end| Some((frame.place_x(end)?, frame.place_y(end)?)));
    let content = html! {
        @if let [Some(from), Some(to)] = ends && x.0.max(y.0) < x.1.min(y.1) {
            (line("diagonal", from, to))
        }
        @for (point, x, y) in &placed {
            (tooltip(&point.title, &point.mark.at(*x, *y, point.is_strong)))
        }
        (labels(frame, &placed))
    };
    frame.svg(&content)
}

/// Those that have a place, with it.
fn place<'a>(frame: &Frame<'_>, points: &'a [Point]) -> Vec<(&'a Point, f64, f64)> {
    let mut placed = Vec::new();
    let mut in_band: Vec<(&Point, f64)> = Vec::new();
    for point in points {
        let Some(x) = frame.place_x(point.x) else {
            continue;
        };
        if frame.band.is_some() && point.y == 0.0 {
            in_band.push((point, x));
        } else if let Some(y) = frame.place_y(point.y) {
            placed.push((point, x, y));
        }
    }
    // The front first, so that its points stay in the middle.
    in_band.sort_by(|a, b| {
        (!a.0.is_strong, a.1)
            .partial_cmp(&(!b.0.is_strong, b.1))
            .expect("finite")
    });
    placed.extend(spread(frame.band_y(), &in_band));
    placed
}

/// Moves points of the band to other lanes where they would cover one another.
fn spread<'a>(middle: f64, points: &[(&'a Point, f64)]) -> Vec<(&'a Point, f64, f64)> {
    let lanes = [0.0, LANE, -LANE].map(|offset| middle + offset);
    let mut placed: Vec<(&Point, f64, f64)> = Vec::new();
    for (point, x) in points {
        let distance = |lane: f64| {
            let others = placed.iter().filter(|(_, _, y)| *y == lane);
            others
                .map(|(_, other, _)| (other - x).abs())
                .fold(f64::INFINITY, f64::min)
        };
        let free = lanes
            .into_iter()
            .find(|lane| distance(*lane) >= 2.0 * RADIUS);
        let widest = || {
            lanes
                .into_iter()
                .max_by(|a, b| distance(*a).total_cmp(&distance(*b)))
        };
        let y = free.or_else(widest).unwrap_or(middle);
        placed.push((point, *x, y));
    }
    placed
}

/// Steps through the strong points: how fast one can be with so many errors at most.
fn front(placed: &[(&Point, f64, f64)]) -> Markup {
    let mut corners: Vec<(f64, f64)> = placed
        .iter()
        .filter(|(point, _, _)| point.is_strong)
        .map(|(_, x, y)| (*x, *y))
        .collect();
    // From the fewest errors, at the bottom, upwards.
    corners.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.total_cmp(&b.0)));
    let mut path = String::new();
    for (x, y) in &corners {
        use maud::Render as _;
        let (x, y) = (Px(*x).render().0, Px(*y).render().0);
        if path.is_empty() {
            path = format!("M{x} {y}");
        } else {
            path.push_str(&format!("V{y}H{x}"));
        }
    }
    html! { @if corners.len() > 1 { path.front d=(path) {} } }
}

/// Labels of the points that have one, away from all markers.
fn labels(frame: &Frame<'_>, placed: &[(&Point, f64, f64)]) -> Markup {
    let mut labels = Labels::new(frame.area(), FONT_SIZE);
    for (_, x, y) in placed {
        labels.avoid(Area::around(*x, *y, RADIUS));
    }
    if let Some(area) = frame.caption_area() {
        labels.avoid(area);
    }
    let strong_first = || {
        let weak = placed.iter().filter(|(point, _, _)| !point.is_strong);
        let strong = placed.iter().filter(|(point, _, _)| point.is_strong);
        strong.chain(weak)
    };
    html! {
        @for (point, x, y) in strong_first() {
            @if let Some((label, place)) = point.label.as_ref().and_then(|label| Some((label, labels.place(*x, *y, label)?))) {
                @if place.is_far {
                    (line("leader", (*x, *y), (place.x, place.y - 0.3 * FONT_SIZE)))
                }
                @let class = format!("label{}{}", if point.is_strong { "" } else { " quiet" }, if place.ends_here { " end" } else { "" });
                (text(&class, place.x, place.y, label))
            }
        }
    }
}
