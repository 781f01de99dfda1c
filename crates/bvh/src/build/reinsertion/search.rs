//! The search for the best place of a subtree.
//!
//! Taking `X` out removes its parent, whose area is gained, and shrinks the nodes above up to the lowest common ancestor of the old and the new
//! place. Above that nothing changes, as the subtree stays below. Putting it beside `Y` makes a new node with the area of the box around both, and
//! enlarges the nodes between the common ancestor and `Y`. So, with `d` for what has been gained or lost so far,
//! - the search walks up from `X`; at each node on the way, `d` is the area of the parent and what the nodes below that one shrink by;
//! - from each it looks into the other child's subtree, where `d` falls with every node that would grow;
//! - placed beside `Y` the gain is `d - area(X ∪ Y)`, and anywhere at or below `Y` at most `d - area(X)`, which prunes.

use crate::build::reference::Bounds;

use super::pairs::{PairTree, ROOT};

/// A subtree and the node whose sibling it should become.
#[derive(Clone, Copy, Debug)]
pub(super) struct Move {
    pub(super) subtree: u32,
    pub(super) target: u32,
    /// By how much the sum of the half areas of all inner nodes falls.
    pub(super) gain: f64,
}

/// The move of a subtree, neither the root nor a child of it, that gains most; `None` if none gains anything.
///
/// Cost: O(n) in the worst case; in practice bounds prune all but the neighbourhood of the subtree and the siblings of its ancestors.
pub(super) fn best(tree: &PairTree, subtree: usize) -> Option<Move> {
    let parent = tree.parent(subtree);
    let sibling = subtree ^ 1;
    let moved = tree.bounds(subtree);
    let mut search = Search {
        tree,
        moved,
        moved_area: moved.half_area(),
        gain: 0.0,
        target: None,
        waiting: Vec::new(),
    };
    let mut gained = tree.bounds(parent).half_area();
    // Beside its sibling the subtree is already: only what is below the sibling is looked at, which would grow to the parent's box.
    if let Some(children) = tree.children(sibling) {
        let sibling_area = tree.bounds(sibling).half_area();
        let gained = gained - (tree.bounds(parent).half_area() - sibling_area);
        for child in children {
            search.below(child, gained);
        }
    }
    let mut without = tree.bounds(sibling);
    let mut place = parent;
    while place != ROOT {
        let other = place ^ 1;
        search.below(other, gained);
        place = tree.parent(place);
        without = without.union(tree.bounds(other));
        gained += tree.bounds(place).half_area() - without.half_area();
    }
    search.target.map(|target| {
        #[expect(clippy::cast_possible_truncation, reason = "at most 2^30 nodes")]
        let [subtree, target] = [subtree, target].map(|place| place as u32);
        Move {
            subtree,
            target,
            gain: search.gain,
        }
    })
}

struct Search<'a> {
    tree: &'a PairTree,
    moved: Bounds,
    moved_area: f64,
    /// The best so far.
    gain: f64,
    target: Option<usize>,
    /// Nodes to look at, with what is gained before the subtree is put beside them.
    waiting: Vec<(usize, f64)>,
}

impl Search<'_> {
    /// Looks at a node and all that is below it.
    fn below(&mut self, top: usize, gained: f64) {
        self.waiting.push((top, gained));
        while let Some((place, gained)) = self.waiting.pop() {
            if gained - self.moved_area <= self.gain {
                continue;
            }
            let bounds = self.tree.bounds(place);
            let around = bounds.union(self.moved).half_area();
            if gained - around > self.gain {
                self.gain = gained - around;
                self.target = Some(place);
            }
            let gained = gained - (around - bounds.half_area());
            if gained - self.moved_area > self.gain
                && let Some(children) = self.tree.children(place)
            {
                self.waiting.extend(children.map(|child| (child, gained)));
            }
        }
    }
}
