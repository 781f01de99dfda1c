//! A cell under construction, and its division by a plane.

use tahko_geometry::{Aabb, Axis, Triangle};

use super::clip::clipped_bounds;
use super::events::{Division, EventLists, Target};
use crate::KdTreeOptions;

/// What the build of all cells needs to know.
#[derive(Debug)]
pub(super) struct Context<'a> {
    /// All triangles of the mesh.
    pub triangles: &'a [Triangle],
    pub options: &'a KdTreeOptions,
    /// The number of splits allowed between the root and a leaf.
    pub max_depth: u32,
}

/// A triangle listed in a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reference {
    /// Index in the mesh.
    pub triangle: u32,
    /// A box around the part of the triangle in the cell, inside the cell.
    pub bounds: Aabb,
}

/// Where a cell is to be divided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Split {
    pub axis: Axis,
    pub position: f32,
    /// Whether triangles that lie in the plane go to the left; one side is enough, since either closed
    /// cell contains them whole.
    pub planar_left: bool,
}

/// On which sides of a plane a reference has points to be listed for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sides {
    Left,
    Right,
    Both,
}

impl Split {
    #[inline]
    pub(super) fn sides(&self, bounds: &Aabb) -> Sides {
        let axis = self.axis as usize;
        let (min, max) = (bounds.min[axis], bounds.max[axis]);
        if min == max && min == self.position {
            if self.planar_left {
                Sides::Left
            } else {
                Sides::Right
            }
        } else if max <= self.position {
            Sides::Left
        } else if min >= self.position {
            Sides::Right
        } else {
            Sides::Both
        }
    }
}

#[derive(Debug)]
pub(super) struct Cell {
    pub bounds: Aabb,
    pub references: Vec<Reference>,
    /// Sorted events of the references, numbered as in `references`; `None` for policies that use none.
    pub events: Option<EventLists>,
    /// Splits between the root and this cell.
    pub depth: u32,
    /// The number of references that this cell's leaves may have together.
    pub budget: usize,
}

/// Memory that the division of one cell leaves to the next.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    /// For medians.
    pub centers: Vec<f32>,
    division: Division,
    references: Vec<Vec<Reference>>,
    events: Vec<EventLists>,
}

impl Scratch {
    /// Keeps the memory of a cell that is done with.
    pub(super) fn recycle(&mut self, cell: Cell) {
        self.references.push(cell.references);
        self.events.extend(cell.events);
    }

    fn empty_list(&mut self) -> Vec<Reference> {
        let mut list = self.references.pop().unwrap_or_default();
        list.clear();
        list
    }
}

impl Cell {
    /// Divides the cell, in time proportional to its references, plus sorting those that straddle the plane.
    pub(super) fn divide(
        self,
        split: Split,
        context: &Context<'_>,
        scratch: &mut Scratch,
    ) -> [Self; 2] {
        let axis = split.axis as usize;
        let mut halves = [self.bounds; 2];
        halves[0].max[axis] = split.position;
        halves[1].min[axis] = split.position;
        scratch.division.references = [scratch.empty_list(), scratch.empty_list()];
        scratch.division.fill(&self, split, &halves, context);
        let events = self.events.as_ref().map(|events| {
            let mut parts = [(); 2].map(|()| scratch.events.pop().unwrap_or_default());
            events.distribute(&scratch.division, &mut parts);
            parts
        });
        let lists = std::mem::take(&mut scratch.division.references);
        let budgets = share(self.budget, lists.each_ref().map(Vec::len));
        let depth = self.depth + 1;
        scratch.recycle(self);
        let [left_events, right_events] = match events {
            Some(parts) => parts.map(Some),
            None => [None, None],
        };
        let child = |bounds, references, events, budget| Self {
            bounds,
            references,
            events,
            depth,
            budget,
        };
        let [left, right] = lists;
        [
            child(halves[0], left, left_events, budgets[0]),
            child(halves[1], right, right_events, budgets[1]),
        ]
    }
}

impl Division {
    /// Puts the references of a cell, or their parts, into the lists of its halves.
    fn fill(&mut self, cell: &Cell, split: Split, halves: &[Aabb; 2], context: &Context<'_>) {
        self.targets.clear();
        for numbers in &mut self.cut_parts {
            numbers.clear();
        }
        let [left, right] = &mut self.references;
        for reference in &cell.references {
            let target = match split.sides(&reference.bounds) {
                Sides::Left => Target::left(push(left, *reference)),
                Sides::Right => Target::right(push(right, *reference)),
                Sides::Both => {
                    let lists = [&mut *left, &mut *right];
                    for ((list, half), numbers) in
                        lists.into_iter().zip(halves).zip(&mut self.cut_parts)
                    {
                        if let Some(part) = clip(reference, half, context) {
                            numbers.push(push(list, part));
                        }
                    }
                    Target::CUT
                }
            };
            self.targets.push(target);
        }
    }
}

fn push(list: &mut Vec<Reference>, reference: Reference) -> usize {
    list.push(reference);
    list.len() - 1
}

/// The part of a reference in one half of its cell.
fn clip(reference: &Reference, half: &Aabb, context: &Context<'_>) -> Option<Reference> {
    let triangle = &context.triangles[reference.triangle as usize];
    let bounds = clipped_bounds(triangle, half)?.intersection(reference.bounds);
    (!bounds.is_empty()).then_some(Reference {
        bounds,
        ..*reference
    })
}

/// Divides a budget that is at least `left + right` in proportion to them.
fn share(budget: usize, [left, right]: [usize; 2]) -> [usize; 2] {
    let total = (left + right).max(1) as u64;
    // Both factors are below 2^31.
    let share = budget as u64 * left as u64 / total;
    let share = usize::try_from(share).unwrap_or(budget);
    [share, budget - share]
}
