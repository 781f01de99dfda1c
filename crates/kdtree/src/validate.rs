//! Well-formedness of a tree.

use tahko_geometry::Aabb;
use thiserror::Error;

use crate::KdTree;
use crate::node::Kind;

/// What is wrong with a tree. Nodes are numbered from the root, 0; primitives as in the mesh.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ValidationError {
    /// A child does not exist.
    #[error("node {node} has a child {child}, but there are only {count} nodes")]
    ChildOutOfRange {
        /// The parent.
        node: usize,
        /// The child.
        child: usize,
        /// The number of nodes.
        count: usize,
    },
    /// Two parents share a child, or a node is below itself.
    #[error("node {node} is reached a second time")]
    NodeReachedTwice {
        /// The node.
        node: usize,
    },
    /// No way leads from the root to a node.
    #[error("node {node} is not reached from the root")]
    NodeUnreached {
        /// The node.
        node: usize,
    },
    /// A splitting plane does not meet the cell that it splits.
    #[error("node {node} splits its cell at {position}, which is outside")]
    SplitOutsideCell {
        /// The node.
        node: usize,
        /// Position of the plane.
        position: f32,
    },
    /// The list of a leaf is not inside the array of list entries.
    #[error(
        "leaf {node} has the list entries {first} to {first} + {count}, but there are only {available}"
    )]
    ListOutOfRange {
        /// The leaf.
        node: usize,
        /// Its first list entry.
        first: usize,
        /// How many it has.
        count: usize,
        /// The number of list entries.
        available: usize,
    },
    /// List entries that belong to no leaf, or to several.
    #[error("the leaves have {listed} list entries together, but there are {available}")]
    ListsDoNotAddUp {
        /// The sum over the leaves.
        listed: usize,
        /// The number of list entries.
        available: usize,
    },
    /// A list names a triangle that does not exist.
    #[error("leaf {node} lists triangle {slot}, but the tree has only {count}")]
    TriangleOutOfRange {
        /// The leaf.
        node: usize,
        /// The triangle's place in the tree.
        slot: usize,
        /// The number of triangles in the tree.
        count: usize,
    },
    /// A leaf lists a triangle that does not touch its cell.
    #[error("leaf {node} lists primitive {primitive}, which is outside its cell")]
    TriangleOutsideCell {
        /// The leaf.
        node: usize,
        /// The primitive.
        primitive: u32,
    },
    /// No leaf that contains a vertex of a triangle lists the triangle, so a ray to the vertex may miss it.
    #[error("vertex {vertex} of primitive {primitive} is in no leaf that lists the primitive")]
    VertexUnlisted {
        /// The primitive.
        primitive: u32,
        /// The vertex: 0, 1 or 2.
        vertex: usize,
    },
    /// A triangle's number is not that of a primitive, or two triangles have it.
    #[error("number {primitive} is given twice, or not below the {count} primitives")]
    PrimitiveInvalid {
        /// The number.
        primitive: u32,
        /// The number of primitives.
        count: usize,
    },
    /// The depth, which gives the size of the traversal stack, is wrong.
    #[error("the depth is {actual}, not {stored}")]
    WrongDepth {
        /// The depth that the tree states.
        stored: usize,
        /// The depth that it has.
        actual: usize,
    },
}

impl KdTree {
    /// Checks that the tree is well formed: every node is reached once, planes and lists lie where they should, every
    /// list entry belongs to one leaf and touches its cell, and every vertex of every triangle is in a leaf that
    /// lists the triangle.
    ///
    /// Trees that [`build`](Self::build) returns are. Time and memory in proportion to the tree.
    ///
    /// # Errors
    /// The first fault that is found.
    pub fn validate(&self) -> Result<(), ValidationError> {
        self.validate_primitives()?;
        let mut walk = Walk::new(self);
        if !self.nodes.is_empty() {
            walk.open.push((0, self.bounds, 1));
        }
        while let Some((node, cell, level)) = walk.open.pop() {
            walk.visit(node, cell, level)?;
        }
        walk.finish()
    }

    fn validate_primitives(&self) -> Result<(), ValidationError> {
        let mut seen = vec![false; self.mesh_len];
        for primitive in &self.primitives {
            match seen.get_mut(*primitive as usize) {
                Some(seen) if !*seen => *seen = true,
                _ => {
                    return Err(ValidationError::PrimitiveInvalid {
                        primitive: *primitive,
                        count: self.mesh_len,
                    });
                }
            }
        }
        Ok(())
    }
}

/// What a walk over all nodes has seen.
struct Walk<'a> {
    tree: &'a KdTree,
    /// Nodes to visit, with their cells and levels.
    open: Vec<(usize, Aabb, usize)>,
    reached: Vec<bool>,
    depth: usize,
    listed: usize,
    /// For each triangle, the vertices that were found in a leaf that lists it.
    vertices: Vec<[bool; 3]>,
}

impl<'a> Walk<'a> {
    fn new(tree: &'a KdTree) -> Self {
        Self {
            tree,
            open: Vec::new(),
            reached: vec![false; tree.nodes.len()],
            depth: 0,
            listed: 0,
            vertices: vec![[false; 3]; tree.triangles.len()],
        }
    }

    fn visit(&mut self, node: usize, cell: Aabb, level: usize) -> Result<(), ValidationError> {
        if std::mem::replace(&mut self.reached[node], true) {
            return Err(ValidationError::NodeReachedTwice { node });
        }
        self.depth = self.depth.max(level);
        match self.tree.nodes[node].kind() {
            Kind::Inner {
                axis,
                position,
                first_child,
            } => {
                let axis = axis as usize;
                if !(cell.min[axis] <= position && position <= cell.max[axis]) {
                    return Err(ValidationError::SplitOutsideCell { node, position });
                }
                let count = self.tree.nodes.len();
                if first_child + 1 >= count {
                    let child = first_child + 1;
                    return Err(ValidationError::ChildOutOfRange { node, child, count });
                }
                let [mut left, mut right] = [cell; 2];
                left.max[axis] = position;
                right.min[axis] = position;
                self.open.push((first_child + 1, right, level + 1));
                self.open.push((first_child, left, level + 1));
                Ok(())
            }
            Kind::Leaf { first, count } => self.visit_list(node, &cell, first, count),
        }
    }

    fn visit_list(
        &mut self,
        node: usize,
        cell: &Aabb,
        first: usize,
        count: usize,
    ) -> Result<(), ValidationError> {
        let tree = self.tree;
        let Some(list) = tree.references.get(first..first + count) else {
            return Err(ValidationError::ListOutOfRange {
                node,
                first,
                count,
                available: tree.references.len(),
            });
        };
        self.listed += count;
        for slot in list.iter().map(|slot| *slot as usize) {
            let (Some(triangle), Some(primitive)) =
                (tree.triangles.get(slot), tree.primitives.get(slot))
            else {
                return Err(ValidationError::TriangleOutOfRange {
                    node,
                    slot,
                    count: tree.triangles.len(),
                });
            };
            if cell.intersection(triangle.aabb()).is_empty() {
                return Err(ValidationError::TriangleOutsideCell {
                    node,
                    primitive: *primitive,
                });
            }
            for (found, vertex) in self.vertices[slot].iter_mut().zip(triangle.vertices()) {
                *found |= cell.contains(vertex);
            }
        }
        Ok(())
    }

    fn finish(self) -> Result<(), ValidationError> {
        if let Some(node) = self.reached.iter().position(|reached| !reached) {
            return Err(ValidationError::NodeUnreached { node });
        }
        if self.listed != self.tree.references.len() {
            return Err(ValidationError::ListsDoNotAddUp {
                listed: self.listed,
                available: self.tree.references.len(),
            });
        }
        for (slot, found) in self.vertices.iter().enumerate() {
            if let Some(vertex) = found.iter().position(|found| !found) {
                let primitive = self.tree.primitives[slot];
                return Err(ValidationError::VertexUnlisted { primitive, vertex });
            }
        }
        if self.depth != self.tree.depth {
            return Err(ValidationError::WrongDepth {
                stored: self.tree.depth,
                actual: self.depth,
            });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use tahko_geometry::Axis;
    use tahko_geometry::glam::Vec3;
    use tahko_geometry::test_support::soup;

    use super::*;
    use crate::KdTreeOptions;
    use crate::node::Node;

    /// Two triangles apart from each other along x: a root with children.
    fn tree() -> KdTree {
        let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let mesh = soup(vec![
            triangle,
            triangle.map(|corner| corner + 9.0 * Vec3::X),
        ]);
        let options = KdTreeOptions::default().with_max_leaf_size(1);
        let tree = KdTree::build(&mesh, &options).expect("the options are valid");
        assert!(tree.node_count() >= 3, "the triangles are separated");
        assert_eq!(tree.validate(), Ok(()));
        tree
    }

    fn first_leaf(tree: &KdTree) -> usize {
        let is_leaf = |node: &Node| matches!(node.kind(), Kind::Leaf { count, .. } if count > 0);
        tree.nodes
            .iter()
            .position(is_leaf)
            .expect("there are leaves")
    }

    #[test]
    fn a_loop_is_found() {
        let mut tree = tree();
        let leaf = first_leaf(&tree);
        tree.nodes[leaf] = tree.nodes[0];
        let error = tree.validate().expect_err("the root is below itself");
        assert!(
            matches!(
                error,
                ValidationError::NodeReachedTwice { .. } | ValidationError::SplitOutsideCell { .. }
            ),
            "{error}"
        );
    }

    #[test]
    fn a_child_that_does_not_exist_is_found() {
        let mut tree = tree();
        tree.nodes[0] = Node::inner(Axis::X, 1.0, 1000);
        let error = tree.validate().expect_err("there is no node 1001");
        assert!(
            matches!(
                error,
                ValidationError::ChildOutOfRange {
                    node: 0,
                    child: 1001,
                    ..
                }
            ),
            "{error}"
        );
    }

    #[test]
    fn a_plane_outside_its_cell_is_found() {
        let mut tree = tree();
        let Kind::Inner {
            axis, first_child, ..
        } = tree.nodes[0].kind()
        else {
            panic!("the root has children");
        };
        tree.nodes[0] = Node::inner(axis, f32::NAN, first_child);
        let error = tree.validate().expect_err("NaN is nowhere");
        assert!(
            matches!(error, ValidationError::SplitOutsideCell { node: 0, .. }),
            "{error}"
        );
    }

    #[test]
    fn a_lost_triangle_is_found() {
        let mut tree = tree();
        let leaf = first_leaf(&tree);
        tree.nodes[leaf] = Node::EMPTY_LEAF;
        let error = tree.validate().expect_err("a list entry has no leaf");
        assert!(
            matches!(error, ValidationError::ListsDoNotAddUp { .. }),
            "{error}"
        );
        tree.references.pop();
        let error = tree.validate().expect_err("a triangle is in no leaf");
        assert!(
            matches!(
                error,
                ValidationError::VertexUnlisted { .. } | ValidationError::ListOutOfRange { .. }
            ),
            "{error}"
        );
    }

    #[test]
    fn wrong_lists_and_numbers_are_found() {
        let mut with_entry = tree();
        with_entry.references[0] = 77;
        let error = with_entry.validate().expect_err("there is no triangle 77");
        assert!(
            matches!(error, ValidationError::TriangleOutOfRange { slot: 77, .. }),
            "{error}"
        );

        let mut swapped = tree();
        swapped.references.swap(0, 1);
        let error = swapped.validate().expect_err("the lists are swapped");
        assert!(
            matches!(error, ValidationError::TriangleOutsideCell { .. }),
            "{error}"
        );

        let mut twins = tree();
        twins.primitives[1] = twins.primitives[0];
        let error = twins.validate().expect_err("two triangles have one number");
        assert!(
            matches!(error, ValidationError::PrimitiveInvalid { .. }),
            "{error}"
        );

        let mut shallow = tree();
        shallow.depth = 1;
        let error = shallow.validate().expect_err("the tree is deeper");
        assert!(
            matches!(error, ValidationError::WrongDepth { stored: 1, .. }),
            "{error}"
        );
    }
}
