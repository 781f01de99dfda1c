//! What is to be done at a node.

use tahko_geometry::{Plane, Side};

use super::random::Seed;
use crate::Straddlers;
use crate::cell::Cell;
use crate::node::{BACK, FRONT};
use crate::piece::Piece;

/// A node that is not built yet.
#[derive(Debug)]
pub(super) struct Task<'a> {
    pub(super) pieces: Vec<Piece<'a>>,
    /// The cell of the node, where the splitter asks for it.
    pub(super) cell: Option<Cell>,
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
    pub(super) fn new(plane: &Plane, pieces: &[Piece<'_>]) -> Self {
        let mut counts = Self::default();
        for piece in pieces {
            match piece.side_of(plane) {
                Side::Front => counts.front += 1,
                Side::Back => counts.back += 1,
                Side::Coplanar => counts.coplanar += 1,
                Side::Spanning => counts.spanning += 1,
            }
        }
        counts
    }

    /// Entries in the lists of both children and the node.
    pub(super) const fn references(&self) -> usize {
        self.front + self.back + self.coplanar + 2 * self.spanning
    }

    /// Whether both children have fewer polygons than the node. What splits a node forever does not.
    pub(super) const fn makes_progress(&self) -> bool {
        self.back + self.coplanar > 0 && self.front + self.coplanar > 0
    }
}

/// What a plane makes of a task.
#[derive(Debug)]
pub(super) struct Parts<'a> {
    pub(super) coplanar: Vec<u32>,
    pub(super) children: [Task<'a>; 2],
    pub(super) straddlers: usize,
}

impl<'a> Task<'a> {
    pub(super) fn ids(&self) -> impl ExactSizeIterator<Item = u32> {
        self.pieces.iter().map(Piece::id)
    }

    /// Distributes the pieces over both sides of a plane. The budget that is not used up is shared in
    /// proportion to the numbers of pieces.
    pub(super) fn split(self, plane: &Plane, straddlers: Straddlers) -> Parts<'a> {
        let mut front = Vec::new();
        let mut back = Vec::new();
        let mut coplanar = Vec::new();
        let mut straddler_count = 0;
        for piece in self.pieces {
            match piece.side_of(plane) {
                Side::Front => front.push(piece),
                Side::Back => back.push(piece),
                Side::Coplanar => coplanar.push(piece.id()),
                Side::Spanning => {
                    straddler_count += 1;
                    let [in_front, behind] = piece.parts(plane, straddlers);
                    front.extend(in_front);
                    back.extend(behind);
                }
            }
        }
        let budget = self.budget - coplanar.len();
        let total = front.len() + back.len();
        let spare = budget - total;
        let front_spare = (spare as u128 * front.len() as u128)
            .checked_div(total as u128)
            .unwrap_or(0) as usize;
        let budgets = [
            front.len() + front_spare,
            budget - front.len() - front_spare,
        ];
        let cells = match self.cell {
            Some(cell) => cell.cut(plane).map(Some),
            None => [None, None],
        };
        let [front_cell, back_cell] = cells;
        let child = |pieces, cell, side: usize| Task {
            pieces,
            cell,
            depth: self.depth + 1,
            seed: self.seed.child(side),
            budget: budgets[side],
        };
        Parts {
            coplanar,
            children: [
                child(front, front_cell, FRONT),
                child(back, back_cell, BACK),
            ],
            straddlers: straddler_count,
        }
    }
}
