//! The build from the top: each node is split where the surface area heuristic finds it cheapest, and becomes a
//! leaf where no split is cheaper.

use tahko_geometry::Axis;
use tahko_geometry::simd::AvailableSimd;

use super::node::{BuildNode, Link, concatenate};
use super::reference::{Bounds, CentroidScale, Extent, Reference};
use super::split::{self, Candidate, Parts};
use super::{LEAF_SIZE, binned, sweep};
use crate::control::Work;
use crate::parallel::{join_if, reduce};
use crate::{BuildError, BvhOptions};

/// Nodes with fewer references than this are not worth a task of their own: their subtree is one block of nodes.
pub(super) const BLOCK_SIZE: usize = 4096;

/// The nodes of a tree over at least one reference, the root first; sorts the references into the order of the leaves.
///
/// No way from the root has more than `max_depth` nodes, which must be at least 30: where the cheapest splits would lead
/// deeper (triangles nested in geometric progression), nodes are halved instead.
///
/// Cost: O(n log n) time; the nodes twice, for a moment.
///
/// # Errors
/// If the build was cancelled.
pub(super) fn build(
    references: &mut [Reference],
    options: &BvhOptions,
    max_depth: usize,
    work: &Work<'_>,
) -> Result<Vec<BuildNode>, BuildError> {
    let builder = Builder::new(references, options, max_depth, work);
    let extent = builder.extent(references);
    let top = builder.top(references, extent, Place { first: 0, depth: 1 });
    work.control.check()?;
    let mut nodes = Vec::new();
    let mut blocks = Vec::new();
    let mut next_block = top.top_size();
    top.list(&mut nodes, &mut blocks, &mut next_block);
    Ok(concatenate(&nodes, &blocks))
}

/// What splits nodes, also for builders that have other ways besides.
pub(super) struct Builder<'a> {
    options: &'a BvhOptions,
    max_leaf_size: usize,
    pub(super) scale: CentroidScale,
    max_depth: usize,
    pub(super) work: Work<'a>,
    pub(super) simd: AvailableSimd,
}

/// Where a subtree stands in the tree.
#[derive(Clone, Copy)]
struct Place {
    /// Its first reference.
    first: usize,
    /// Nodes on the way from the root, this one included.
    depth: usize,
}

impl Place {
    fn children(self, middle: usize) -> [Self; 2] {
        let depth = self.depth + 1;
        let first = self.first + middle;
        [Self { depth, ..self }, Self { first, depth }]
    }
}

/// A subtree as its builder returns it. How it is cut in blocks depends on numbers of references alone.
enum Subtree {
    Inner(Bounds, Box<[Subtree; 2]>),
    /// Nodes, the root first, that link to others by their places in the block.
    Block(Vec<BuildNode>),
}

impl Subtree {
    /// Nodes that are not in blocks.
    fn top_size(&self) -> usize {
        match self {
            Self::Inner(_, children) => 1 + children.iter().map(Self::top_size).sum::<usize>(),
            Self::Block(_) => 0,
        }
    }

    /// Appends the nodes of the top and the blocks to their lists, and returns the place of the root.
    fn list(
        self,
        nodes: &mut Vec<BuildNode>,
        blocks: &mut Vec<Vec<BuildNode>>,
        next_block: &mut usize,
    ) -> usize {
        match self {
            Self::Inner(bounds, children) => {
                let place = nodes.len();
                nodes.push(BuildNode::UNUSED);
                let link = Link::Inner(children.map(|child| child.list(nodes, blocks, next_block)));
                nodes[place] = BuildNode::new(&bounds.to_aabb(), link);
                place
            }
            Self::Block(block) => {
                let place = *next_block;
                *next_block += block.len();
                blocks.push(block);
                place
            }
        }
    }
}

impl<'a> Builder<'a> {
    /// For a tree over some references, at least one, whose ways from the root have at most `max_depth` nodes.
    pub(super) fn new(
        references: &[Reference],
        options: &'a BvhOptions,
        max_depth: usize,
        work: &Work<'a>,
    ) -> Self {
        let bounds = reduce(references, &Bounds::of, &Bounds::union);
        Self {
            options,
            max_leaf_size: options.max_leaf_size.min(LEAF_SIZE),
            scale: CentroidScale::new(&bounds.to_aabb()),
            max_depth,
            work: *work,
            simd: AvailableSimd::best(),
        }
    }

    pub(super) fn extent(&self, references: &[Reference]) -> Extent {
        reduce(
            references,
            &|chunk: &[Reference]| Extent::new(chunk, self.scale),
            &Extent::union,
        )
    }

    /// Builds a subtree, its children at the same time; something else, at once, if the build was cancelled. The recursion is
    /// at most `max_depth` deep.
    fn top(&self, references: &mut [Reference], extent: Extent, place: Place) -> Subtree {
        if self.work.is_cancelled() {
            return Subtree::Block(Vec::new());
        }
        let split = if references.len() < BLOCK_SIZE {
            None
        } else {
            self.split(references, &extent, place.depth)
        };
        let Some(parts) = split else {
            // Two nodes to three references are usual.
            let mut nodes = Vec::with_capacity(references.len());
            nodes.push(BuildNode::UNUSED);
            self.block(references, extent, place, 0, &mut nodes);
            nodes.shrink_to_fit();
            self.work.done(references.len());
            return Subtree::Block(nodes);
        };
        let [first_place, second_place] = place.children(parts.middle);
        let (first, second) = references.split_at_mut(parts.middle);
        let (first, second) = join_if(
            true,
            || self.top(first, parts.first, first_place),
            || self.top(second, parts.second, second_place),
        );
        Subtree::Inner(extent.bounds, Box::new([first, second]))
    }

    /// Builds a subtree whose root has an index in a list of nodes, at whose end the others go.
    fn block(
        &self,
        references: &mut [Reference],
        extent: Extent,
        place: Place,
        index: usize,
        nodes: &mut Vec<BuildNode>,
    ) {
        let bounds = extent.bounds.to_aabb();
        let Some(parts) = self.split(references, &extent, place.depth) else {
            let (first, count) = (place.first, references.len());
            nodes[index] = BuildNode::new(&bounds, Link::Leaf { first, count });
            return;
        };
        let children = [nodes.len(), nodes.len() + 1];
        nodes[index] = BuildNode::new(&bounds, Link::Inner(children));
        nodes.extend([BuildNode::UNUSED; 2]);
        let places = place.children(parts.middle);
        let (first, second) = references.split_at_mut(parts.middle);
        self.block(first, parts.first, places[0], children[0], nodes);
        self.block(second, parts.second, places[1], children[1], nodes);
    }

    /// Cuts the references of a node in two, or makes it a leaf.
    #[inline(never)]
    fn split(&self, references: &mut [Reference], extent: &Extent, depth: usize) -> Option<Parts> {
        let BvhOptions {
            traversal_cost,
            intersection_cost,
            ..
        } = *self.options;
        let may_be_leaf = references.len() <= self.max_leaf_size;
        if may_be_leaf && self.options.sweep_size == 0 && traversal_cost >= intersection_cost {
            return None;
        }
        if self.max_leaf_size == 1 && references.len() <= split::FEW && references.len() > 1 {
            let cut = split::of_few(references, self.scale);
            return Some(cut.apply(references, self.scale, self.simd));
        }
        let cut = match self.candidate(references, extent, depth) {
            Some(candidate) if may_be_leaf && !self.pays(&candidate, references.len(), extent) => {
                return None;
            }
            Some(candidate) => candidate.cut,
            None if may_be_leaf => return None,
            None => {
                let axis = Axis::dominant(extent.centroids.extent());
                split::median(references, axis as usize, self.scale)
            }
        };
        Some(cut.apply(references, self.scale, self.simd))
    }

    /// The cheapest split; `None` if there is none, or no depth left for an unbalanced one.
    pub(super) fn candidate(
        &self,
        references: &mut [Reference],
        extent: &Extent,
        depth: usize,
    ) -> Option<Candidate> {
        let count = references.len();
        // Invariant: depth + ceil(log2(count)) <= max_depth, so that halving can always finish the subtree. It holds for
        // the children of a halved node; here it must hold for a child with nearly all references.
        let has_room = depth + 1 + ceil_log2(count) <= self.max_depth;
        if count < 2 || !has_room {
            None
        } else if count <= self.options.sweep_size {
            sweep::best(references, self.scale)
        } else {
            let bins = bins_for(count, self.options.bins);
            binned::best(references, extent, self.scale, bins, self.simd)
        }
    }

    /// Whether a split is cheaper than a leaf. Costs are multiplied by the node's area: nothing is divided by it,
    /// as it may be zero.
    pub(super) fn pays(&self, candidate: &Candidate, count: usize, extent: &Extent) -> bool {
        let BvhOptions {
            traversal_cost,
            intersection_cost,
            ..
        } = *self.options;
        let area = extent.bounds.half_area();
        let leaf = intersection_cost * count as f64 * area;
        traversal_cost * area + intersection_cost * candidate.cost < leaf
    }
}

/// The bins on each axis for a node of some references: half of the most where it has less than two for each of those, and not more
/// than references. Measured with 16 bins: 3 to 4 % less time for the binary tree, and its cost moved by -0.2 to +0.3 %.
fn bins_for(count: usize, most: usize) -> usize {
    let bins = if count < 2 * most {
        most.div_ceil(2)
    } else {
        most
    };
    bins.min(count.max(4)).max(2)
}

/// The number of halvings that take `count` to one.
fn ceil_log2(count: usize) -> usize {
    count.next_power_of_two().trailing_zeros() as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bins_are_within_what_the_options_and_the_node_allow() {
        for most in 2..=BvhOptions::MAX_BINS {
            for count in 2..=3 * most {
                let bins = bins_for(count, most);
                let allowed = 2..=most.min(count.max(4));
                assert!(allowed.contains(&bins), "{count} of {most}: {bins}");
            }
            assert_eq!(bins_for(2 * most.max(2), most), most, "large nodes");
        }
    }
}
