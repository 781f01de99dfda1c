//! The surface area heuristic, evaluated at every event.
//!
//! A random ray that meets a cell meets a part of it with the probability of the ratio of their surface areas. A
//! split of a cell with area `A` is expected to cost `K_T + K_I (A_L N_L + A_R N_R) / A`, times the empty
//! space factor where `N_L` or `N_R` is zero, against `K_I N` for a leaf. Source: Wald and Havran 2006, sections 3 and 4.3.
//!
//! Triangles that lie in the plane count on the cheaper side. A plane in a face of the cell is a candidate only if
//! triangles lie in it, and they get a flat cell of their own. A cell without area (a point or a segment) is not split.

use tahko_geometry::{Aabb, Axis};

use super::cell::{Cell, Context, Split};
use super::events::{Event, EventKind, PARALLEL_EVENTS};
use super::join;

/// The best split found so far, or a leaf.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    /// Expected cost times the area of the cell.
    cost: f64,
    split: Option<Split>,
}

/// The cheapest split of a cell; `None` if a leaf is cheaper.
pub(super) fn cheapest_split(cell: &Cell, context: &Context<'_>) -> Option<Split> {
    let events = cell.events.as_ref()?;
    let area = cell.bounds.half_area();
    if area == 0.0 {
        return None;
    }
    let intersection_cost = f64::from(context.options.intersection_cost);
    let leaf = Candidate {
        cost: intersection_cost * area * cell.references.len() as f64,
        split: None,
    };
    let sweep = |axis: Axis| {
        let sweep = Sweep::new(cell, axis, context);
        sweep.run(events.axis(axis), leaf)
    };
    let candidates = if events.axis(Axis::X).len() < PARALLEL_EVENTS {
        Axis::ALL.map(sweep)
    } else {
        let (x, (y, z)) = join(
            || sweep(Axis::X),
            || join(|| sweep(Axis::Y), || sweep(Axis::Z)),
        );
        [x, y, z]
    };
    let cheapest = candidates
        .into_iter()
        .reduce(|best, other| if other.cost < best.cost { other } else { best })?;
    cheapest.split
}

/// One sweep over the planes perpendicular to an axis.
struct Sweep {
    axis: Axis,
    min: f32,
    max: f32,
    /// Half the area of a slab of the cell is `base + slope * thickness`.
    base: f64,
    slope: f64,
    traversal_cost: f64,
    intersection_cost: f64,
    empty_space_factor: f64,
    references: usize,
    budget: usize,
}

impl Sweep {
    fn new(cell: &Cell, axis: Axis, context: &Context<'_>) -> Self {
        let Aabb { min, max } = cell.bounds;
        let extent = max.as_dvec3() - min.as_dvec3();
        let [b, c] = [axis.next(), axis.next().next()].map(|other| extent[other as usize]);
        let options = context.options;
        Self {
            axis,
            min: min[axis as usize],
            max: max[axis as usize],
            base: b * c,
            slope: b + c,
            traversal_cost: f64::from(options.traversal_cost) * cell.bounds.half_area(),
            intersection_cost: f64::from(options.intersection_cost),
            empty_space_factor: f64::from(options.empty_space_factor),
            references: cell.references.len(),
            budget: cell.budget,
        }
    }

    fn run(&self, events: &[Event], leaf: Candidate) -> Candidate {
        let mut best = leaf;
        if self.min == self.max {
            return best;
        }
        let mut left = 0;
        let mut right = self.references;
        let mut rest = events;
        while let Some(first) = rest.first() {
            let key = first.position_key();
            let mut counts = [0; 3];
            let mut here = 0;
            while let Some(event) = rest.get(here)
                && event.position_key() == key
            {
                counts[event.kind() as usize] += 1;
                here += 1;
            }
            rest = &rest[here..];
            let planar = counts[EventKind::Planar as usize];
            right -= counts[EventKind::End as usize] + planar;
            self.consider(first.position(), [left, planar, right], &mut best);
            left += counts[EventKind::Start as usize] + planar;
        }
        best
    }

    /// Compares a plane, with the triangles on the left of it, in it, and on the right, with the best so far.
    #[inline]
    fn consider(&self, position: f32, [left, planar, right]: [usize; 3], best: &mut Candidate) {
        let at_min = position <= self.min;
        let at_max = position >= self.max;
        if left + planar + right > self.budget || (planar == 0 && (at_min || at_max)) {
            return;
        }
        let from_min = f64::from(position) - f64::from(self.min);
        let to_max = f64::from(self.max) - f64::from(position);
        let areas = [from_min, to_max].map(|thickness| self.base + self.slope * thickness);
        let mut offer = |planar_left: bool, counts: [usize; 2]| {
            let tests = areas[0] * counts[0] as f64 + areas[1] * counts[1] as f64;
            let mut cost = self.traversal_cost + self.intersection_cost * tests;
            if counts.contains(&0) {
                cost *= self.empty_space_factor;
            }
            if cost < best.cost {
                let split = Split {
                    axis: self.axis,
                    position,
                    planar_left,
                };
                *best = Candidate {
                    cost,
                    split: Some(split),
                };
            }
        };
        if !at_max {
            offer(true, [left + planar, right]);
        }
        if planar > 0 && !at_min {
            offer(false, [left, planar + right]);
        }
    }
}
