//! The build: the thesis' algorithm 2, with a list of tasks in place of recursion.
//!
//! At each node a splitting plane is chosen and all polygons are classified against it. Those in front and behind go
//! to their side; straddlers are cut or go to both sides. Coplanar polygons, whichever way they face, go to a third
//! child, which a ray visits where it crosses the plane; there, planes through their edges and the like split them
//! further, since a floor of a thousand triangles is too much to test as one list. A node becomes a leaf when
//! it is small enough, when no plane is worth it, or at one of two limits: the depth, and its share of the budget of references.
//!
//! **No triangle is lost.** Cutting decides only which lists name a triangle; hits are tested on the original. So it
//! is enough that every point of a triangle is near a listed part of it, and every part near the side that it was
//! put on. Let `u = 2^-53` and `S` the largest coordinate of the mesh; lengths of plane offsets are then at most
//! `sqrt(3) S` up to rounding, and a computed distance from a plane is off by at most `28 u S`.
//! - A cut vertex is computed from the edge's ends: its place on the edge rounds by at most `9 u S`, so after `k` cuts a
//!   point of the triangle is within `9 k u S`, in each direction, of a part that was kept.
//! - It is off the plane by those, the errors of both distances and that of their quotient: below `47 u S`.
//! - A vertex counts as coplanar up to [`Plane::rounding_error`], at most `56 u S`, plus the error of its distance: below
//!   `84 u S`. The same bound holds for polygons that count as coplanar.
//!
//! So whatever is listed below a side of a plane reaches beyond it by at most `(84 + 16 k) u S`.
//! [`crossing`](crate::crossing) makes room for that.

mod choose;
mod outlines;
mod random;
mod subtree;
mod task;

use tahko_geometry::{Plane, Polygon, TriangleMesh};

use self::choose::Chooser;
use self::random::Seed;
use self::subtree::Place;
use self::task::{Parts, Task};
use crate::cell::Cell;
use crate::node::{BACK, FRONT, IN_PLANE};
use crate::piece::Piece;
use crate::tree::largest_coordinates;
use crate::{BspOptions, Splitter, parallel};

pub(crate) use self::subtree::Subtree;

/// The most references in a tree: indices of them must fit 32 bits.
const MAX_REFERENCES: usize = (1 << 31) - 1;

/// Nodes with fewer polygons than this are not worth a thread of their own.
const PARALLEL_SIZE: usize = 512;

/// Levels on which children may be built at the same time: this bounds the recursion.
const PARALLEL_LEVELS: usize = 16;

/// Builds the tree of a mesh. References are the triangles' numbers. Triangles without area are not listed: no kernel
/// accepts them. The options are in range.
pub(crate) fn build(mesh: &TriangleMesh, options: &BspOptions) -> Subtree {
    let polygons: Vec<Polygon> = (0u32..)
        .zip(mesh.triangles())
        .filter_map(|(number, triangle)| Polygon::from_triangle(&triangle, number))
        .collect();
    let planes: Vec<Option<Plane>> = mesh
        .triangles()
        .map(|triangle| Plane::from_triangle(&triangle))
        .collect();
    let bounds = mesh.aabb();
    let needs_cells = options.splitter == Splitter::SurfaceArea;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "at least 1 times the number, and cut to the limit below"
    )]
    let budget = (options.max_growth * polygons.len() as f64) as usize;
    let root = Task {
        pieces: polygons.iter().map(Piece::whole).collect(),
        cell: needs_cells.then(|| Cell::from_aabb(&bounds)),
        is_flat: false,
        depth: 0,
        seed: Seed::new(options.seed),
        budget: budget.clamp(polygons.len(), MAX_REFERENCES),
    };
    let builder = Builder {
        options,
        chooser: Chooser {
            options,
            planes: &planes,
            largest_coordinates: largest_coordinates(&bounds),
        },
    };
    builder.build(root, PARALLEL_LEVELS)
}

struct Builder<'a> {
    options: &'a BspOptions,
    chooser: Chooser<'a>,
}

impl Builder<'_> {
    /// Builds a subtree, both children of large nodes at the same time. The recursion is `levels` deep.
    fn build(&self, task: Task<'_>, levels: usize) -> Subtree {
        if levels == 0 || task.pieces.len() < PARALLEL_SIZE {
            return self.build_in_order(task);
        }
        let mut tree = Subtree::new();
        let Some((node, [front, back, in_plane])) = self.add(&mut tree, Place::Root, task) else {
            return tree;
        };
        let (front, (back, in_plane)) = parallel::join(
            || self.build(front, levels - 1),
            || {
                parallel::join(
                    || self.build(back, levels - 1),
                    || self.build(in_plane, levels - 1),
                )
            },
        );
        for (side, child) in [(FRONT, front), (BACK, back), (IN_PLANE, in_plane)] {
            tree.add_subtree(Place::Child { node, side }, child);
        }
        tree
    }

    fn build_in_order(&self, root: Task<'_>) -> Subtree {
        let mut tree = Subtree::new();
        let mut pending = vec![(root, Place::Root)];
        while let Some((task, place)) = pending.pop() {
            if let Some((node, children)) = self.add(&mut tree, place, task) {
                // The last one is taken first.
                for (side, child) in children.into_iter().enumerate().rev() {
                    pending.push((child, Place::Child { node, side }));
                }
            }
        }
        tree
    }

    /// Adds the node or leaf of a task. For a node, its index and the tasks of its children.
    fn add<'t>(
        &self,
        tree: &mut Subtree,
        place: Place,
        task: Task<'t>,
    ) -> Option<(usize, [Task<'t>; 3])> {
        let may_split =
            task.pieces.len() > self.options.max_leaf_size && task.depth < self.options.max_depth;
        let divider = if may_split {
            self.chooser.choose(&task)
        } else {
            None
        };
        let Some(divider) = divider else {
            tree.add_leaf(place, task.ids());
            return None;
        };
        let was_flat = task.is_flat;
        let Parts {
            children,
            straddlers,
        } = task.split(&divider, self.options.straddlers);
        tree.straddlers += straddlers;
        if !was_flat {
            tree.coplanar += children[IN_PLANE].pieces.len();
        }
        Some((tree.add_node(place, divider.plane), children))
    }
}
