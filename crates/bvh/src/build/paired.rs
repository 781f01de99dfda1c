//! Boxes as one vector, for loops over many of them.

use tahko_geometry::glam::Vec4;
use tahko_geometry::simd::{Lanes, Simd};

use super::reference::{Bounds, CentroidScale};

/// A box as eight lanes: the lower corner, and the upper one with the opposite sign. So the union of two boxes is one minimum.
#[derive(Clone, Copy, Debug)]
pub(super) struct PairedBounds(Lanes);

impl PairedBounds {
    /// The box of nothing. Not a constant: many would be copied from one that is as large.
    #[inline(always)]
    pub(super) fn empty<S: Simd>(simd: S) -> Self {
        Self::of(simd, simd.splat(f32::INFINITY))
    }

    /// The box that a vector holds.
    #[inline(always)]
    pub(super) fn of<S: Simd>(simd: S, lanes: S::F32s) -> Self {
        Self(simd.store(lanes))
    }

    #[inline(always)]
    pub(super) fn lanes<S: Simd>(&self, simd: S) -> S::F32s {
        simd.load(&self.0)
    }

    /// The box around this one and another.
    #[inline(always)]
    pub(super) fn with<S: Simd>(&self, simd: S, other: S::F32s) -> Self {
        Self::of(simd, simd.min(self.lanes(simd), other))
    }

    /// The box around some boxes.
    #[inline(always)]
    pub(super) fn around<S: Simd>(simd: S, boxes: &[Self]) -> Self {
        let mut around = simd.splat(f32::INFINITY);
        for bounds in boxes {
            around = simd.min(around, bounds.lanes(simd));
        }
        Self::of(simd, around)
    }

    pub(super) fn to_bounds(self) -> Bounds {
        let [a, b, c, d, e, f, g, h] = self.0.0;
        Bounds::between(
            Vec4::from_array([a, b, c, d]),
            -Vec4::from_array([e, f, g, h]),
        )
    }
}

impl Bounds {
    /// The lanes of a [`PairedBounds`].
    #[inline(always)]
    pub(super) fn paired<S: Simd>(&self, simd: S) -> S::F32s {
        simd.halves(self.lower().to_array(), (-self.upper()).to_array())
    }
}

impl CentroidScale {
    /// [`centroid`](Self::centroid) of a reference by its lanes.
    #[inline(always)]
    pub(super) fn centroid_of<S: Simd>(self, simd: S, lanes: S::F32s) -> Vec4 {
        let [lower, upper] = simd.to_halves(simd.mul(lanes, simd.splat(self.factor())));
        Vec4::from_array(lower) - Vec4::from_array(upper)
    }

    /// The edge lengths of a box in scaled units, negative, as [`extent`](Self::extent) has them positive.
    #[inline(always)]
    pub(super) fn negative_extent<S: Simd>(self, simd: S, bounds: S::F32s) -> Vec4 {
        let scaled = simd.mul(bounds, simd.splat(self.factor()));
        let [lower, upper] = simd.to_halves(scaled);
        Vec4::from_array(lower) + Vec4::from_array(upper)
    }
}
