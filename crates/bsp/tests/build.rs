//! Builds: determinism, limits, statistics, options.

mod common;

use common::{SPLITTERS, all_options, build};
use proptest::prelude::*;
use tahko_bsp::{
    BspOptions, BspTree, BuildError, Candidates, Splitter, SplittingPlanes, Straddlers,
};
use tahko_geometry::test_support::{degenerate_meshes, mesh, soup};
use tahko_geometry::{Precision, TriangleMesh, glam::Vec3};

/// Triangles at places that a linear congruential generator picks: the same on every machine.
fn scattered(count: usize, size: f32) -> TriangleMesh {
    let mut state = 1u32;
    let mut random = move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f32::from((state >> 16) as u16) / 65536.0
    };
    let triangles = (0..count).map(|_| {
        let mut point = || Vec3::new(random(), random(), random());
        let corner = point();
        [corner, corner + size * point(), corner + size * point()]
    });
    soup(triangles.collect())
}

#[test]
fn the_tree_is_the_same_for_every_number_of_threads() {
    // Enough triangles for subtrees and candidates to be shared among tasks.
    let mesh = scattered(4000, 0.05);
    let mut all = vec![BspOptions::balanced()];
    all.extend(SPLITTERS.map(|splitter| BspOptions::fast().with_splitter(splitter)));
    for options in all {
        let trees = [1, 2, 4].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.expect("threads can be started")
                .install(|| build(&mesh, &options))
        });
        assert_eq!(trees[0].validate(), Ok(()), "{options:?}");
        assert!(trees[0] == trees[1], "2 threads, {options:?}");
        assert!(trees[0] == trees[2], "4 threads, {options:?}");
    }
}

#[test]
fn candidates_ranked_by_a_part_of_the_polygons_are_nearly_as_good() {
    // 3000 candidates times 3000 polygons are too many to count; 1000 times 1000 are not.
    let cost = |count: usize, candidates| {
        let options = BspOptions::balanced()
            .with_planes(SplittingPlanes::Polygons)
            .with_candidates(candidates);
        let tree = build(&scattered(count, 0.05), &options);
        assert_eq!(tree.validate(), Ok(()));
        tree.statistics().sah_cost
    };
    for count in [1000, 3000] {
        let (all, few) = (
            cost(count, Candidates::All),
            cost(count, Candidates::Sample(4)),
        );
        assert!(
            all < few,
            "{count} triangles: {all} with all, {few} with four"
        );
    }
}

#[test]
fn seeds_choose_different_trees() {
    let mesh = scattered(500, 0.1);
    let tree = |seed| build(&mesh, &BspOptions::fast().with_seed(seed));
    assert!(tree(1) == tree(1), "the same seed");
    assert!(tree(1) != tree(2), "different seeds");
}

#[test]
fn growth_stays_within_the_budget() {
    // Large triangles through each other: BSP trees of them grow with the square of their number or faster.
    let mesh = scattered(300, 2.0);
    let unlimited = BspOptions::fast()
        .with_planes(SplittingPlanes::Polygons)
        .with_splitter(Splitter::Random)
        .with_candidates(Candidates::Sample(4))
        .with_max_growth(1000.0)
        .with_max_leaf_size(1);
    for splitter in SPLITTERS {
        for straddlers in [Straddlers::Split, Straddlers::ListInBoth] {
            for growth in [1.0, 2.5] {
                let options = unlimited
                    .clone()
                    .with_splitter(splitter)
                    .with_straddlers(straddlers);
                let tree = build(&mesh, &options.with_max_growth(growth));
                let references = tree.statistics().references_per_primitive();
                assert!(
                    references <= growth,
                    "{splitter:?} {straddlers:?}: {references}"
                );
            }
        }
    }
    let references = build(&mesh, &unlimited)
        .statistics()
        .references_per_primitive();
    assert!(references > 10.0, "{references} without a budget");
}

#[test]
fn the_depth_limit_ends_a_build_that_gets_nowhere() {
    // Around a sphere, every polygon has all others behind it.
    let point = |i: u16, j: u16| {
        let (a, b) = (f32::from(i) * 0.31, f32::from(j) * 0.157);
        Vec3::new(a.cos() * b.sin(), a.sin() * b.sin(), b.cos())
    };
    let squares = (0..20).flat_map(|i| (0..20).map(move |j| (i, j)));
    let triangles = squares.map(|(i, j)| [point(i, j), point(i, j + 1), point(i + 1, j + 1)]);
    let mesh = soup(triangles.collect());
    let options = BspOptions::balanced().with_max_depth(10);
    for splitter in SPLITTERS {
        let options = options.clone().with_splitter(splitter);
        let classic = build(
            &mesh,
            &options.clone().with_planes(SplittingPlanes::Polygons),
        );
        assert!(classic.depth() <= 11, "{splitter:?}: {}", classic.depth());
        assert_eq!(classic.validate(), Ok(()));
    }
    let largest_leaf = |planes| {
        let options = options
            .clone()
            .with_splitter(Splitter::MostBalanced)
            .with_planes(planes);
        build(&mesh, &options).bsp_statistics().largest_leaf
    };
    assert!(
        largest_leaf(SplittingPlanes::Polygons) > 300,
        "one off at a time"
    );
    assert!(
        largest_leaf(SplittingPlanes::PolygonsEdgesAndAxes) < 30,
        "axis planes halve it"
    );
}

#[test]
fn limits_of_zero_make_a_single_leaf() {
    let mesh = scattered(50, 0.1);
    let tree = build(&mesh, &BspOptions::default().with_max_depth(0));
    let statistics = tree.statistics();
    assert_eq!(
        (statistics.nodes, statistics.leaves, tree.depth()),
        (1, 1, 1)
    );
    assert_eq!((statistics.references, statistics.sah_cost), (50, 50.0));
}

#[test]
fn statistics_of_two_rooms_are_those_of_one_plane() {
    // A wall between two triangles, and one triangle through the wall.
    let wall = [Vec3::ZERO, Vec3::Y * 4.0, Vec3::Z * 4.0];
    let beside = |x: f32| [Vec3::X, Vec3::Y, Vec3::Z].map(|corner| corner + Vec3::X * x);
    let through = [
        Vec3::new(-1.0, 2.0, 0.0),
        Vec3::new(1.0, 2.0, 0.0),
        Vec3::new(0.0, 2.0, 1.0),
    ];
    let mesh = soup(vec![wall, beside(1.0), beside(-3.0), through]);
    let options = BspOptions::balanced()
        .with_splitter(Splitter::First)
        .with_max_leaf_size(2);
    for (straddlers, fragments) in [(Straddlers::Split, 2), (Straddlers::ListInBoth, 0)] {
        let tree = build(&mesh, &options.clone().with_straddlers(straddlers));
        let statistics = tree.statistics();
        assert_eq!((statistics.nodes, statistics.leaves), (4, 3));
        assert_eq!((statistics.references, statistics.empty_leaves), (5, 0));
        let special = tree.bsp_statistics();
        assert_eq!((special.straddlers, special.fragments), (1, fragments));
        assert_eq!((special.coplanar, special.axis_planes), (1, 1));
        assert_eq!((special.large_leaves, special.largest_leaf), (0, 2));
        // The bounds are 5 x 4 x 4, cut 3 : 2 by the wall: 1 plane, 2 triangles on each side, 1 in the cut.
        let visits = statistics.expected_visits;
        let leaves = (80.0 + 64.0 + 32.0) / 112.0;
        let tests = (2.0 * 80.0 + 2.0 * 64.0 + 1.0 * 32.0) / 112.0;
        for (found, expected) in [
            (visits.inner_nodes, 1.0),
            (visits.leaves, leaves),
            (visits.triangle_tests, tests),
            (statistics.sah_cost, options.traversal_cost + tests),
        ] {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }
}

/// Triangles with area: those that a tree must list.
fn hittable(mesh: &TriangleMesh) -> usize {
    mesh.triangles()
        .filter(|triangle| !triangle.is_degenerate())
        .count()
}

#[test]
fn every_triangle_with_area_is_listed() {
    for (name, mesh) in degenerate_meshes() {
        for options in all_options() {
            let tree = build(&mesh, &options);
            let statistics = tree.statistics();
            assert_eq!(statistics.primitives, mesh.len(), "{name}, {options:?}");
            assert!(
                statistics.references >= hittable(&mesh),
                "{name}, {options:?}"
            );
            assert!(statistics.sah_cost.is_finite(), "{name}, {options:?}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(50))]

    #[test]
    fn statistics_add_up(mesh in mesh()) {
        for options in all_options() {
            let tree = build(&mesh, &options);
            let statistics = tree.statistics();
            let special = tree.bsp_statistics();
            prop_assert_eq!(statistics.nodes, tree.node_count());
            prop_assert!(statistics.nodes < 2 * statistics.leaves);
            prop_assert_eq!(statistics.depth, tree.depth());
            // Each straddler is one reference more.
            prop_assert_eq!(
                statistics.references,
                hittable(&mesh) + special.straddlers
            );
            prop_assert!(special.coplanar <= statistics.references);
            prop_assert_eq!(tree.bounds(), mesh.aabb());
        }
    }
}

#[test]
fn options_out_of_range_are_named() {
    let mesh = soup(vec![[Vec3::ZERO, Vec3::X, Vec3::Y]]);
    let good = BspOptions::default().with_precision(Precision::Fast);
    assert!(BspTree::build(&mesh, &good).is_ok(), "the defaults");
    let weighted = |balance, splits| Splitter::Weighted { balance, splits };
    for (bad, name) in [
        (
            good.clone().with_candidates(Candidates::Sample(0)),
            "candidates",
        ),
        (good.clone().with_max_leaf_size(0), "max_leaf_size"),
        (good.clone().with_max_leaf_size(65536), "max_leaf_size"),
        (good.clone().with_max_depth(1001), "max_depth"),
    ] {
        let error = BspTree::build(&mesh, &bad).unwrap_err();
        let is_named = matches!(error, BuildError::OutOfRange { option, .. } if option == name);
        assert!(is_named, "{error}");
    }
    for (bad, name) in [
        (good.clone().with_max_growth(0.5), "max_growth"),
        (good.clone().with_max_growth(f64::NAN), "max_growth"),
        (good.clone().with_traversal_cost(0.0), "traversal_cost"),
        (
            good.clone().with_traversal_cost(f64::INFINITY),
            "traversal_cost",
        ),
        (good.clone().with_splitter(weighted(0.0, 0.0)), "splitter"),
        (good.clone().with_splitter(weighted(-1.0, 2.0)), "splitter"),
        (
            good.clone().with_splitter(weighted(1.0, f64::NAN)),
            "splitter",
        ),
    ] {
        let error = BspTree::build(&mesh, &bad).unwrap_err();
        let is_named = matches!(error, BuildError::InvalidNumber { option, .. } if option == name);
        assert!(is_named, "{error}");
    }
}
