//! The build: cells are divided until no split pays, large ones in parallel, small ones in a loop.
//!
//! A policy only chooses where a cell is split ([`surface_area`], [`midpoints`]); the division, with clipping and
//! the sorted events, is the same for all ([`cell`], [`events`], [`clip`]). It always ends: every division
//! takes one of a limited number of levels, and a cell's references have to fit its share of a budget, so that time is
//! `O(B d)` for a budget `B` and depth limit `d`, and `O(n log n)` where few triangles straddle a plane.
//!
//! Which cells are divided in parallel depends on their size and level alone, and subtrees are put together
//! in the order of the tree, so the number of threads changes nothing.

mod cell;
mod clip;
mod events;
mod midpoints;
mod surface_area;

use tahko_geometry::{Aabb, Axis, Triangle, TriangleMesh};

use self::cell::{Cell, Context, Reference, Scratch, Split};
use self::events::EventLists;
use crate::node::Node;
use crate::{AxisChoice, BuildError, KdTreeOptions, SplitPolicy};

#[cfg(feature = "parallel")]
use rayon::join;

/// Runs two closures one after the other: what `rayon::join` does on one thread.
#[cfg(not(feature = "parallel"))]
fn join<A, B, RA, RB>(a: A, b: B) -> (RA, RB)
where
    A: FnOnce() -> RA,
    B: FnOnce() -> RB,
{
    (a(), b())
}

/// Down to this level the halves of a cell may be built in parallel; recursion goes no deeper.
const PARALLEL_LEVELS: u32 = 24;
/// Cells with fewer references are not worth a task.
const PARALLEL_REFERENCES: usize = 1 << 11;

/// Where no split pays by the surface area heuristic, cells with more references than this are split in the middle.
///
/// The heuristic takes every ray to pass through the whole cell. Triangles as large as their cell straddle every plane, so
/// no split ever pays, and thousands can be left in one leaf; but in small cells a ray stops at the first hit. With 10
/// thousand random triangles across a cube a ray tests 118 instead of 6950; scenes of small triangles keep their trees.
const LARGE_LEAF: usize = 64;

/// A finished tree over the triangles of a mesh.
#[derive(Debug)]
pub(crate) struct BuiltTree {
    /// The root first; none if there are no triangles.
    pub nodes: Vec<Node>,
    /// Lists of the leaves: indices in the mesh.
    pub references: Vec<u32>,
    /// A box around all triangles that are listed: the cell of the root.
    pub bounds: Aabb,
    /// Nodes on the longest way from the root to a leaf.
    pub depth: usize,
}

/// Builds a tree. Triangles without area are not listed: no kernel accepts them.
pub(crate) fn build(mesh: &TriangleMesh, options: &KdTreeOptions) -> Result<BuiltTree, BuildError> {
    let triangles: Vec<Triangle> = mesh.triangles().collect();
    let references: Vec<Reference> = (0..)
        .zip(&triangles)
        .filter(|(_, triangle)| !triangle.is_degenerate())
        .map(|(number, triangle)| Reference {
            triangle: number,
            bounds: triangle.aabb(),
        })
        .collect();
    let bounds = references.iter().fold(Aabb::EMPTY, |bounds, reference| {
        bounds.union(reference.bounds)
    });
    let mut tree = BuiltTree {
        nodes: Vec::new(),
        references: Vec::new(),
        bounds,
        depth: 0,
    };
    if references.is_empty() {
        return Ok(tree);
    }
    let context = Context {
        triangles: &triangles,
        options,
        max_depth: options
            .max_depth
            .unwrap_or_else(|| default_max_depth(references.len())),
    };
    let events =
        (options.split_policy == SplitPolicy::SurfaceArea).then(|| EventLists::new(&references));
    let root = Cell {
        bounds,
        budget: budget(references.len(), options),
        references,
        events,
        depth: 0,
    };
    let root = grow(root, &context, 0)?;
    tree.nodes.push(Node::EMPTY_LEAF);
    tree.place(root, 0, 1)?;
    Ok(tree)
}

/// `8 + 1.3 log2 n`, the limit of Havran and of pbrt.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "between 8 and 46"
)]
fn default_max_depth(triangles: usize) -> u32 {
    (8.0 + 1.3 * (triangles as f64).log2()).round() as u32
}

/// The number of references that the whole tree may have.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "positive, and limited just after; a float beyond usize becomes its maximum"
)]
fn budget(triangles: usize, options: &KdTreeOptions) -> usize {
    let limit = f64::from(options.max_references_per_triangle) * triangles as f64;
    (limit as usize).clamp(triangles, Node::MAX_OFFSET)
}

/// A part of the tree on its way into place.
#[derive(Debug)]
enum Subtree {
    Inner {
        axis: Axis,
        position: f32,
        children: Box<[Subtree; 2]>,
    },
    Fragment(Fragment),
}

/// A subtree built by one thread, with indices of its own: the root is node 0, references begin at 0.
#[derive(Debug)]
struct Fragment {
    nodes: Vec<Node>,
    references: Vec<u32>,
    depth: usize,
}

fn grow(cell: Cell, context: &Context<'_>, level: u32) -> Result<Subtree, BuildError> {
    if level < PARALLEL_LEVELS && cell.references.len() >= PARALLEL_REFERENCES {
        let mut scratch = Scratch::default();
        if let Some(split) = choose_split(&cell, context, &mut scratch) {
            let [left, right] = cell.divide(split, context, &mut scratch);
            drop(scratch);
            let (left, right) = join(
                || grow(left, context, level + 1),
                || grow(right, context, level + 1),
            );
            return Ok(Subtree::Inner {
                axis: split.axis,
                position: split.position,
                children: Box::new([left?, right?]),
            });
        }
    }
    grow_fragment(cell, context).map(Subtree::Fragment)
}

/// Builds a subtree in a loop.
fn grow_fragment(root: Cell, context: &Context<'_>) -> Result<Fragment, BuildError> {
    let mut scratch = Scratch::default();
    let mut fragment = Fragment {
        nodes: vec![Node::EMPTY_LEAF],
        references: Vec::new(),
        depth: 0,
    };
    let root_depth = root.depth;
    let mut open = vec![(root, 0)];
    while let Some((cell, node)) = open.pop() {
        fragment.depth = fragment.depth.max((cell.depth - root_depth) as usize + 1);
        if let Some(split) = choose_split(&cell, context, &mut scratch) {
            let first_child = fragment.nodes.len();
            check_size(first_child + 2)?;
            fragment.nodes.extend([Node::EMPTY_LEAF; 2]);
            fragment.nodes[node] = Node::inner(split.axis, split.position, first_child);
            let [left, right] = cell.divide(split, context, &mut scratch);
            open.push((right, first_child + 1));
            open.push((left, first_child));
        } else {
            let first = fragment.references.len();
            check_size(first + cell.references.len())?;
            fragment.nodes[node] = Node::leaf(first, cell.references.len());
            let triangles = cell.references.iter().map(|reference| reference.triangle);
            fragment.references.extend(triangles);
            scratch.recycle(cell);
        }
    }
    Ok(fragment)
}

fn check_size(size: usize) -> Result<(), BuildError> {
    if size > Node::MAX_OFFSET {
        return Err(BuildError::TooLarge);
    }
    Ok(())
}

fn choose_split(cell: &Cell, context: &Context<'_>, scratch: &mut Scratch) -> Option<Split> {
    if cell.references.len() <= context.options.max_leaf_size || cell.depth >= context.max_depth {
        return None;
    }
    match context.options.split_policy {
        SplitPolicy::SpatialMiddle(choice) => midpoints::middle_split(cell, choice),
        SplitPolicy::ObjectMedian(choice) => {
            midpoints::median_split(cell, choice, &mut scratch.centers)
        }
        SplitPolicy::SurfaceArea => surface_area::cheapest_split(cell, context).or_else(|| {
            (cell.references.len() > LARGE_LEAF)
                .then(|| midpoints::middle_split(cell, AxisChoice::Longest))
                .flatten()
        }),
    }
}

impl BuiltTree {
    /// Writes a subtree whose root is node `index`, on the given level; recursion is limited by
    /// [`PARALLEL_LEVELS`].
    fn place(&mut self, subtree: Subtree, index: usize, level: usize) -> Result<(), BuildError> {
        match subtree {
            Subtree::Inner {
                axis,
                position,
                children,
            } => {
                let first_child = self.nodes.len();
                check_size(first_child + 2)?;
                self.nodes.extend([Node::EMPTY_LEAF; 2]);
                self.nodes[index] = Node::inner(axis, position, first_child);
                let [left, right] = *children;
                self.place(left, first_child, level + 1)?;
                self.place(right, first_child + 1, level + 1)
            }
            Subtree::Fragment(fragment) => {
                check_size(self.nodes.len() + fragment.nodes.len())?;
                check_size(self.references.len() + fragment.references.len())?;
                self.depth = self.depth.max(level - 1 + fragment.depth);
                // The fragment's root goes to `index`, its node 1 to the end.
                let node_offset = self.nodes.len() - 1;
                let mut nodes = fragment
                    .nodes
                    .into_iter()
                    .map(|node| node.moved(node_offset, self.references.len()));
                self.nodes[index] = nodes.next().unwrap_or(Node::EMPTY_LEAF);
                self.nodes.extend(nodes);
                self.references.extend(fragment.references);
                Ok(())
            }
        }
    }
}
