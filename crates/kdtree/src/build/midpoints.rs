//! Splits without a cost model: the middle of the cell and the object median.
//!
//! Where all triangles straddle the plane on the chosen axis, the next axes are tried; where no axis
//! separates anything, as for equal triangles, the cell becomes a leaf.

use tahko_geometry::Axis;

use super::cell::{Cell, Reference, Sides, Split};
use crate::AxisChoice;

/// The split in the middle of the cell; `None` if none is of use.
pub(super) fn middle_split(cell: &Cell, choice: AxisChoice) -> Option<Split> {
    axes(cell, choice).into_iter().find_map(|axis| {
        let middle = 0.5 * cell.bounds.min[axis as usize] + 0.5 * cell.bounds.max[axis as usize];
        useful_split(cell, axis, middle)
    })
}

/// The split that has as many centres of references on both sides; `None` if none is of use.
pub(super) fn median_split(
    cell: &Cell,
    choice: AxisChoice,
    centers: &mut Vec<f32>,
) -> Option<Split> {
    axes(cell, choice).into_iter().find_map(|axis| {
        let median = median_of_centers(&cell.references, axis, centers)?;
        useful_split(cell, axis, median)
    })
}

/// The three axes, the preferred one first.
fn axes(cell: &Cell, choice: AxisChoice) -> [Axis; 3] {
    let first = match choice {
        AxisChoice::Cycling => Axis::ALL[cell.depth as usize % 3],
        AxisChoice::Longest => cell.bounds.longest_axis(),
    };
    [first, first.next(), first.next().next()]
}

/// Half-way between the two centres in the middle of their order. Expected time `O(n)`.
fn median_of_centers(references: &[Reference], axis: Axis, centers: &mut Vec<f32>) -> Option<f32> {
    let axis = axis as usize;
    centers.clear();
    centers.extend(
        references
            .iter()
            .map(|reference| reference.bounds.center()[axis]),
    );
    let half = centers.len() / 2;
    if half == 0 {
        return None;
    }
    let (lower, upper, _) = centers.select_nth_unstable_by(half, f32::total_cmp);
    let largest_lower = lower.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    Some(0.5 * largest_lower + 0.5 * *upper)
}

/// The split at a position, unless it is in a face of the cell, separates nothing, or exceeds the budget.
fn useful_split(cell: &Cell, axis: Axis, position: f32) -> Option<Split> {
    let (min, max) = (
        cell.bounds.min[axis as usize],
        cell.bounds.max[axis as usize],
    );
    if position <= min || max <= position {
        return None;
    }
    let split = Split {
        axis,
        position,
        planar_left: true,
    };
    let straddling = cell
        .references
        .iter()
        .filter(|reference| split.sides(&reference.bounds) == Sides::Both)
        .count();
    let total = cell.references.len() + straddling;
    (straddling < cell.references.len() && total <= cell.budget).then_some(split)
}
