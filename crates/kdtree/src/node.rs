//! The node and its layout.

use tahko_geometry::Axis;

/// A node of the tree: 8 bytes, aligned to 4.
///
/// | bits | inner node | leaf |
/// |---|---|---|
/// | `value` | position of the splitting plane, as f32 bits | number of list entries |
/// | `packed`, lower 2 | axis of the plane: 0, 1 or 2 | 3 |
/// | `packed`, upper 30 | index of the left child; the right one follows it | index of the first list entry |
///
/// The left child's cell is where the coordinate is at most the position, the right child's where it is at
/// least that. An empty leaf has no entries. A tree over no triangles has no nodes; over one, it has at least a leaf.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Node {
    value: u32,
    packed: u32,
}

const _: () = assert!(
    size_of::<Node>() == 8 && align_of::<Node>() == 4,
    "eight nodes in a cache line"
);

const LEAF: u32 = 3;

/// A node, unpacked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Kind {
    Inner {
        axis: Axis,
        position: f32,
        /// Index of the left child.
        first_child: usize,
    },
    Leaf {
        /// Index of the first list entry.
        first: usize,
        count: usize,
    },
}

impl Node {
    /// The largest index of a child or of a list entry.
    pub(crate) const MAX_OFFSET: usize = (1 << 30) - 1;

    /// A leaf without list entries.
    pub(crate) const EMPTY_LEAF: Self = Self {
        value: 0,
        packed: LEAF,
    };

    /// An inner node; `first_child` is at most [`Self::MAX_OFFSET`].
    pub(crate) fn inner(axis: Axis, position: f32, first_child: usize) -> Self {
        Self {
            value: position.to_bits(),
            packed: pack(first_child, axis as u32),
        }
    }

    /// A leaf; `first` and `count` are at most [`Self::MAX_OFFSET`].
    pub(crate) fn leaf(first: usize, count: usize) -> Self {
        #[expect(clippy::cast_possible_truncation, reason = "at most MAX_OFFSET")]
        let value = count as u32;
        Self {
            value,
            packed: pack(first, LEAF),
        }
    }

    #[inline]
    pub(crate) const fn kind(self) -> Kind {
        let offset = (self.packed >> 2) as usize;
        let axis = match self.packed & 3 {
            0 => Axis::X,
            1 => Axis::Y,
            2 => Axis::Z,
            _ => {
                return Kind::Leaf {
                    first: offset,
                    count: self.value as usize,
                };
            }
        };
        Kind::Inner {
            axis,
            position: f32::from_bits(self.value),
            first_child: offset,
        }
    }

    /// The node after its children have moved up by `nodes` places and its list by `references`.
    pub(crate) fn moved(self, nodes: usize, references: usize) -> Self {
        match self.kind() {
            Kind::Inner {
                axis,
                position,
                first_child,
            } => Self::inner(axis, position, first_child + nodes),
            Kind::Leaf { first, count } => Self::leaf(first + references, count),
        }
    }
}

fn pack(offset: usize, tag: u32) -> u32 {
    debug_assert!(offset <= Node::MAX_OFFSET, "builders check the limit");
    #[expect(clippy::cast_possible_truncation, reason = "at most MAX_OFFSET")]
    let offset = offset as u32;
    offset << 2 | tag
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_unpack_to_what_was_packed() {
        for axis in Axis::ALL {
            for (position, first_child) in [(-0.0, 1), (f32::MAX, Node::MAX_OFFSET), (1e-45, 7)] {
                let Kind::Inner {
                    axis: unpacked,
                    position: at,
                    first_child: child,
                } = Node::inner(axis, position, first_child).kind()
                else {
                    panic!("an inner node became a leaf");
                };
                assert_eq!((unpacked, child), (axis, first_child));
                assert_eq!(at.to_bits(), position.to_bits());
            }
        }
        for (first, count) in [(0, 0), (Node::MAX_OFFSET, 3), (5, Node::MAX_OFFSET)] {
            assert_eq!(Node::leaf(first, count).kind(), Kind::Leaf { first, count });
        }
        assert_eq!(Node::EMPTY_LEAF, Node::leaf(0, 0));
    }
}
