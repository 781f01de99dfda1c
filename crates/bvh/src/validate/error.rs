//! What can be wrong with a tree.

use std::fmt;

use thiserror::Error;

/// What is wrong with a tree.
///
/// Nodes are numbered in memory order. Triangles stand in blocks of up to eight; a leaf has the number of its first block.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ValidationError {
    /// There are nodes or triangles, but no root.
    #[error("the tree has no root")]
    NoRoot,
    /// The first block, which stands for children that are not there, is missing or has triangles.
    #[error("block 0 is not an empty leaf")]
    FirstBlockInUse,
    /// A node or block is named that does not exist.
    #[error("{content} is named, but there are only {count}")]
    OutOfRange {
        /// The node or block.
        content: Content,
        /// How many there are.
        count: usize,
    },
    /// A node or block is below two nodes, or below itself.
    #[error("{content} is reached a second time")]
    ReachedTwice {
        /// The node or block.
        content: Content,
    },
    /// A node or block is not below the root.
    #[error("{content} is not reached")]
    NotReached {
        /// The node or block.
        content: Content,
    },
    /// A block of a leaf has no triangles.
    #[error("block {block} is empty")]
    EmptyBlock {
        /// Number of the block.
        block: usize,
    },
    /// A box does not enclose that of a child, or a child has an empty box.
    #[error("the bounds of node {node} do not enclose {content}")]
    NotEnclosed {
        /// Number of the node.
        node: usize,
        /// The child that sticks out.
        content: Content,
    },
    /// A triangle number is not below the number of triangles.
    #[error("leaf {leaf} lists triangle {triangle}, but there are only {count}")]
    NoSuchTriangle {
        /// Number of the leaf.
        leaf: usize,
        /// Number of the triangle.
        triangle: usize,
        /// The number of triangles.
        count: usize,
    },
    /// A triangle is listed in no leaf.
    #[error("triangle {triangle} is not listed")]
    NotListed {
        /// Number of the triangle.
        triangle: usize,
    },
    /// A triangle is listed twice in one leaf.
    #[error("leaf {leaf} lists triangle {triangle} twice")]
    ListedTwice {
        /// Number of the leaf.
        leaf: usize,
        /// Number of the triangle.
        triangle: usize,
    },
    /// A triangle has other vertices in one leaf than in another.
    #[error("leaf {leaf} lists triangle {triangle} with vertices of its own")]
    Differs {
        /// Number of the leaf.
        leaf: usize,
        /// Number of the triangle.
        triangle: usize,
    },
    /// A leaf lists a triangle that its box has no part of.
    #[error("the bounds of leaf {leaf} do not meet triangle {triangle}")]
    NotMet {
        /// Number of the leaf.
        leaf: usize,
        /// Number of the triangle.
        triangle: usize,
    },
    /// A corner of a triangle is in the box of no leaf that lists the triangle.
    #[error("corner {corner} of triangle {triangle} is in no leaf that lists the triangle")]
    NotCovered {
        /// Number of the triangle.
        triangle: usize,
        /// Which of its corners: 0, 1 or 2.
        corner: usize,
    },
    /// A way from the root to a leaf is longer than allowed, or not as long as the tree says.
    #[error("the tree is {found} nodes deep; it says {stated}, and at most {limit} are allowed")]
    Depth {
        /// Nodes on the longest way.
        found: usize,
        /// The depth that the tree states.
        stated: usize,
        /// The depth that is allowed.
        limit: usize,
    },
}

/// A part of a tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Content {
    /// The node with a number.
    Node(usize),
    /// The leaf, or the block of a leaf, with a number.
    Leaf(usize),
}

impl fmt::Display for Content {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Node(number) => write!(formatter, "node {number}"),
            Self::Leaf(number) => write!(formatter, "leaf {number}"),
        }
    }
}
