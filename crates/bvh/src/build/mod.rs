//! The build: from a mesh to a [`BinaryTree`], which knows nothing of how queries want their nodes.
//!
//! Top down: each node is split where the surface area heuristic finds it cheapest, and becomes a leaf where no
//! split is cheaper. Subtrees are built at the same time, each in its own part of the lists, so neither the
//! number of threads nor their timing can show in the tree.

mod binned;
mod reference;
mod reinsertion;
mod spatial;
mod split;
mod sweep;

use tahko_geometry::{Aabb, Axis, TriangleMesh};

use self::reference::{Bounds, CentroidScale, Extent};
use self::split::{Candidate, Parts};
use crate::BvhOptions;
use crate::parallel::{collect, join_if, reduce};

pub(crate) use self::reference::Reference;

/// The most nodes on a way from the root to a leaf. Traversal has a stack of this size.
///
/// Where the cheapest splits would lead deeper (triangles nested in geometric progression), nodes are halved
/// instead: 30 levels of that suffice for the largest mesh.
pub(crate) const MAX_DEPTH: usize = 64;

/// Nodes with fewer references than this are not worth a task of their own.
const PARALLEL_SIZE: usize = 4096;

/// A binary tree over references in leaf order.
pub(crate) struct BinaryTree {
    /// Depth first. A subtree over `n` references has a block of `2n - 1` nodes that its root begins; a node's first child
    /// follows it, and blocks may have unused nodes at their ends.
    nodes: Vec<BuildNode>,
    pub(crate) references: Vec<Reference>,
    /// Nodes with children.
    pub(crate) inner_count: usize,
}

#[derive(Clone, Copy, Debug)]
struct BuildNode {
    bounds: Aabb,
    link: Link,
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum Link {
    /// The children's places in the tree's list of nodes.
    Inner([usize; 2]),
    /// The leaf's part of the list of references.
    Leaf { first: usize, count: usize },
}

impl BinaryTree {
    /// Builds the tree of a mesh. The options are in range.
    ///
    /// Cost: O(n log n) time, 128 bytes per triangle.
    pub(crate) fn build(mesh: &TriangleMesh, options: &BvhOptions) -> Self {
        let mut tree = Self::build_top_down(mesh, options);
        reinsertion::improve(&mut tree, options.reinsertion_rounds);
        tree
    }

    fn build_top_down(mesh: &TriangleMesh, options: &BvhOptions) -> Self {
        let mut references = collect(mesh.len(), |number| {
            #[expect(
                clippy::cast_possible_truncation,
                reason = "meshes have at most 2^29 triangles"
            )]
            Reference::new(&mesh.triangle(number), number as u32)
        });
        if options.spatial_split_budget > 1.0 && !references.is_empty() {
            return spatial::build(references, mesh, options);
        }
        let mut nodes = unused_nodes((2 * mesh.len()).saturating_sub(1));
        let mut inner_count = 0;
        if !references.is_empty() {
            let builder = Builder::new(&references, options);
            let extent = builder.extent(&references);
            inner_count = builder.build(&mut references, &mut nodes, extent, Place::ROOT);
        }
        Self {
            nodes,
            references,
            inner_count,
        }
    }

    /// The box of a node and what it links to; node 0 is the root of a tree over at least one reference.
    pub(crate) fn node(&self, index: usize) -> (Aabb, Link) {
        let node = &self.nodes[index];
        (node.bounds, node.link)
    }

    /// Places in the list of nodes, used or not.
    pub(crate) fn node_count(&self) -> usize {
        self.nodes.len()
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.references.is_empty()
    }
}

/// Nodes that no subtree has taken yet.
fn unused_nodes(count: usize) -> Vec<BuildNode> {
    let unused = BuildNode {
        bounds: Aabb::EMPTY,
        link: Link::Leaf { first: 0, count: 0 },
    };
    vec![unused; count]
}

struct Builder<'a> {
    options: &'a BvhOptions,
    scale: CentroidScale,
}

/// Where a subtree stands in the tree and in its lists.
#[derive(Clone, Copy)]
struct Place {
    first_reference: usize,
    first_node: usize,
    /// Nodes on the way from the root, this one included.
    depth: usize,
}

impl Place {
    const ROOT: Self = Self {
        first_reference: 0,
        first_node: 0,
        depth: 1,
    };
}

impl<'a> Builder<'a> {
    fn new(references: &[Reference], options: &'a BvhOptions) -> Self {
        let bounds = reduce(references, &Bounds::of, &Bounds::union);
        Self {
            options,
            scale: CentroidScale::new(&bounds.to_aabb()),
        }
    }

    fn extent(&self, references: &[Reference]) -> Extent {
        reduce(
            references,
            &|chunk: &[Reference]| Extent::new(chunk, self.scale),
            &Extent::union,
        )
    }

    /// Builds a subtree into its block of nodes and returns how many of its nodes have children. The recursion is
    /// at most [`MAX_DEPTH`] deep.
    fn build(
        &self,
        references: &mut [Reference],
        nodes: &mut [BuildNode],
        extent: Extent,
        place: Place,
    ) -> usize {
        let count = references.len();
        let parts = self.split(references, &extent, place.depth);
        let bounds = extent.bounds.to_aabb();
        let Some(parts) = parts else {
            let first = place.first_reference;
            let link = Link::Leaf { first, count };
            nodes[0] = BuildNode { bounds, link };
            return 0;
        };
        let first_place = Place {
            first_reference: place.first_reference,
            first_node: place.first_node + 1,
            depth: place.depth + 1,
        };
        let second_place = Place {
            first_reference: place.first_reference + parts.middle,
            first_node: place.first_node + 2 * parts.middle,
            depth: place.depth + 1,
        };
        let link = Link::Inner([first_place.first_node, second_place.first_node]);
        nodes[0] = BuildNode { bounds, link };
        let (first_nodes, second_nodes) = nodes[1..].split_at_mut(2 * parts.middle - 1);
        let (first, second) = references.split_at_mut(parts.middle);
        let (first_count, second_count) = join_if(
            count >= PARALLEL_SIZE,
            || self.build(first, first_nodes, parts.first, first_place),
            || self.build(second, second_nodes, parts.second, second_place),
        );
        1 + first_count + second_count
    }

    /// Cuts the references of a node in two, or makes it a leaf.
    #[inline(never)]
    fn split(&self, references: &mut [Reference], extent: &Extent, depth: usize) -> Option<Parts> {
        let may_be_leaf = references.len() <= self.options.max_leaf_size;
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
        Some(cut.apply(references, self.scale))
    }

    /// The cheapest split; `None` if there is none, or no depth left for an unbalanced one.
    fn candidate(
        &self,
        references: &mut [Reference],
        extent: &Extent,
        depth: usize,
    ) -> Option<Candidate> {
        let count = references.len();
        // Invariant: depth + ceil(log2(count)) <= MAX_DEPTH, so that halving can always finish the subtree. It holds for
        // the children of a halved node; here it must hold for a child with nearly all references.
        let has_room = depth + 1 + ceil_log2(count) <= MAX_DEPTH;
        if count < 2 || !has_room {
            None
        } else if count <= self.options.sweep_size {
            sweep::best(references, self.scale)
        } else {
            let bins = self.options.bins.min(count.max(4));
            binned::best(references, extent, self.scale, bins)
        }
    }

    /// Whether a split is cheaper than a leaf. Costs are multiplied by the node's area: nothing is divided by it,
    /// as it may be zero.
    fn pays(&self, candidate: &Candidate, count: usize, extent: &Extent) -> bool {
        let BvhOptions {
            traversal_cost,
            intersection_cost,
            ..
        } = self.options;
        let area = extent.bounds.half_area();
        let leaf = intersection_cost * count as f64 * area;
        traversal_cost * area + intersection_cost * candidate.cost < leaf
    }
}

/// The number of halvings that take `count` to one.
fn ceil_log2(count: usize) -> usize {
    count.next_power_of_two().trailing_zeros() as usize
}
