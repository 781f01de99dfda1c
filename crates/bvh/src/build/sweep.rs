//! Splits by the surface area heuristic between any two neighbours in the order of the centroids.

use super::reference::{Bounds, CentroidScale, Reference};
use super::split::{Candidate, Cut};

/// The best of all splits along the three axes; leaves the references in the order that the split cuts.
///
/// `None` for fewer than two references. Source: the sweep build in Wald, "On fast construction of
/// SAH-based bounding volume hierarchies", 2007.
pub(super) fn best(references: &mut [Reference], scale: CentroidScale) -> Option<Candidate> {
    match references.len() {
        ..=16 => best_of::<16>(references, scale),
        17..=64 => best_of::<64>(references, scale),
        _ => best_of::<256>(references, scale),
    }
}

fn best_of<const N: usize>(
    references: &mut [Reference],
    scale: CentroidScale,
) -> Option<Candidate> {
    let mut best: Option<(f64, usize, usize)> = None;
    for axis in 0..3 {
        sort(references, axis, scale);
        let split = cheapest::<N>(references);
        if let Some((cost, middle)) = split
            && best.is_none_or(|(best_cost, ..)| cost < best_cost)
        {
            best = Some((cost, axis, middle));
        }
    }
    let (cost, axis, middle) = best?;
    if axis != 2 {
        sort(references, axis, scale);
    }
    Some(Candidate {
        cost,
        cut: Cut::At(middle),
    })
}

/// Orders references by their centroids along an axis, equal ones by their numbers.
fn sort(references: &mut [Reference], axis: usize, scale: CentroidScale) {
    references.sort_unstable_by(|a, b| super::split::compare(a, b, axis, scale));
}

/// The cheapest place to cut references that are in order: its cost and index.
fn cheapest<const N: usize>(references: &[Reference]) -> Option<(f64, usize)> {
    let mut costs = [0.0; N];
    let mut behind = Bounds::EMPTY;
    let mut count = 0.0;
    for (reference, cost) in references.iter().zip(&mut costs).rev() {
        behind.add(reference);
        count += 1.0;
        *cost = count * behind.half_area();
    }
    let mut best: Option<(f64, usize)> = None;
    let mut before = Bounds::EMPTY;
    let mut count = 0.0;
    for (middle, reference) in (1..references.len()).zip(references) {
        before.add(reference);
        count += 1.0;
        let cost = count * before.half_area() + costs[middle];
        if best.is_none_or(|(best_cost, _)| cost < best_cost) {
            best = Some((cost, middle));
        }
    }
    best
}
