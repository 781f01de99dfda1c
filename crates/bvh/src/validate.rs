//! Checks that a tree is well formed.

mod error;

use tahko_geometry::Aabb;
use tahko_geometry::simd::LANES;

use crate::Bvh;
use crate::build::MAX_DEPTH;
use crate::wide::{Child, Kind, WideBvh};

pub use self::error::{Content, ValidationError};

impl Bvh {
    /// Checks that the tree is well formed: every node and every block of triangles reached once, boxes that enclose what is below them,
    /// every triangle listed and covered by the boxes of the leaves that list it, a depth and a stack that traversal can manage.
    /// Trees from [`build`](Self::build) are.
    ///
    /// A triangle may be listed in several leaves, whose boxes then need not hold all of it: each of its corners has to be in at least one of them.
    ///
    /// Cost: O(n).
    ///
    /// # Errors
    /// The first fault found, with the node or leaf that has it.
    pub fn validate(&self) -> Result<(), ValidationError> {
        Validation::new(self.layout()).run()
    }
}

struct Validation<'a> {
    layout: &'a WideBvh,
    node_reached: Vec<bool>,
    block_reached: Vec<bool>,
    listings: Vec<Listing>,
    /// The greatest depth found.
    depth: usize,
}

/// What is known of a triangle.
#[derive(Clone, Copy)]
struct Listing {
    /// The last leaf that lists it; 0, which is none, before the first one.
    leaf: usize,
    /// Its first place: the block and the lane.
    place: (usize, usize),
    /// A bit for each of its corners that is in the box of a leaf that lists it.
    corners: u8,
}

/// A child that is still to be looked at.
struct Pending {
    child: Child,
    bounds: Aabb,
    /// Nodes on the way from the root, this one included.
    depth: usize,
}

const ALL_CORNERS: u8 = 0b111;

impl<'a> Validation<'a> {
    fn new(layout: &'a WideBvh) -> Self {
        let unlisted = Listing {
            leaf: 0,
            place: (0, 0),
            corners: 0,
        };
        Self {
            layout,
            node_reached: vec![false; layout.nodes.len()],
            block_reached: vec![false; layout.blocks.len()],
            listings: vec![unlisted; layout.triangle_count],
            depth: 0,
        }
    }

    fn run(mut self) -> Result<(), ValidationError> {
        self.check_first_block()?;
        let root = Pending {
            child: self.layout.root,
            bounds: self.layout.outer_bounds(),
            depth: 1,
        };
        let mut pending = Vec::new();
        if root.child != Child::NOTHING {
            pending.push(root);
        } else if self.layout.nodes.len() > 0 || self.layout.blocks.len() > 1 {
            return Err(ValidationError::NoRoot);
        }
        while let Some(next) = pending.pop() {
            self.depth = self.depth.max(next.depth);
            match next.child.kind() {
                Kind::Inner(index) => self.check_node(index, &next, &mut pending)?,
                // Boxes that are rounded outward may leave the bounds; triangles must not.
                Kind::Leaf(first) => {
                    self.check_leaf(first, &next.bounds.intersection(self.layout.bounds))?;
                }
            }
        }
        self.check_totals()
    }

    /// Block 0 stands for unused lanes.
    fn check_first_block(&mut self) -> Result<(), ValidationError> {
        let first = self.layout.blocks.first();
        if !first.is_some_and(|block| block.used() == 0 && !block.continues()) {
            return Err(ValidationError::FirstBlockInUse);
        }
        self.block_reached[0] = true;
        Ok(())
    }

    fn check_node(
        &mut self,
        index: usize,
        place: &Pending,
        pending: &mut Vec<Pending>,
    ) -> Result<(), ValidationError> {
        let content = Content::Node(index);
        let count = self.layout.nodes.len();
        if index >= count {
            return Err(ValidationError::OutOfRange { content, count });
        }
        let node = self.layout.nodes.at(index);
        if std::mem::replace(&mut self.node_reached[index], true) {
            return Err(ValidationError::ReachedTwice { content });
        }
        for (bounds, child) in node.children() {
            if bounds.is_empty() || !place.bounds.contains_box(&bounds) {
                let content = match child.kind() {
                    Kind::Inner(index) => Content::Node(index),
                    Kind::Leaf(first) => Content::Leaf(first),
                };
                return Err(ValidationError::NotEnclosed {
                    node: index,
                    content,
                });
            }
            pending.push(Pending {
                child,
                bounds,
                depth: place.depth + 1,
            });
        }
        Ok(())
    }

    fn check_leaf(&mut self, first: usize, bounds: &Aabb) -> Result<(), ValidationError> {
        let mut index = first;
        loop {
            let content = Content::Leaf(index);
            let count = self.layout.blocks.len();
            let Some(block) = self.layout.blocks.get(index) else {
                return Err(ValidationError::OutOfRange { content, count });
            };
            if std::mem::replace(&mut self.block_reached[index], true) {
                return Err(ValidationError::ReachedTwice { content });
            }
            if block.used() == 0 {
                return Err(ValidationError::EmptyBlock { block: index });
            }
            for lane in (0..LANES).filter(|lane| block.number(*lane).is_some()) {
                self.check_triangle(first, (index, lane), bounds)?;
            }
            if !block.continues() {
                return Ok(());
            }
            index += 1;
        }
    }

    fn check_triangle(
        &mut self,
        leaf: usize,
        place: (usize, usize),
        bounds: &Aabb,
    ) -> Result<(), ValidationError> {
        let at = |(block, lane): (usize, usize)| {
            let block = &self.layout.blocks[block];
            (block.number(lane), block.triangle(lane))
        };
        let (number, found) = at(place);
        let triangle = number.map_or(usize::MAX, |number| number as usize);
        let count = self.listings.len();
        let Some(listing) = self.listings.get_mut(triangle) else {
            return Err(ValidationError::NoSuchTriangle {
                leaf,
                triangle,
                count,
            });
        };
        if listing.leaf == leaf {
            return Err(ValidationError::ListedTwice { leaf, triangle });
        }
        if listing.leaf == 0 {
            listing.place = place;
        } else if at(listing.place).1 != found {
            return Err(ValidationError::Differs { leaf, triangle });
        }
        listing.leaf = leaf;
        if bounds.intersection(found.aabb()).is_empty() {
            return Err(ValidationError::NotMet { leaf, triangle });
        }
        for (corner, vertex) in found.vertices().into_iter().enumerate() {
            listing.corners |= u8::from(bounds.contains(vertex)) << corner;
        }
        Ok(())
    }

    fn check_totals(&self) -> Result<(), ValidationError> {
        let first_missed = |reached: &[bool]| reached.iter().position(|reached| !reached);
        let missed = first_missed(&self.node_reached).map(Content::Node);
        let missed = missed.or_else(|| first_missed(&self.block_reached).map(Content::Leaf));
        if let Some(content) = missed {
            return Err(ValidationError::NotReached { content });
        }
        for (triangle, listing) in self.listings.iter().enumerate() {
            if listing.leaf == 0 {
                return Err(ValidationError::NotListed { triangle });
            }
            // Boxes are convex, and those of ancestors enclose those of leaves: a triangle that is listed once lies wholly in its leaf's box.
            if listing.corners != ALL_CORNERS {
                let corner = listing.corners.trailing_ones() as usize;
                return Err(ValidationError::NotCovered { triangle, corner });
            }
        }
        let (found, stated) = (self.depth, self.layout.depth);
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

#[cfg(test)]
mod tests;
