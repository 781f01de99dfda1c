//! Writes the nodes and blocks that a collapse chose.
//!
//! First the nodes and blocks of all subtrees are counted. Then the lists are made as long as they get, and each large subtree is a task that has
//! a part of its own of both, which it fills from the end on: so a node knows where its children are.

mod waiting;

use tahko_geometry::simd::LANES;
use tahko_geometry::{Aabb, TriangleBlock, TriangleMesh, size_of_bounds};

use self::waiting::Waiting;
use super::choice::Choice;
use super::collapse::{Collapse, Root};
use super::{CACHED, Child, Nodes, WideBvh, WideNode};
use crate::NodeFormat;
use crate::build::{BinaryTree, Link};
use crate::filling::{Filling, Part};
use crate::parallel::{for_each, map};

/// The layout of a tree. Cost: O(n).
pub(super) fn emit(
    tree: &BinaryTree,
    collapse: &Collapse<'_>,
    mesh: &TriangleMesh,
    format: NodeFormat,
) -> WideBvh {
    let emitter = Emitter {
        tree,
        collapse,
        mesh,
    };
    let root = (!tree.is_empty()).then(|| collapse.root());
    let bounds = root.map_or(Aabb::EMPTY, |root| tree.node(root.index()).0);
    let plan = root.map_or_else(Plan::default, |root| emitter.plan(root));
    let mut nodes = Filling::new(plan.extent.nodes);
    let mut blocks = Filling::new(1 + plan.extent.blocks);
    let mut whole = Parts::new(nodes.whole(), blocks.whole());
    let below = whole.split_last(plan.extent);
    whole.blocks.push_last(TriangleBlock::EMPTY);
    drop(whole);
    let root = root.map_or(Child::NOTHING, |root| emitter.write(root, &plan, below));
    let mut layout = WideBvh {
        root,
        bounds,
        size: 0.0,
        is_cached: false,
        nodes: Nodes::new(nodes.finish(), format),
        blocks: blocks.finish(),
        depth: plan.extent.depth,
        triangle_count: mesh.len(),
    };
    layout.size = root_size(&layout.outer_bounds());
    layout.is_cached = layout.bytes() <= CACHED;
    layout
}

/// The largest magnitude of a coordinate; 0 for a box without points.
fn root_size(bounds: &Aabb) -> f32 {
    if bounds.is_empty() {
        0.0
    } else {
        size_of_bounds(bounds)
    }
}

/// How much there is in a subtree.
#[derive(Clone, Copy, Default)]
struct Extent {
    nodes: usize,
    blocks: usize,
    /// Nodes on the longest way, leaves included.
    depth: usize,
}

/// What a task has to write.
#[derive(Default)]
struct Plan {
    extent: Extent,
    /// The children of its nodes: each node's in order, the nodes in the order in which they are looked at when they are written.
    children: Vec<Root>,
    /// Those among the children that are tasks of their own, in the same order.
    tasks: Vec<Self>,
}

/// The part of both lists that a task fills.
struct Parts<'a> {
    nodes: Part<'a, WideNode>,
    blocks: Part<'a, TriangleBlock>,
    waiting: Waiting,
}

impl<'a> Parts<'a> {
    fn new(nodes: Part<'a, WideNode>, blocks: Part<'a, TriangleBlock>) -> Self {
        Self {
            nodes,
            blocks,
            waiting: Waiting::default(),
        }
    }

    /// Cuts off the last places that are not yet written. No blocks wait.
    fn split_last(&mut self, extent: Extent) -> Self {
        debug_assert!(self.waiting.len() == 0, "they stand behind it");
        Self::new(
            self.nodes.split_last(extent.nodes),
            self.blocks.split_last(extent.blocks),
        )
    }

    /// Writes the blocks that wait.
    fn write_waiting(&mut self, mesh: &TriangleMesh) {
        self.waiting.write(&mut self.blocks, mesh);
    }
}

/// What is left of a plan.
struct Reader<'a> {
    children: &'a [Root],
    tasks: std::slice::Iter<'a, Plan>,
}

impl<'a> Reader<'a> {
    /// The children of the next node.
    fn children(&mut self) -> &'a [Root] {
        let count = self
            .children
            .iter()
            .take_while(|child| !child.is_last())
            .count();
        let (children, rest) = self.children.split_at(count + 1);
        self.children = rest;
        children
    }
}

struct Emitter<'a> {
    tree: &'a BinaryTree,
    collapse: &'a Collapse<'a>,
    mesh: &'a TriangleMesh,
}

impl Emitter<'_> {
    /// Whether a tree is a task of its own: some 20 microseconds at least.
    fn is_task(&self, root: Root) -> bool {
        !root.is_leaf() && self.collapse.count(root.index()) == Choice::MANY
    }

    fn plan(&self, root: Root) -> Plan {
        let mut plan = Plan::default();
        let mut tasks = Vec::new();
        if root.is_leaf() {
            plan.extent.depth = 1;
            plan.extent.blocks = self.block_count(root.index());
        } else {
            self.plan_node(root.index(), 1, &mut plan, &mut tasks);
        }
        plan.children.shrink_to_fit();
        plan.tasks = map(&tasks, |(task, _)| self.plan(*task));
        for ((_, depth), task) in tasks.iter().zip(&plan.tasks) {
            plan.extent.nodes += task.extent.nodes;
            plan.extent.blocks += task.extent.blocks;
            plan.extent.depth = plan.extent.depth.max(depth + task.extent.depth);
        }
        plan
    }

    /// Plans a node at some depth of a task, and those below it that are no tasks of their own; lists these with the depth of their parents.
    fn plan_node(
        &self,
        index: usize,
        depth: usize,
        plan: &mut Plan,
        tasks: &mut Vec<(Root, usize)>,
    ) {
        let first = plan.children.len();
        self.collapse.children(index, &mut plan.children);
        plan.extent.nodes += 1;
        for place in (first..plan.children.len()).rev() {
            let child = plan.children[place];
            if child.is_leaf() {
                plan.extent.blocks += self.block_count(child.index());
                plan.extent.depth = plan.extent.depth.max(depth + 1);
            } else if self.is_task(child) {
                tasks.push((child, depth));
            } else {
                self.plan_node(child.index(), depth + 1, plan, tasks);
            }
        }
    }

    /// The blocks of a leaf.
    fn block_count(&self, index: usize) -> usize {
        if self.collapse.count(index) as usize <= LANES {
            return 1;
        }
        let mut numbers = Vec::new();
        self.list(index, &mut numbers);
        numbers.len().div_ceil(LANES)
    }

    /// Fills the parts of a task and of those below it, and returns where its root is.
    fn write(&self, root: Root, plan: &Plan, mut parts: Parts<'_>) -> Child {
        let mut tasks = Vec::new();
        let place = if root.is_leaf() {
            self.add_leaf(root.index(), &mut parts)
        } else {
            let mut reader = Reader {
                children: &plan.children,
                tasks: plan.tasks.iter(),
            };
            self.add_node(&mut reader, &mut parts, &mut tasks)
        };
        parts.write_waiting(self.mesh);
        for_each(tasks, |(root, plan, parts)| {
            self.write(root, plan, parts);
        });
        place
    }

    /// Adds the next node of a plan and those below it that are no tasks of their own. The recursion is as deep as the wide tree.
    fn add_node<'p, 'l>(
        &self,
        reader: &mut Reader<'p>,
        parts: &mut Parts<'l>,
        tasks: &mut Vec<(Root, &'p Plan, Parts<'l>)>,
    ) -> Child {
        let children = reader.children();
        let mut places = [Child::NOTHING; LANES];
        for (place, child) in places.iter_mut().zip(children).rev() {
            if child.is_leaf() {
                continue;
            }
            *place = if self.is_task(*child) {
                parts.write_waiting(self.mesh);
                let plan = reader.tasks.next().expect("it was planned");
                let below = parts.split_last(plan.extent);
                let place = Child::inner(below.nodes.first());
                tasks.push((*child, plan, below));
                place
            } else {
                self.add_node(reader, parts, tasks)
            };
        }
        // The blocks of a node's leaves stand before those below its other children.
        let mut node = WideNode::EMPTY;
        for (lane, child) in children.iter().enumerate().rev() {
            if child.is_leaf() {
                places[lane] = self.add_leaf(child.index(), parts);
            }
            node.set(lane, &self.tree.node(child.index()).0, places[lane]);
        }
        parts.nodes.push_last(node);
        Child::inner(parts.nodes.end())
    }

    /// Adds the blocks of all triangles below a binary node.
    fn add_leaf(&self, index: usize, parts: &mut Parts<'_>) -> Child {
        if parts.waiting.is_full() {
            parts.write_waiting(self.mesh);
        }
        parts.waiting.add_leaf(|numbers| self.list(index, numbers));
        Child::leaf(parts.blocks.end() - parts.waiting.len())
    }

    /// Appends the triangles below a binary node to a list: in the order of the tree if that lists each once, else in ascending order.
    fn list(&self, index: usize, numbers: &mut Vec<u32>) {
        let first = numbers.len();
        self.gather(index, numbers);
        if self.tree.is_ordered {
            return;
        }
        numbers[first..].sort_unstable();
        // Spatial splits may have listed a triangle in several of the leaves that are now one.
        let mut end = first;
        for place in first..numbers.len() {
            if place == first || numbers[place] != numbers[end - 1] {
                numbers[end] = numbers[place];
                end += 1;
            }
        }
        numbers.truncate(end);
    }

    fn gather(&self, index: usize, numbers: &mut Vec<u32>) {
        match self.tree.node(index).1 {
            Link::Inner([first, second]) => {
                self.gather(first, numbers);
                self.gather(second, numbers);
            }
            Link::Leaf { first, count } => {
                let references = &self.tree.references[first..][..count];
                numbers.extend(references.iter().map(|reference| reference.number()));
            }
        }
    }
}

#[cfg(test)]
mod tests;
