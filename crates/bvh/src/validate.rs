//! Checks that a tree is well formed.

use tahko_geometry::Aabb;
use thiserror::Error;

use crate::Bvh;
use crate::build::MAX_DEPTH;
use crate::layout::Bvh2;
use crate::node::{LeafTriangle, Node};

/// What is wrong with a tree. Nodes are numbered from the root, 0, in memory order.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ValidationError {
    /// There are nodes or triangles, but no root.
    #[error("the tree has no root")]
    NoRoot,
    /// An inner node names children that do not exist.
    #[error(
        "node {node} has its children at {index}, but there are only {count} pairs of siblings"
    )]
    ChildrenOutOfRange {
        /// Number of the node.
        node: usize,
        /// The index of its children.
        index: usize,
        /// The number of pairs.
        count: usize,
    },
    /// A node is the child of two nodes, or of its own descendant.
    #[error("node {node} is reached a second time")]
    ReachedTwice {
        /// Number of the node.
        node: usize,
    },
    /// A node is not the child of any node that is reached.
    #[error("node {node} is not reached")]
    NotReached {
        /// Number of the node.
        node: usize,
    },
    /// A leaf names triangles that do not exist.
    #[error("leaf {node} has triangles up to {end}, but there are only {count}")]
    TrianglesOutOfRange {
        /// Number of the node.
        node: usize,
        /// One beyond its last triangle.
        end: usize,
        /// The number of triangles.
        count: usize,
    },
    /// A box does not enclose what is in it.
    #[error("the bounds of node {node} do not enclose {content}")]
    NotEnclosed {
        /// Number of the node.
        node: usize,
        /// The child that sticks out.
        content: Content,
    },
    /// A triangle number is not below the number of triangles.
    #[error("leaf {node} lists triangle {triangle}, but there are only {count}")]
    NoSuchTriangle {
        /// Number of the node.
        node: usize,
        /// Number of the triangle.
        triangle: usize,
        /// The number of triangles.
        count: usize,
    },
    /// A triangle is listed in no leaf.
    #[error("triangle {triangle} is not listed")]
    NotListed {
        /// Number of the triangle.
        triangle: usize,
    },
    /// The boxes of the leaves that list a triangle do not enclose it together.
    #[error("the {times} leaves that list triangle {triangle} do not enclose it")]
    NotCovered {
        /// Number of the triangle.
        triangle: usize,
        /// How often it is listed.
        times: u32,
    },
    /// A way from the root to a leaf is longer than the stack of the traversal, or not as long as the tree says.
    #[error("the tree is {found} nodes deep; it says {stated}, and at most {limit} are allowed")]
    Depth {
        /// Nodes on the longest way.
        found: usize,
        /// The depth that the tree states.
        stated: usize,
        /// The depth that traversal can manage.
        limit: usize,
    },
}

/// What a box must enclose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Content {
    /// The node with a number.
    Node(usize),
}

impl std::fmt::Display for Content {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Node(number) => write!(formatter, "node {number}"),
        }
    }
}

impl Bvh {
    /// Checks that the tree is well formed: indices in range, every node reached once, boxes that enclose their
    /// content, every triangle in a leaf that encloses it or in several that enclose it together, a depth that traversal can manage. Trees
    /// from [`build`](Self::build) are.
    ///
    /// Cost: O(n).
    ///
    /// # Errors
    /// The first fault found, with the node that has it.
    pub fn validate(&self) -> Result<(), ValidationError> {
        Validation::new(self.layout()).run()
    }
}

struct Validation<'a> {
    layout: &'a Bvh2,
    siblings_reached: Vec<bool>,
    times_listed: Vec<u32>,
    /// The box around the leaves that list a triangle.
    leaves_around: Vec<Aabb>,
}

impl<'a> Validation<'a> {
    fn new(layout: &'a Bvh2) -> Self {
        Self {
            layout,
            siblings_reached: vec![false; layout.siblings.len()],
            times_listed: vec![0; layout.triangles.len()],
            leaves_around: vec![Aabb::EMPTY; layout.triangles.len()],
        }
    }

    fn run(mut self) -> Result<(), ValidationError> {
        let mut found = 0;
        let mut pending: Vec<(usize, &Node, usize)> = Vec::new();
        match &self.layout.root {
            Some(root) => pending.push((0, root, 1)),
            None if self.layout.siblings.is_empty() && self.layout.triangles.is_empty() => {}
            None => return Err(ValidationError::NoRoot),
        }
        while let Some((number, node, depth)) = pending.pop() {
            found = found.max(depth);
            if node.is_leaf() {
                self.check_leaf(number, node)?;
            } else {
                let children = self.check_children(number, node)?;
                pending.extend(children.map(|(number, node)| (number, node, depth + 1)));
            }
        }
        self.check_totals(found)
    }

    /// The children of an inner node with their numbers.
    fn check_children(
        &mut self,
        number: usize,
        node: &Node,
    ) -> Result<[(usize, &'a Node); 2], ValidationError> {
        let index = node.first();
        let count = self.layout.siblings.len();
        let siblings = self.layout.siblings.get(index);
        let siblings = siblings.ok_or(ValidationError::ChildrenOutOfRange {
            node: number,
            index,
            count,
        })?;
        let numbers = [2 * index + 1, 2 * index + 2];
        if std::mem::replace(&mut self.siblings_reached[index], true) {
            return Err(ValidationError::ReachedTwice { node: numbers[0] });
        }
        let children = [0, 1].map(|side| (numbers[side], &siblings.0[side]));
        for (child_number, child) in children {
            check_enclosed(number, node, &child.bounds(), Content::Node(child_number))?;
        }
        Ok(children)
    }

    fn check_leaf(&mut self, number: usize, node: &Node) -> Result<(), ValidationError> {
        let count = self.layout.triangles.len();
        let end = node.first() + node.count();
        let triangles = self.layout.triangles.get(node.first()..end);
        let triangles = triangles.ok_or(ValidationError::TrianglesOutOfRange {
            node: number,
            end,
            count,
        })?;
        for LeafTriangle { number: listed, .. } in triangles {
            let listed = *listed as usize;
            let times = self.times_listed.get_mut(listed);
            *times.ok_or(ValidationError::NoSuchTriangle {
                node: number,
                triangle: listed,
                count,
            })? += 1;
            self.leaves_around[listed] = self.leaves_around[listed].union(node.bounds());
        }
        Ok(())
    }

    fn check_totals(&self, found: usize) -> Result<(), ValidationError> {
        if let Some(index) = self.siblings_reached.iter().position(|reached| !reached) {
            let node = 2 * index + 1;
            return Err(ValidationError::NotReached { node });
        }
        let numbers = self
            .layout
            .triangles
            .iter()
            .map(|leaf| leaf.number as usize);
        let count = numbers.max().map_or(0, |largest| largest + 1);
        let mut times = self.times_listed.iter().take(count);
        if let Some(triangle) = times.position(|times| *times == 0) {
            return Err(ValidationError::NotListed { triangle });
        }
        for LeafTriangle { triangle, number } in &self.layout.triangles {
            let number = *number as usize;
            if !self.leaves_around[number].contains_box(&triangle.aabb()) {
                return Err(ValidationError::NotCovered {
                    triangle: number,
                    times: self.times_listed[number],
                });
            }
        }
        let stated = self.layout.depth;
        if found > MAX_DEPTH || found != stated {
            return Err(ValidationError::Depth {
                found,
                stated,
                limit: MAX_DEPTH,
            });
        }
        Ok(())
    }
}

fn check_enclosed(
    number: usize,
    node: &Node,
    inside: &Aabb,
    content: Content,
) -> Result<(), ValidationError> {
    if inside.is_empty() || !node.bounds().contains_box(inside) {
        return Err(ValidationError::NotEnclosed {
            node: number,
            content,
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests;
