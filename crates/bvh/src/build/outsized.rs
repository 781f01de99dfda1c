//! Splits by size: the references that are large beside their node against all others.
//!
//! A few references as large as a node of thousands (the water under a terrain) lie across every cut between centroids. Each cut leaves them on one
//! side, which is then as large as before, so that a way through the whole tree is as large as they are. Set apart once, they are not met again.

use super::reference::{CentroidScale, Extent, Reference};
use super::split::{Candidate, Cut};
use crate::parallel::reduce;

/// Nodes with fewer references are split by their centroids only. Measured with 64 and 8 in place of this, the nodes and leaves that a line is expected to meet change by 0.1 % at most.
pub(super) const LEAST: usize = 1024;

/// References with more than this part of their node's area are large. Measured with the cheapest of all limits down to 1/256, the same number changes by -0.1 to +4 %.
const PART: f32 = 0.5;

/// The area above which a reference is large in a node, in scaled units.
pub(super) fn limit(node: &Extent, scale: CentroidScale) -> f32 {
    PART * scale.half_area(&node.bounds)
}

/// The split between references of more than some area, in scaled units, and all others; `None` if either are all. Cost: O(n).
pub(super) fn candidate(
    references: &[Reference],
    limit: f32,
    scale: CentroidScale,
) -> Option<Candidate> {
    let [large, others] = reduce(
        references,
        &|references: &[Reference]| {
            let mut sides = [(0, Extent::EMPTY); 2];
            for reference in references {
                let side = &mut sides[usize::from(!is_large(reference, limit, scale))];
                side.0 += 1;
                side.1.add(reference, scale);
            }
            sides
        },
        &|[a, b], [c, d]| [(a, c), (b, d)].map(|(a, b)| (a.0 + b.0, a.1.union(b.1))),
    );
    if large.0 == 0 || others.0 == 0 {
        return None;
    }
    let cost = |(count, extent): &(usize, Extent)| *count as f64 * extent.bounds.half_area();
    Some(Candidate {
        cost: cost(&large) + cost(&others),
        cut: Cut::Size {
            limit,
            extents: [large.1, others.1],
        },
    })
}

/// Moves the references above a limit of area to the front, and returns how many they are.
pub(super) fn apply(references: &mut [Reference], limit: f32, scale: CentroidScale) -> usize {
    let mut middle = 0;
    for index in 0..references.len() {
        if is_large(&references[index], limit, scale) {
            references.swap(index, middle);
            middle += 1;
        }
    }
    middle
}

#[inline]
fn is_large(reference: &Reference, limit: f32, scale: CentroidScale) -> bool {
    scale.half_area(&reference.bounds()) > limit
}

#[cfg(test)]
mod tests;
