//! The box of the part of a triangle in a cell: the "perfect split" of Wald and Havran.
//!
//! The box may be too large, never too small: a triangle that a cell does not list although it touches it would
//! be lost to rays. The triangle is cut in f64 by those of the cell's six planes that it crosses
//! ([`ClippedTriangle`]). For one coordinate let `M` be the largest magnitude among the vertices, and `u = 2^-53`.
//!
//! Call the exact point on the exact edge with the weight that a cut computes its *shadow*; the triangle's vertices are their own
//! shadows. Shadows lie in the triangle's plane, and after six cuts every vertex is within `d = 84 u M` of its shadow.
//!
//! **Nothing is cut away.** Each plane is first moved outwards by `2^-45 M = 256 u M`. A cut replaces a run of the boundary
//! by a chord. The shadows of both lie where the coordinate is beyond the moved plane less `2d`, hence beyond the
//! true plane. So the winding number of the shadow's boundary around a point inside the true plane stays what it was:
//! the shadow contains the part of the triangle in the cell, even if rounding bends the polygon or misjudges a
//! vertex. The box around vertices, with `2^-45 M` to both sides of cut points, contains the shadow.
//! Then it is rounded outwards to f32 and cut down to the triangle's own box and to the cell.

use tahko_geometry::glam::{DVec3, Vec3};
use tahko_geometry::{Aabb, ClippedTriangle, Triangle};

/// The bound on the error of a cut point, relative to the largest magnitude of the coordinate: `2^-45`.
const RELATIVE_ERROR: f64 = 1.0 / (1u64 << 45) as f64;

/// A box around the part of a triangle that lies in the closed cell; `None` if there is certainly no such part.
pub(super) fn clipped_bounds(triangle: &Triangle, cell: &Aabb) -> Option<Aabb> {
    let bounds = triangle.aabb();
    let magnitude = bounds.min.abs().max(bounds.max.abs()).as_dvec3();
    let error = magnitude * RELATIVE_ERROR;
    let [min, max] = [cell.min, cell.max].map(Vec3::as_dvec3);
    let part = ClippedTriangle::new(triangle).in_box(min - error, max + error);
    let clipped = bounds_of(&part, error)?
        .intersection(bounds)
        .intersection(*cell);
    (!clipped.is_empty()).then_some(clipped)
}

/// The box around a polygon; `None` if nothing is left of it.
fn bounds_of(part: &ClippedTriangle, error: DVec3) -> Option<Aabb> {
    let mut min = DVec3::INFINITY;
    let mut max = DVec3::NEG_INFINITY;
    for vertex in part.vertices() {
        let margin = if vertex.is_cut { error } else { DVec3::ZERO };
        min = min.min(vertex.position - margin);
        max = max.max(vertex.position + margin);
    }
    (!part.vertices().is_empty()).then(|| {
        Aabb::new(
            min.to_array().map(round_down).into(),
            max.to_array().map(round_up).into(),
        )
    })
}

fn round_down(value: f64) -> f32 {
    -round_up(-value)
}

fn round_up(value: f64) -> f32 {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "rounds to the nearest f32, mended below"
    )]
    let nearest = value as f32;
    if f64::from(nearest) < value {
        nearest.next_up()
    } else {
        nearest
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use tahko_geometry::test_support::{grid_point, point};

    use super::*;

    fn triangle() -> impl Strategy<Value = Triangle> {
        let corner = || prop_oneof![point(4.0), grid_point()];
        (corner(), corner(), corner()).prop_map(|(a, b, c)| Triangle::new(a, b, c))
    }

    proptest! {
        #[test]
        fn no_point_of_the_triangle_in_the_cell_is_outside_the_box(
            triangle in triangle(),
            corners in (grid_point(), point(3.0)),
            weights in prop::collection::vec((0.0f64..=1.0, 0.0f64..=1.0), 100),
        ) {
            let cell = Aabb::from_points([corners.0, corners.1]);
            let clipped = clipped_bounds(&triangle, &cell);
            let [a, b, c] = triangle.vertices().map(Vec3::as_dvec3);
            for (v, w) in weights {
                let (v, w) = if v + w <= 1.0 { (v, w) } else { (1.0 - v, 1.0 - w) };
                let point = a + v * (b - a) + w * (c - a);
                // The point itself is rounded: only what is inside by more than that counts.
                let margin = 1e-14 * (1.0 + point.abs());
                let inside = (cell.min.as_dvec3() + margin).cmple(point).all()
                    && point.cmple(cell.max.as_dvec3() - margin).all();
                if inside {
                    let clipped = clipped.expect("a point of the triangle is in the cell");
                    let (min, max) = (clipped.min.as_dvec3() - margin, clipped.max.as_dvec3() + margin);
                    prop_assert!(min.cmple(point).all() && point.cmple(max).all(), "{point} {clipped:?}");
                }
            }
            if let Some(clipped) = clipped {
                prop_assert!(cell.contains_box(&clipped), "the box is in the cell");
                prop_assert!(triangle.aabb().contains_box(&clipped), "the box is in that of the triangle");
            }
        }
    }

    #[test]
    fn a_diagonal_triangle_is_cut_to_its_part_in_the_cell() {
        let triangle = Triangle::new(
            Vec3::ZERO,
            Vec3::new(4.0, 4.0, 0.0),
            Vec3::new(4.0, 4.0, 1.0),
        );
        let cell = Aabb::new(Vec3::new(1.0, -1.0, -1.0), Vec3::new(2.0, 9.0, 9.0));
        let clipped = clipped_bounds(&triangle, &cell).expect("the cell is crossed");
        assert!(
            clipped.min.abs_diff_eq(Vec3::new(1.0, 1.0, 0.0), 1e-6),
            "{clipped:?}"
        );
        assert!(
            clipped.max.abs_diff_eq(Vec3::new(2.0, 2.0, 0.5), 1e-6),
            "{clipped:?}"
        );
    }

    #[test]
    fn a_triangle_that_passes_a_corner_of_the_cell_is_not_in_it() {
        let triangle = Triangle::new(Vec3::X * 3.0, Vec3::Y * 3.0, Vec3::new(3.0, 3.0, 0.0));
        let cell = Aabb::new(Vec3::NEG_ONE, Vec3::ONE);
        assert!(
            !cell.intersection(triangle.aabb()).is_empty(),
            "the boxes meet"
        );
        assert_eq!(clipped_bounds(&triangle, &cell), None);
    }

    #[test]
    fn a_triangle_in_a_face_of_the_cell_stays_flat() {
        let triangle = Triangle::new(
            Vec3::new(-5.0, -5.0, 0.3),
            Vec3::new(5.0, -5.0, 0.3),
            Vec3::new(0.1, 5.0, 0.3),
        );
        let cell = Aabb::new(Vec3::new(-1.0, -1.0, 0.3), Vec3::ONE);
        let clipped = clipped_bounds(&triangle, &cell).expect("it touches the face");
        assert_eq!((clipped.min.z, clipped.max.z), (0.3, 0.3));
    }

    #[test]
    fn the_largest_coordinates_are_cut_without_overflow() {
        let triangle = Triangle::new(Vec3::MIN, Vec3::MAX, Vec3::new(f32::MAX, f32::MIN, 0.0));
        let cell = Aabb::new(Vec3::NEG_ONE, Vec3::ONE);
        let clipped = clipped_bounds(&triangle, &cell).expect("it passes the origin");
        assert!(
            cell.contains_box(&clipped) && clipped.contains(Vec3::ZERO),
            "{clipped:?}"
        );
    }
}
