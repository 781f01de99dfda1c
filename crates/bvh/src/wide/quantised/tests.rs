use proptest::prelude::*;
use tahko_geometry::Aabb;
use tahko_geometry::glam::Vec3;
use tahko_geometry::simd::{Lanes, SimdLevel, WithSimd};

use super::*;

/// The planes of a node as a search loads them: by axis, first the smallest, then the largest.
struct Loaded<'a>(&'a QuantisedNode, bool);

impl WithSimd for Loaded<'_> {
    type Output = [[Lanes; 2]; 3];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        [0, 1, 2].map(|axis| {
            let planes = self
                .0
                .planes(simd, axis, &PlaneOrder::new(if self.1 { 7 } else { 0 }));
            planes.map(|planes| simd.store(planes))
        })
    }
}

/// A node whose first lanes have some boxes.
fn node(boxes: &[Aabb]) -> WideNode {
    let mut node = WideNode::EMPTY;
    for (lane, bounds) in boxes.iter().enumerate() {
        node.set(lane, bounds, Child::inner(lane));
    }
    node
}

/// Checks what the format promises about some boxes, and returns them as they are decoded.
fn check(boxes: &[Aabb]) -> Vec<Aabb> {
    let quantised = QuantisedNode::new(&node(boxes));
    let decoded = quantised.decoded();
    let found: Vec<(Aabb, Child)> = decoded.children().collect();
    assert_eq!(found.len(), boxes.len(), "every box that is used");
    for (lane, (bounds, (found, child))) in boxes.iter().zip(&found).enumerate() {
        assert_eq!(*child, Child::inner(lane));
        assert!(found.contains_box(bounds), "{found:?} around {bounds:?}");
    }
    for lane in boxes.len()..LANES {
        for [smallest, largest] in decoded.bounds {
            let (smallest, largest) = (smallest.0[lane], largest.0[lane]);
            assert!(smallest > largest, "{smallest} {largest} in lane {lane}");
        }
    }
    for level in SimdLevel::ALL.into_iter().filter_map(SimdLevel::available) {
        let [forward, backward] =
            [false, true].map(|is_negative| level.dispatch(Loaded(&quantised, is_negative)));
        for axis in 0..3 {
            let [smallest, largest] = forward[axis];
            assert_eq!([largest, smallest], backward[axis], "the other way round");
            let largest = Lanes(largest.0.map(|place| place.min(f32::MAX)));
            let bits = |planes: [Lanes; 2]| planes.map(|planes| planes.0.map(f32::to_bits));
            let expected = bits(decoded.bounds[axis]);
            assert_eq!(bits([smallest, largest]), expected, "{:?}", level.level());
        }
    }
    found.into_iter().map(|(bounds, _)| bounds).collect()
}

/// Coordinates of every size, and such as are next to each other or equal.
fn coordinate() -> impl Strategy<Value = f32> {
    let special = prop::sample::select(vec![
        0.0,
        -0.0,
        1.0,
        1.0f32.next_up(),
        -1e7,
        f32::from_bits(1),
        -f32::from_bits(1),
        f32::MIN_POSITIVE,
        1e-39,
        1e30,
        f32::MAX,
        f32::MAX.next_down(),
        f32::MIN,
    ]);
    let any = any::<u32>().prop_map(f32::from_bits);
    let ordinary = -1000.0f32..1000.0;
    let all = prop_oneof![special, any, ordinary.clone(), ordinary];
    all.prop_filter("finite", |number| number.is_finite())
}

fn any_box() -> impl Strategy<Value = Aabb> {
    prop::array::uniform2(prop::array::uniform3(coordinate()))
        .prop_map(|[a, b]| Aabb::from_points([Vec3::from(a), Vec3::from(b)]))
}

/// Boxes of a few ulps beside each other, at any coordinate.
fn close_boxes() -> impl Strategy<Value = Vec<Aabb>> {
    let near = |place: f32, ulps: i8| {
        let stepped = (0..ulps.unsigned_abs()).fold(place, |place, _| {
            if ulps < 0 {
                place.next_down()
            } else {
                place.next_up()
            }
        });
        stepped.clamp(f32::MIN, f32::MAX)
    };
    let corner = prop::array::uniform3(coordinate());
    let ulps = prop::array::uniform2(prop::array::uniform3(-40i8..40));
    (corner, prop::collection::vec(ulps, 1..=LANES)).prop_map(move |(corner, boxes)| {
        let at = |ulps: [i8; 3]| Vec3::from([0, 1, 2].map(|axis| near(corner[axis], ulps[axis])));
        let boxes = boxes.into_iter();
        boxes
            .map(|[a, b]| Aabb::from_points([at(a), at(b)]))
            .collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn decoded_boxes_contain_any_boxes(boxes in prop::collection::vec(any_box(), 1..=LANES)) {
        check(&boxes);
    }

    #[test]
    fn decoded_boxes_contain_boxes_of_a_few_ulps(boxes in close_boxes()) {
        check(&boxes);
    }

    /// Else a tree of boxes as large as their parents would pass all other tests.
    #[test]
    fn decoded_boxes_of_ordinary_size_are_larger_by_less_than_a_step(
        corners in prop::collection::vec(prop::array::uniform2(prop::array::uniform3(-1000.0f32..1000.0)), 1..=LANES),
    ) {
        let boxes: Vec<Aabb> = corners
            .into_iter()
            .map(|corners| Aabb::from_points(corners.map(Vec3::from)))
            .collect();
        let all = boxes.iter().copied().fold(Aabb::EMPTY, Aabb::union);
        // 255 steps are not more than twice the way. And what sums are rounded by.
        let step = all.extent() * (2.0 / 255.0) + Vec3::splat(1e-4);
        for (found, bounds) in check(&boxes).into_iter().zip(&boxes) {
            prop_assert!((bounds.min - found.min).cmple(step).all(), "{found:?} {bounds:?}");
            prop_assert!((found.max - bounds.max).cmple(step).all(), "{found:?} {bounds:?}");
        }
    }
}

#[test]
fn what_lies_in_a_plane_or_on_the_grid_is_kept_as_it_is() {
    let flat = Aabb::new(Vec3::new(0.1, -7.0, 3.0), Vec3::new(0.1, 248.0, 3.0));
    let half = Aabb::new(Vec3::new(0.1, -7.0, 3.0), Vec3::new(0.1, 101.0, 3.0));
    assert_eq!(check(&[flat, half]), [flat, half]);
    for place in [0.0, -0.0, 1e-40, -1.5, 1e20, f32::MAX, f32::MIN] {
        let point = Aabb::from_points([Vec3::splat(place)]);
        assert_eq!(check(&[point, point]), [point, point]);
    }
}

#[test]
fn boxes_as_large_as_numbers_are_have_room() {
    let all = Aabb::new(Vec3::splat(f32::MIN), Vec3::splat(f32::MAX));
    let small = Aabb::new(Vec3::ZERO, Vec3::splat(f32::from_bits(1)));
    assert_eq!(check(&[all, small]), [all, all]);
    // Half of that has steps again.
    let half = Aabb::new(Vec3::ZERO, Vec3::splat(3e38));
    let found = check(&[half, small]);
    assert!(found[0].max.max_element() < f32::MAX, "{:?}", found[0]);
    assert!(found[1].max.max_element() < 3e36, "{:?}", found[1]);
}

#[test]
fn a_node_without_children_has_no_box_that_a_ray_enters() {
    assert!(check(&[]).is_empty(), "no children");
}
