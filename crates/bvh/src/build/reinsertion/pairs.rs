//! A binary tree whose nodes can be moved: siblings stand side by side and know their parent.

use tahko_geometry::glam::Vec4;

use crate::build::MAX_DEPTH;
use crate::build::node::to_u32;
use crate::build::reference::Bounds;
use crate::parallel::{collect, sort};

use super::search::Move;

/// The upper part of a tree, down to groups. The root has place 0, place 1 is not used, siblings have the places `2i` and `2i + 1`.
pub(super) struct PairTree {
    pub(super) pairs: Vec<Pair>,
    /// For each pair but the first one a node of the binary tree that stands for its parent when the tree is written back: the one whose children it was made of.
    pub(super) origins: Vec<u32>,
}

/// Two siblings in one cache line, which is all that a search reads of them: the corners of both boxes, and in the fourth lanes the link of the first, the place of
/// their parent, the link of the second, and both heights.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(super) struct Pair([Vec4; 4]);

const _: () = assert!(size_of::<Pair>() == 64, "a cache line");

/// One of two siblings.
#[derive(Clone, Copy)]
pub(super) struct Sibling {
    pub(super) bounds: Bounds,
    /// The place of its first child, or [`GROUP`] and the index of a group's root in the binary tree.
    pub(super) link: u32,
    /// Nodes on the longest way down to a leaf, this one and those in groups included.
    pub(super) height: u8,
}

/// Marks the links of groups. Trees have at most 2^30 nodes.
pub(super) const GROUP: u32 = 1 << 31;

pub(super) const ROOT: usize = 0;

impl Pair {
    /// Two siblings whose parent is not known yet.
    pub(super) fn new(siblings: [Sibling; 2]) -> Self {
        let mut pair = Self([Vec4::ZERO; 4]);
        pair.set(0, siblings[0]);
        pair.set(1, siblings[1]);
        pair
    }

    #[inline]
    fn bounds(&self, side: usize) -> Bounds {
        Bounds::between(self.0[2 * side], self.0[2 * side + 1])
    }

    #[inline]
    fn link(&self, side: usize) -> u32 {
        self.0[2 * side].w.to_bits()
    }

    fn parent(&self) -> u32 {
        self.0[1].w.to_bits()
    }

    pub(super) fn set_parent(&mut self, place: u32) {
        self.0[1].w = f32::from_bits(place);
    }

    fn heights(&self) -> [u8; 4] {
        self.0[3].w.to_bits().to_le_bytes()
    }

    fn sibling(&self, side: usize) -> Sibling {
        Sibling {
            bounds: self.bounds(side),
            link: self.link(side),
            height: self.heights()[side],
        }
    }

    /// Sets all but the parent.
    fn set(&mut self, side: usize, sibling: Sibling) {
        let (parent, mut heights) = (self.parent(), self.heights());
        heights[side] = sibling.height;
        self.0[2 * side] = sibling.bounds.lower();
        self.0[2 * side + 1] = sibling.bounds.upper();
        self.0[2 * side].w = f32::from_bits(sibling.link);
        self.0[1].w = f32::from_bits(parent);
        self.0[3].w = f32::from_bits(u32::from_le_bytes(heights));
    }

    /// The same pair in a list that stands behind some other places.
    pub(super) fn behind(&self, places: u32) -> Self {
        let mut moved = *self;
        moved.set_parent(self.parent() + places);
        for side in 0..2 {
            moved.0[2 * side].w = f32::from_bits(link_behind(self.link(side), places));
        }
        moved
    }
}

/// A link as it is behind some other places.
pub(super) const fn link_behind(link: u32, places: u32) -> u32 {
    if link & GROUP == 0 {
        link + places
    } else {
        link
    }
}

impl PairTree {
    /// Places, used or not.
    pub(super) const fn len(&self) -> usize {
        2 * self.pairs.len()
    }

    #[inline]
    pub(super) fn bounds(&self, place: usize) -> Bounds {
        self.pairs[place / 2].bounds(place % 2)
    }

    #[inline]
    pub(super) fn link(&self, place: usize) -> u32 {
        self.pairs[place / 2].link(place % 2)
    }

    /// The place of the parent of any node but the root.
    #[inline]
    pub(super) fn parent(&self, place: usize) -> usize {
        self.pairs[place / 2].parent() as usize
    }

    /// The places of the children of a node that is no group.
    #[inline]
    pub(super) fn children(&self, place: usize) -> Option<[usize; 2]> {
        let link = self.link(place);
        (link & GROUP == 0).then_some([link as usize, link as usize + 1])
    }

    fn height(&self, place: usize) -> u8 {
        self.pairs[place / 2].heights()[place % 2]
    }

    fn set(&mut self, place: usize, sibling: Sibling) {
        self.pairs[place / 2].set(place % 2, sibling);
    }

    /// The places of some nodes with the largest areas, in order of their places, without the root and its children.
    pub(super) fn largest(&self, count: usize) -> Vec<u32> {
        let mut keys = collect(self.len() - 2, |index| {
            let place = index + 2;
            #[expect(
                clippy::cast_possible_truncation,
                reason = "rounds: which nodes are tried is a matter of speed"
            )]
            let area = self.bounds(place).half_area() as f32;
            // Areas are not negative, so their bits are in their order; the smallest key has the largest area.
            u64::from(!area.to_bits()) << 32 | u64::from(to_u32(place))
        });
        if count < keys.len() {
            keys.select_nth_unstable(count);
            keys.truncate(count);
        }
        #[expect(clippy::cast_possible_truncation, reason = "the lower half")]
        let mut places: Vec<u32> = keys.into_iter().map(|key| key as u32).collect();
        places.retain(|place| self.parent(*place as usize) != ROOT);
        sort(&mut places, u32::cmp);
        places
    }

    /// Makes a move, unless a node that it needs is among those that `changed`, or it is not possible any more. Whether it was made.
    pub(super) fn make(&mut self, wanted: &Move, changed: &mut [bool]) -> bool {
        let (subtree, target) = (wanted.subtree as usize, wanted.target as usize);
        let sibling = subtree ^ 1;
        let parent = self.parent(subtree);
        let needed = [subtree, sibling, parent, target];
        if needed.iter().any(|place| changed[*place]) || !self.may_move(subtree, target) {
            return false;
        }
        for place in needed {
            changed[place] = true;
        }
        // The sibling takes the place of the parent. The target moves to where the sibling was, and the pair hangs where the target was.
        self.copy(sibling, parent);
        self.copy(target, sibling);
        let pair = Sibling {
            link: to_u32(subtree & !1),
            ..self.pairs[target / 2].sibling(target % 2)
        };
        self.set(target, pair);
        self.pairs[subtree / 2].set_parent(wanted.target);
        self.refit_up(self.parent(parent));
        self.refit_up(target);
        true
    }

    /// Whether a subtree may become the sibling of a target: the target is not below it, and the tree does not get too deep.
    fn may_move(&self, subtree: usize, target: usize) -> bool {
        let mut depth = 1;
        let mut place = target;
        while place != ROOT {
            if place == subtree {
                return false;
            }
            place = self.parent(place);
            depth += 1;
        }
        let height = self.height(subtree).max(self.height(target));
        depth + usize::from(height) <= MAX_DEPTH
    }

    /// Puts a node with all that is below it into another place, whose node goes elsewhere or is not needed.
    fn copy(&mut self, from: usize, to: usize) {
        self.set(to, self.pairs[from / 2].sibling(from % 2));
        if let Some([first, _]) = self.children(to) {
            self.pairs[first / 2].set_parent(to_u32(to));
        }
    }

    /// Brings the nodes from one with children upward up to date, as far as they change.
    fn refit_up(&mut self, mut place: usize) {
        while let Some([first, second]) = self.children(place) {
            let before = self.pairs[place / 2].sibling(place % 2);
            let bounds = self.bounds(first).union(self.bounds(second));
            let height = 1 + self.height(first).max(self.height(second));
            let changes = height != before.height || !bounds.equals(&before.bounds);
            let link = before.link;
            self.set(
                place,
                Sibling {
                    bounds,
                    link,
                    height,
                },
            );
            if !changes || place == ROOT {
                return;
            }
            place = self.parent(place);
        }
    }
}
