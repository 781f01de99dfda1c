//! How much the boxes of a tree overlap, where rays end.

use std::ops::Range;

use tahko_geometry::glam::{DVec3, Vec3};
use tahko_geometry::simd::LANES;
use tahko_geometry::{Aabb, ClippedTriangle};

use crate::Bvh;
use crate::parallel;
use crate::wide::{Child, Kind, WideBvh};

impl Bvh {
    /// The end-point overlap: what a ray is expected to cost because its end lies in boxes of other triangles, in triangle tests.
    ///
    /// The surface area heuristic measures a line that passes everything. A ray ends on a surface, and has to visit every node whose
    /// box contains that point, even those whose triangles are elsewhere. For an end on a random point of all
    /// triangles this is the sum over all nodes of the node's cost times the area, in the node's box, of the triangles that are not
    /// below the node, divided by the area of all triangles. Costs are those of
    /// [`sah_cost`](tahko_geometry::TreeStatistics::sah_cost): `traversal_cost / intersection_cost` for an inner node with its up to eight
    /// children, the number of triangles for a leaf. A triangle that several leaves list is below the ancestors of all of them.
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
    /// Cost: each triangle visits the nodes whose boxes contain a part of it; where all triangles lie in each other's boxes that grows with the
    /// square of their number. It runs on the threads of the current rayon pool, with the same result for every number of them.
    ///
    /// Source: Aila, Karras, Laine, *On quality metrics of bounding volume hierarchies*, 2013, section 4. There it explains, together with
    /// the surface area heuristic, the speed of rays better than either does alone.
    #[must_use]
    pub fn end_point_overlap(&self) -> f64 {
        end_point_overlap(self.layout(), self.inner_node_cost())
    }
}

fn end_point_overlap(layout: &WideBvh, inner_node_cost: f64) -> f64 {
    let overlap = Overlap::new(layout, inner_node_cost);
    // In the order of the leaves: neighbours visit the same nodes.
    let places = || 0..LANES * layout.blocks.len();
    let total = parallel::sum(places(), CHUNK, &|place| overlap.area(place));
    if total > 0.0 {
        parallel::sum(places(), CHUNK, &|place| overlap.of(place)) / total
    } else {
        0.0
    }
}

/// Places of triangles that one task works on: some 100 microseconds if the triangles are small.
const CHUNK: usize = 64;

/// A place of a triangle is its block times eight plus its lane.
struct Overlap<'a> {
    layout: &'a WideBvh,
    listings: Listings,
    /// For each node, the blocks below it.
    blocks_below: Vec<Range<usize>>,
    /// For each block, the triangles in it and in those that continue it.
    counts: Vec<usize>,
    inner_node_cost: f64,
}

/// The places at which each triangle is listed.
struct Listings {
    /// For each triangle, where its places begin; then where the last ones end.
    starts: Vec<usize>,
    /// By triangle, ascending.
    places: Vec<usize>,
}

/// The part of a triangle in the box of a node.
struct Part {
    polygon: ClippedTriangle,
    min: DVec3,
    max: DVec3,
    area: f64,
}

impl<'a> Overlap<'a> {
    /// Cost: O(n).
    fn new(layout: &'a WideBvh, inner_node_cost: f64) -> Self {
        let mut counts = vec![0; layout.blocks.len()];
        for (index, block) in layout.blocks.iter().enumerate().rev() {
            let rest = if block.continues() {
                counts[index + 1]
            } else {
                0
            };
            counts[index] = block.used().count_ones() as usize + rest;
        }
        let mut overlap = Self {
            layout,
            listings: Listings::new(layout),
            blocks_below: vec![0..0; layout.nodes.len()],
            counts,
            inner_node_cost,
        };
        // Children stand behind their parents.
        for (index, node) in layout.nodes.iter().enumerate().rev() {
            let below = node.children().map(|(_, child)| overlap.below(child));
            let below = below.reduce(|a, b| a.start.min(b.start)..a.end.max(b.end));
            overlap.blocks_below[index] = below.unwrap_or(0..0);
        }
        overlap
    }

    /// The blocks below a child: those of a subtree stand together, as it is laid out depth first.
    fn below(&self, child: Child) -> Range<usize> {
        match child.kind() {
            Kind::Inner(node) => self.blocks_below[node].clone(),
            Kind::Leaf(first) => first..first + self.layout.leaf_blocks(first).len(),
        }
    }

    /// The places of the triangle that is listed at a place; nothing if there is none, or if it is listed before that.
    fn places(&self, place: usize) -> &[usize] {
        let number = self.layout.blocks[place / LANES].number(place % LANES);
        let places = number.map_or(&[][..], |number| self.listings.of(number));
        if places.first() == Some(&place) {
            places
        } else {
            &[]
        }
    }

    /// The area of the triangle that is listed at a place for the first time.
    fn area(&self, place: usize) -> f64 {
        match self.places(place) {
            [] => 0.0,
            [first, ..] => self.layout.blocks[first / LANES]
                .triangle(first % LANES)
                .area(),
        }
    }

    /// The sum of cost times area for the triangle that is listed at a place for the first time.
    fn of(&self, place: usize) -> f64 {
        match self.places(place) {
            [] => 0.0,
            places => {
                let triangle = self.layout.blocks[place / LANES].triangle(place % LANES);
                let whole = Part::new(ClippedTriangle::new(&triangle));
                self.around(self.layout.root, places, &whole)
            }
        }
    }

    /// The sum over the nodes of a subtree that contains a triangle at some places. No deeper than the tree.
    fn around(&self, child: Child, places: &[usize], whole: &Part) -> f64 {
        let Kind::Inner(node) = child.kind() else {
            return 0.0;
        };
        let node = self.layout.nodes.at(node);
        let sums = node.children().map(|(bounds, child)| {
            let below = self.below(child);
            let start = places.partition_point(|place| place / LANES < below.start);
            let end = places.partition_point(|place| place / LANES < below.end);
            if start < end {
                self.around(child, &places[start..end], whole)
            } else {
                self.inside(child, &bounds, whole)
            }
        });
        sums.sum()
    }

    /// The sum over the nodes of a subtree that does not contain the triangle, given its part in the parent's box. No deeper than the tree.
    fn inside(&self, child: Child, bounds: &Aabb, parent_part: &Part) -> f64 {
        let clipped;
        let part = match parent_part.relation(bounds) {
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
        match child.kind() {
            Kind::Leaf(first) => part.area * self.counts[first] as f64,
            Kind::Inner(node) => {
                let node = self.layout.nodes.at(node);
                let below = node
                    .children()
                    .map(|(bounds, child)| self.inside(child, &bounds, part));
                part.area * self.inner_node_cost + below.sum::<f64>()
            }
        }
    }
}

impl Listings {
    fn new(layout: &WideBvh) -> Self {
        let lanes = || {
            let places = 0..LANES * layout.blocks.len();
            places.filter_map(|place| {
                let number = layout.blocks[place / LANES].number(place % LANES)?;
                Some((place, number as usize))
            })
        };
        let mut starts = vec![0; layout.triangle_count + 1];
        for (_, number) in lanes() {
            starts[number + 1] += 1;
        }
        for number in 0..layout.triangle_count {
            starts[number + 1] += starts[number];
        }
        let mut next = starts.clone();
        let mut places = vec![0; starts[layout.triangle_count]];
        for (place, number) in lanes() {
            places[next[number]] = place;
            next[number] += 1;
        }
        Self { starts, places }
    }

    fn of(&self, number: u32) -> &[usize] {
        let number = number as usize;
        &self.places[self.starts[number]..self.starts[number + 1]]
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
