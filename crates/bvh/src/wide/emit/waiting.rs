//! The blocks of leaves, written many in a row.

use std::ops::Range;

use tahko_geometry::simd::LANES;
use tahko_geometry::{TriangleBlock, TriangleMesh};

use crate::filling::Part;

/// Blocks that are still to be written, in the order in which they are. Many in a row keep more loads of triangles under way than one at a
/// time between nodes.
#[derive(Default)]
pub(super) struct Waiting {
    /// For each block, its triangles in `numbers`, and whether it is followed by another of its leaf.
    blocks: Vec<(Range<usize>, bool)>,
    numbers: Vec<u32>,
    /// What the triangles' vertices are, while blocks are written.
    corners: Vec<[u32; 3]>,
}

/// Blocks that wait at most, before a leaf is added: what belongs to them stays in the cache.
const MOST: usize = 256;

impl Waiting {
    /// Blocks that wait.
    pub(super) fn len(&self) -> usize {
        self.blocks.len()
    }

    pub(super) fn is_full(&self) -> bool {
        self.blocks.len() >= MOST
    }

    /// Adds the blocks of a leaf whose triangles are appended to a list.
    pub(super) fn add_leaf(&mut self, list: impl FnOnce(&mut Vec<u32>)) {
        let Self {
            blocks, numbers, ..
        } = self;
        let mut end = numbers.len();
        let first = end;
        list(numbers);
        while end < numbers.len() {
            let start = end;
            end = numbers.len().min(start + LANES);
            blocks.push((start..end, end < numbers.len()));
        }
        // The last block of the leaf is written first.
        let count = (end - first).div_ceil(LANES);
        let in_order = blocks.len() - count;
        blocks[in_order..].reverse();
    }

    /// Writes the blocks to the end of a part, one before the other.
    pub(super) fn write(&mut self, part: &mut Part<'_, TriangleBlock>, mesh: &TriangleMesh) {
        let Self {
            blocks,
            numbers,
            corners,
        } = self;
        // What is needed next is asked for while nothing waits for it.
        let indices = mesh.indices();
        corners.extend(numbers.iter().map(|number| indices[*number as usize]));
        for (range, continues) in blocks.drain(..) {
            let (numbers, corners) = (&numbers[range.clone()], &corners[range]);
            let block = TriangleBlock::of_corners(numbers, corners, mesh.vertices());
            let block = part.push_last(block);
            if continues {
                block.set_continued();
            }
        }
        numbers.clear();
        corners.clear();
    }
}
