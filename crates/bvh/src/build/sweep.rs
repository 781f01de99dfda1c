//! Splits by the surface area heuristic between any two neighbours in the order of the centroids.
//!
//! In a build with sweeps most nodes are split here, so lists are sorted by keys that are compared as whole numbers, and short ones by counting: nothing
//! branches on an order, which nobody could predict.

use tahko_geometry::glam::{Vec4, Vec4Swizzles};

use super::reference::{Bounds, CentroidScale, Reference};
use super::split::{Candidate, Cut};

/// The best of all splits along the three axes; leaves the references in the order that the split cuts.
///
/// `None` for fewer than two references. Source: the sweep build in Wald, "On fast construction of
/// SAH-based bounding volume hierarchies", 2007.
pub(super) fn best(references: &mut [Reference], scale: CentroidScale) -> Option<Candidate> {
    match references.len() {
        ..=1 => None,
        2 => Some(only(references, scale)),
        3..=4 => best_of::<4>(references, scale),
        5..=8 => best_of::<8>(references, scale),
        9..=16 => best_of::<16>(references, scale),
        17..=64 => best_of::<64>(references, scale),
        _ => best_of::<256>(references, scale),
    }
}

/// The split of two references.
fn only(references: &[Reference], scale: CentroidScale) -> Candidate {
    let areas = references
        .iter()
        .map(|reference| half_area(&scaled(reference, scale)));
    Candidate {
        cost: f64::from(areas.sum::<f32>()) * scale.area_unit(),
        cut: Cut::At(1),
    }
}

fn best_of<const N: usize>(
    references: &mut [Reference],
    scale: CentroidScale,
) -> Option<Candidate> {
    let count = references.len();
    let mut boxes = [Bounds::EMPTY; N];
    let mut centroids = [Vec4::ZERO; N];
    for ((bounds, centroid), reference) in boxes.iter_mut().zip(&mut centroids).zip(&*references) {
        *bounds = scaled(reference, scale);
        *centroid = bounds.lower() + bounds.upper();
    }
    let (boxes, centroids) = (&boxes[..count], &centroids[..count]);
    let mut best: Option<(f32, usize)> = None;
    let mut best_order = [0; N];
    for axis in 0..3 {
        let order = order_of::<N>(centroids, axis);
        let split = cheapest::<N>(boxes, &order);
        if let Some((cost, middle)) = split
            && best.is_none_or(|(best_cost, _)| cost < best_cost)
        {
            best = Some((cost, middle));
            best_order = order;
        }
    }
    let (cost, middle) = best?;
    let mut before = [references[0]; N];
    before[..count].copy_from_slice(references);
    for (reference, index) in references.iter_mut().zip(best_order) {
        *reference = before[usize::from(index)];
    }
    Some(Candidate {
        cost: f64::from(cost) * scale.area_unit(),
        cut: Cut::At(middle),
    })
}

/// The box of a reference in units in which neither its area nor its centroid overflows.
#[inline]
fn scaled(reference: &Reference, scale: CentroidScale) -> Bounds {
    let (bounds, factor) = (reference.bounds(), scale.factor());
    Bounds::between(bounds.lower() * factor, bounds.upper() * factor)
}

/// Half of the surface area of a scaled box.
#[inline]
fn half_area(bounds: &Bounds) -> f32 {
    let extent = bounds.upper() - bounds.lower();
    let faces = extent * extent.yzxw();
    faces.x + faces.y + faces.z
}

/// The indices of points in their order along an axis, equal ones as they stand.
#[inline]
fn order_of<const N: usize>(points: &[Vec4], axis: usize) -> [u8; N] {
    const { assert!(N <= 256, "an index has a byte") };
    let mut keys = [0u64; N];
    for ((key, point), index) in keys.iter_mut().zip(points).zip(0..) {
        *key = u64::from(ordered(point[axis])) << 8 | index;
    }
    let keys = &mut keys[..points.len()];
    let mut order = [0; N];
    if N <= 8 {
        let mut ranks = [0u8; N];
        for second in 1..keys.len() {
            for first in 0..second {
                let is_after = u8::from(keys[second] > keys[first]);
                ranks[second] += is_after;
                ranks[first] += 1 - is_after;
            }
        }
        for (rank, index) in ranks.into_iter().take(keys.len()).zip(0..) {
            order[usize::from(rank)] = index;
        }
    } else {
        keys.sort_unstable();
        for (place, key) in order.iter_mut().zip(keys) {
            *place = key.to_le_bytes()[0];
        }
    }
    order
}

/// A number whose order is that of the total order of f32.
#[inline]
const fn ordered(value: f32) -> u32 {
    let bits = value.to_bits();
    // All bits of negative numbers are turned, of the others the sign.
    bits ^ ((bits.cast_signed() >> 31).cast_unsigned() | 1 << 31)
}

/// The cheapest place to cut boxes that are in some order: its cost and index.
#[inline]
fn cheapest<const N: usize>(boxes: &[Bounds], order: &[u8; N]) -> Option<(f32, usize)> {
    let boxes_in_order = order[..boxes.len()]
        .iter()
        .map(|index| boxes[usize::from(*index)]);
    let mut costs = [0.0; N];
    let mut behind = Bounds::EMPTY;
    let mut count = 0.0;
    for (bounds, cost) in boxes_in_order.clone().zip(&mut costs).rev() {
        behind = behind.union(bounds);
        count += 1.0;
        *cost = count * half_area(&behind);
    }
    let mut best: Option<(f32, usize)> = None;
    let mut before = Bounds::EMPTY;
    let mut count = 0.0;
    for (middle, bounds) in (1..boxes.len()).zip(boxes_in_order) {
        before = before.union(bounds);
        count += 1.0;
        let cost = count * half_area(&before) + costs[middle];
        if best.is_none_or(|(best_cost, _)| cost < best_cost) {
            best = Some((cost, middle));
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use tahko_geometry::{Aabb, glam::Vec3};

    use super::*;

    /// Boxes of a size from a linear congruential generator, on few places, so that some centroids are equal.
    fn scattered(count: usize, size: f32) -> Vec<Reference> {
        let mut state = 7u32;
        let mut random = move || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f32::from((state >> 28) as u8) - 7.5
        };
        let mut point = move || Vec3::new(random(), random(), random()) * (size / 64.0);
        let bounds = (0..count).map(|_| Aabb::from_points([point(), point()]));
        bounds
            .enumerate()
            .map(|(number, bounds)| Reference::of_box(&bounds, number))
            .collect()
    }

    /// The least cost of all cuts of all orders, in f64.
    fn least(references: &[Reference], scale: CentroidScale) -> f64 {
        let mut least = f64::INFINITY;
        for axis in 0..3 {
            let mut sorted = references.to_vec();
            sorted.sort_by(|a, b| {
                let [a, b] = [a, b].map(|reference| scale.centroid(reference)[axis]);
                a.total_cmp(&b)
            });
            for middle in 1..sorted.len() {
                least = least.min(cost(&sorted, middle));
            }
        }
        least
    }

    fn cost(references: &[Reference], middle: usize) -> f64 {
        let (first, second) = references.split_at(middle);
        [first, second]
            .iter()
            .map(|side| side.len() as f64 * Bounds::of(side).half_area())
            .sum()
    }

    #[test]
    fn the_cheapest_of_all_cuts_is_found_and_nothing_is_lost() {
        for count in [2, 3, 4, 5, 7, 8, 9, 16, 17, 64, 65, 256] {
            for size in [1.0, 1e-36, 3e38] {
                let mut references = scattered(count, size);
                let scale = CentroidScale::new(&Bounds::of(&references).to_aabb());
                let least = least(&references, scale);
                let found = best(&mut references, scale).expect("more than one");
                let Cut::At(middle) = found.cut else {
                    panic!("a sweep cuts a list that is in order");
                };
                for (what, cost) in [("said", found.cost), ("cut", cost(&references, middle))] {
                    assert!(
                        (cost / least - 1.0).abs() < 1e-5,
                        "{count} of {size}: {what} {cost} for {least}"
                    );
                }
                let mut numbers: Vec<u32> = references.iter().map(Reference::number).collect();
                numbers.sort_unstable();
                assert!(
                    numbers
                        .into_iter()
                        .map(|number| number as usize)
                        .eq(0..count),
                    "{count} of {size}"
                );
            }
        }
        assert!(
            best(
                &mut scattered(1, 1.0),
                CentroidScale::new(&Aabb::new(Vec3::ZERO, Vec3::ONE))
            )
            .is_none()
        );
    }

    #[test]
    fn keys_are_in_the_order_of_their_numbers() {
        let values = [
            f32::NEG_INFINITY,
            -2.0,
            -1e-44,
            -0.0,
            0.0,
            1e-44,
            1.0,
            f32::MAX,
            f32::INFINITY,
        ];
        assert!(values.is_sorted_by(|a, b| ordered(*a) < ordered(*b)));
    }
}
