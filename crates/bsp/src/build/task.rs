//! What is to be done at a node.

use tahko_geometry::{Side, glam::DVec3};

use super::random::Seed;
use crate::Straddlers;
use crate::cell::Cell;
use crate::divider::Divider;
use crate::node::{BACK, FRONT, IN_PLANE};
use crate::piece::Piece;

/// A node that is not built yet.
#[derive(Debug)]
pub(super) struct Task<'a> {
    pub(super) pieces: Vec<Piece<'a>>,
    /// The cell of the node, where the splitter asks for it.
    pub(super) cell: Option<Cell>,
    /// Whether all pieces are in the splitting plane of a node above.
    pub(super) is_flat: bool,
    /// Planes on the way from the root.
    pub(super) depth: usize,
    pub(super) seed: Seed,
    /// The most references that the subtree may have, not below the number of pieces.
    pub(super) budget: usize,
}

/// How many polygons are where, seen from a plane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Counts {
    pub(super) front: usize,
    pub(super) back: usize,
    pub(super) coplanar: usize,
    pub(super) spanning: usize,
}

impl Counts {
    pub(super) fn new<'p>(
        divider: &Divider,
        outlines: impl IntoIterator<Item = &'p [DVec3]>,
    ) -> Self {
        let mut counts = Self::default();
        for outline in outlines {
            match divider.side_of(outline) {
                Side::Front => counts.front += 1,
                Side::Back => counts.back += 1,
                Side::Coplanar => counts.coplanar += 1,
                Side::Spanning => counts.spanning += 1,
            }
        }
        counts
    }

    /// An estimate from counts of a part.
    pub(super) const fn times(self, factor: usize) -> Self {
        Self {
            front: self.front * factor,
            back: self.back * factor,
            coplanar: self.coplanar * factor,
            spanning: self.spanning * factor,
        }
    }

    /// Entries in the lists of all children.
    const fn references(&self) -> usize {
        self.front + self.back + self.coplanar + 2 * self.spanning
    }

    /// Whether each side has fewer polygons than the node. What splits a node forever does not.
    pub(super) const fn makes_progress(&self) -> bool {
        self.back + self.coplanar > 0 && self.front + self.coplanar > 0
    }
}

/// What a plane makes of a task.
#[derive(Debug)]
pub(super) struct Parts<'a> {
    /// Front, back and in the plane.
    pub(super) children: [Task<'a>; 3],
    pub(super) straddlers: usize,
}

impl<'a> Task<'a> {
    pub(super) fn ids(&self) -> impl ExactSizeIterator<Item = u32> {
        self.pieces.iter().map(Piece::id)
    }

    /// Whether the task may be split so. Pieces that are in a plane already must not be put into it again.
    pub(super) fn allows(&self, counts: &Counts) -> bool {
        let repeats = self.is_flat && counts.coplanar == self.pieces.len();
        !repeats && counts.references() <= self.budget
    }

    /// Distributes the pieces over the sides of a plane that is [allowed](Self::allows).
    pub(super) fn split(self, divider: &Divider, straddlers: Straddlers) -> Parts<'a> {
        let mut pieces = [Vec::new(), Vec::new(), Vec::new()];
        let mut straddler_count = 0;
        for piece in self.pieces {
            match divider.side_of(piece.vertices()) {
                Side::Front => pieces[FRONT].push(piece),
                Side::Back => pieces[BACK].push(piece),
                Side::Coplanar => pieces[IN_PLANE].push(piece),
                Side::Spanning => {
                    straddler_count += 1;
                    let [in_front, behind] = piece.parts(&divider.plane, straddlers);
                    pieces[FRONT].extend(in_front);
                    pieces[BACK].extend(behind);
                }
            }
        }
        let budgets = shares(self.budget, [0, 1, 2].map(|side| pieces[side].len()));
        let cells = match self.cell {
            Some(cell) => cell.cut(&divider.plane).map(Some),
            None => [None, None, None],
        };
        let child = |side: usize, pieces, cell| Task {
            pieces,
            cell,
            is_flat: self.is_flat || side == IN_PLANE,
            depth: self.depth + 1,
            seed: self.seed.child(side),
            budget: budgets[side],
        };
        let [front, back, in_plane] = pieces;
        let [front_cell, back_cell, section] = cells;
        Parts {
            children: [
                child(FRONT, front, front_cell),
                child(BACK, back, back_cell),
                child(IN_PLANE, in_plane, section),
            ],
            straddlers: straddler_count,
        }
    }
}

/// A budget shared among lists: each gets its length, and of the rest a part in proportion to it.
fn shares(budget: usize, lengths: [usize; 3]) -> [usize; 3] {
    let total: usize = lengths.iter().sum();
    let spare = budget.saturating_sub(total) as u128;
    lengths.map(|length| length + (spare * length as u128 / total.max(1) as u128) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_at_least_the_lengths_and_at_most_the_budget() {
        assert_eq!(shares(100, [10, 30, 10]), [20, 60, 20]);
        assert_eq!(shares(7, [3, 3, 1]), [3, 3, 1]);
        assert_eq!(shares(10, [2, 1, 0]), [6, 3, 0]);
        assert_eq!(shares(0, [0, 0, 0]), [0, 0, 0]);
    }
}
