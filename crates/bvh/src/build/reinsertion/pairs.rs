//! A binary tree whose nodes can be moved: siblings stand side by side and know their parent.

use crate::build::node::{BuildNode, Link, to_u32};
use crate::build::reference::Bounds;
use crate::build::{BinaryTree, MAX_DEPTH};
use crate::huge_pages;
use crate::parallel::collect;

use super::search::Move;

/// Subtrees of at most this many references are moved as a whole. Layouts may make them one leaf, whose cost does not grow with
/// the number of its triangles; to scatter them made a wide tree of an interior dearer (12.41 against 11.91 before and 11.45 now), although its binary
/// cost fell as much.
const GROUP_SIZE: u32 = 8;

/// The upper part of a tree, down to groups. The root has place 0, place 1 is not used, siblings have the places `2i` and `2i + 1`.
pub(super) struct PairTree {
    bounds: Vec<Bounds>,
    /// For each place the place of its first child, or [`GROUP`] and the index of a group's root in the binary tree.
    links: Vec<u32>,
    /// Nodes on the longest way down from each place to a leaf, that node and those in groups included.
    heights: Vec<u8>,
    /// For each pair the place of its parent.
    parents: Vec<u32>,
}

/// Marks the links of groups. Trees have at most 2^30 nodes.
const GROUP: u32 = 1 << 31;

pub(super) const ROOT: usize = 0;

impl PairTree {
    /// The upper part of a tree. Cost: O(n).
    pub(super) fn new(tree: &BinaryTree) -> Self {
        let measures = Measures::new(tree);
        let inner = measures.counts.iter().filter(|count| **count > GROUP_SIZE);
        let pair_count = 1 + inner.count();
        let mut pairs = Self {
            bounds: huge_pages::with_capacity(2 * pair_count),
            links: huge_pages::with_capacity(2 * pair_count),
            heights: Vec::with_capacity(2 * pair_count),
            parents: Vec::with_capacity(pair_count),
        };
        pairs.add_pair(0);
        let mut pending = vec![(0, ROOT)];
        while let Some((node, place)) = pending.pop() {
            let (bounds, link) = tree.node(node);
            pairs.bounds[place] = Bounds::new(&bounds);
            pairs.heights[place] = measures.heights[node];
            match link {
                Link::Inner([first, second]) if measures.counts[node] > GROUP_SIZE => {
                    let next = pairs.len();
                    pairs.links[place] = to_u32(next);
                    pairs.add_pair(place);
                    pending.extend([(second, next + 1), (first, next)]);
                }
                _ => pairs.links[place] = GROUP | to_u32(node),
            }
        }
        pairs
    }

    /// Adds two places, to be filled, for the children of a node.
    fn add_pair(&mut self, parent: usize) {
        self.parents.push(to_u32(parent));
        self.bounds.extend([Bounds::EMPTY; 2]);
        self.links.extend([GROUP; 2]);
        self.heights.extend([0; 2]);
    }

    /// Places, used or not.
    pub(super) fn len(&self) -> usize {
        self.links.len()
    }

    pub(super) fn bounds(&self, place: usize) -> Bounds {
        self.bounds[place]
    }

    /// The place of the parent of any node but the root.
    pub(super) fn parent(&self, place: usize) -> usize {
        self.parents[place / 2] as usize
    }

    /// The places of the children of a node that is no group.
    pub(super) fn children(&self, place: usize) -> Option<[usize; 2]> {
        let link = self.links[place];
        (link & GROUP == 0).then_some([link as usize, link as usize + 1])
    }

    /// The places of some nodes with the largest areas, in order of their places, without the root and its children.
    pub(super) fn largest(&self, count: usize) -> Vec<u32> {
        let first = 4;
        let mut keys = collect(self.len().saturating_sub(first), |index| {
            #[expect(
                clippy::cast_possible_truncation,
                reason = "rounds: which nodes are tried is a matter of speed"
            )]
            let area = self.bounds[first + index].half_area() as f32;
            // Areas are not negative, so their bits are in their order; the smallest key has the largest area.
            u64::from(!area.to_bits()) << 32 | u64::from(to_u32(first + index))
        });
        if count < keys.len() {
            keys.select_nth_unstable(count);
            keys.truncate(count);
        }
        #[expect(clippy::cast_possible_truncation, reason = "the lower half")]
        let mut places: Vec<u32> = keys.into_iter().map(|key| key as u32).collect();
        places.sort_unstable();
        places
    }

    /// Makes a move, unless a node that it needs is among those that `changed`, or it is not possible any more. Whether it was made.
    pub(super) fn make(&mut self, wanted: &Move, changed: &mut [bool]) -> bool {
        let (subtree, target) = (wanted.subtree as usize, wanted.target as usize);
        let sibling = subtree ^ 1;
        let parent = self.parent(subtree);
        let needed = [subtree, sibling, parent, target];
        if needed.iter().any(|place| changed[*place]) || !self.may_move(subtree, target) {
            return false;
        }
        for place in needed {
            changed[place] = true;
        }
        // The sibling takes the place of the parent. The target moves to where the sibling was, and the pair hangs where the target was.
        self.copy(sibling, parent);
        self.copy(target, sibling);
        self.links[target] = to_u32(subtree & !1);
        self.parents[subtree / 2] = wanted.target;
        self.refit_up(self.parent(parent));
        self.refit_up(target);
        true
    }

    /// Whether a subtree may become the sibling of a target: the target is not below it, and the tree does not get too deep.
    fn may_move(&self, subtree: usize, target: usize) -> bool {
        let mut depth = 1;
        let mut place = target;
        while place != ROOT {
            if place == subtree {
                return false;
            }
            place = self.parent(place);
            depth += 1;
        }
        let height = self.heights[subtree].max(self.heights[target]);
        depth + usize::from(height) <= MAX_DEPTH
    }

    /// Puts a node with all that is below it into another place, whose node goes elsewhere or is not needed.
    fn copy(&mut self, from: usize, to: usize) {
        self.bounds[to] = self.bounds[from];
        self.links[to] = self.links[from];
        self.heights[to] = self.heights[from];
        if let Some([first, _]) = self.children(to) {
            self.parents[first / 2] = to_u32(to);
        }
    }

    /// Brings the nodes from one with children upward up to date, as far as they change.
    fn refit_up(&mut self, mut place: usize) {
        while let Some([first, second]) = self.children(place) {
            let bounds = self.bounds[first].union(self.bounds[second]);
            let height = 1 + self.heights[first].max(self.heights[second]);
            let changes = height != self.heights[place] || !bounds.equals(&self.bounds[place]);
            self.bounds[place] = bounds;
            self.heights[place] = height;
            if !changes || place == ROOT {
                return;
            }
            place = self.parent(place);
        }
    }

    /// Writes the nodes back depth first, and the references in the order of the leaves. Cost: O(n).
    pub(super) fn write_back(&self, tree: &mut BinaryTree) {
        let mut nodes: Vec<BuildNode> = huge_pages::with_capacity(2 * tree.inner_count + 1);
        let mut references = huge_pages::with_capacity(tree.references.len());
        // A second child waits together with the index of its parent, which links to it.
        let mut pending: Vec<(Source, Option<usize>)> = vec![(Source::Place(ROOT), None)];
        while let Some((source, parent)) = pending.pop() {
            let index = nodes.len();
            if let Some(parent) = parent {
                let link = Link::Inner([parent + 1, index]);
                nodes[parent] = BuildNode::new(&nodes[parent].bounds(), link);
            }
            let (bounds, children) = match self.resolve(source) {
                Source::Place(place) => {
                    let children = self.children(place);
                    (
                        self.bounds[place].to_aabb(),
                        Ok(children.unwrap_or_default().map(Source::Place)),
                    )
                }
                Source::Node(node) => match tree.node(node) {
                    (bounds, Link::Inner(children)) => (bounds, Ok(children.map(Source::Node))),
                    (bounds, Link::Leaf { first, count }) => (bounds, Err((first, count))),
                },
            };
            let link = match children {
                Ok([first, second]) => {
                    pending.extend([(second, Some(index)), (first, None)]);
                    Link::Inner([0, 0])
                }
                Err((first, count)) => {
                    references.extend_from_slice(&tree.references[first..][..count]);
                    let first = references.len() - count;
                    Link::Leaf { first, count }
                }
            };
            nodes.push(BuildNode::new(&bounds, link));
        }
        tree.nodes = nodes;
        tree.references = references;
    }

    /// The node of the binary tree, if a place has a group.
    fn resolve(&self, source: Source) -> Source {
        match source {
            Source::Place(place) if self.links[place] & GROUP != 0 => {
                Source::Node((self.links[place] & !GROUP) as usize)
            }
            source => source,
        }
    }
}

/// Where a node that is written back comes from.
#[derive(Clone, Copy)]
enum Source {
    /// The upper part of the tree.
    Place(usize),
    /// A group, which is as it was in the binary tree.
    Node(usize),
}

/// What subtrees contain.
struct Measures {
    counts: Vec<u32>,
    heights: Vec<u8>,
}

impl Measures {
    fn new(tree: &BinaryTree) -> Self {
        let mut measures = Self {
            counts: vec![0; tree.nodes.len()],
            heights: vec![1; tree.nodes.len()],
        };
        let Self { counts, heights } = &mut measures;
        // Children follow their parents.
        for node in (0..tree.nodes.len()).rev() {
            match tree.node(node).1 {
                Link::Leaf { count, .. } => counts[node] = to_u32(count),
                Link::Inner([first, second]) => {
                    counts[node] = counts[first] + counts[second];
                    heights[node] = 1 + heights[first].max(heights[second]);
                }
            }
        }
        measures
    }
}
