//! The frame of a chart with two axes: grid, ticks and names.

use maud::{Markup, html};

use super::super::labels::{Area, text_width};
use super::super::mark::Px;
use super::{Domain, FONT_SIZE, line, svg, text};

const WIDTH: f64 = 560.0;
const HEIGHT: f64 = 370.0;
const LEFT: f64 = 66.0;
const RIGHT: f64 = 14.0;
const TOP: f64 = 28.0;
const BOTTOM: f64 = 44.0;
/// Height of the band for zero.
const BAND: f64 = 76.0;
/// Between the axis and the band.
const GAP: f64 = 6.0;

/// An axis.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Axis<'a> {
    pub(in super::super) name: &'a str,
    pub(in super::super) domain: Domain,
    /// Writes the value of a tick.
    pub(in super::super) tick: fn(f64) -> String,
}

/// The frame around the data.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Frame<'a> {
    pub(in super::super) title: &'a str,
    pub(in super::super) description: &'a str,
    pub(in super::super) x: Axis<'a>,
    pub(in super::super) y: Axis<'a>,
    /// What stands in a band below the axis, which holds the points at zero; no band without it.
    pub(in super::super) band: Option<&'a str>,
}

impl Frame<'_> {
    /// Where the plot ends at the bottom, without the band.
    fn floor(&self) -> f64 {
        let band = if self.band.is_some() { BAND + GAP } else { 0.0 };
        HEIGHT - BOTTOM - band
    }

    pub(super) fn place_x(&self, value: f64) -> Option<f64> {
        let fraction = self.x.domain.fraction(value)?;
        Some(LEFT + fraction * (WIDTH - LEFT - RIGHT))
    }

    pub(super) fn place_y(&self, value: f64) -> Option<f64> {
        let fraction = self.y.domain.fraction(value)?;
        Some(self.floor() + fraction * (TOP - self.floor()))
    }

    /// The middle of the band.
    pub(super) const fn band_y(&self) -> f64 {
        HEIGHT - BOTTOM - BAND / 2.0 + 4.0
    }

    /// Where data and labels may stand.
    pub(super) const fn area(&self) -> Area {
        Area {
            left: LEFT,
            top: TOP - 6.0,
            right: WIDTH - RIGHT,
            bottom: HEIGHT - BOTTOM,
        }
    }

    /// Where the caption of the band stands.
    pub(super) fn caption_area(&self) -> Option<Area> {
        let top = HEIGHT - BOTTOM - BAND;
        self.band.map(|caption| Area {
            left: LEFT,
            top,
            right: LEFT + 6.0 + text_width(caption, FONT_SIZE),
            bottom: top + 18.0,
        })
    }

    pub(super) fn svg(&self, content: &Markup) -> Markup {
        let inside = html! {
            (self.grid())
            (content)
        };
        svg(self.title, self.description, WIDTH, HEIGHT, &inside)
    }

    fn grid(&self) -> Markup {
        let bottom = HEIGHT - BOTTOM;
        html! {
            @if let Some(caption) = self.band {
                rect.band x=(Px(LEFT)) y=(Px(bottom - BAND)) width=(Px(WIDTH - LEFT - RIGHT)) height=(Px(BAND)) {}
                (text("tick end", LEFT - 8.0, self.band_y() + 4.0, "0"))
                (text("caption", LEFT + 6.0, bottom - BAND + 13.0, caption))
            }
            @for (tick, x) in self.x.domain.ticks().into_iter().filter_map(|tick| Some((tick, self.place_x(tick)?))) {
                (line("grid", (x, TOP), (x, bottom)))
                (text("tick middle", x, bottom + 16.0, &(self.x.tick)(tick)))
            }
            @for (tick, y) in self.y.domain.ticks().into_iter().filter_map(|tick| Some((tick, self.place_y(tick)?))) {
                (line("grid", (LEFT, y), (WIDTH - RIGHT, y)))
                (text("tick end", LEFT - 8.0, y + 4.0, &(self.y.tick)(tick)))
            }
            (line("axis", (LEFT, bottom), (WIDTH - RIGHT, bottom)))
            (text("name end", WIDTH - RIGHT, bottom + 36.0, self.x.name))
            (text("name", 2.0, 13.0, self.y.name))
        }
    }
}
