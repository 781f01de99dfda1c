//! The build: from a mesh to a [`BinaryTree`], which knows nothing of how queries want their nodes.
//!
//! Two builders: [`clusters`], the fast one, merges triangles bottom up and splits the clusters top down; [`top_down`] splits all
//! the way. Both cut their work by numbers of triangles alone, and each task works in its own part of the lists, so neither
//! the number of threads nor their timing can show in the tree.

mod binned;
mod bins;
mod clusters;
mod join;
mod memory;
mod merging;
mod morton;
mod node;
mod outsized;
mod paired;
mod radix;
mod reference;
mod reinsertion;
mod spatial;
mod split;
mod sweep;
mod top_down;

use tahko_geometry::{Aabb, TriangleMesh};

use self::node::BuildNode;
use self::reference::Reference;
use crate::control::Work;
use crate::parallel::{collect, collect_with_room};
use crate::report::Stopwatch;
use crate::{BuildControl, BuildError, BuildMethod, BuildPhase, BvhOptions};

pub(crate) use self::node::Link;

/// The most nodes on a way from the root to a leaf. The stack of a traversal has room for what waits along such a way.
pub(crate) const MAX_DEPTH: usize = 64;

/// The most references in a leaf of a build from the top, if the options do not say fewer.
///
/// Queries test eight triangles at a time, so little is saved below leaves of this size, and the layout joins leaves
/// where that is cheaper. So a build from the top does not look further, if it is not one that takes its time (with a sweep) and if a node
/// costs no less than a triangle. Measured against leaves by cost per triangle: a third fewer nodes and a sixth less build
/// time, for 0.05 to 0.5 % (a soup: 1.7 %) higher cost of a tree with eight children per node.
const LEAF_SIZE: usize = 4;

/// What an eighth of the build of a binary tree counts per triangle, so that its pieces count something too.
const WORK_UNIT: u64 = 64;

/// A binary tree over references in leaf order.
#[derive(Default)]
pub(crate) struct BinaryTree {
    /// The root first. There may be some that no node links to.
    nodes: Vec<BuildNode>,
    /// There may be some that no leaf lists.
    pub(crate) references: Vec<TriangleNumber>,
    /// Whether the references are in an order to keep, each triangle once.
    pub(crate) is_ordered: bool,
    /// References that the build began with: triangles, or pieces of them.
    pub(crate) pieces: usize,
}

/// A triangle as a leaf lists it: its index in the mesh.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TriangleNumber(u32);

impl TriangleNumber {
    pub(crate) const fn number(self) -> u32 {
        self.0
    }
}

impl BinaryTree {
    /// Builds the tree of a mesh. The options are in range, and the control has [begun](BuildControl::begin) with at least
    /// [`WORK`](Self::WORK) per triangle.
    ///
    /// Cost: O(n log n) time, or that for fewer clusters than triangles.
    ///
    /// # Errors
    /// If the build was cancelled.
    pub(crate) fn build(
        mesh: &TriangleMesh,
        options: &BvhOptions,
        control: &BuildControl,
        stopwatch: &mut Stopwatch,
    ) -> Result<Self, BuildError> {
        if mesh.is_empty() {
            return Ok(Self::default());
        }
        let work = |weight| Work {
            control,
            weight: weight * WORK_UNIT,
        };
        let mut pieces = mesh.len();
        let (nodes, references) = match options.method {
            BuildMethod::Clusters => {
                let (numbers, scale) = morton::order(mesh);
                control.check()?;
                work(3).done(mesh.len());
                stopwatch.end(BuildPhase::References);
                let nodes = clusters::build(mesh, &numbers, scale, options, control)?;
                (nodes, numbers)
            }
            BuildMethod::TopDown => {
                let room = options.most_references(mesh.len(), mesh.len());
                let reference = |number| Reference::new(mesh, number);
                let references = collect_with_room(mesh.len(), room, reference);
                let most = options.most_pieces(mesh.len(), control.memory_limit());
                let mut references = spatial::presplit::split(references, mesh, most, &work(1))?;
                pieces = references.len();
                work(1).done(mesh.len());
                stopwatch.end(BuildPhase::References);
                if options.has_parts(mesh.len(), pieces) {
                    let whole = work(7);
                    let weight = whole.weight * mesh.len() as u64 / pieces as u64;
                    spatial::build(references, mesh, options, &Work { weight, ..whole })?
                } else {
                    let nodes = top_down::build(&mut references, options, MAX_DEPTH, &work(7))?;
                    let numbers = collect(references.len(), |index| {
                        TriangleNumber(references[index].number())
                    });
                    (nodes, numbers)
                }
            }
        };
        stopwatch.end(BuildPhase::Tree);
        let mut tree = Self {
            nodes,
            references,
            is_ordered: matches!(options.method, BuildMethod::Clusters),
            pieces,
        };
        if options.reinsertion_rounds > 0 {
            reinsertion::improve(&mut tree, options.reinsertion_rounds, control)?;
            stopwatch.end(BuildPhase::Reinsertion);
        }
        control.check()?;
        Ok(tree)
    }

    /// The tree of a mesh that nobody watches.
    #[cfg(test)]
    pub(crate) fn of(mesh: &TriangleMesh, options: &BvhOptions) -> Self {
        let control = BuildControl::new();
        let tree = Self::build(mesh, options, &control, &mut Stopwatch::start());
        tree.expect("nobody cancels it")
    }

    /// The nodes that the root leads to; checks that each is reached once, and none too deep.
    #[cfg(test)]
    fn reached(&self, name: &str) -> Vec<usize> {
        let mut is_reached = vec![false; self.nodes.len()];
        let mut reached = Vec::new();
        let mut pending = vec![(0, 1)];
        while let Some((node, depth)) = pending.pop() {
            assert!(!is_reached[node], "{name}: {node} is reached twice");
            assert!(depth <= MAX_DEPTH, "{name}: {node} at {depth}");
            is_reached[node] = true;
            reached.push(node);
            if let Link::Inner(children) = self.node(node).1 {
                pending.extend(children.map(|child| (child, depth + 1)));
            }
        }
        reached
    }

    /// The work per triangle that a build reports to its control.
    pub(crate) const WORK: u64 = 8 * WORK_UNIT;

    /// The box of a node and what it links to; node 0 is the root of a tree over at least one reference.
    pub(crate) fn node(&self, index: usize) -> (Aabb, Link) {
        let node = &self.nodes[index];
        (node.bounds(), node.link())
    }

    /// Places in the list of nodes, used or not.
    pub(crate) const fn node_count(&self) -> usize {
        self.nodes.len()
    }

    pub(crate) const fn is_empty(&self) -> bool {
        self.references.is_empty()
    }
}
