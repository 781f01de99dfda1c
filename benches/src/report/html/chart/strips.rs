//! Stretches of a logarithmic axis, a row for each scene.

use maud::{Markup, html};

use super::super::format;
use super::super::labels::text_width;
use super::super::mark::{Mark, Px};
use super::super::scale::Domain;
use super::{FONT_SIZE, line, svg, text, tooltip};

const WIDTH: f64 = 560.0;
const ROW: f64 = 30.0;
const TOP: f64 = 4.0;
const BOTTOM: f64 = 42.0;
const RIGHT: f64 = 14.0;

/// A row of stretches.
#[derive(Clone, Debug, PartialEq)]
pub(in super::super) struct Strip {
    pub(in super::super) name: String,
    pub(in super::super) pieces: Vec<Piece>,
}

/// A stretch; it may begin at zero and end at infinity.
#[derive(Clone, Debug, PartialEq)]
pub(in super::super) struct Piece {
    pub(in super::super) mark: Mark,
    /// What stands inside, the best first: the first one that fits.
    pub(in super::super) labels: [String; 2],
    pub(in super::super) from: f64,
    pub(in super::super) to: f64,
    pub(in super::super) title: String,
}

/// The strips; `None` if nothing ever changes.
pub(in super::super) fn strips(
    title: &str,
    description: &str,
    axis: &str,
    strips: &[Strip],
) -> Option<Markup> {
    let pieces = strips.iter().flat_map(|strip| &strip.pieces);
    // Some room at both ends, for the stretches that begin at zero or never end.
    let ends = pieces.flat_map(|piece| [piece.from / 5.0, piece.from * 5.0]);
    let domain = Domain::logarithmic(ends)?;
    let widths = strips
        .iter()
        .map(|strip| text_width(&strip.name, FONT_SIZE));
    let left = widths.fold(60.0, f64::max) + 12.0;
    let across = |fraction: f64| left + fraction * (WIDTH - left - RIGHT);
    let end = |value: f64, otherwise: f64| across(domain.fraction(value).unwrap_or(otherwise));
    let bottom = strips.iter().fold(TOP, |y, _| y + ROW);
    let content = html! {
        @for (tick, x) in domain.ticks().into_iter().filter_map(|tick| Some((tick, across(domain.fraction(tick)?)))) {
            (line("grid", (x, TOP), (x, bottom + 4.0)))
            (text("tick middle", x, bottom + 18.0, &format::rays(tick)))
        }
        @for (index, strip) in (0u32..).zip(strips) {
            @let y = TOP + ROW * f64::from(index);
            (text("row end", left - 8.0, y + ROW / 2.0 + 4.0, &strip.name))
            @for piece in &strip.pieces {
                @let (from, to) = (end(piece.from, 0.0), end(piece.to, 1.0));
                (tooltip(&piece.title, &html! {
                    rect class={ "piece c" (piece.mark.colour) } x=(Px(from)) y=(Px(y + 4.0)) width=(Px((to - from).max(1.0))) height=(Px(ROW - 8.0)) {}
                    @if let Some(label) = piece.labels.iter().find(|label| text_width(label, FONT_SIZE) + 4.0 < to - from) {
                        (text("inside middle", (from + to) / 2.0, y + ROW / 2.0 + 4.0, label))
                    }
                }))
            }
        }
        (text("name end", WIDTH - RIGHT, bottom + 36.0, axis))
    };
    Some(svg(title, description, WIDTH, bottom + BOTTOM, &content))
}
