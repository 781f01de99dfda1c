//! The nodes of a [`BinaryTree`](super::BinaryTree), and how lists of them become one list.

use tahko_geometry::{Aabb, glam::Vec3};

use crate::filling::Filling;
use crate::parallel::for_each;

/// A box and what it links to, 32 bytes.
///
/// An inner node names its children in `links`. A leaf has [`LEAF`] set in the second link, its number of references in the
/// other bits, and its first reference in the first link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BuildNode {
    min: Vec3,
    max: Vec3,
    links: [u32; 2],
}

const _: () = assert!(size_of::<BuildNode>() == 32, "two nodes share a cache line");

/// Marks leaves. References and nodes are numbered below it: meshes have at most 2^29 triangles.
const LEAF: u32 = 1 << 31;

#[derive(Clone, Copy, Debug)]
pub(crate) enum Link {
    /// The children's places in the tree's list of nodes.
    Inner([usize; 2]),
    /// The leaf's part of the list of references.
    Leaf { first: usize, count: usize },
}

impl BuildNode {
    /// A leaf of nothing, which no node links to.
    pub(super) const UNUSED: Self = Self {
        min: Vec3::ZERO,
        max: Vec3::ZERO,
        links: [0, LEAF],
    };

    pub(super) fn new(bounds: &Aabb, link: Link) -> Self {
        let links = match link {
            Link::Inner(children) => children.map(to_u32),
            Link::Leaf { first, count } => [to_u32(first), to_u32(count) | LEAF],
        };
        Self {
            min: bounds.min,
            max: bounds.max,
            links,
        }
    }

    pub(super) const fn bounds(&self) -> Aabb {
        Aabb::new(self.min, self.max)
    }

    pub(super) const fn link(&self) -> Link {
        let [first, second] = self.links;
        if second & LEAF == 0 {
            Link::Inner([first as usize, second as usize])
        } else {
            Link::Leaf {
                first: first as usize,
                count: (second & !LEAF) as usize,
            }
        }
    }

    pub(super) const fn is_leaf(&self) -> bool {
        self.links[1] & LEAF != 0
    }

    /// The same node with the places of its children, or of its references, moved.
    pub(super) fn moved(self, nodes: Shift, references: Shift) -> Self {
        let [first, second] = self.links;
        let links = if self.is_leaf() {
            [references.apply(first), second]
        } else {
            [nodes.apply(first), nodes.apply(second)]
        };
        Self { links, ..self }
    }
}

/// How far places in a list move, forwards or backwards.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shift(u32);

impl Shift {
    pub(super) const NONE: Self = Self(0);

    pub(super) fn new(from: usize, to: usize) -> Self {
        Self(to_u32(to).wrapping_sub(to_u32(from)))
    }

    const fn apply(self, place: u32) -> u32 {
        place.wrapping_add(self.0)
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "trees have fewer than 2^30 nodes and references"
)]
pub(super) fn to_u32(index: usize) -> u32 {
    debug_assert!(index < LEAF as usize, "{index} is too large");
    index as u32
}

/// One list of the nodes of the top, whose links are final, and of blocks, whose nodes link to children within
/// their block. Cost: O(n), shared among threads.
pub(super) fn concatenate(top: &[BuildNode], blocks: &[Vec<BuildNode>]) -> Vec<BuildNode> {
    let length = top.len() + blocks.iter().map(Vec::len).sum::<usize>();
    let mut nodes = Filling::new(length);
    let mut whole = nodes.whole();
    let mut copies = Vec::with_capacity(blocks.len());
    for block in blocks.iter().rev() {
        copies.push((whole.split_last(block.len()), block));
    }
    whole.fill_last(top.iter().copied());
    drop(whole);
    for_each(copies, |(mut target, block)| {
        let shift = Shift::new(0, target.first());
        target.fill_last(block.iter().map(|node| node.moved(shift, Shift::NONE)));
    });
    nodes.finish()
}

/// Cuts a part off the front of a slice.
pub(super) fn take<'a, T>(slice: &mut &'a mut [T], length: usize) -> &'a mut [T] {
    let (part, rest) = std::mem::take(slice).split_at_mut(length);
    *slice = rest;
    part
}
