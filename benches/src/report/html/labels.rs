//! Where labels fit beside points without covering one another.

/// Width of a character, as a part of the size of the font: rather too wide than too narrow.
const CHARACTER: f64 = 0.62;

/// A rectangle in a chart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Area {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) right: f64,
    pub(super) bottom: f64,
}

impl Area {
    /// The square around a point.
    pub(super) const fn around(x: f64, y: f64, radius: f64) -> Self {
        Self {
            left: x - radius,
            top: y - radius,
            right: x + radius,
            bottom: y + radius,
        }
    }

    fn meets(&self, other: &Self) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }

    fn contains(&self, other: &Self) -> bool {
        self.left <= other.left
            && other.right <= self.right
            && self.top <= other.top
            && other.bottom <= self.bottom
    }
}

/// Where a text stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    /// The end of the text that is nearest to its point.
    pub(super) x: f64,
    /// The base line.
    pub(super) y: f64,
    /// The text ends at `x` instead of beginning there.
    pub(super) ends_here: bool,
    /// The label is so far away that a line must lead to it.
    pub(super) is_far: bool,
}

/// Places labels one after another.
#[derive(Clone, Debug)]
pub(super) struct Labels {
    bounds: Area,
    taken: Vec<Area>,
    size: f64,
}

impl Labels {
    /// For labels of a font size within bounds.
    pub(super) const fn new(bounds: Area, size: f64) -> Self {
        Self {
            bounds,
            taken: Vec::new(),
            size,
        }
    }

    /// Keeps labels away from an area.
    pub(super) fn avoid(&mut self, area: Area) {
        self.taken.push(area);
    }

    /// A place near a point, or `None` where all are taken.
    pub(super) fn place(&mut self, x: f64, y: f64, text: &str) -> Option<Place> {
        let width = text_width(text, self.size);
        for (dx, dy) in OFFSETS {
            let place = Place {
                x: x + dx,
                // From the middle of the text to its base line.
                y: y + dy + 0.35 * self.size,
                ends_here: dx < 0.0,
                is_far: dy.abs() > 20.0,
            };
            let left = if place.ends_here {
                place.x - width
            } else {
                place.x
            };
            let area = Area {
                left,
                top: y + dy - 0.6 * self.size,
                right: left + width,
                bottom: y + dy + 0.6 * self.size,
            };
            let is_free = !self.taken.iter().any(|other| other.meets(&area));
            if is_free && self.bounds.contains(&area) {
                self.taken.push(area);
                return Some(place);
            }
        }
        None
    }
}

/// From a point to its label, the best first.
const OFFSETS: [(f64, f64); 14] = [
    (10.0, 0.0),
    (-10.0, 0.0),
    (8.0, -12.0),
    (-8.0, -12.0),
    (8.0, 12.0),
    (-8.0, 12.0),
    (10.0, -26.0),
    (-10.0, -26.0),
    (10.0, 26.0),
    (-10.0, 26.0),
    (12.0, -42.0),
    (-12.0, -42.0),
    (12.0, 42.0),
    (-12.0, 42.0),
];

/// About how wide a text is.
pub(super) fn text_width(text: &str, size: f64) -> f64 {
    text.chars().map(|_| CHARACTER * size).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOUNDS: Area = Area {
        left: 0.0,
        top: 0.0,
        right: 200.0,
        bottom: 200.0,
    };

    #[test]
    fn a_label_at_the_right_end_stands_to_the_left() {
        let mut labels = Labels::new(BOUNDS, 10.0);
        let place = labels.place(195.0, 100.0, "a long name").expect("room");
        assert!(place.ends_here && place.x < 195.0, "{place:?}");
    }

    #[test]
    fn labels_of_one_point_stand_in_different_places() {
        let mut labels = Labels::new(BOUNDS, 10.0);
        let places: Vec<Place> = (0..40)
            .filter_map(|_| labels.place(100.0, 100.0, "name"))
            .collect();
        assert!((4..=OFFSETS.len()).contains(&places.len()), "{places:?}");
        for (index, area) in labels.taken.iter().enumerate() {
            assert!(
                labels.taken[..index].iter().all(|other| !other.meets(area)),
                "{area:?}"
            );
        }
    }

    #[test]
    fn a_label_without_room_is_left_out() {
        let mut labels = Labels::new(BOUNDS, 10.0);
        labels.avoid(BOUNDS);
        assert_eq!(labels.place(100.0, 100.0, "name"), None);
    }
}
