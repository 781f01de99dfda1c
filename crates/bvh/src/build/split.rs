//! Where to cut a list of references in two, and the cut itself.

use std::cmp::Ordering;

use super::binned::BinMap;
use super::reference::{Bounds, CentroidScale, Extent, Reference};

/// A way to split a node.
pub(super) struct Candidate {
    /// The sum over both sides of their half area times their number of references.
    pub(super) cost: f64,
    pub(super) cut: Cut,
}

pub(super) enum Cut {
    /// The references in the bins before `bin` go to the first side.
    Bin {
        map: BinMap,
        axis: usize,
        bin: usize,
        /// The boxes around either side.
        bounds: [Bounds; 2],
    },
    /// The references before an index go to the first side.
    At(usize),
}

/// A list of references cut in two, both parts with at least one reference.
pub(super) struct Parts {
    pub(super) middle: usize,
    pub(super) first: Extent,
    pub(super) second: Extent,
}

impl Cut {
    pub(super) fn apply(self, references: &mut [Reference], scale: CentroidScale) -> Parts {
        match self {
            Self::Bin {
                map,
                axis,
                bin,
                bounds,
            } => {
                let (middle, centroids) = partition(references, scale, |reference| {
                    map.bin(reference, axis) < bin
                });
                let [first, second] = [0, 1].map(|side| Extent {
                    bounds: bounds[side],
                    centroids: centroids[side],
                });
                Parts {
                    middle,
                    first,
                    second,
                }
            }
            Self::At(middle) => {
                let (first, second) = references.split_at(middle);
                Parts {
                    middle,
                    first: Extent::new(first, scale),
                    second: Extent::new(second, scale),
                }
            }
        }
    }
}

/// Moves the references that belong to the first side to the front; their number, and the boxes around the centroids
/// of either side.
fn partition(
    references: &mut [Reference],
    scale: CentroidScale,
    is_first: impl Fn(&Reference) -> bool,
) -> (usize, [Bounds; 2]) {
    // Two boxes per side, taken in turns: a box that has just been written must not be waited for.
    let mut centroids = [Bounds::EMPTY; 4];
    let mut middle = 0;
    // Nothing here depends on the side by a branch, which would be mispredicted every other time.
    for index in 0..references.len() {
        let is_first = is_first(&references[index]);
        let reference = references[index];
        let side = usize::from(!is_first) + index % 2 * 2;
        centroids[side].add_point(scale.centroid(&reference));
        references[index] = references[middle];
        references[middle] = reference;
        middle += usize::from(is_first);
    }
    let [first, second, others @ ..] = centroids;
    (middle, [first.union(others[0]), second.union(others[1])])
}

/// Cuts in the middle of the order along an axis: works on any references, whatever their centroids, and
/// halves their number. Cost: O(n).
pub(super) fn median(references: &mut [Reference], axis: usize, scale: CentroidScale) -> Cut {
    let middle = references.len() / 2;
    references.select_nth_unstable_by(middle, |a, b| compare(a, b, axis, scale));
    Cut::At(middle)
}

/// The order of the centroids along an axis, then of the triangles' numbers.
pub(super) fn compare(a: &Reference, b: &Reference, axis: usize, scale: CentroidScale) -> Ordering {
    let [at_a, at_b] = [a, b].map(|reference| scale.centroid(reference)[axis]);
    at_a.total_cmp(&at_b)
        .then_with(|| a.number().cmp(&b.number()))
}
