//! From a binary tree to pairs and back.
//!
//! Subtrees become lists of pairs at the same time, which are then put one behind the other. On the way back a pair is written into the node whose children it was made
//! of: moves neither make pairs nor lose them, so that each node of the upper part gets one again, and groups stay where they are.

use super::pairs::{GROUP, Pair, PairTree, ROOT, Sibling, link_behind};
use crate::build::BinaryTree;
use crate::build::node::{BuildNode, Link, to_u32};
use crate::build::reference::Bounds;
use crate::filling::Filling;
use crate::parallel::{for_each, join_if, map_range};

/// Subtrees of at most this many references are moved as a whole. Layouts may make them one leaf, whose cost does not grow with
/// the number of its triangles; to scatter them made a wide tree of an interior dearer (12.41 against 11.91 before and 11.45 now), although its binary
/// cost fell as much.
const GROUP_SIZE: u32 = 8;

/// Nodes for each task, about.
const TASK: usize = 1 << 11;

/// Pairs that a task compares with the nodes that they were made of.
const CHUNK: usize = 1 << 12;

/// A subtree of the binary tree.
struct Subtree {
    root: Sibling,
    /// References below.
    count: u32,
}

/// A subtree with the pairs that were made of it.
enum Part {
    /// The index of a node, and its children.
    Inner(usize, Box<[Part; 2]>),
    /// A subtree whose pairs link to each other by their places in the block.
    Block(Subtree, Pairs),
}

/// Pairs, each behind those below it, and their origins.
#[derive(Default)]
struct Pairs {
    pairs: Vec<Pair>,
    origins: Vec<u32>,
}

impl PairTree {
    /// The upper part of a tree. Cost: O(n), shared among threads.
    pub(super) fn new(tree: &BinaryTree) -> Self {
        let levels = (tree.node_count() / TASK).checked_ilog2();
        let part = Part::new(tree, 0, levels.map_or(0, |levels| levels + 2));
        let mut pairs = part.concatenated();
        let root = pairs.finish(tree, &part, &mut 1).root;
        let unused = Sibling {
            link: GROUP,
            ..root
        };
        pairs.pairs[ROOT] = Pair::new([root, unused]);
        if root.link & GROUP == 0 {
            pairs.pairs[root.link as usize / 2].set_parent(to_u32(ROOT));
        }
        let Pairs { pairs, origins } = pairs;
        Self { pairs, origins }
    }

    /// Writes the pairs that are not as they were back. Cost: O(n), shared among threads, and 10 ns for each change.
    pub(super) fn write_back(&self, tree: &mut BinaryTree) {
        let count = self.pairs.len();
        let changes = map_range(count.div_ceil(CHUNK), |chunk| {
            let first = chunk * CHUNK;
            let pairs = first.max(1)..count.min(first + CHUNK);
            let nodes = pairs.map(|pair| (self.origins[pair] as usize, self.parent_node(pair)));
            let changes = nodes.filter(|(index, node)| tree.nodes[*index] != *node);
            changes.collect::<Vec<_>>()
        });
        for (index, node) in changes.into_iter().flatten() {
            tree.nodes[index] = node;
        }
    }

    /// The parent of a pair as a node of the binary tree.
    fn parent_node(&self, pair: usize) -> BuildNode {
        let children = [2 * pair, 2 * pair + 1].map(|place| match self.children(place) {
            Some([first, _]) => self.origins[first / 2] as usize,
            None => (self.link(place) & !GROUP) as usize,
        });
        let bounds = self.bounds(self.parent(2 * pair));
        BuildNode::new(&bounds.to_aabb(), Link::Inner(children))
    }
}

impl Part {
    /// Makes pairs of a subtree, of those of its children at the same time if there are `levels` left on which that is worth it. The recursion is as deep as
    /// the tree.
    fn new(tree: &BinaryTree, node: usize, levels: u32) -> Self {
        match tree.node(node).1 {
            Link::Inner([first, second]) if levels > 0 => {
                let (first, second) = join_if(
                    true,
                    || Self::new(tree, first, levels - 1),
                    || Self::new(tree, second, levels - 1),
                );
                Self::Inner(node, Box::new([first, second]))
            }
            _ => {
                let mut pairs = Pairs::default();
                let subtree = pairs.gather(tree, node);
                Self::Block(subtree, pairs)
            }
        }
    }

    /// Lists the blocks in order.
    fn list<'a>(&'a self, blocks: &mut Vec<&'a Pairs>) {
        match self {
            Self::Inner(_, children) => children.iter().for_each(|child| child.list(blocks)),
            Self::Block(_, pairs) => blocks.push(pairs),
        }
    }

    /// The pairs of all blocks behind one place for the root, with room for those above them.
    fn concatenated(&self) -> Pairs {
        let mut blocks = Vec::new();
        self.list(&mut blocks);
        let count = 1 + blocks.iter().map(|block| block.pairs.len()).sum::<usize>();
        let mut pairs = Filling::with_room(count, blocks.len());
        let mut origins = Filling::with_room(count, blocks.len());
        let (mut pairs_left, mut origins_left) = (pairs.whole(), origins.whole());
        let mut copies = Vec::with_capacity(blocks.len());
        for block in blocks.into_iter().rev() {
            let length = block.pairs.len();
            copies.push((
                block,
                pairs_left.split_last(length),
                origins_left.split_last(length),
            ));
        }
        let unused = Sibling {
            bounds: Bounds::EMPTY,
            link: GROUP,
            height: 0,
        };
        pairs_left.push_last(Pair::new([unused; 2]));
        origins_left.push_last(0);
        drop((pairs_left, origins_left));
        for_each(copies, |(block, mut pairs, mut origins)| {
            let places = to_u32(2 * pairs.first());
            pairs.fill_last(block.pairs.iter().map(|pair| pair.behind(places)));
            origins.fill_last(block.origins.iter().copied());
        });
        Pairs {
            pairs: pairs.finish(),
            origins: origins.finish(),
        }
    }
}

impl Pairs {
    /// Appends the pairs of a subtree. The recursion is as deep as the tree.
    fn gather(&mut self, tree: &BinaryTree, node: usize) -> Subtree {
        match tree.node(node) {
            (bounds, Link::Leaf { count, .. }) => Subtree {
                root: Sibling {
                    bounds: Bounds::new(&bounds),
                    link: GROUP | to_u32(node),
                    height: 1,
                },
                count: to_u32(count),
            },
            (_, Link::Inner([first, second])) => {
                let first = self.gather(tree, first);
                let second = self.gather(tree, second);
                self.join(tree, node, &[first, second])
            }
        }
    }

    /// Appends the pairs of a part that are not in blocks, whose own begin at the pair `next`.
    fn finish(&mut self, tree: &BinaryTree, part: &Part, next: &mut usize) -> Subtree {
        match part {
            Part::Inner(node, children) => {
                let [first, second] = &**children;
                let first = self.finish(tree, first, next);
                let second = self.finish(tree, second, next);
                self.join(tree, *node, &[first, second])
            }
            Part::Block(subtree, block) => {
                let link = link_behind(subtree.root.link, to_u32(2 * *next));
                *next += block.pairs.len();
                Subtree {
                    root: Sibling {
                        link,
                        ..subtree.root
                    },
                    ..*subtree
                }
            }
        }
    }

    /// Makes a pair of the children of a node, if there is more than a group below it.
    fn join(&mut self, tree: &BinaryTree, node: usize, children: &[Subtree; 2]) -> Subtree {
        let [first, second] = children;
        let count = first.count + second.count;
        let link = if count > GROUP_SIZE {
            let place = to_u32(2 * self.pairs.len());
            for (child, place) in children.iter().zip(place..) {
                if child.root.link & GROUP == 0 {
                    self.pairs[child.root.link as usize / 2].set_parent(place);
                }
            }
            self.pairs.push(Pair::new([first.root, second.root]));
            self.origins.push(to_u32(node));
            place
        } else {
            GROUP | to_u32(node)
        };
        Subtree {
            root: Sibling {
                bounds: Bounds::new(&tree.node(node).0),
                link,
                height: 1 + first.root.height.max(second.root.height),
            },
            count,
        }
    }
}
