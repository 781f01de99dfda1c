//! The hard cases, asked of trees with both treatments of straddlers, and what splitting polygons has to keep.

use tahko_bsp::{BspOptions, BspTree, Splitter, SplittingPlanes, Straddlers};
use tahko_geometry::glam::{DVec3, Vec3, dvec3, vec3};
use tahko_geometry::test_support::hard_cases::{
    Structure, check_cost_of_a_stadium, check_many_duplicates,
};
use tahko_geometry::test_support::soup;
use tahko_geometry::{Plane, Polygon, Precision, Ray, RayQuery, Split, hard_case_tests};

fn structure(name: &str, options: BspOptions) -> Structure {
    Structure::new(format!("bsp, {name}"), move |mesh, precision: Precision| {
        let options = options.clone().with_precision(precision);
        BspTree::build(mesh, &options).expect("options in range")
    })
}

/// Single triangles in the leaves, by the planes of polygons only.
fn classic(splitter: Splitter, straddlers: Straddlers) -> BspOptions {
    BspOptions::fast()
        .with_splitter(splitter)
        .with_straddlers(straddlers)
        .with_planes(SplittingPlanes::Polygons)
        .with_max_leaf_size(1)
        .with_max_depth(BspOptions::MAX_DEPTH)
}

fn structures() -> Vec<Structure> {
    let both = Straddlers::ListInBoth;
    vec![
        structure("balanced", BspOptions::balanced()),
        structure(
            "balanced, listed in both",
            BspOptions::balanced().with_straddlers(both),
        ),
        structure("high quality", BspOptions::high_quality()),
        structure("first plane", classic(Splitter::First, Straddlers::Split)),
        structure(
            "fewest splits, listed in both",
            classic(Splitter::FewestSplits, both),
        ),
    ]
}

hard_case_tests!(structures);

#[test]
fn a_hundred_thousand_duplicates_are_told_apart() {
    check_many_duplicates(&structures());
}

#[test]
fn a_large_floor_does_not_make_a_small_object_dear() {
    check_cost_of_a_stadium(&[structure("balanced", BspOptions::balanced())]);
}

#[test]
fn stacked_triangles_make_a_tree_deeper_than_a_hundred() {
    // The plane of the first triangle has all others on one side, and so on.
    let at = |z: u8| [Vec3::ZERO, Vec3::X, Vec3::Y].map(|corner| corner + f32::from(z) * Vec3::Z);
    let options = classic(Splitter::First, Straddlers::Split);
    let tree =
        BspTree::build(&soup((0..120).map(at).collect()), &options).expect("options in range");
    assert_eq!(tree.depth(), 120);
    assert_eq!(tree.validate(), Ok(()));
    for z in [0.0f32, 60.0, 119.0] {
        let hit = tree.closest_hit(&Ray::new(vec3(0.25, 0.25, z + 0.5), Vec3::NEG_Z));
        assert_eq!(hit.map(|hit| hit.t), Some(0.5), "from above {z}");
    }
}

/// All parts of a polygon that is cut by planes one after the other.
fn cut(polygon: Polygon, planes: &[Plane]) -> Vec<Polygon> {
    planes.iter().fold(vec![polygon], |parts, plane| {
        let split = |part: Polygon| match part.split(plane) {
            Split::Front(part) | Split::Back(part) | Split::Coplanar(part) => vec![part],
            Split::Spanning { front, back } => vec![front, back],
        };
        parts.into_iter().flat_map(split).collect()
    })
}

/// Cases 39 to 41: nearly parallel planes, planes through one line, and planes that graze it cut a square into parts that stay in its plane, are
/// convex, and have its area together, up to a few roundings of coordinates of size 1.
#[test]
fn parts_cut_by_nearly_coplanar_planes_stay_flat_and_convex_and_lose_no_area() {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
        .map(|(x, y)| dvec3(x, y, 0.3 * x - 0.2 * y));
    let square = Polygon::new(corners.to_vec(), 7).expect("a square");
    let plane_of_square = square.plane().expect("a square has a plane");
    let plane =
        |point: DVec3, normal: DVec3| Plane::from_point_normal(point, normal).expect("not zero");
    for tilt in [1e-3, 1e-6, 1e-9, 1e-12, 1e-15] {
        let parallel = (0..6u8).map(|step| plane(DVec3::X * tilt * f64::from(step), DVec3::X));
        let fan = (0..6u8).map(|step| plane(DVec3::ZERO, dvec3(1.0, tilt * f64::from(step), 0.1)));
        let grazing =
            (1..4u8).map(|step| plane(DVec3::ZERO, dvec3(-0.3, 0.2 + tilt * f64::from(step), 1.0)));
        let planes: Vec<Plane> = parallel.chain(fan).chain(grazing).collect();
        let parts = cut(square.clone(), &planes);
        assert!(parts.len() > 1, "the planes cut the square");
        let roundings = 16.0 * f64::EPSILON;
        let area: f64 = parts.iter().map(Polygon::area).sum();
        assert!(
            (area - square.area()).abs() <= roundings * parts.len() as f64,
            "tilt {tilt}: {area}"
        );
        for part in parts {
            assert_eq!(part.id(), 7);
            let vertices = part.vertices();
            for (index, vertex) in vertices.iter().enumerate() {
                let [next, after] =
                    [1, 2].map(|step| vertices[(index + step) % vertices.len()] - *vertex);
                assert!(
                    plane_of_square.signed_distance(*vertex).abs() <= roundings,
                    "tilt {tilt}: {part:?}"
                );
                assert!(
                    plane_of_square.normal.dot(next.cross(after)) >= -roundings,
                    "tilt {tilt}: {part:?}"
                );
            }
        }
    }
}
