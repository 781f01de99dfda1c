use proptest::prelude::*;

use super::*;
use crate::glam::Vec3;

fn square() -> Vec<DVec3> {
    [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)]
        .map(|(x, y)| DVec3::new(x, y, 1.0))
        .to_vec()
}

#[test]
fn a_square_has_its_front_where_it_runs_counter_clockwise() {
    let polygon = Polygon::new(square(), 7).unwrap();
    assert_eq!(polygon.area(), 4.0);
    assert_eq!(polygon.plane().unwrap().normal, DVec3::Z);
    assert_eq!(polygon.aabb(), Aabb::new(Vec3::Z, Vec3::new(2.0, 2.0, 1.0)));
}

#[test]
fn a_collinear_first_corner_does_not_hide_the_plane() {
    let mut vertices = square();
    vertices.insert(1, DVec3::new(1.0, 0.0, 1.0));
    assert_eq!(
        Polygon::new(vertices, 0).unwrap().plane().unwrap().normal,
        DVec3::Z
    );
}

#[test]
fn what_is_wrong_with_a_polygon_is_named() {
    let error = |vertices: Vec<DVec3>| Polygon::new(vertices, 0).unwrap_err();
    assert_eq!(
        error(square()[..2].to_vec()),
        PolygonError::TooFewVertices { count: 2 }
    );

    let mut infinite = square();
    infinite[2].x = f64::INFINITY;
    assert_eq!(error(infinite), PolygonError::NonFiniteVertex { vertex: 2 });

    let line = vec![DVec3::ZERO, DVec3::X, DVec3::X * 2.0];
    assert_eq!(error(line), PolygonError::NoArea);

    let mut bent = square();
    bent[3].z = 1.5;
    assert!(
        matches!(error(bent), PolygonError::NotPlanar { .. }),
        "a bent square"
    );

    let mut concave = square();
    concave[2] = DVec3::new(0.5, 0.5, 1.0);
    assert!(
        matches!(error(concave), PolygonError::NotConvex { .. }),
        "an arrow head"
    );

    let star = (0..5)
        .map(|i| 2.0 * std::f64::consts::TAU * f64::from(i) / 5.0)
        .map(|angle| DVec3::new(angle.cos(), angle.sin(), 0.0))
        .collect();
    assert!(
        matches!(error(star), PolygonError::NotConvex { .. }),
        "a five-pointed star"
    );
}

#[test]
fn splitting_through_two_corners_makes_triangles_without_new_vertices() {
    let plane = Plane::from_point_normal(DVec3::Z, DVec3::new(1.0, -1.0, 0.0)).unwrap();
    let Split::Spanning { front, back } = Polygon::new(square(), 3).unwrap().split(&plane) else {
        panic!("a diagonal splits a square");
    };
    assert_eq!((front.vertices().len(), back.vertices().len()), (3, 3));
    assert_eq!((front.id(), back.id()), (3, 3));
    assert_eq!((front.area(), back.area()), (2.0, 2.0));
}

#[test]
fn touching_is_not_spanning() {
    let plane = Plane::from_point_normal(DVec3::ZERO, DVec3::X).unwrap();
    let polygon = Polygon::new(square(), 0).unwrap();
    assert_eq!(polygon.side_of(&plane), Side::Front);
    assert_eq!(polygon.side_of(&plane.flipped()), Side::Back);
    let own = polygon.plane().unwrap();
    assert!(
        matches!(polygon.split(&own), Split::Coplanar(_)),
        "its own plane"
    );
}

prop_compose! {
    /// A convex polygon: an affine image of points in angular order on the unit circle.
    fn convex_polygon()(
        mut angles in prop::collection::btree_set(0u32..360, 3..9),
        center in coordinates(10.0),
        u in coordinates(3.0),
        v in coordinates(3.0),
    ) -> Vec<DVec3> {
        if angles.len() < 3 {
            angles.extend([0, 120, 240]);
        }
        angles
            .into_iter()
            .map(|angle| f64::from(angle).to_radians())
            .map(|angle| center + u * angle.cos() + v * angle.sin())
            .collect()
    }
}

fn coordinates(size: f64) -> impl Strategy<Value = DVec3> {
    (-size..size, -size..size, -size..size).prop_map(DVec3::from)
}

#[test]
fn a_polygon_whose_outline_seems_to_meet_a_plane_three_times_is_coplanar() {
    // Found by cutting a square in this plane by planes through a line: the distances are roundings, with the signs back, on, on, front and back.
    // Cut there, the parts overlapped, and together had more area than the whole.
    let sliced = Polygon::new(
        vec![
            DVec3::new(4.996_003_610_813_204e-15, -1.0, 0.200_000_000_000_001_4),
            DVec3::new(1.0, -1.0, 0.5),
            DVec3::new(1.0, 1.0, 0.099_999_999_999_999_98),
            DVec3::new(0.019_417_475_728_155_33, 1.0, -0.194_174_757_281_553_53),
            DVec3::new(
                4.996_003_610_813_204e-15,
                2.566_835_632_933_362e-13,
                -4.996_003_610_813_204e-14,
            ),
        ],
        3,
    )
    .unwrap();
    let plane = Plane::from_point_normal(DVec3::ZERO, DVec3::new(-0.3, 0.2 + 1e-15, 1.0)).unwrap();
    assert_eq!(sliced.side_of(&plane), Side::Spanning);
    assert_eq!(sliced.clone().split(&plane), Split::Coplanar(sliced));
}

proptest! {
    #[test]
    fn splitting_keeps_area_plane_winding_and_id(
        vertices in convex_polygon(),
        through in coordinates(10.0),
        normal in coordinates(1.0),
    ) {
        let Ok(polygon) = Polygon::new(vertices, 42) else { return Ok(()) };
        let Some(plane) = Plane::from_point_normal(through, normal) else { return Ok(()) };
        let original = polygon.clone();
        let (front, back) = match polygon.split(&plane) {
            Split::Front(part) | Split::Back(part) | Split::Coplanar(part) => {
                prop_assert_eq!(part, original);
                return Ok(());
            }
            Split::Spanning { front, back } => (front, back),
        };
        let scale = original.largest_coordinate();
        prop_assert!((front.area() + back.area() - original.area()).abs() <= 1e-13 * scale * scale);
        prop_assert!(front.vertices().iter().all(|p| plane.signed_distance(*p) >= -1e-13 * scale));
        prop_assert!(back.vertices().iter().all(|p| plane.signed_distance(*p) <= 1e-13 * scale));
        let own = original.plane().unwrap();
        for part in [&front, &back] {
            prop_assert_eq!(part.id(), 42);
            prop_assert!(part.vertices().iter().all(|p| own.signed_distance(*p).abs() <= 1e-12 * scale));
            // The winding: the part's area vector points where the original's does.
            prop_assert!(part.scaled_normal().dot(own.normal) >= -1e-13 * scale * scale);
        }
    }

    #[test]
    fn neighbours_get_the_same_vertex_on_a_shared_edge(
        points in prop::array::uniform4(coordinates(10.0)),
        normal in coordinates(1.0),
    ) {
        let [a, b, c, d] = points;
        let Some(plane) = Plane::from_point_normal(DVec3::ZERO, normal) else { return Ok(()) };
        let (Ok(left), Ok(right)) = (Polygon::new(vec![a, b, c], 0), Polygon::new(vec![b, a, d], 1)) else {
            return Ok(());
        };
        let (Split::Spanning { front: left, .. }, Split::Spanning { front: right, .. }) =
            (left.split(&plane), right.split(&plane))
        else {
            return Ok(());
        };
        let edge_is_cut = plane.side_of_points([a, b]) == Side::Spanning;
        let shared = left.vertices().iter().filter(|p| right.vertices().contains(p)).count();
        prop_assert!(!edge_is_cut || shared == 2, "one corner and the crossing of the edge");
    }
}

/// The cuts before the last one leave two vertices at (0, 0, 2), a rounding apart: seen from the plane at z = 2 that is one point of the outline.
#[test]
fn a_polygon_with_two_vertices_for_one_is_cut() {
    let corners = [[3.0, -2.0, 1.0], [0.0, 1.0, 0.0], [-3.0, 2.0, 3.0]].map(Vec3::from);
    let triangle = Triangle::new(corners[0], corners[1], corners[2]);
    let mut polygon = Polygon::from_triangle(&triangle, 0).expect("it has an area");
    let cuts = [
        (DVec3::X, -1.0),
        (DVec3::NEG_X, 0.0),
        (DVec3::Y, 0.0),
        (DVec3::NEG_Z, 2.0),
    ];
    for (inwards, place) in cuts {
        let plane = Plane::from_point_normal(inwards.abs() * place, inwards).expect("a normal");
        match polygon.split(&plane) {
            Split::Spanning { front, .. } => polygon = front,
            other => panic!("{inwards}: {other:?}"),
        }
    }
    let top = polygon.vertices().iter().map(|vertex| vertex.z);
    assert!(top.fold(0.0, f64::max) <= 2.0, "{polygon:?}");
}
