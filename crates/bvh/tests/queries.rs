//! Queries answer like brute force, bit for bit.

use proptest::prelude::*;
use tahko_bvh::{Bvh, BvhOptions, NodeFormat};
use tahko_geometry::simd::SimdLevel;
use tahko_geometry::test_support::hard_cases::nested_triangles;
use tahko_geometry::test_support::{
    BruteForceAnswers, degenerate_meshes, invalid_rays, mesh, ray, rays_along_axes,
    rays_at_features,
};
use tahko_geometry::{Precision, QueryCounts, Ray, RayQuery, RungCounts, TriangleMesh, glam::Vec3};

/// The presets, and options that lead to the deepest and the flattest trees.
fn all_options() -> Vec<(&'static str, BvhOptions)> {
    vec![
        ("fast", BvhOptions::fast()),
        ("balanced", BvhOptions::balanced()),
        ("high quality", BvhOptions::high_quality()),
        (
            "two bins, single triangles",
            BvhOptions::fast().with_bins(2).with_max_leaf_size(1),
        ),
        (
            "sweep only, single triangles",
            BvhOptions::high_quality()
                .with_sweep_size(256)
                .with_max_leaf_size(1),
        ),
        (
            "spatial splits, single triangles",
            BvhOptions::balanced()
                .with_spatial_split_budget(2.0)
                .with_max_leaf_size(1),
        ),
        (
            "two bins, reinsertion",
            BvhOptions::fast()
                .with_bins(2)
                .with_max_leaf_size(1)
                .with_reinsertion_rounds(10),
        ),
        (
            "large leaves",
            BvhOptions::balanced()
                .with_costs(50.0, 1.0)
                .with_max_leaf_size(20),
        ),
    ]
}

/// The same options with every format of nodes.
fn in_all_formats(options: &BvhOptions) -> impl Iterator<Item = BvhOptions> + '_ {
    let formats = NodeFormat::ALL.into_iter();
    formats.map(|format| options.clone().with_node_format(format))
}

/// The tree at every level of instructions that this processor has.
fn at_all_levels(bvh: &Bvh) -> impl Iterator<Item = (SimdLevel, Bvh)> + '_ {
    let levels = SimdLevel::ALL.into_iter();
    levels.filter_map(|level| Some((level, bvh.clone().with_simd(level)?)))
}

fn check(name: &str, mesh: &TriangleMesh, rays: &[Ray]) {
    for precision in Precision::ALL {
        let answers = BruteForceAnswers::new(mesh, precision, rays);
        for (options_name, options) in all_options() {
            check_options(
                (name, options_name),
                mesh,
                &answers,
                &options.with_precision(precision),
            );
        }
    }
}

fn check_one(
    name: &str,
    mesh: &TriangleMesh,
    rays: &[Ray],
    (options_name, options): &(&'static str, BvhOptions),
) {
    for precision in Precision::ALL {
        let answers = BruteForceAnswers::new(mesh, precision, rays);
        let options = options.clone().with_precision(precision);
        check_options((name, options_name), mesh, &answers, &options);
    }
}

fn check_options(
    names: (&str, &str),
    mesh: &TriangleMesh,
    answers: &BruteForceAnswers<'_>,
    options: &BvhOptions,
) {
    for options in in_all_formats(options) {
        let format = options.node_format;
        let bvh = Bvh::build(mesh, &options).expect("options in range");
        assert_eq!(bvh.validate(), Ok(()), "{names:?}, {format:?}");
        for (level, bvh) in at_all_levels(&bvh) {
            answers.assert_equal((names, format, level), &bvh);
        }
    }
}

proptest! {
    #[test]
    fn random_queries_answer_like_brute_force(
        mesh in mesh(),
        options in prop::sample::select(all_options()),
        rays in prop::collection::vec(ray(), 1..20),
    ) {
        check_one("random", &mesh, &rays, &options);
    }

    #[test]
    fn rays_at_edges_and_vertices_answer_like_brute_force(
        mesh in mesh(),
        options in prop::sample::select(all_options()),
        start in any::<prop::sample::Index>(),
    ) {
        let rays = rays_at_features(&mesh);
        let start = if rays.is_empty() { 0 } else { start.index(rays.len()) };
        let rays: Vec<Ray> = rays.into_iter().skip(start).take(200).collect();
        check_one("features", &mesh, &rays, &options);
    }
}

/// Many small triangles and a few that reach across them, all on a grid, so that splitting planes pass through vertices.
fn long_among_small() -> impl Strategy<Value = TriangleMesh> {
    let corner = |size: i16| prop::array::uniform3(-size..=size).prop_map(grid_point);
    let triangles = move |along: i16, across: i16, count| {
        let triangle = (corner(64), corner(along), corner(across))
            .prop_map(|(start, along, across)| [start, start + along, start + across]);
        prop::collection::vec(triangle, count)
    };
    (triangles(2, 2, 100..250), triangles(96, 4, 4..16))
        .prop_map(|(small, long)| tahko_geometry::test_support::soup([small, long].concat()))
}

fn grid_point(coordinates: [i16; 3]) -> Vec3 {
    Vec3::from(coordinates.map(f32::from)) / 16.0
}

proptest! {
    // Few are rejected: nearly all such meshes have triangles that are worth a split.
    #![proptest_config(ProptestConfig { max_global_rejects: 32, ..ProptestConfig::with_cases(32) })]

    #[test]
    fn triangles_in_several_leaves_answer_like_brute_force(
        mesh in long_among_small(),
        budget in 1.1f64..2.0,
        start in any::<prop::sample::Index>(),
        mut rays in prop::collection::vec(ray(), 20),
    ) {
        let features = rays_at_features(&mesh);
        let start = start.index(features.len());
        rays.extend(features.into_iter().skip(start).take(100));
        let options = BvhOptions::high_quality().with_spatial_split_budget(budget);
        let bvh = Bvh::build(&mesh, &options).expect("options in range");
        prop_assume!(bvh.statistics().references > mesh.len(), "no spatial split");
        check_one("long triangles", &mesh, &rays, &("high quality", options));
    }
}

#[test]
fn degenerate_meshes_build_and_answer_like_brute_force() {
    for (name, mesh) in degenerate_meshes() {
        let mut rays = rays_at_features(&mesh);
        rays.extend(rays_along_axes(&mesh));
        // Some of the meshes have thousands of features that differ in nothing.
        let step = rays.len().div_ceil(250).max(1);
        let rays: Vec<Ray> = rays.into_iter().step_by(step).collect();
        check(name, &mesh, &rays);
    }
}

#[test]
fn a_grid_of_boxes_touched_at_their_faces_answers_like_brute_force() {
    // Every box of the tree has faces on grid planes, and so has every ray.
    let squares = (0..4u8).flat_map(|x| (0..4u8).map(move |y| (f32::from(x), f32::from(y))));
    let corners = squares.flat_map(|(x, y)| {
        let at = |dx: f32, dy: f32| Vec3::new(x + dx, y + dy, (x * y) % 3.0);
        [
            [at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0)],
            [at(0.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)],
        ]
    });
    let mesh = tahko_geometry::test_support::soup(corners.collect());
    check("grid", &mesh, &rays_along_axes(&mesh));
    check("grid", &mesh, &rays_at_features(&mesh));
}

#[test]
fn of_equal_triangles_the_first_one_is_hit_in_whatever_leaf_it_is() {
    let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let mesh = tahko_geometry::test_support::soup(vec![triangle; 1000]);
    let bvh = Bvh::build(&mesh, &BvhOptions::default()).expect("options in range");
    let ray = Ray::new(Vec3::new(0.25, 0.25, 1.0), Vec3::NEG_Z);
    assert_eq!(bvh.closest_hit(&ray).map(|hit| hit.primitive), Some(0));
}

#[test]
fn rays_that_are_not_valid_hit_nothing_and_visit_nothing() {
    let mesh = tahko_geometry::test_support::soup(vec![[Vec3::ZERO, Vec3::X, Vec3::Y]; 9]);
    let bvh = Bvh::build(&mesh, &BvhOptions::default()).expect("options in range");
    let good = Ray::new(Vec3::new(0.25, 0.25, 1.0), Vec3::NEG_Z);
    assert!(bvh.any_hit(&good), "the valid ray hits");
    let mut counts = QueryCounts::default();
    for bad in invalid_rays(good) {
        assert_eq!(bvh.closest_hit_counted(&bad, &mut counts), None, "{bad:?}");
        assert!(!bvh.any_hit_counted(&bad, &mut counts), "{bad:?}");
    }
    assert_eq!(counts, QueryCounts::default());
}

#[test]
fn counts_tell_what_a_traversal_did() {
    let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let stacked = (0..64u8).map(|i| triangle.map(|corner| corner + Vec3::Z * f32::from(i)));
    let mesh = tahko_geometry::test_support::soup(stacked.collect());
    let options = BvhOptions::default().with_max_leaf_size(1);
    let bvh = Bvh::build(&mesh, &options).expect("options in range");
    assert_eq!((bvh.depth(), bvh.node_count()), (3, 64 + 9));
    let down = Ray::new(Vec3::new(0.25, 0.25, 100.0), Vec3::NEG_Z);
    // Straight down to the topmost triangle: the nearer child first, all others skipped.
    let expected = QueryCounts {
        node_visits: 3,
        bound_tests: 16,
        triangle_tests: 1,
        rungs: RungCounts {
            f32: 0,
            f64: 1,
            exact: 0,
        },
        orders: RungCounts::default(),
    };
    for (level, bvh) in at_all_levels(&bvh) {
        let mut counts = QueryCounts::default();
        let hit = bvh.closest_hit_counted(&down, &mut counts);
        assert_eq!(hit.map(|hit| hit.primitive), Some(63), "{level:?}");
        assert_eq!(counts, expected, "{level:?}");
    }
}

/// Boxes are tested with fused operations where the level has them. What their rounding changes is at the edges of boxes: answers are the
/// same, and of visits hardly any is of another node.
#[test]
fn all_levels_visit_the_same_nodes() {
    let point = |i: u32, factor: u32| (i.wrapping_mul(factor) % 8191) as f32 / 8191.0;
    let points = |i: u32| Vec3::new(point(i, 48_271), point(i, 69_621), point(i, 16_807));
    let triangles = (0..3000).map(|i| {
        let corner = points(i);
        [corner, corner + 0.02 * Vec3::X, corner + 0.03 * Vec3::ONE]
    });
    let mesh = tahko_geometry::test_support::soup(triangles.collect());
    let rays: Vec<Ray> = (0..5000)
        .map(|i| Ray::new(points(i + 3000), points(i + 8000) - 0.5))
        .collect();
    let bvh = Bvh::build(&mesh, &BvhOptions::default()).expect("options in range");
    let visits = |bvh: &Bvh| {
        let mut counts = QueryCounts::default();
        for ray in &rays {
            bvh.closest_hit_counted(ray, &mut counts);
            bvh.any_hit_counted(ray, &mut counts);
        }
        counts.node_visits
    };
    let expected = visits(&bvh);
    assert!(expected > 30_000, "{expected} visits");
    for (level, bvh) in at_all_levels(&bvh) {
        let visits = visits(&bvh);
        let difference = visits.abs_diff(expected);
        assert!(
            difference * 10_000 <= expected,
            "{level:?}: {visits}, {expected}"
        );
    }
}

#[test]
fn where_nothing_can_be_culled_the_stack_has_room_for_all_lanes() {
    // A tree deeper than its size asks for, and directions so short that no box is culled, unused lanes included.
    let mesh = nested_triangles();
    let options = BvhOptions::balanced().with_bins(2).with_max_leaf_size(1);
    let bvh = Bvh::build(&mesh, &options).expect("options in range");
    assert!(bvh.depth() > 10, "{}", bvh.depth());
    let directions = [1e-30, -1e-30].map(|length| Vec3::new(length, 0.5 * length, length));
    let rays = directions.map(|direction| Ray::new(Vec3::splat(0.1), direction));
    let answers = BruteForceAnswers::new(&mesh, Precision::Exact, &rays);
    answers.assert_equal("deep", &bvh);
}
