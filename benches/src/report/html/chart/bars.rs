//! Horizontal bars from zero.

use maud::{Markup, html};

use super::super::format;
use super::super::labels::text_width;
use super::super::mark::{Mark, Px};
use super::super::scale::Domain;
use super::{FONT_SIZE, line, svg, text, tooltip};

const WIDTH: f64 = 760.0;
const ROW: f64 = 22.0;
const TOP: f64 = 6.0;
const BOTTOM: f64 = 40.0;
const RIGHT: f64 = 60.0;

/// A bar.
#[derive(Clone, Debug, PartialEq)]
pub(in super::super) struct Bar {
    pub(in super::super) name: String,
    pub(in super::super) mark: Mark,
    pub(in super::super) value: f64,
    /// The smallest and largest of the values behind it.
    pub(in super::super) ends: (f64, f64),
    pub(in super::super) title: String,
}

/// Bars with their names to the left; `None` if no value is positive.
pub(in super::super) fn bars(
    title: &str,
    description: &str,
    axis: &str,
    bars: &[Bar],
) -> Option<Markup> {
    let values = bars.iter().flat_map(|bar| [bar.value, bar.ends.1]);
    let domain = Domain::from_zero(values)?;
    let widths = bars.iter().map(|bar| text_width(&bar.name, FONT_SIZE));
    let left = widths.fold(60.0, f64::max) + 12.0;
    let place = |value: f64| Some(left + domain.fraction(value)? * (WIDTH - left - RIGHT));
    let bottom = bars.iter().fold(TOP, |y, _| y + ROW);
    let rows = (0u32..).zip(bars).filter_map(|(index, bar)| {
        let y = TOP + ROW * f64::from(index);
        Some((
            bar,
            y,
            place(bar.value)?,
            place(bar.ends.0)?,
            place(bar.ends.1)?,
        ))
    });
    let content = html! {
        @for (tick, x) in domain.ticks().into_iter().filter_map(|tick| Some((tick, place(tick)?))) {
            (line("grid", (x, TOP), (x, bottom)))
            (text("tick middle", x, bottom + 16.0, &format::short(tick)))
        }
        @for (bar, y, end, low, high) in rows {
            @let middle = y + ROW / 2.0;
            (text("row end", left - 8.0, middle + 4.0, &bar.name))
            (tooltip(&bar.title, &html! {
                rect class={ "bar c" (bar.mark.colour) } x=(Px(left)) y=(Px(y + 3.0)) width=(Px(end - left)) height=(Px(ROW - 6.0)) {}
                @if high - low > 1.0 {
                    (line("whisker", (low, middle), (high, middle)))
                    (line("whisker", (low, middle - 4.0), (low, middle + 4.0)))
                    (line("whisker", (high, middle - 4.0), (high, middle + 4.0)))
                }
            }))
            (text("value", end.max(high) + 6.0, middle + 4.0, &format::number(bar.value)))
        }
        (line("axis", (left, TOP), (left, bottom)))
        (text("name end", WIDTH - RIGHT, bottom + 34.0, axis))
    };
    Some(svg(title, description, WIDTH, bottom + BOTTOM, &content))
}
