//! The nodes that queries read.

use tahko_geometry::Aabb;
use tahko_geometry::glam::Vec3;
use tahko_geometry::simd::{LANES, Lanes, Simd};

use super::plane_order::PlaneOrder;

/// What searches read of a node, whatever its format.
pub(crate) trait Node: Copy {
    /// The cache lines that a node lies in, two or four, in bytes.
    const PREFETCHED: usize;

    /// Where the children are; nothing for lanes that are not used.
    fn lanes(&self) -> &[Child; LANES];

    /// The planes of the children's boxes across an axis: those that a ray meets first, and the others.
    fn planes<S: Simd>(&self, simd: S, axis: usize, order: &PlaneOrder) -> [S::F32s; 2];

    /// A plane of a child's box across an axis: the smallest coordinate for an even `side`, the largest for an odd one.
    fn child_plane(&self, axis: usize, side: u32, lane: usize) -> f32;

    /// The same boxes and children as 32-bit numbers.
    fn decoded(&self) -> WideNode;
}

/// The boxes of up to eight children and where they are: 256 bytes, four cache lines.
///
/// Unused lanes have a box that is inside out, which no ray enters, and stand for the leaf without triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(256))]
pub(crate) struct WideNode {
    /// By axis: the smallest coordinates, then the largest.
    pub(crate) bounds: [[Lanes; 2]; 3],
    pub(crate) children: [Child; LANES],
}

const _: () = assert!(size_of::<WideNode>() == 256, "four cache lines");

/// Where a child is: a node, or a leaf with its triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Child(u32);

/// What a child is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// The index of a node.
    Inner(usize),
    /// The index of the first block of a leaf's triangles.
    Leaf(usize),
}

impl Child {
    const LEAF: u32 = 1 << 31;

    /// The leaf without triangles: block 0 of every tree is empty.
    pub(crate) const NOTHING: Self = Self(Self::LEAF);

    pub(crate) fn inner(node: usize) -> Self {
        Self(to_u32(node))
    }

    pub(crate) fn leaf(first_block: usize) -> Self {
        Self(to_u32(first_block) | Self::LEAF)
    }

    #[inline(always)]
    pub(crate) const fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }

    /// The index of its node or of its first block.
    #[inline(always)]
    pub(crate) const fn index(self) -> usize {
        (self.0 & !Self::LEAF) as usize
    }

    #[inline(always)]
    pub(crate) const fn kind(self) -> Kind {
        if self.is_leaf() {
            Kind::Leaf(self.index())
        } else {
            Kind::Inner(self.index())
        }
    }

    /// The number that stands for it on the stack.
    #[inline(always)]
    pub(crate) const fn bits(self) -> u32 {
        self.0
    }

    #[inline(always)]
    pub(crate) const fn from_bits(bits: u32) -> Self {
        Self(bits)
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "trees have at most 2^31 nodes and blocks"
)]
fn to_u32(index: usize) -> u32 {
    debug_assert!(index < Child::LEAF as usize, "{index} is too large");
    index as u32
}

impl Node for WideNode {
    const PREFETCHED: usize = size_of::<Self>();

    #[inline(always)]
    fn lanes(&self) -> &[Child; LANES] {
        &self.children
    }

    #[inline(always)]
    fn planes<S: Simd>(&self, simd: S, axis: usize, order: &PlaneOrder) -> [S::F32s; 2] {
        let [first, last] = order.of_axis(&self.bounds, axis);
        [simd.load(first), simd.load(last)]
    }

    #[inline(always)]
    fn child_plane(&self, axis: usize, side: u32, lane: usize) -> f32 {
        self.bounds[axis][(side & 1) as usize].0[lane]
    }

    #[inline(always)]
    fn decoded(&self) -> WideNode {
        *self
    }
}

impl WideNode {
    /// A node without children.
    pub(crate) const EMPTY: Self = Self {
        bounds: [[Lanes::splat(f32::MAX), Lanes::splat(f32::MIN)]; 3],
        children: [Child::NOTHING; LANES],
    };

    pub(crate) fn set(&mut self, lane: usize, bounds: &Aabb, child: Child) {
        for axis in 0..3 {
            self.bounds[axis][0].0[lane] = bounds.min[axis];
            self.bounds[axis][1].0[lane] = bounds.max[axis];
        }
        self.children[lane] = child;
    }

    /// The children that are used, with their boxes.
    pub(crate) fn children(&self) -> impl Iterator<Item = (Aabb, Child)> + '_ {
        let used = (0..LANES).filter(|lane| self.children[*lane] != Child::NOTHING);
        used.map(|lane| (self.child_bounds(lane), self.children[lane]))
    }

    /// The smallest box around those of the children.
    pub(crate) fn outer_bounds(&self) -> Aabb {
        let boxes = self.children().map(|(bounds, _)| bounds);
        boxes.fold(Aabb::EMPTY, Aabb::union)
    }

    fn child_bounds(&self, lane: usize) -> Aabb {
        let corner =
            |side: usize| Vec3::from([0, 1, 2].map(|axis| self.bounds[axis][side].0[lane]));
        Aabb::new(corner(0), corner(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_child_tells_what_it_is() {
        for index in [0, 1, 255, (1 << 31) - 1] {
            assert_eq!(Child::inner(index).kind(), Kind::Inner(index));
            assert_eq!(Child::leaf(index).kind(), Kind::Leaf(index));
            for child in [Child::inner(index), Child::leaf(index)] {
                assert_eq!(Child::from_bits(child.bits()), child);
            }
        }
        assert_eq!(Child::NOTHING.kind(), Kind::Leaf(0));
    }

    #[test]
    fn children_are_those_that_were_set_with_their_boxes() {
        assert_eq!(WideNode::EMPTY.children().count(), 0);
        let bounds = |x: f32| Aabb::new(Vec3::new(x, 1.0, -2.0), Vec3::new(x + 0.5, 3.0, -0.0));
        let mut node = WideNode::EMPTY;
        node.set(5, &bounds(5.0), Child::leaf(3));
        node.set(0, &bounds(7.0), Child::inner(0));
        let children: Vec<_> = node.children().collect();
        let expected = [
            (bounds(7.0), Child::inner(0)),
            (bounds(5.0), Child::leaf(3)),
        ];
        assert_eq!(children, expected);
        assert_eq!(node.bounds[0][1].0[5], 5.5);
        assert_eq!(node.bounds[2][0].0[0], -2.0);
    }

    #[test]
    fn the_boxes_of_unused_lanes_are_inside_out() {
        for lane in 0..LANES {
            assert!(WideNode::EMPTY.child_bounds(lane).is_empty(), "{lane}");
        }
    }
}
