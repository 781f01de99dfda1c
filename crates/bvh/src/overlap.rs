//! How much the boxes of a tree overlap, where rays end.

use tahko_geometry::glam::{DVec3, Vec3};
use tahko_geometry::{Aabb, ClippedTriangle};

use crate::Bvh;
use crate::layout::Bvh2;
use crate::node::{Node, Siblings};
use crate::parallel;

impl Bvh {
    /// The end-point overlap: what a ray is expected to cost because its end lies in boxes of other triangles, in triangle tests.
    ///
    /// The surface area heuristic measures a line that passes everything. A ray ends on a surface, and has to visit every node whose
    /// box contains that point, even those whose triangles are elsewhere. For an end on a random point of all
    /// triangles this is the sum over all nodes of the node's cost times the area, in the node's box, of the triangles that are not
    /// below the node, divided by the area of all triangles. Costs are those of
    /// [`sah_cost`](tahko_geometry::TreeStatistics::sah_cost): `traversal_cost / intersection_cost` for an inner node, the number of triangles for a leaf.
    ///
    /// Boxes are closed, as they are for rays: of a triangle in a face, the part in the face counts, and so it does in flat
    /// boxes. Triangles at the same place count each. The value is 0 where boxes contain no part of other
    /// triangles, and where no triangle has an area.
    ///
    /// Cells of a space partition have no such overlap. A kd-tree or BSP tree lists a triangle in every leaf whose cell contains a part
    /// of it, so the inside of a node's cell contains only triangles that are listed below the node. What lies in the face between two
    /// cells is in both closed cells, but may be listed on one side or in a child of its own: a face has to be counted with
    /// the cell that lists it, and then the sum is 0.
    ///
    /// Cost: each triangle visits the nodes whose boxes contain a part of it. Measured on one thread, that is two microseconds for the triangles of a scan
    /// or an interior, two to three times as long as the build; where all triangles lie in each other's boxes it grows with the square of their
    /// number (half a millisecond for each of 20 000 diagonal needles). It runs on the threads of the current rayon pool, with the same result for
    /// every number of them.
    ///
    /// Source: Aila, Karras, Laine, *On quality metrics of bounding volume hierarchies*, 2013, section 4. There it explains, together with
    /// the surface area heuristic, the speed of rays better than either does alone.
    #[must_use]
    pub fn end_point_overlap(&self) -> f64 {
        let layout = self.layout();
        let Some(root) = &layout.root else {
            return 0.0;
        };
        let overlap = Overlap {
            layout,
            first_triangles: first_triangles(&layout.siblings),
            inner_node_cost: self.inner_node_cost(),
        };
        let triangles = || 0..layout.triangles.len();
        let total = parallel::sum(triangles(), CHUNK, &|place| {
            layout.triangles[place].triangle.area()
        });
        if total > 0.0 {
            parallel::sum(triangles(), CHUNK, &|place| overlap.of(place, root)) / total
        } else {
            0.0
        }
    }
}

/// Triangles that one task works on: some 100 microseconds if they are small.
const CHUNK: usize = 64;

struct Overlap<'a> {
    layout: &'a Bvh2,
    /// For each pair of siblings, the place of the first triangle below them.
    first_triangles: Vec<usize>,
    inner_node_cost: f64,
}

/// The part of a triangle in the box of a node.
struct Part {
    polygon: ClippedTriangle,
    min: DVec3,
    max: DVec3,
    area: f64,
}

impl Overlap<'_> {
    /// The sum of cost times area for the triangle at a place: on the way down to its leaf, the other children do not contain it.
    fn of(&self, place: usize, root: &Node) -> f64 {
        let whole = Part::new(ClippedTriangle::new(&self.layout.triangles[place].triangle));
        let mut sum = 0.0;
        let mut node = root;
        while !node.is_leaf() {
            let Siblings([first, second]) = &self.layout.siblings[node.first()];
            let (own, other) = if place < self.first_triangle(second) {
                (first, second)
            } else {
                (second, first)
            };
            sum += self.below(other, &whole);
            node = own;
        }
        sum
    }

    /// The sum over the nodes of a subtree that does not contain the triangle, given its part in the parent's box. No deeper than the tree.
    fn below(&self, node: &Node, parent_part: &Part) -> f64 {
        let clipped;
        let part = match parent_part.relation(&node.bounds()) {
            Relation::Outside => return 0.0,
            Relation::Inside => parent_part,
            Relation::Crossing([min, max]) => {
                clipped = Part::new(parent_part.polygon.in_box(min, max));
                &clipped
            }
        };
        if part.area == 0.0 {
            return 0.0;
        }
        if node.is_leaf() {
            return part.area * node.count() as f64;
        }
        let Siblings([first, second]) = &self.layout.siblings[node.first()];
        part.area * self.inner_node_cost + self.below(first, part) + self.below(second, part)
    }

    /// The place of the first triangle below a node. Triangles stand in the order of the leaves.
    fn first_triangle(&self, node: &Node) -> usize {
        first_triangle(node, &self.first_triangles)
    }
}

/// The place of the first triangle below each pair of siblings. Children follow the pair that they are part of.
fn first_triangles(siblings: &[Siblings]) -> Vec<usize> {
    let mut places = vec![0; siblings.len()];
    for (index, Siblings([first, _])) in siblings.iter().enumerate().rev() {
        places[index] = first_triangle(first, &places);
    }
    places
}

fn first_triangle(node: &Node, places: &[usize]) -> usize {
    if node.is_leaf() {
        node.first()
    } else {
        places[node.first()]
    }
}

/// Where a part of a triangle is, as its box tells.
enum Relation {
    Outside,
    Inside,
    /// Neither for certain; with the corners of the box.
    Crossing([DVec3; 2]),
}

impl Part {
    fn new(polygon: ClippedTriangle) -> Self {
        let (min, max) = polygon.bounds();
        Self {
            area: polygon.area(),
            polygon,
            min,
            max,
        }
    }

    fn relation(&self, bounds: &Aabb) -> Relation {
        let [min, max] = [bounds.min, bounds.max].map(Vec3::as_dvec3);
        if self.min.cmpgt(max).any() || self.max.cmplt(min).any() {
            Relation::Outside
        } else if self.min.cmpge(min).all() && self.max.cmple(max).all() {
            Relation::Inside
        } else {
            Relation::Crossing([min, max])
        }
    }
}

#[cfg(test)]
mod tests;
