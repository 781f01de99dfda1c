//! Ratios as dots with whiskers, row by row, and a line where both are equal.

use maud::{Markup, html};

use super::super::format;
use super::super::labels::text_width;
use super::super::mark::{Mark, Px};
use super::super::scale::Domain;
use super::{FONT_SIZE, line, svg, text, tooltip};

const WIDTH: f64 = 560.0;
const ROW: f64 = 20.0;
const TOP: f64 = 6.0;
const BOTTOM: f64 = 40.0;
const RIGHT: f64 = 16.0;

/// A row.
#[derive(Clone, Debug, PartialEq)]
pub(in super::super) struct Row {
    pub(in super::super) name: String,
    pub(in super::super) dots: Vec<Dot>,
}

/// A dot.
#[derive(Clone, Debug, PartialEq)]
pub(in super::super) struct Dot {
    pub(in super::super) mark: Mark,
    pub(in super::super) value: f64,
    /// The ends of its whiskers.
    pub(in super::super) ends: (f64, f64),
    pub(in super::super) title: String,
}

/// An axis that has room for 1 and for the dots of all rows.
pub(in super::super) fn domain<'a>(rows: impl IntoIterator<Item = &'a Row>) -> Option<Domain> {
    let dots = rows.into_iter().flat_map(|row| &row.dots);
    let values = dots.flat_map(|dot| [dot.value, dot.ends.0, dot.ends.1]);
    Domain::logarithmic(values.chain([1.0]))
}

/// The rows over an axis.
pub(in super::super) fn dots(
    title: &str,
    description: &str,
    axis: &str,
    domain: &Domain,
    rows: &[Row],
) -> Markup {
    let widths = rows.iter().map(|row| text_width(&row.name, FONT_SIZE));
    let left = widths.fold(60.0, f64::max) + 16.0;
    let place = |value: f64| Some(left + domain.fraction(value)? * (WIDTH - left - RIGHT));
    let bottom = rows.iter().fold(TOP, |y, _| y + ROW);
    let content = html! {
        @for (tick, x) in domain.ticks().into_iter().filter_map(|tick| Some((tick, place(tick)?))) {
            (line("grid", (x, TOP), (x, bottom)))
            (text("tick middle", x, bottom + 16.0, &format!("{}×", format::short(tick))))
        }
        @if let Some(x) = place(1.0) { (line("unity", (x, TOP), (x, bottom))) }
        @for (index, row) in (0u32..).zip(rows) {
            @let y = TOP + ROW * (f64::from(index) + 0.5);
            (text("row end", left - 8.0, y + 4.0, &row.name))
            @for (dot, x, low, high) in row.dots.iter().filter_map(|dot| Some((dot, place(dot.value)?, place(dot.ends.0)?, place(dot.ends.1)?))) {
                (tooltip(&dot.title, &html! {
                    line class={ "range c" (dot.mark.colour) } x1=(Px(low)) x2=(Px(high)) y1=(Px(y)) y2=(Px(y)) {}
                    (dot.mark.at(x, y, false))
                }))
            }
        }
        (text("name end", WIDTH - RIGHT, bottom + 34.0, axis))
    };
    svg(title, description, WIDTH, bottom + BOTTOM, &content)
}
