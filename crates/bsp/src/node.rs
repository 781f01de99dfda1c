//! The nodes that queries read.

use tahko_geometry::{Plane, Triangle};

/// An inner node: 48 bytes, aligned to 8.
///
/// | bytes | field | meaning |
/// |---|---|---|
/// | 0..32 | `plane` | the splitting plane, four f64 |
/// | 32..44 | `children` | what is in front of it, what is behind it, and what lies in it |
/// | 44..48 | | unused |
///
/// A tree over no triangles has an empty child for a root; one triangle makes a root that is a leaf.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Node {
    pub(crate) plane: Plane,
    pub(crate) children: [Child; 3],
}

/// Place of the child in front in [`Node::children`].
pub(crate) const FRONT: usize = 0;
/// Place of the child behind.
pub(crate) const BACK: usize = 1;
/// Place of the child whose polygons lie in the splitting plane.
pub(crate) const IN_PLANE: usize = 2;

/// A part of the list of references.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct List {
    pub(crate) first: u32,
    pub(crate) count: u32,
}

/// A link to a node, in 32 bits: all ones for an empty leaf, which takes no memory otherwise; the top bit and an index
/// of the list of leaves for a leaf; else an index of the list of nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Child(u32);

/// What a [`Child`] links to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Link {
    Inner(usize),
    Leaf(usize),
    Empty,
}

/// A triangle with its number in the mesh, 40 bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ListedTriangle {
    pub(crate) triangle: Triangle,
    pub(crate) number: u32,
}

const _: () = assert!(
    size_of::<Node>() == 48 && align_of::<Node>() == 8,
    "four bytes of padding"
);
const _: () = assert!(size_of::<ListedTriangle>() == 40, "no padding");

const LEAF_BIT: u32 = 1 << 31;

impl Child {
    pub(crate) const EMPTY: Self = Self(u32::MAX);

    pub(crate) fn inner(index: usize) -> Self {
        Self(index_bits(index))
    }

    pub(crate) fn leaf(index: usize) -> Self {
        Self(index_bits(index) | LEAF_BIT)
    }

    #[inline]
    pub(crate) const fn link(self) -> Link {
        if self.0 & LEAF_BIT == 0 {
            Link::Inner(self.0 as usize)
        } else if self.0 == u32::MAX {
            Link::Empty
        } else {
            Link::Leaf((self.0 & !LEAF_BIT) as usize)
        }
    }

    /// The same link in lists that follow others of these lengths.
    pub(crate) fn moved(self, nodes: usize, leaves: usize) -> Self {
        match self.link() {
            Link::Inner(index) => Self::inner(index + nodes),
            Link::Leaf(index) => Self::leaf(index + leaves),
            Link::Empty => Self::EMPTY,
        }
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "2^31 nodes would take 96 GiB, and 2^31 leaves need as many references"
)]
fn index_bits(index: usize) -> u32 {
    debug_assert!(index < LEAF_BIT as usize - 1, "the top bit marks leaves");
    index as u32
}

impl List {
    #[inline]
    pub(crate) fn range(self) -> std::ops::Range<usize> {
        self.first as usize..self.first as usize + self.count as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_keep_their_kind_and_index() {
        assert_eq!(Child::inner(7).link(), Link::Inner(7));
        assert_eq!(Child::leaf(7).link(), Link::Leaf(7));
        assert_eq!(Child::leaf(0).moved(5, 3).link(), Link::Leaf(3));
        assert_eq!(Child::inner(0).moved(5, 3).link(), Link::Inner(5));
        assert_eq!(Child::EMPTY.moved(5, 3).link(), Link::Empty);
    }
}
