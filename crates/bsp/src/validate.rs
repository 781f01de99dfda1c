//! Checks that a tree is well formed.

use tahko_geometry::{Plane, Polygon, Side};
use thiserror::Error;

use crate::BspTree;
use crate::divider::Divider;
use crate::node::{BACK, Child, FRONT, IN_PLANE, Link, List};
use crate::piece::Piece;
use crate::tree::largest_coordinates;

/// What is wrong with a tree. Nodes and leaves are numbered by their places in memory, apart from each other.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ValidationError {
    /// A child links to a node or leaf that does not exist.
    #[error("node {node} has a child {index}, but there are only {count} of its kind")]
    ChildOutOfRange {
        /// Number of the node; 0 for the link to the root too.
        node: usize,
        /// The index of the child.
        index: usize,
        /// The number of nodes or leaves.
        count: usize,
    },
    /// A node is reached in several ways, or not at all.
    #[error("node {node} is reached {times} times, and not once")]
    NodeNotReachedOnce {
        /// Number of the node.
        node: usize,
        /// How often it is reached.
        times: usize,
    },
    /// A leaf is reached in several ways, or not at all.
    #[error("leaf {leaf} is reached {times} times, and not once")]
    LeafNotReachedOnce {
        /// Number of the leaf.
        leaf: usize,
        /// How often it is reached.
        times: usize,
    },
    /// A node has a plane whose normal is not of unit length, or which is not finite.
    #[error("node {node} has no valid splitting plane: {plane:?}")]
    InvalidPlane {
        /// Number of the node.
        node: usize,
        /// Its plane.
        plane: Plane,
    },
    /// A list has references that do not exist, or one that leads nowhere.
    #[error("a list from reference {first} on names a triangle that does not exist")]
    ReferenceOutOfRange {
        /// Index of the first reference of the list.
        first: usize,
    },
    /// A triangle has a part where no list names it.
    #[error("triangle {triangle} has a part in {place}, which does not list it")]
    NotListed {
        /// Number of the triangle in the mesh.
        triangle: usize,
        /// The leaf.
        place: Place,
    },
    /// There are more references than places where triangles are.
    #[error("there are {references} references, but triangles are in {places} places only")]
    Superfluous {
        /// The number of references.
        references: usize,
        /// The number of places.
        places: usize,
    },
    /// The longest way from the root is not as long as the tree says.
    #[error("the tree is {found} nodes deep; it says {stated}")]
    Depth {
        /// Nodes on the longest way.
        found: usize,
        /// The depth that the tree states.
        stated: usize,
    },
}

/// Where a triangle is listed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// The leaf with a number.
    Leaf(usize),
    /// A leaf without triangles.
    EmptyLeaf,
}

impl std::fmt::Display for Place {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Leaf(number) => write!(formatter, "leaf {number}"),
            Self::EmptyLeaf => write!(formatter, "an empty leaf"),
        }
    }
}

impl BspTree {
    /// Checks that the tree is well formed: indices in range, every node and leaf reached once, valid planes, the
    /// depth as stated, and every triangle listed exactly where its parts lie. Trees from [`build`](Self::build) are.
    ///
    /// Each triangle is sent down the tree and classified, cut or listed twice as in the build.
    /// Cost: O(references * depth).
    ///
    /// # Errors
    /// The first fault found, with the node that has it.
    pub fn validate(&self) -> Result<(), ValidationError> {
        self.check_links()?;
        for (index, node) in self.nodes.iter().enumerate() {
            let Plane { normal, offset } = node.plane;
            if !(normal.is_normalized() && offset.is_finite()) {
                return Err(ValidationError::InvalidPlane {
                    node: index,
                    plane: node.plane,
                });
            }
        }
        for leaf in &self.leaves {
            self.check_list(*leaf)?;
        }
        self.check_triangles()
    }

    /// Every node and leaf is reached once, and the depth is as stated.
    fn check_links(&self) -> Result<(), ValidationError> {
        let mut nodes_reached = vec![0usize; self.nodes.len()];
        let mut leaves_reached = vec![0usize; self.leaves.len()];
        let mut found = 0;
        let mut pending = vec![(0, self.root, 1)];
        while let Some((node, child, depth)) = pending.pop() {
            found = found.max(depth);
            let (reached, index) = match child.link() {
                Link::Empty => continue,
                Link::Leaf(index) => (&mut leaves_reached, index),
                Link::Inner(index) => (&mut nodes_reached, index),
            };
            let count = reached.len();
            let times = reached.get_mut(index);
            let times = times.ok_or(ValidationError::ChildOutOfRange { node, index, count })?;
            *times += 1;
            // A second time would be the way into a loop.
            if let Link::Inner(index) = child.link()
                && nodes_reached[index] == 1
            {
                let children = self.nodes[index].children;
                pending.extend(children.map(|child| (index, child, depth + 1)));
            }
        }
        if let Some(node) = nodes_reached.iter().position(|times| *times != 1) {
            let times = nodes_reached[node];
            return Err(ValidationError::NodeNotReachedOnce { node, times });
        }
        if let Some(leaf) = leaves_reached.iter().position(|times| *times != 1) {
            let times = leaves_reached[leaf];
            return Err(ValidationError::LeafNotReachedOnce { leaf, times });
        }
        let stated = self.depth;
        if found == stated {
            Ok(())
        } else {
            Err(ValidationError::Depth { found, stated })
        }
    }

    fn check_list(&self, list: List) -> Result<(), ValidationError> {
        let first = list.first as usize;
        let exists = |reference: &u32| (*reference as usize) < self.triangles.len();
        match self.references.get(list.range()) {
            Some(references) if references.iter().all(exists) => Ok(()),
            _ => Err(ValidationError::ReferenceOutOfRange { first }),
        }
    }

    /// Every triangle is listed where its parts lie, and nowhere else.
    fn check_triangles(&self) -> Result<(), ValidationError> {
        let mut places = 0;
        for (index, listed) in (0u32..).zip(&self.triangles) {
            if let Some(polygon) = Polygon::from_triangle(&listed.triangle, index) {
                places += self.check_parts(Piece::whole(&polygon), listed.number as usize)?;
            }
        }
        let references = self.references.len();
        if places == references {
            Ok(())
        } else {
            Err(ValidationError::Superfluous { references, places })
        }
    }

    /// Sends a triangle down the tree. The number of lists that it belongs to.
    fn check_parts(&self, whole: Piece<'_>, triangle: usize) -> Result<usize, ValidationError> {
        let largest = largest_coordinates(&self.bounds());
        let mut places = 0;
        let mut pending: Vec<(Child, Piece<'_>)> = vec![(self.root, whole)];
        while let Some((child, piece)) = pending.pop() {
            let (list, place) = match child.link() {
                Link::Empty => (List::default(), Place::EmptyLeaf),
                Link::Leaf(index) => (self.leaves[index], Place::Leaf(index)),
                Link::Inner(index) => {
                    let node = &self.nodes[index];
                    let divider = Divider::new(node.plane, largest);
                    match divider.side_of(piece.vertices()) {
                        Side::Front => pending.push((node.children[FRONT], piece)),
                        Side::Back => pending.push((node.children[BACK], piece)),
                        Side::Coplanar => pending.push((node.children[IN_PLANE], piece)),
                        Side::Spanning => {
                            let parts = piece.parts(&node.plane, self.options().straddlers);
                            let parts = node.children.into_iter().zip(parts);
                            pending.extend(parts.filter_map(|(child, part)| Some((child, part?))));
                        }
                    }
                    continue;
                }
            };
            if !self.references[list.range()].contains(&piece.id()) {
                return Err(ValidationError::NotListed { triangle, place });
            }
            places += 1;
        }
        Ok(places)
    }
}

#[cfg(test)]
mod tests;
