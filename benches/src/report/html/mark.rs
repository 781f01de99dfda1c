//! Who is who in a chart: the colour says the structure, the shape the precision.
//!
//! Colours are custom properties of the style sheet, so that they follow a light or dark page: `--c0` to `--c3` for the project's structures, the
//! others for other libraries. They are close to the palette of Okabe and Ito (2008), which colour-blind readers can tell apart.

use std::collections::{BTreeMap, BTreeSet};

use maud::{Markup, Render, html};

use super::super::Contender;

/// The project's structures, in the order of their colours.
const STRUCTURES: [&str; 4] = ["bvh", "kdtree", "bsp", "brute"];
/// Colours in the style sheet.
const COLOURS: usize = 12;
/// The library whose structures have fixed colours.
pub(super) use crate::structures::LIBRARY as OWN_LIBRARY;

/// A length in a chart, with one decimal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Px(pub(super) f64);

impl Render for Px {
    fn render_to(&self, buffer: &mut String) {
        let rounded = (self.0 * 10.0).round() / 10.0;
        debug_assert!(rounded.is_finite(), "no place in a chart");
        // Adding zero turns -0 into 0.
        buffer.push_str(&(rounded + 0.0).to_string());
    }
}

/// The shape of a marker.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Shape {
    /// Exact.
    Circle,
    /// Watertight.
    Square,
    /// Fast.
    Triangle,
    /// What other libraries call their own.
    Diamond,
}

impl Shape {
    /// All of them, with what they stand for.
    pub(super) const ALL: [(Self, &str); 4] = [
        (Self::Circle, "exact"),
        (Self::Square, "watertight"),
        (Self::Triangle, "fast"),
        (Self::Diamond, "another library's own"),
    ];

    /// The shape of a precision.
    pub(super) fn of(precision: &str) -> Self {
        let known = Self::ALL[..3].iter().find(|(_, name)| *name == precision);
        known.map_or(Self::Diamond, |(shape, _)| *shape)
    }

    /// Of about the same area for all shapes, around the origin.
    fn path(self, radius: f64) -> String {
        let r = |factor: f64| Px(radius * factor).render().into_string();
        match self {
            Self::Circle => format!(
                "M-{0} 0a{0} {0} 0 1 0 {1} 0a{0} {0} 0 1 0-{1} 0z",
                r(1.0),
                r(2.0)
            ),
            Self::Square => format!("M-{0}-{0}H{0}V{0}H-{0}z", r(0.9)),
            Self::Triangle => format!("M0-{}L{1} {2}H-{1}z", r(1.2), r(1.15), r(0.8)),
            Self::Diamond => format!("M0-{0}L{0} 0L0 {0}L-{0} 0z", r(1.25)),
        }
    }
}

/// A marker.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Mark {
    /// Which colour.
    pub(super) colour: usize,
    pub(super) shape: Shape,
    /// Only the outline: many rays are handed over at once.
    pub(super) is_hollow: bool,
}

impl Mark {
    /// The marker around a point.
    pub(super) fn at(self, x: f64, y: f64, is_strong: bool) -> Markup {
        let radius = if is_strong { 6.0 } else { 4.6 };
        html! {
            path class=(self.class(is_strong)) d=(self.shape.path(radius)) transform={ "translate(" (Px(x)) " " (Px(y)) ")" } {}
        }
    }

    fn class(self, is_strong: bool) -> String {
        let hollow = if self.is_hollow { " hollow" } else { "" };
        let strong = if is_strong { " strong" } else { "" };
        format!("mark c{}{hollow}{strong}", self.colour)
    }

    /// The marker in running text.
    pub(super) fn in_text(self) -> Markup {
        html! {
            svg.swatch viewBox="-8 -8 16 16" aria-hidden="true" { (self.at(0.0, 0.0, false)) }
        }
    }
}

/// Which library and structure has which colour.
#[derive(Clone, Debug)]
pub(super) struct Palette {
    colours: BTreeMap<(String, String), usize>,
}

impl Palette {
    /// Fixed colours for the project's structures; the others take theirs in the order of their names.
    pub(super) fn new(contenders: &BTreeSet<Contender>) -> Self {
        let mut colours = BTreeMap::new();
        let mut next = STRUCTURES.len();
        for contender in contenders {
            let key = (contender.library.clone(), contender.structure.clone());
            if colours.contains_key(&key) {
                continue;
            }
            let own = STRUCTURES
                .iter()
                .position(|name| *name == contender.structure)
                .filter(|_| contender.library == OWN_LIBRARY);
            let colour = own.unwrap_or_else(|| {
                let colour = next;
                next = if next + 1 < COLOURS {
                    next + 1
                } else {
                    STRUCTURES.len()
                };
                colour
            });
            colours.insert(key, colour);
        }
        Self { colours }
    }

    /// The marker of a contender.
    pub(super) fn mark(&self, contender: &Contender) -> Mark {
        let key = (contender.library.clone(), contender.structure.clone());
        Mark {
            colour: self.colours.get(&key).copied().unwrap_or(COLOURS - 1),
            shape: Shape::of(&contender.precision),
            is_hollow: contender.interface != "single",
        }
    }

    /// The marker of one of the project's structures at a precision.
    pub(super) fn own(structure: &str, precision: &str) -> Mark {
        let colour = STRUCTURES.iter().position(|name| *name == structure);
        Mark {
            colour: colour.unwrap_or(COLOURS - 1),
            shape: Shape::of(precision),
            is_hollow: false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_short_and_never_minus_zero() {
        for (value, text) in [(1.0, "1"), (-0.01, "0"), (2.25, "2.3"), (-7.12, "-7.1")] {
            assert_eq!(Px(value).render().into_string(), text);
        }
    }

    #[test]
    fn own_structures_have_fixed_colours_and_others_their_own() {
        let contender = |library: &str, structure: &str| Contender {
            library: library.to_owned(),
            structure: structure.to_owned(),
            preset: String::new(),
            precision: "exact".to_owned(),
            simd: String::new(),
            interface: "single".to_owned(),
        };
        let all = [
            ("a", "bvh"),
            ("b", "bvh"),
            ("tahko", "bvh"),
            ("tahko", "bsp"),
        ];
        let contenders = all.map(|(library, structure)| contender(library, structure));
        let palette = Palette::new(&contenders.iter().cloned().collect());
        let colours = contenders.map(|contender| palette.mark(&contender).colour);
        assert_eq!(colours, [4, 5, 0, 2]);
        assert_eq!(Palette::own("bsp", "fast").colour, 2);
    }
}
