use tahko_geometry::Aabb;
use tahko_geometry::simd::SimdLevel;

use super::*;
use crate::build::reference::Bounds;
use crate::build::split::Candidate;

/// Boxes of up to a tenth of a cube's size at places that a linear congruential generator picks, from coordinates of any size.
fn scattered(count: usize, size: f32) -> Vec<Reference> {
    let mut state = 1u32;
    let mut random = move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f32::from((state >> 16) as u16) / 65536.0 - 0.5
    };
    let mut point = move || Vec3::new(random(), random(), random());
    let boxes = (0..count).map(|_| {
        let (corner, extent) = (point(), 0.1 * point().abs());
        Aabb::new(corner * size, (corner + extent) * size)
    });
    boxes
        .enumerate()
        .map(|(number, bounds)| Reference::of_box(&bounds, number))
        .collect()
}

fn found(references: &[Reference], bins: usize, simd: AvailableSimd) -> (Candidate, CentroidScale) {
    let scale = CentroidScale::new(&Bounds::of(references).to_aabb());
    let extent = Extent::new(references, scale);
    let candidate = best(references, &extent, scale, bins, simd);
    (candidate.expect("centroids differ"), scale)
}

fn numbers(references: &[Reference]) -> Vec<u32> {
    let mut numbers: Vec<u32> = references.iter().map(Reference::number).collect();
    numbers.sort_unstable();
    numbers
}

/// The list is cut into what the candidate's cost and boxes say, and nothing is lost.
#[test]
fn a_split_is_what_it_is_said_to_be_at_every_level() {
    // Odd and even numbers, few and more than one task bins; all sizes of bins.
    for (count, bins) in [
        (2, 4),
        (3, 4),
        (5, 4),
        (8, 8),
        (17, 16),
        (100, 16),
        (1001, 32),
        (40_001, 64),
    ] {
        for size in [1.0, 1e-38, 3e38] {
            let references = scattered(count, size);
            let mut costs = Vec::new();
            for simd in SimdLevel::ALL.into_iter().filter_map(SimdLevel::available) {
                let case = format!("{count} in {bins} bins, {size}, {:?}", simd.level());
                let mut cut = references.clone();
                let (candidate, scale) = found(&cut, bins, simd);
                let cost = candidate.cost;
                let parts = candidate.cut.apply(&mut cut, scale, simd);
                assert_eq!(numbers(&cut), numbers(&references), "{case}");
                let (first, second) = cut.split_at(parts.middle);
                assert!(!first.is_empty() && !second.is_empty(), "{case}");
                let mut expected = 0.0;
                for (side, extent) in [(first, parts.first), (second, parts.second)] {
                    let exact = Extent::new(side, scale);
                    assert!(extent.bounds.equals(&exact.bounds), "{case}");
                    assert!(extent.centroids.equals(&exact.centroids), "{case}");
                    expected += exact.bounds.half_area() * side.len() as f64;
                }
                assert!(
                    (cost / expected - 1.0).abs() < 1e-5,
                    "{case}: {cost} {expected}"
                );
                costs.push((cost, numbers(first)));
            }
            assert!(
                costs.iter().all(|cost| *cost == costs[0]),
                "{count}, {size}: levels differ"
            );
        }
    }
}

/// No other cut between the bins of an axis is cheaper.
#[test]
fn the_cheapest_of_all_cuts_between_bins_is_found() {
    for (count, bins) in [(7, 7u16), (50, 16), (700, 13)] {
        let references = scattered(count, 1.0);
        let (candidate, scale) = found(&references, usize::from(bins), AvailableSimd::best());
        let extent = Extent::new(&references, scale);
        let map = BinMap::new(&extent, scale, bins);
        let mut least = f64::INFINITY;
        for axis in 0..3 {
            for bin in 1..usize::from(bins) {
                let is_first =
                    |reference: &&Reference| map.bins::<64>(scale.centroid(reference))[axis] < bin;
                let (first, second): (Vec<_>, Vec<_>) = references.iter().partition(is_first);
                if !first.is_empty() && !second.is_empty() {
                    let cost =
                        |side: &[Reference]| Bounds::of(side).half_area() * side.len() as f64;
                    least = least.min(cost(&first) + cost(&second));
                }
            }
        }
        assert!(
            (candidate.cost / least - 1.0).abs() < 1e-5,
            "{count}: {} {least}",
            candidate.cost
        );
    }
}
