//! Nodes and blocks, as traversals get them.
#![allow(
    unsafe_code,
    reason = "a check of every index would be a tenth of the instructions of a ray"
)]

use tahko_geometry::TriangleBlock;
use tahko_geometry::simd::Simd;

use super::node::Node;
use super::nodes::Nodes;
use super::quantised::QuantisedNode;
use super::{Child, WideBvh, WideNode};

/// A layout as searches read it, with the format of its nodes known when they are compiled.
#[derive(Clone, Copy, Debug)]
pub(super) struct View<'a, N> {
    pub(super) root: Child,
    /// What rays are prepared for, as [`WideBvh::size`].
    pub(super) size: f32,
    /// Whether all stays in the caches near the processor.
    pub(super) is_cached: bool,
    /// Invariant: of one layout.
    nodes: &'a [N],
    blocks: &'a [TriangleBlock],
}

/// A layout with the format of its nodes: what a search is called with, fewer words than a view.
#[derive(Clone, Copy, Debug)]
pub(super) struct Source<'a, N> {
    layout: &'a WideBvh,
    nodes: &'a [N],
}

/// Half of what is asked for of a leaf before it is needed, in bytes.
const HALF: usize = 128;

/// A source for each format of nodes.
#[derive(Clone, Copy, Debug)]
pub(super) enum AnySource<'a> {
    Full(Source<'a, WideNode>),
    Quantised(Source<'a, QuantisedNode>),
}

/// Compiles a search for every format of nodes and runs the one that the layout has.
macro_rules! with_source {
    ($layout:expr, $source:ident => $search:expr) => {
        match $layout.source() {
            $crate::wide::access::AnySource::Full($source) => $search,
            $crate::wide::access::AnySource::Quantised($source) => $search,
        }
    };
}
pub(super) use with_source;

impl WideBvh {
    #[inline(always)]
    pub(super) fn source(&self) -> AnySource<'_> {
        let layout = self;
        match &self.nodes {
            Nodes::Full(nodes) => AnySource::Full(Source { layout, nodes }),
            Nodes::Quantised(nodes) => AnySource::Quantised(Source { layout, nodes }),
        }
    }
}

impl<'a, N> Source<'a, N> {
    #[inline(always)]
    pub(super) fn view(self) -> View<'a, N> {
        let Self { layout, nodes } = self;
        View {
            root: layout.root,
            size: layout.size,
            is_cached: layout.is_cached,
            nodes,
            blocks: &layout.blocks,
        }
    }
}

impl<'a, N: Node> View<'a, N> {
    /// The node that a child stands for.
    #[inline(always)]
    pub(super) fn node(self, index: usize) -> &'a N {
        debug_assert!(index < self.nodes.len(), "child out of range");
        // SAFETY: `emit` alone makes layouts. It gives a child the index of a node that it adds later, or of a block that it has added, and nothing
        // changes them after it. A view has the nodes and the blocks of one layout.
        unsafe { self.nodes.get_unchecked(index) }
    }

    /// The blocks from the first one of a leaf on.
    #[inline(always)]
    pub(super) fn blocks_from(self, index: usize) -> &'a [TriangleBlock] {
        debug_assert!(index < self.blocks.len(), "leaf out of range");
        // SAFETY: as above.
        unsafe { self.blocks.get_unchecked(index..) }
    }

    /// A block of a leaf.
    #[inline(always)]
    pub(super) fn block(self, index: usize) -> &'a TriangleBlock {
        debug_assert!(index < self.blocks.len(), "leaf out of range");
        // SAFETY: as above; a block that is continued is followed by another one.
        unsafe { self.blocks.get_unchecked(index) }
    }

    /// Asks for the memory of a child that is soon needed.
    #[inline(always)]
    pub(super) fn prefetch<S: Simd>(self, simd: S, child: Child) {
        let index = child.index();
        let node = self.nodes.as_ptr().wrapping_add(index).cast::<u8>();
        let block = self.blocks.as_ptr().wrapping_add(index).cast::<u8>();
        // Choices between addresses, not branches. What is shorter than four lines asks for its two lines twice.
        let (place, rest) = if child.is_leaf() {
            (block, HALF)
        } else {
            (node, N::PREFETCHED - HALF)
        };
        simd.prefetch(place, HALF);
        simd.prefetch(place.wrapping_add(rest), HALF);
        // The last line of a block; the first one of a node again.
        let last = 2 * HALF * usize::from(child.is_leaf());
        simd.prefetch(place.wrapping_add(last), 1);
    }
}
