//! The boxes of the two parts of a triangle that a plane cuts: conservative, and tight to a rounding.
//!
//! **What has to hold.** A reference with box `B` stands for the part of its triangle `T` in `B`. Cut at `x = p` (for any axis), its two new boxes have to
//! contain `T ∩ B ∩ {x <= p}` and `T ∩ B ∩ {x >= p}`, all closed sets: every coordinate that is returned as the
//! least is exactly a lower bound.
//!
//! **Why it does.** [`ClippedTriangle`] cuts in f64. Let `M` be the largest magnitude of a coordinate among the vertices and `e = 84 * 2^-53 M`, the error that its
//! documentation states for six cuts: each cut point is within `14 * 2^-53 M` of the point on its edge with the same weight. Think of each computed vertex as the image of a
//! point of the triangle in barycentric coordinates, the one found with the same weights and no rounding; the image is at most `e` away. In these coordinates
//! each cut takes an exactly convex piece off an exactly convex polygon, for it cuts two edges and the vertices it drops are neighbours. The piece is spanned by dropped vertices,
//! whose images are beyond the plane, and by cut points, whose images are in it. So every point of the triangle in that piece is beyond
//! the plane or less than `e` before it. The planes are therefore moved outward by `2^-45 M >= 2e`: then nothing of `T ∩ B ∩ {x <= p}` is ever dropped, and all of
//! it stays within `e` of the hull of the computed vertices. Their box, moved outward by `2^-45 M` (which also covers the rounding of both moves) and
//! rounded outward to f32, contains it, and so does that box cut with `B` and `{x <= p}`, which are exact.
//!
//! The converse holds to the same error: the box is larger than it could be by no more than an ulp and `2^-44 M` for all but the thinnest
//! triangles, and never larger than `B`.

use tahko_geometry::{
    Aabb, ClippedTriangle, Triangle,
    glam::{DVec3, Vec3},
};

use crate::build::reference::Bounds;

/// How far planes and boxes are moved outward, as a part of the largest coordinate.
const MARGIN: f64 = 1.0 / (1u64 << 45) as f64;

/// The boxes of the parts of a triangle in `bounds`, up to a plane and from it on; empty where there is no part.
///
/// The plane is strictly inside the box. Cost: some 100 ns per side.
pub(super) fn halves(triangle: &Triangle, bounds: &Bounds, axis: usize, plane: f32) -> [Bounds; 2] {
    let [mut below, mut above] = [bounds.to_aabb(), bounds.to_aabb()];
    below.max[axis] = plane;
    above.min[axis] = plane;
    let margin = triangle
        .vertices()
        .map(|vertex| vertex.as_dvec3().abs())
        .into_iter()
        .fold(DVec3::ZERO, DVec3::max)
        * MARGIN;
    let whole = ClippedTriangle::new(triangle);
    [below, above].map(|half| {
        let min = half.min.as_dvec3() - margin;
        let max = half.max.as_dvec3() + margin;
        let (least, most) = whole.in_box(min, max).bounds();
        let tight = Bounds::new(&Aabb::new(
            round_down(least - margin),
            round_up(most + margin),
        ));
        tight.intersection(Bounds::new(&half))
    })
}

/// The largest f32 numbers not above the given ones.
fn round_down(values: DVec3) -> Vec3 {
    let nearest = values.as_vec3();
    let lower = Vec3::from(nearest.to_array().map(f32::next_down));
    Vec3::select(nearest.as_dvec3().cmpgt(values), lower, nearest)
}

/// The smallest f32 numbers not below the given ones.
fn round_up(values: DVec3) -> Vec3 {
    -round_down(-values)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn whole(triangle: &Triangle) -> Bounds {
        Bounds::new(&triangle.aabb())
    }

    #[test]
    fn a_triangle_is_cut_where_its_edges_are() {
        let triangle = Triangle::new(
            Vec3::ZERO,
            Vec3::new(4.0, 8.0, 2.0),
            Vec3::new(0.0, 8.0, 0.0),
        );
        let [below, above] = halves(&triangle, &whole(&triangle), 1, 2.0).map(Bounds::to_aabb);
        let next = |value: f32| value.next_up();
        assert_eq!((below.min, below.max.x), (Vec3::ZERO, next(1.0)));
        assert_eq!((below.max.y, below.max.z), (2.0, next(0.5)));
        assert_eq!(
            (above.min, above.max),
            (Vec3::Y * 2.0, Vec3::new(4.0, 8.0, 2.0))
        );
    }

    #[test]
    fn a_side_that_the_part_does_not_reach_is_empty() {
        // The box has been cut to a corner in which the triangle only has its diagonal.
        let triangle = Triangle::new(
            Vec3::ZERO,
            Vec3::new(8.0, 8.0, 0.0),
            Vec3::new(8.0, 8.0, 1.0),
        );
        let bounds = Bounds::new(&Aabb::new(
            Vec3::new(2.0, 2.0, 0.0),
            Vec3::new(8.0, 4.0, 1.0),
        ));
        let [below, above] = halves(&triangle, &bounds, 0, 6.0);
        assert!(above.is_empty(), "nothing is beyond (4, 4)");
        let below = below.to_aabb();
        assert_eq!((below.min.x, below.max.y), (2.0, 4.0));
        assert!((4.0..4.000_001).contains(&below.max.x), "{below:?}");
    }

    #[test]
    fn coordinates_of_any_size_are_cut_without_loss() {
        for size in [f32::MAX, 1.0, f32::MIN_POSITIVE, 1e-44] {
            let corners = [
                Vec3::splat(-1.0),
                Vec3::splat(1.0),
                Vec3::new(1.0, -1.0, 0.5),
            ];
            let [a, b, c] = corners.map(|corner| corner * size);
            let triangle = Triangle::new(a, b, c);
            let cut = halves(&triangle, &whole(&triangle), 0, 0.0).map(Bounds::to_aabb);
            let [below, above] = cut;
            assert!(
                below.contains(a) && above.contains(b) && above.contains(c),
                "{size}"
            );
            assert!(
                below.contains(Vec3::ZERO) && above.contains(Vec3::ZERO),
                "{size}"
            );
            // The largest y of the part below the plane is 0, that of the whole is 1.
            assert!(
                below.max.y <= size * 1e-6 || size < 1e-40,
                "{size}: {below:?}"
            );
        }
    }

    fn vertex() -> impl Strategy<Value = Vec3> {
        let coordinate = prop_oneof![
            (-1024i16..=1024).prop_map(|value| f32::from(value) / 256.0),
            (-4i16..=4).prop_map(f32::from),
            // Needles: very near to a grid line.
            (-4i16..=4).prop_map(|value| f32::from(value) + 1.0 / 65536.0),
        ];
        prop::array::uniform3(coordinate).prop_map(Vec3::from)
    }

    proptest! {
        /// A sequence of cuts, as in a tree: a point is followed to a side whose half-space contains it.
        #[test]
        fn points_of_the_triangle_stay_in_the_boxes(
            corners in prop::array::uniform3(vertex()),
            weights in prop::array::uniform2(0u8..=64),
            planes in prop::collection::vec((0usize..3, 0.0f32..1.0, any::<bool>()), 1..12),
        ) {
            let triangle = Triangle::new(corners[0], corners[1], corners[2]);
            let [i, j] = weights;
            let j = j.min(64 - i);
            let [a, b, c] = corners.map(Vec3::as_dvec3);
            let weigh = |corner: DVec3, weight: u8| corner * (f64::from(weight) / 64.0);
            // Exact: coordinates have at most 19 binary digits.
            let point = weigh(a, i) + weigh(b, j) + weigh(c, 64 - i - j);
            let mut bounds = whole(&triangle);
            for (axis, share, prefers_first) in planes {
                let Aabb { min, max } = bounds.to_aabb();
                // On a coordinate of the point where it is one of f32: the hardest place.
                #[expect(clippy::cast_possible_truncation, reason = "rounds")]
                let at_point = point[axis] as f32;
                let between = min[axis] + (max[axis] - min[axis]) * share;
                let plane = if share < 0.5 { at_point } else { between };
                if !(min[axis] < plane && plane < max[axis]) {
                    continue;
                }
                let position = point[axis];
                let side = match f64::from(plane) {
                    plane if position < plane => 0,
                    plane if position > plane => 1,
                    _ => usize::from(!prefers_first),
                };
                let outer = bounds.to_aabb();
                bounds = halves(&triangle, &bounds, axis, plane)[side];
                let Aabb { min, max } = bounds.to_aabb();
                prop_assert!(outer.contains_box(&bounds.to_aabb()), "{outer:?}");
                prop_assert!(min.as_dvec3().cmple(point).all(), "{point} below {min}");
                prop_assert!(max.as_dvec3().cmpge(point).all(), "{point} above {max}");
            }
        }
    }
}
