//! What the builders move and measure: references to triangles, their boxes and centroids.

use tahko_geometry::simd::Lanes;
use tahko_geometry::{
    Aabb, TriangleMesh,
    glam::{BVec4A, Vec3, Vec4, Vec4Swizzles},
};

/// The fourth lane of a reference holds the triangle's number under this bit, which makes it a normal
/// f32: arithmetic on denormal lanes would be slow, even where nobody reads the result.
const NUMBER_TAG: u32 = 1 << 30;
const _: () = assert!(
    TriangleMesh::MAX_TRIANGLES <= NUMBER_TAG as usize / 2,
    "a number with the tag must not be NaN or infinite"
);

/// A triangle's box and number, 32 bytes that move as one vector: the lanes of [`PairedBounds`], and in the fourth one the number.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reference(Lanes);

impl Reference {
    /// A reference to a triangle of a mesh.
    #[inline]
    pub(super) fn new(mesh: &TriangleMesh, number: usize) -> Self {
        Self::of_box(&mesh.triangle(number).aabb(), number)
    }

    /// A reference to what a box is around, under a number of at most 29 bits.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "meshes have at most 2^29 triangles"
    )]
    #[inline]
    pub(super) fn of_box(bounds: &Aabb, number: usize) -> Self {
        Self::of_bounds(&Bounds::new(bounds), number as u32 | NUMBER_TAG)
    }

    #[inline]
    fn of_bounds(bounds: &Bounds, tagged: u32) -> Self {
        let ([a, b, c, _], [e, f, g, _]) = (bounds.lower.to_array(), (-bounds.upper).to_array());
        Self(Lanes([a, b, c, f32::from_bits(tagged), e, f, g, 0.0]))
    }

    /// A reference to the same triangle with another box.
    pub(super) fn with_bounds(&self, bounds: &Bounds) -> Self {
        Self::of_bounds(bounds, self.0.0[3].to_bits())
    }

    #[inline(always)]
    pub(super) fn bounds(&self) -> Bounds {
        let [a, b, c, d, e, f, g, h] = self.0.0;
        Bounds {
            lower: Vec4::from_array([a, b, c, d]),
            upper: -Vec4::from_array([e, f, g, h]),
        }
    }

    /// The lower corner, and the upper one with the opposite sign, as one vector.
    #[inline(always)]
    pub(super) const fn lanes(&self) -> &Lanes {
        &self.0
    }

    /// A reference by its [`lanes`](Self::lanes).
    #[inline(always)]
    pub(super) const fn of_lanes(lanes: Lanes) -> Self {
        Self(lanes)
    }

    /// The triangle's index in the mesh, or the number of what the box is around.
    #[inline]
    pub(super) fn number(&self) -> u32 {
        self.0.0[3].to_bits() & !NUMBER_TAG
    }
}

/// A box whose fourth lane means nothing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    lower: Vec4,
    upper: Vec4,
}

impl Bounds {
    pub(super) const EMPTY: Self = Self {
        lower: Vec4::INFINITY,
        upper: Vec4::NEG_INFINITY,
    };

    pub(super) fn of(references: &[Reference]) -> Self {
        let mut bounds = Self::EMPTY;
        for reference in references {
            bounds.add(reference);
        }
        bounds
    }

    #[inline]
    pub(super) fn add(&mut self, reference: &Reference) {
        *self = self.union(reference.bounds());
    }

    #[inline]
    pub(super) fn add_point(&mut self, point: Vec4) {
        self.lower = self.lower.min(point);
        self.upper = self.upper.max(point);
    }

    /// Adds a point where a mask, of equal lanes, is set.
    #[inline]
    pub(super) fn add_point_if(&mut self, mask: BVec4A, point: Vec4) {
        self.lower = self.lower.min(Vec4::select(mask, point, Vec4::INFINITY));
        self.upper = self
            .upper
            .max(Vec4::select(mask, point, Vec4::NEG_INFINITY));
    }

    #[inline]
    pub(super) fn union(self, other: Self) -> Self {
        Self {
            lower: self.lower.min(other.lower),
            upper: self.upper.max(other.upper),
        }
    }

    #[inline]
    pub(super) fn intersection(self, other: Self) -> Self {
        Self {
            lower: self.lower.max(other.lower),
            upper: self.upper.min(other.upper),
        }
    }

    /// Whether two boxes have equal corners.
    #[inline]
    pub(super) fn equals(&self, other: &Self) -> bool {
        self.lower.xyz() == other.lower.xyz() && self.upper.xyz() == other.upper.xyz()
    }

    /// Whether the box contains no point.
    #[inline]
    pub(super) fn is_empty(&self) -> bool {
        !self.lower.xyz().cmple(self.upper.xyz()).all()
    }

    #[inline]
    pub(super) fn new(bounds: &Aabb) -> Self {
        Self {
            lower: bounds.min.extend(0.0),
            upper: bounds.max.extend(0.0),
        }
    }

    /// The box of three points.
    #[inline(always)]
    pub(super) fn of_points(points: [Vec3; 3]) -> Self {
        let [a, b, c] = points.map(|point| point.extend(0.0));
        Self {
            lower: a.min(b).min(c),
            upper: a.max(b).max(c),
        }
    }

    #[inline(always)]
    pub(super) fn lower(&self) -> Vec4 {
        self.lower
    }

    #[inline(always)]
    pub(super) fn upper(&self) -> Vec4 {
        self.upper
    }

    /// A box by its corners.
    pub(super) const fn between(lower: Vec4, upper: Vec4) -> Self {
        Self { lower, upper }
    }

    /// Edge lengths of a box that is not empty.
    pub(super) fn extent(&self) -> Vec3 {
        (self.upper - self.lower).xyz()
    }

    /// Half of the surface area of a box that is not empty, in f64, where it neither over- nor underflows.
    #[inline]
    pub(super) fn half_area(&self) -> f64 {
        let extent = self.upper.xyz().as_dvec3() - self.lower.xyz().as_dvec3();
        extent.x * extent.y + extent.y * extent.z + extent.z * extent.x
    }

    pub(super) fn to_aabb(self) -> Aabb {
        Aabb::new(self.lower.xyz(), self.upper.xyz())
    }
}

/// The power of two that brings the coordinates of a mesh to the order of one before centroids are taken.
///
/// Then sums of two coordinates cannot overflow (not at 3e38), and differences between centroids keep
/// their digits (not only at 1e-39, where they would have none to lose).
#[derive(Clone, Copy, Debug)]
pub(super) struct CentroidScale(f32);

impl CentroidScale {
    pub(super) fn new(bounds: &Aabb) -> Self {
        let largest = bounds.min.abs().max(bounds.max.abs()).max_element();
        let exponent = largest.to_bits() >> 23;
        let opposite = 254u32.saturating_sub(exponent).max(1);
        Self(f32::from_bits(opposite << 23))
    }

    /// Twice the centre of a reference's box, scaled. Rounded, and the same for the same reference: it steers
    /// the build and decides nothing else.
    #[inline(always)]
    pub(super) fn centroid(self, reference: &Reference) -> Vec4 {
        self.middle_of(&reference.bounds())
    }

    /// The same for a box.
    #[inline(always)]
    pub(super) fn middle_of(self, bounds: &Bounds) -> Vec4 {
        bounds.lower * self.0 + bounds.upper * self.0
    }

    /// Edge lengths of a box in scaled units; the fourth lane means nothing.
    #[inline]
    pub(super) fn extent(self, bounds: &Bounds) -> Vec4 {
        bounds.upper * self.0 - bounds.lower * self.0
    }

    pub(super) const fn factor(self) -> f32 {
        self.0
    }

    /// What [`half_area`](Self::half_area) counts in.
    pub(super) fn area_unit(self) -> f64 {
        f64::from(self.0).powi(-2)
    }

    /// The corners of a box as centroids: those of boxes within it are between them.
    pub(super) fn centroids_of(self, bounds: &Bounds) -> [Vec4; 2] {
        [bounds.lower, bounds.upper].map(|corner| corner * self.0 + corner * self.0)
    }

    /// Half of the surface area of a box that is not empty, in scaled units: good enough to compare boxes, at any size
    /// of coordinates.
    #[inline]
    pub(super) fn half_area(self, bounds: &Bounds) -> f32 {
        let extent = self.extent(bounds);
        let faces = extent * extent.yzxw();
        // The same sum in the first three lanes, of which one is read.
        (faces + faces.yzxw() + faces.zxyw()).x
    }
}

/// The box of some references and the box of their centroids.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    pub(super) bounds: Bounds,
    pub(super) centroids: Bounds,
}

impl Extent {
    pub(super) const EMPTY: Self = Self {
        bounds: Bounds::EMPTY,
        centroids: Bounds::EMPTY,
    };

    pub(super) fn new(references: &[Reference], scale: CentroidScale) -> Self {
        let mut extent = Self::EMPTY;
        for reference in references {
            extent.add(reference, scale);
        }
        extent
    }

    #[inline]
    pub(super) fn add(&mut self, reference: &Reference, scale: CentroidScale) {
        self.bounds.add(reference);
        self.centroids.add_point(scale.centroid(reference));
    }

    pub(super) fn union(self, other: Self) -> Self {
        Self {
            bounds: self.bounds.union(other.bounds),
            centroids: self.centroids.union(other.centroids),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(size: f32) -> Aabb {
        Aabb::new(Vec3::splat(-size), Vec3::splat(size))
    }

    #[test]
    fn a_reference_keeps_its_number_and_its_box() {
        for number in [0, 1, 12_345, (1 << 29) - 1] {
            let reference = Reference::of_box(&cube(2.0), number);
            assert_eq!(reference.number() as usize, number);
            let mut bounds = Bounds::EMPTY;
            bounds.add(&reference);
            assert_eq!(bounds.to_aabb(), cube(2.0));
        }
    }

    #[test]
    fn centroids_of_any_size_are_finite_and_differ() {
        for size in [f32::MAX, 3.0e38, 1.0, 1e-30, 1e-39, 1e-44] {
            let scale = CentroidScale::new(&cube(size));
            let at = |offset: f32| {
                let corner = Vec3::splat(offset);
                scale.centroid(&Reference::of_box(&Aabb::new(corner, corner), 0))
            };
            let extent = (at(size) - at(-size)).xyz();
            assert!(extent.is_finite(), "{size}: {extent}");
            assert!(extent.min_element() > 1e-10, "{size}: {extent}");
        }
    }

    #[test]
    fn areas_of_any_size_neither_overflow_nor_underflow() {
        for size in [f32::MAX, 1.0, 1e-44] {
            let extent = Extent::new(
                &[Reference::of_box(&cube(size), 0)],
                CentroidScale::new(&cube(size)),
            );
            let expected = 12.0 * f64::from(size).powi(2);
            let area = extent.bounds.half_area();
            assert!((area / expected - 1.0).abs() < 1e-6, "{size}: {area}");
        }
    }
}
