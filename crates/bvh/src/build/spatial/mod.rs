//! The build with spatial splits: a triangle may be listed by several leaves, each with the box of a part of it.
//!
//! Top down as the build without: at each node the cheapest object split is found, and where its children overlap, the cheapest plane
//! as well. A reference across the plane is cut in two, or goes to one side whole where that is cheaper.
//!
//! **No hit falls between boxes.** A reference with triangle `T` and box `B` stands for the part `T ∩ B`, a closed set.
//! Claim: in the finished tree every point of a triangle lies in the box of some leaf that lists the triangle, and in the boxes of all nodes above that leaf.
//! - At first there is one reference per triangle, with the triangle's exact box: its part is the triangle. Or there are the pieces that [`presplit`] has cut it in, each time in two at
//!   a plane as below.
//! - An object split moves references. A spatial split at `x = p` replaces a reference by one or two, whose parts together contain `T ∩ B`: every point
//!   of that has `x <= p` or `x >= p`, and [`clip::halves`] gives boxes that contain `T ∩ B ∩ {x <= p}` and `T ∩ B ∩ {x >= p}`. If one of these boxes is empty,
//!   the other contains all of `T ∩ B`. A reference that goes to one side keeps its box.
//! - So at any time the parts of a triangle's references together are the triangle. The box of a node is that of its references' boxes, of which each
//!   descendant's are parts: boxes of cut references lie inside the box that was cut.
//! - A leaf that has got two parts of a triangle lists it once: the leaf's box contains both.
//!
//! The box of the root is exactly that of all triangles, since all their vertices are points of them and no box grows. The margins of a
//! [`ConservativeRay`](tahko_geometry::ConservativeRay) rely on that. A kernel accepts a triangle because of a point of it that is within its reach of the
//! ray; the box chain of that point passes the ray's test, and the triangle is tested: the answers are those of brute force.
//!
//! **Memory and determinism.** A subtree has a part of the list of references with room for more than it has now, and all its spatial splits have to do
//! with that room. What is left of it after a split is shared between the children in the ratio of their references. So no task waits for
//! another, and neither the number of threads nor their timing can show in the tree.
//!
//! Source: Stich, Friedrich, Dietrich, *Spatial splits in bounding volume hierarchies*, 2009. Differs in where planes are tried (see [`Policy`]), in the budget, and in boxes that are conservative to the last bit.

mod bins;
mod clip;
mod cut;
mod pieces;
pub(super) mod presplit;

use tahko_geometry::{Axis, TriangleMesh};

use self::cut::SpatialParts;
use super::node::{BuildNode, Link};
use super::reference::{Extent, Reference};
use super::split;
use super::top_down::{BLOCK_SIZE, Builder};
use super::{MAX_DEPTH, TriangleNumber};
use crate::control::Work;
use crate::parallel::{collect, join_if};
use crate::{BuildError, BvhOptions};

/// Where planes are tried. On interiors the measured values give trees as cheap as lower ones do, on scans up to 0.4 % dearer, in
/// half of the build time.
#[derive(Clone, Copy, Debug)]
struct Policy {
    /// Where the children of the best object split overlap by more than this part of the root's area; 1e-5 in the paper.
    overlap: f64,
    /// Where they overlap by more than this part of the node's own area.
    node_overlap: f64,
    /// In nodes of at least this many references.
    size: usize,
}

impl Policy {
    const MEASURED: Self = Self {
        overlap: 1e-4,
        node_overlap: 0.2,
        size: 64,
    };
}

/// The most references in a leaf: layouts and reinsertion want fine trees, and join what is too fine.
const LEAF_SIZE: usize = 2;

/// The nodes of a tree over the references to all triangles of a mesh, at least one, or to their pieces, and the triangles in the order of the leaves, each with
/// places between them that nothing links to. The options are in range.
///
/// Cost: O(n log n) time; about 100 bytes per reference, times the budget.
///
/// # Errors
/// If the build was cancelled.
pub(super) fn build(
    references: Vec<Reference>,
    mesh: &TriangleMesh,
    options: &BvhOptions,
    work: &Work<'_>,
) -> Result<(Vec<BuildNode>, Vec<TriangleNumber>), BuildError> {
    build_by(Policy::MEASURED, references, mesh, options, work)
}

fn build_by(
    policy: Policy,
    mut references: Vec<Reference>,
    mesh: &TriangleMesh,
    options: &BvhOptions,
    work: &Work<'_>,
) -> Result<(Vec<BuildNode>, Vec<TriangleNumber>), BuildError> {
    let count = references.len();
    let base = Builder::new(&references, options, MAX_DEPTH, work);
    let extent = base.extent(&references);
    let builder = SpatialBuilder {
        base,
        mesh,
        policy,
        root_overlap: policy.overlap * extent.bounds.half_area(),
        leaf_size: options.max_leaf_size.min(LEAF_SIZE),
    };
    let capacity = options.most_references(mesh.len(), count);
    // The room is filled with anything: it is not read before it is written.
    references.resize(capacity, references[0]);
    let mut nodes = collect(2 * capacity - 1, |_| BuildNode::UNUSED);
    builder.build(&mut references, count, &mut nodes, extent, Place::ROOT);
    work.control.check()?;
    // With the room between the leaves: to leave it out would take as long as it takes those who read the tree.
    let number = |index: usize| TriangleNumber(references[index].number());
    Ok((nodes, collect(references.len(), number)))
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

struct SpatialBuilder<'a> {
    /// Finds object splits, and keeps the depth within its limit.
    base: Builder<'a>,
    mesh: &'a TriangleMesh,
    policy: Policy,
    /// The half area of the overlap that the policy asks for, in parts of the root's.
    root_overlap: f64,
    leaf_size: usize,
}

impl SpatialBuilder<'_> {
    /// Builds a subtree over the first `count` references of a buffer, whose other places are room for more, into the block of nodes that goes with the buffer;
    /// something else, at once, if the build was cancelled. The recursion is at most [`MAX_DEPTH`] deep.
    fn build(
        &self,
        buffer: &mut [Reference],
        count: usize,
        nodes: &mut [BuildNode],
        extent: Extent,
        place: Place,
    ) {
        if self.base.work.is_cancelled() {
            return;
        }
        let bounds = extent.bounds.to_aabb();
        let Some(parts) = self.split(buffer, count, &extent, place.depth) else {
            let count = without_repetition(&mut buffer[..count]);
            let first = place.first_reference;
            nodes[0] = BuildNode::new(&bounds, Link::Leaf { first, count });
            return;
        };
        let counts = [parts.middle, parts.total - parts.middle];
        let second_start = share_room(buffer, &parts);
        let first_place = Place {
            first_reference: place.first_reference,
            first_node: place.first_node + 1,
            depth: place.depth + 1,
        };
        let second_place = Place {
            first_reference: place.first_reference + second_start,
            first_node: place.first_node + 2 * second_start,
            depth: place.depth + 1,
        };
        let link = Link::Inner([first_place.first_node, second_place.first_node]);
        nodes[0] = BuildNode::new(&bounds, link);
        let (first_nodes, second_nodes) = nodes[1..].split_at_mut(2 * second_start - 1);
        let (first, second) = buffer.split_at_mut(second_start);
        join_if(
            count >= BLOCK_SIZE,
            || self.build(first, counts[0], first_nodes, parts.first, first_place),
            || self.build(second, counts[1], second_nodes, parts.second, second_place),
        );
        if count >= BLOCK_SIZE {
            let done = counts.into_iter().filter(|count| *count < BLOCK_SIZE);
            self.base.work.done(done.sum());
        }
    }

    /// Cuts the first `count` references of a buffer in two lists that stand one behind the other, or makes them a leaf.
    fn split(
        &self,
        buffer: &mut [Reference],
        count: usize,
        extent: &Extent,
        depth: usize,
    ) -> Option<SpatialParts> {
        let may_be_leaf = count <= self.leaf_size;
        let references = &mut buffer[..count];
        let candidate = match self.base.candidate(references, extent, depth) {
            Some(candidate) if may_be_leaf && !self.base.pays(&candidate, count, extent) => {
                return None;
            }
            Some(candidate) => candidate,
            None if may_be_leaf => return None,
            // No split is cheap, or there is no depth left for an unbalanced one.
            None => return Some(self.halves(references, extent)),
        };
        let cost = candidate.cost;
        let parts = candidate
            .cut
            .apply(references, self.base.scale, self.base.simd);
        let parts = SpatialParts::of_object_split(&parts, count);
        if !self.may_need_plane(&parts, buffer.len(), extent) {
            return Some(parts);
        }
        let room = buffer.len() - count;
        let simd = self.base.simd;
        let plane = bins::best(&buffer[..count], &extent.bounds, self.mesh, room, simd);
        let Some(plane) = plane.filter(|plane| plane.cost < cost) else {
            return Some(parts);
        };
        let parts = cut::apply(buffer, count, &plane, self.mesh, self.base.scale);
        if parts.middle == 0 || parts.middle == parts.total {
            // Seen exactly, all references are on one side. Nothing was cut in two, but boxes may have shrunk.
            let references = &mut buffer[..count];
            let extent = self.base.extent(references);
            return Some(self.halves(references, &extent));
        }
        Some(parts)
    }

    /// Whether a plane may be cheaper than an object split that was found.
    fn may_need_plane(&self, parts: &SpatialParts, capacity: usize, extent: &Extent) -> bool {
        if parts.total < self.policy.size || parts.total == capacity {
            return false;
        }
        let overlap = parts.first.bounds.intersection(parts.second.bounds);
        let least = (self.policy.node_overlap * extent.bounds.half_area()).max(self.root_overlap);
        !overlap.is_empty() && overlap.half_area() > least
    }

    /// Halves the number of references.
    fn halves(&self, references: &mut [Reference], extent: &Extent) -> SpatialParts {
        let axis = Axis::dominant(extent.centroids.extent());
        let cut = split::median(references, axis as usize, self.base.scale);
        let parts = cut.apply(references, self.base.scale, self.base.simd);
        SpatialParts::of_object_split(&parts, references.len())
    }
}

/// Shares the room behind two lists of references between them: moves the second one up, which may change its order, and returns its
/// new start.
fn share_room(buffer: &mut [Reference], parts: &SpatialParts) -> usize {
    let SpatialParts { middle, total, .. } = *parts;
    let room = buffer.len() - total;
    #[expect(clippy::cast_possible_truncation, reason = "at most the room")]
    let first_room = (room as u64 * middle as u64 / total as u64) as usize;
    let second_start = middle + first_room;
    if second_start < total {
        buffer.copy_within(middle..second_start, total);
    } else {
        buffer.copy_within(middle..total, second_start);
    }
    second_start
}

/// Moves the first reference to each triangle to the front and returns how many they are.
fn without_repetition(references: &mut [Reference]) -> usize {
    let mut kept = 0;
    for index in 0..references.len() {
        let number = references[index].number();
        let is_new = |other: &Reference| other.number() != number;
        if references[..kept].iter().all(is_new) {
            references.swap(kept, index);
            kept += 1;
        }
    }
    kept
}

#[cfg(test)]
mod tests;
