//! Where to cut a list of references in two, and the cut itself.

use std::cmp::Ordering;

use tahko_geometry::simd::{AvailableSimd, Simd, WithSimd};

use super::binned::BinMap;
use super::outsized;
use super::paired::PairedBounds;
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
    /// Those of more than some area, in scaled units, go to the first side.
    Size {
        limit: f32,
        /// Of either side.
        extents: [Extent; 2],
    },
}

/// A list of references cut in two, both parts with at least one reference.
pub(super) struct Parts {
    pub(super) middle: usize,
    pub(super) first: Extent,
    pub(super) second: Extent,
}

impl Cut {
    pub(super) fn apply(
        self,
        references: &mut [Reference],
        scale: CentroidScale,
        simd: AvailableSimd,
    ) -> Parts {
        match self {
            Self::Bin {
                map,
                axis,
                bin,
                bounds,
            } => {
                let (middle, centroids) = simd.dispatch(Partition {
                    references,
                    scale,
                    map,
                    axis,
                    bin,
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
            Self::Size {
                limit,
                extents: [first, second],
            } => Parts {
                middle: outsized::apply(references, limit, scale),
                first,
                second,
            },
        }
    }
}

/// Moves the references in the bins before one to the front; their number, and the boxes around the centroids of either side.
struct Partition<'a> {
    references: &'a mut [Reference],
    scale: CentroidScale,
    map: BinMap,
    axis: usize,
    bin: usize,
}

/// The larger of a point of a [`PairedBounds`] and a gate is the point, or what no box is changed by. For a point of the first side the gates of the two boxes are
/// in the first two places, for one of the second in the last two.
const GATES: [f32; 3] = [f32::NEG_INFINITY, f32::INFINITY, f32::NEG_INFINITY];

impl WithSimd for Partition<'_> {
    type Output = (usize, [Bounds; 2]);

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self {
            references,
            scale,
            map,
            axis,
            bin,
        } = self;
        let bin = bin as f32;
        let mut centroids = [simd.splat(f32::INFINITY); 2];
        let mut middle = 0;
        // Nothing here depends on the side by a branch, which would be mispredicted every other time.
        for index in 0..references.len() {
            // Stored as it was loaded, as one vector: it may soon be loaded again.
            let lanes = simd.load(references[index].lanes());
            let centroid = scale.centroid_of(simd, lanes);
            let is_first = map.is_before(centroid, axis, bin);
            // Both boxes stay in registers: where a side is chosen by an index, what has just been written must be waited for.
            let point = Bounds::between(centroid, centroid).paired(simd);
            let side = usize::from(!is_first);
            let [first, second] = [GATES[side], GATES[side + 1]];
            centroids[0] = simd.min(centroids[0], simd.max(point, simd.splat(first)));
            centroids[1] = simd.min(centroids[1], simd.max(point, simd.splat(second)));
            let moved = simd.load(references[middle].lanes());
            references[index] = Reference::of_lanes(simd.store(moved));
            references[middle] = Reference::of_lanes(simd.store(lanes));
            middle += usize::from(is_first);
        }
        let [first, second] = [
            PairedBounds::of(simd, centroids[0]),
            PairedBounds::of(simd, centroids[1]),
        ];
        (middle, [first.to_bounds(), second.to_bounds()])
    }
}

/// The most references that [`of_few`] cuts.
pub(super) const FEW: usize = 3;

/// The cheapest of all ways to cut two or three references in two.
pub(super) fn of_few(references: &mut [Reference], scale: CentroidScale) -> Cut {
    let last = references.len() - 1;
    if references.len() == FEW {
        let boxes = [0, 1, 2].map(|place| references[place].bounds());
        let cost = |single: usize| {
            let [a, b] = [(single + 1) % FEW, (single + 2) % FEW];
            let pair = boxes[a].union(boxes[b]);
            2.0 * scale.half_area(&pair) + scale.half_area(&boxes[single])
        };
        let [first, second, third] = [cost(0), cost(1), cost(2)];
        let single = if third <= first && third <= second {
            2
        } else {
            usize::from(second < first)
        };
        references.swap(single, last);
    }
    Cut::At(last)
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

#[cfg(test)]
mod tests {
    use tahko_geometry::Aabb;
    use tahko_geometry::glam::Vec3;

    use super::*;

    #[test]
    fn few_references_are_cut_at_the_least_cost() {
        let size = |index: u32| 1.0 + (index * 7 % 5) as f32;
        let reference = |number: usize, index: u32| {
            let corner = Vec3::new((index * 5 % 11) as f32, (index * 3 % 7) as f32, 0.0);
            Reference::of_box(&Aabb::new(corner, corner + size(index)), number)
        };
        let all = Aabb::new(Vec3::ZERO, Vec3::splat(20.0));
        let scale = CentroidScale::new(&all);
        let area = |references: &[Reference]| {
            let bounds = Bounds::of(references);
            references.len() as f64 * bounds.half_area()
        };
        for index in 0..100u32 {
            for count in [2, FEW] {
                let references = (0..count).map(|number| {
                    let index = index + 13 * u32::try_from(number).expect("few");
                    reference(number, index)
                });
                let references: Vec<Reference> = references.collect();
                let least = (0..count)
                    .map(|single| {
                        let mut others = references.clone();
                        let single = others.remove(single);
                        area(&others) + area(&[single])
                    })
                    .fold(f64::INFINITY, f64::min);
                let mut cut = references.clone();
                let parts = of_few(&mut cut, scale).apply(&mut cut, scale, AvailableSimd::best());
                let (first, second) = cut.split_at(parts.middle);
                let found = area(first) + area(second);
                assert!((found - least).abs() <= 1e-5 * least, "{found}, {least}");
                let mut numbers: Vec<u32> = cut.iter().map(Reference::number).collect();
                numbers.sort_unstable();
                assert!((0u32..).take(count).eq(numbers), "each once");
            }
        }
    }
}
