//! Cuts the references of a node at a plane.

use tahko_geometry::TriangleMesh;

use super::bins::{Side, SpatialSplit};
use super::clip;
use crate::build::reference::{Bounds, CentroidScale, Extent, Reference};
use crate::build::split::Parts;

/// A list of references cut in two: first those of the first side, then those of the second.
pub(super) struct SpatialParts {
    /// Where the second side begins.
    pub(super) middle: usize,
    /// How many there are on both sides.
    pub(super) total: usize,
    pub(super) first: Extent,
    pub(super) second: Extent,
}

impl SpatialParts {
    /// The parts of a number of references of which none is cut.
    pub(super) fn of_object_split(parts: &Parts, total: usize) -> Self {
        Self {
            middle: parts.middle,
            total,
            first: parts.first,
            second: parts.second,
        }
    }
}

/// Cuts the first `count` references of a buffer; those across the plane are cut in two, as long as the buffer has room for another,
/// or given to one side whole where that is cheaper.
///
/// Source: Stich, Friedrich, Dietrich, *Spatial splits in bounding volume hierarchies*, 2009, section 4.4 (reference unsplitting).
pub(super) fn apply(
    buffer: &mut [Reference],
    count: usize,
    split: &SpatialSplit,
    mesh: &TriangleMesh,
    scale: CentroidScale,
) -> SpatialParts {
    let mut parts = SpatialParts {
        middle: 0,
        total: count,
        first: Extent::EMPTY,
        second: Extent::EMPTY,
    };
    // Before `middle` and from `end` on references are settled, from `across` to `end` they are not looked at,
    // and between they are across the plane.
    let mut across = 0;
    let mut end = count;
    while across < end {
        let reference = buffer[across];
        let bounds = reference.bounds();
        if bounds.upper()[split.axis] <= split.plane {
            parts.first.add(&reference, scale);
            buffer.swap(parts.middle, across);
            parts.middle += 1;
            across += 1;
        } else if bounds.lower()[split.axis] >= split.plane {
            parts.second.add(&reference, scale);
            end -= 1;
            buffer.swap(across, end);
        } else {
            across += 1;
        }
    }
    let mut sides = split.sides;
    while parts.middle < end {
        let reference = buffer[parts.middle];
        let triangle = mesh.triangle(reference.number() as usize);
        let halves = clip::halves(&triangle, &reference.bounds(), split.axis, split.plane);
        let has_room = parts.total < buffer.len();
        match place(&reference.bounds(), halves, &mut sides, has_room) {
            Place::First(bounds) => {
                let reference = reference.with_bounds(&bounds);
                parts.first.add(&reference, scale);
                buffer[parts.middle] = reference;
                parts.middle += 1;
            }
            Place::Second(bounds) => {
                let reference = reference.with_bounds(&bounds);
                parts.second.add(&reference, scale);
                end -= 1;
                buffer[parts.middle] = buffer[end];
                buffer[end] = reference;
            }
            Place::Both([first, second]) => {
                let [first, second] = [first, second].map(|half| reference.with_bounds(&half));
                parts.first.add(&first, scale);
                parts.second.add(&second, scale);
                buffer[parts.middle] = first;
                buffer[parts.total] = second;
                parts.middle += 1;
                parts.total += 1;
            }
        }
    }
    parts
}

/// Where a reference across the plane goes, with its box there.
enum Place {
    First(Bounds),
    Second(Bounds),
    Both([Bounds; 2]),
}

/// Chooses the cheapest place by the expected boxes and numbers of both sides, and keeps these up to date. The sum over both sides of half area times
/// number is compared.
fn place(whole: &Bounds, halves: [Bounds; 2], sides: &mut [Side; 2], has_room: bool) -> Place {
    // A part that does not exist needs no reference, and the other one is all of it.
    if halves[0].is_empty() {
        sides[0].count = sides[0].count.saturating_sub(1);
        return Place::Second(halves[1]);
    }
    if halves[1].is_empty() {
        sides[1].count = sides[1].count.saturating_sub(1);
        return Place::First(halves[0]);
    }
    let [first, second] = *sides;
    let in_first = [
        Side {
            bounds: first.bounds.union(*whole),
            count: first.count,
        },
        Side {
            bounds: second.bounds,
            count: second.count.saturating_sub(1),
        },
    ];
    let in_second = [
        Side {
            bounds: first.bounds,
            count: first.count.saturating_sub(1),
        },
        Side {
            bounds: second.bounds.union(*whole),
            count: second.count,
        },
    ];
    let cost = |sides: &[Side; 2]| sides[0].cost() + sides[1].cost();
    let in_both = if has_room { cost(sides) } else { f64::INFINITY };
    let (first_cost, second_cost) = (cost(&in_first), cost(&in_second));
    if in_both <= first_cost && in_both <= second_cost {
        Place::Both(halves)
    } else if first_cost <= second_cost {
        *sides = in_first;
        Place::First(*whole)
    } else {
        *sides = in_second;
        Place::Second(*whole)
    }
}
