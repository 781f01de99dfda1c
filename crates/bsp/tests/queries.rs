//! Queries: the answers of brute force, bit for bit.

mod common;

use common::{all_options, build};
use proptest::prelude::*;
use tahko_bsp::{BspOptions, SplittingPlanes};
use tahko_geometry::test_support::{
    BruteForceAnswers, assert_answers_like_brute_force, degenerate_meshes, invalid_rays, mesh, ray,
    rays_along_axes, rays_at_features, soup,
};
use tahko_geometry::{Precision, QueryCounts, Ray, RayQuery, RungCounts, glam::Vec3};

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn all_trees_answer_like_brute_force(
        mesh in mesh(),
        rays in prop::collection::vec(ray(), 1..20),
        seed in any::<u64>(),
    ) {
        for options in all_options() {
            for precision in Precision::ALL {
                let options = options.clone().with_precision(precision).with_seed(seed);
                let tree = build(&mesh, &options);
                prop_assert_eq!(tree.validate(), Ok(()), "{:?}", options);
                assert_answers_like_brute_force(&options, &tree, &mesh, precision, &rays);
            }
        }
    }

    #[test]
    fn rays_at_vertices_edges_and_centroids_find_what_brute_force_finds(mesh in mesh()) {
        let rays = rays_at_features(&mesh);
        for precision in Precision::ALL {
            let options = BspOptions::high_quality().with_precision(precision);
            assert_answers_like_brute_force(&options, &build(&mesh, &options), &mesh, precision, &rays);
        }
    }

    #[test]
    fn rays_in_splitting_planes_find_what_brute_force_finds(
        mesh in mesh(),
        weights in prop::collection::vec((0usize..60, prop::array::uniform4(-2i8..=2)), 1..10),
    ) {
        // From and to integer combinations of a triangle's corners: in its plane, up to rounding.
        prop_assume!(!mesh.is_empty());
        let rays: Vec<Ray> = weights
            .into_iter()
            .map(|(index, weights)| {
                let triangle = mesh.triangle(index % mesh.len());
                let [u, v, p, q] = weights.map(f32::from);
                let (along, across) = (triangle.b - triangle.a, triangle.c - triangle.a);
                Ray::new(triangle.a + u * along + v * across, p * along + q * across)
            })
            .collect();
        for planes in [SplittingPlanes::Polygons, SplittingPlanes::PolygonsEdgesAndAxes] {
            let options = BspOptions::high_quality().with_planes(planes);
            let tree = build(&mesh, &options);
            assert_answers_like_brute_force(&options, &tree, &mesh, options.precision, &rays);
        }
    }

    #[test]
    fn meshes_far_from_the_origin_lose_no_hit(mesh in mesh(), rays in prop::collection::vec(ray(), 1..20)) {
        for scale in [1.0, 1e3, 1e-4] {
            let offset = Vec3::new(1e6, -3e5, 1e6);
            let vertices = mesh.vertices().iter().map(|vertex| scale * *vertex + offset).collect();
            let moved = tahko_geometry::TriangleMesh::new(vertices, mesh.indices().to_vec())
                .expect("finite vertices");
            let mut all = rays_at_features(&moved);
            all.extend(rays.iter().map(|ray| Ray { origin: scale * ray.origin + offset, ..*ray }));
            for options in [BspOptions::high_quality(), BspOptions::fast().with_max_leaf_size(1)] {
                let tree = build(&moved, &options);
                assert_answers_like_brute_force(&options, &tree, &moved, options.precision, &all);
            }
        }
    }
}

#[test]
fn degenerate_meshes_are_answered_like_brute_force() {
    for (name, mesh) in degenerate_meshes() {
        let mut rays = rays_at_features(&mesh);
        rays.extend(rays_along_axes(&mesh));
        // Enough of each kind for the larger meshes too.
        let step = rays.len().div_ceil(500).max(1);
        let rays: Vec<Ray> = rays.into_iter().step_by(step).collect();
        for precision in Precision::ALL {
            let answers = BruteForceAnswers::new(&mesh, precision, &rays);
            for options in all_options() {
                let options = options.with_precision(precision);
                let tree = build(&mesh, &options);
                assert_eq!(tree.validate(), Ok(()), "{name}, {options:?}");
                answers.assert_equal((name, &options), &tree);
            }
        }
    }
}

#[test]
fn of_equal_triangles_the_first_is_hit() {
    let mesh = soup(vec![[Vec3::ZERO, Vec3::X, Vec3::Y]; 1000]);
    let tree = build(&mesh, &BspOptions::default());
    let ray = Ray::new(Vec3::new(0.25, 0.25, 1.0), Vec3::NEG_Z);
    assert_eq!(tree.closest_hit(&ray).map(|hit| hit.primitive), Some(0));
}

#[test]
fn rays_that_are_not_valid_hit_nothing_and_visit_nothing() {
    let tree = build(
        &soup(vec![[Vec3::ZERO, Vec3::X, Vec3::Y]; 9]),
        &BspOptions::default(),
    );
    let good = Ray::new(Vec3::new(0.25, 0.25, 1.0), Vec3::NEG_Z);
    assert!(tree.any_hit(&good), "the valid ray hits");
    let mut counts = QueryCounts::default();
    for bad in invalid_rays(good) {
        assert_eq!(tree.closest_hit_counted(&bad, &mut counts), None, "{bad:?}");
        assert!(!tree.any_hit_counted(&bad, &mut counts), "{bad:?}");
    }
    assert_eq!(counts, QueryCounts::default());
}

#[test]
fn counts_tell_what_a_traversal_did() {
    let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let stacked = (0..63u8).map(|i| triangle.map(|corner| corner + Vec3::Z * f32::from(i)));
    let options = BspOptions::fast()
        .with_splitter(tahko_bsp::Splitter::MostBalanced)
        .with_planes(SplittingPlanes::Polygons)
        .with_candidates(tahko_bsp::Candidates::All)
        .with_max_leaf_size(1);
    let tree = build(&soup(stacked.collect()), &options);
    // Halving 63: each triangle is in the plane of a node of its own, or in a leaf.
    assert_eq!(tree.depth(), 6);
    let mut counts = QueryCounts::default();
    let down = Ray::new(Vec3::new(0.25, 0.25, 100.0), Vec3::NEG_Z);
    let hit = tree.closest_hit_counted(&down, &mut counts);
    assert_eq!(hit.map(|hit| hit.primitive), Some(62));
    // Straight down to the topmost triangle: five planes, a leaf, all else is behind the hit.
    let expected = QueryCounts {
        node_visits: 6,
        bound_tests: 6,
        triangle_tests: 1,
        rungs: RungCounts {
            f32: 0,
            f64: 1,
            exact: 0,
        },
        orders: RungCounts::default(),
    };
    assert_eq!(counts, expected);
}
