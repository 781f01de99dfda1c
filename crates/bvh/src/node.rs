//! The nodes that queries read.

use tahko_geometry::{Aabb, Triangle, glam::Vec3};

/// A box and what is in it: 32 bytes, aligned to 32.
///
/// | bytes | field | inner node | leaf |
/// |---|---|---|---|
/// | 0..12 | `min` | smallest coordinates | the same |
/// | 12..16 | `first` | index of the children's [`Siblings`] | index of the first triangle in leaf order |
/// | 16..28 | `max` | largest coordinates | the same |
/// | 28..32 | `count` | 0 | number of triangles, at least 1 |
///
/// A tree over no triangles has no node; one triangle makes a root that is a leaf.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(32))]
pub(crate) struct Node {
    min: Vec3,
    first: u32,
    max: Vec3,
    count: u32,
}

/// The two children of an inner node: one cache line of 64 bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub(crate) struct Siblings(pub(crate) [Node; 2]);

/// A triangle of a leaf with its number in the mesh, 40 bytes: a leaf reads one run of memory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LeafTriangle {
    pub(crate) triangle: Triangle,
    pub(crate) number: u32,
}

const _: () = assert!(
    size_of::<Node>() == 32 && align_of::<Node>() == 32,
    "two nodes share a cache line"
);
const _: () = assert!(
    size_of::<Siblings>() == 64 && align_of::<Siblings>() == 64,
    "siblings are one cache line"
);
const _: () = assert!(size_of::<LeafTriangle>() == 40, "no padding");

impl Node {
    /// A node whose children are at an index of the list of siblings.
    pub(crate) fn inner(bounds: &Aabb, siblings: u32) -> Self {
        Self::new(bounds, siblings, 0)
    }

    /// A node over `count > 0` triangles.
    pub(crate) fn leaf(bounds: &Aabb, first: u32, count: u32) -> Self {
        debug_assert!(count > 0, "a count of 0 marks inner nodes");
        Self::new(bounds, first, count)
    }

    fn new(bounds: &Aabb, first: u32, count: u32) -> Self {
        Self {
            min: bounds.min,
            first,
            max: bounds.max,
            count,
        }
    }

    #[inline]
    pub(crate) const fn bounds(&self) -> Aabb {
        Aabb::new(self.min, self.max)
    }

    #[inline]
    pub(crate) const fn is_leaf(&self) -> bool {
        self.count > 0
    }

    /// The index of an inner node's children, or of a leaf's first triangle.
    #[inline]
    pub(crate) const fn first(&self) -> usize {
        self.first as usize
    }

    /// The number of a leaf's triangles; 0 for an inner node.
    #[inline]
    pub(crate) const fn count(&self) -> usize {
        self.count as usize
    }
}
