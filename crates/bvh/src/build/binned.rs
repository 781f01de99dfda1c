//! Splits by the surface area heuristic over bins of centroids.
//!
//! Source: Wald, "On fast construction of SAH-based bounding volume hierarchies", 2007. Differs in binning
//! all three axes, in centroids that are scaled so that coordinates of any size can be binned, and in fewer bins for small nodes.

use tahko_geometry::glam::{Vec3, Vec4};
use tahko_geometry::simd::{AvailableSimd, Simd, WithSimd};

use super::bins::{BinSplit, Bins};
use super::outsized;
use super::reference::{CentroidScale, Extent, Reference};
use super::split::{Candidate, Cut};
use crate::parallel::reduce;

/// The map from a reference to its bin on each axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct BinMap {
    pub(super) scale: CentroidScale,
    origin: Vec4,
    factor: Vec4,
    last: Vec4,
}

/// Adding this to a small number rounds it to a whole one, and leaves that in the lower bits. Conversion to integers would
/// take several times as long, as it has to care for numbers of any size.
pub(super) const ROUNDING: f32 = 12_582_912.0;

impl BinMap {
    /// Bins of equal width over the box of the centroids. On an axis on which all centroids coincide, or are so
    /// close that the factor overflows, all references may fall into one bin.
    fn new(extent: &Extent, scale: CentroidScale, bins: u16) -> Self {
        let factors = (f32::from(bins) / extent.centroids.extent()).min(Vec3::splat(f32::MAX));
        Self {
            scale,
            origin: extent.centroids.lower(),
            factor: factors.extend(0.0),
            last: Vec4::splat(f32::from(bins - 1)),
        }
    }

    /// The bins on the three axes, below `N`, which is a power of two and not below the number of bins.
    #[inline(always)]
    pub(super) fn bins<const N: usize>(&self, centroid: Vec4) -> [usize; 3] {
        let position = (centroid - self.origin) * self.factor - 0.5;
        let [x, y, z, _] = (position.min(self.last) + ROUNDING).to_array();
        [x, y, z].map(|position| position.to_bits() as usize % N)
    }

    /// Whether the reference with a centroid is in a bin before `bin` on an axis: the same arithmetic, hence the same bins.
    #[inline(always)]
    pub(super) fn is_before(&self, centroid: Vec4, axis: usize, bin: f32) -> bool {
        let position = (centroid - self.origin) * self.factor - 0.5;
        // Whole numbers of this size are exact.
        let rounded = position.min(self.last) + ROUNDING;
        rounded.cmplt(Vec4::splat(ROUNDING + bin)).bitmask() >> axis & 1 == 1
    }
}

/// The best split between bins, or by size where that is cheaper; `None` if each axis has all references in one bin. The same at every level of instructions.
pub(super) fn best(
    references: &[Reference],
    extent: &Extent,
    scale: CentroidScale,
    bins: usize,
    simd: AvailableSimd,
) -> Option<Candidate> {
    // Room for no more bins than needed: clearing the bins of a small node would cost more than filling them.
    match bins {
        ..=4 => best_of::<4>(references, extent, scale, bins, simd),
        5..=8 => best_of::<8>(references, extent, scale, bins, simd),
        9..=16 => best_of::<16>(references, extent, scale, bins, simd),
        17..=32 => best_of::<32>(references, extent, scale, bins, simd),
        _ => best_of::<64>(references, extent, scale, bins.min(64), simd),
    }
}

fn best_of<const N: usize>(
    references: &[Reference],
    extent: &Extent,
    scale: CentroidScale,
    bins: usize,
    simd: AvailableSimd,
) -> Option<Candidate> {
    #[expect(clippy::cast_possible_truncation, reason = "at most 64")]
    let map = BinMap::new(extent, scale, bins as u16);
    if references.len() < outsized::LEAST {
        let split = simd.dispatch(FillAndSplit::<N> {
            references,
            map,
            bins,
        })?;
        return Some(split.candidate(map));
    }
    let filled = reduce(
        references,
        &|references: &[Reference]| simd.dispatch(Fill::<N> { references, map }),
        &Bins::merged,
    );
    let limit = outsized::limit(extent, scale);
    let (split, least_by_size) = simd.dispatch(Search {
        filled: &filled,
        bins,
        scale,
        limit,
    })?;
    let is_cheaper = |other: &Candidate| other.cost < split.cost(scale);
    let by_size = (least_by_size < split.cost)
        .then(|| outsized::candidate(references, limit, scale))
        .flatten();
    Some(
        by_size
            .filter(is_cheaper)
            .unwrap_or_else(|| split.candidate(map)),
    )
}

impl BinSplit {
    /// Its cost in units of the mesh.
    fn cost(&self, scale: CentroidScale) -> f64 {
        f64::from(self.cost) * scale.area_unit()
    }

    fn candidate(self, map: BinMap) -> Candidate {
        Candidate {
            cost: self.cost(map.scale),
            cut: Cut::Bin {
                map,
                axis: self.axis,
                bin: self.bin,
                bounds: self.bounds,
            },
        }
    }
}

/// Fills bins with references.
struct Fill<'a, const N: usize> {
    references: &'a [Reference],
    map: BinMap,
}

impl<const N: usize> WithSimd for Fill<'_, N> {
    type Output = Bins<N>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Bins<N> {
        let mut filled = Bins::empty(simd);
        filled.fill(simd, self.references, &self.map);
        filled
    }
}

/// Finds the cheapest split between bins that are filled, and at least what one by size costs.
struct Search<'a, const N: usize> {
    filled: &'a Bins<N>,
    bins: usize,
    scale: CentroidScale,
    limit: f32,
}

impl<const N: usize> WithSimd for Search<'_, N> {
    type Output = Option<(BinSplit, f32)>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self {
            filled,
            bins,
            scale,
            limit,
        } = self;
        let split = filled.cheapest(simd, bins, scale)?;
        let least_by_size = filled.least_cost_by_size(simd, bins, scale, limit);
        Some((split, least_by_size))
    }
}

/// Fills bins and finds the cheapest split, for nodes of few references: the bins are not moved.
struct FillAndSplit<'a, const N: usize> {
    references: &'a [Reference],
    map: BinMap,
    bins: usize,
}

impl<const N: usize> WithSimd for FillAndSplit<'_, N> {
    type Output = Option<BinSplit>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Option<BinSplit> {
        let mut filled = Bins::<N>::empty(simd);
        filled.fill(simd, self.references, &self.map);
        filled.cheapest(simd, self.bins, self.map.scale)
    }
}

#[cfg(test)]
mod tests;
