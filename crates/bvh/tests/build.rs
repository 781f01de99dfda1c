//! Builds: determinism, depth, statistics, options.

use proptest::prelude::*;
use tahko_bvh::{BuildError, BuildMethod, Bvh, BvhOptions};
use tahko_geometry::test_support::{degenerate_meshes, mesh, soup};
use tahko_geometry::{ExpectedVisits, Precision, TreeStatistics, TriangleMesh, glam::Vec3};

fn scattered(count: usize) -> TriangleMesh {
    soup(scattered_triangles(count))
}

/// Small triangles at places that a linear congruential generator picks: the same on every machine.
fn scattered_triangles(count: usize) -> Vec<[Vec3; 3]> {
    let mut state = 1u32;
    let mut random = move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f32::from((state >> 16) as u16) / 65536.0
    };
    let triangles = (0..count).map(|_| {
        let mut point = || Vec3::new(random(), random(), random());
        let corner = point();
        [corner, corner + 0.02 * point(), corner + 0.02 * point()]
    });
    triangles.collect()
}

fn build(mesh: &TriangleMesh, options: &BvhOptions) -> Bvh {
    Bvh::build(mesh, options).expect("options in range")
}

/// Concentric triangles, each `ratio` times as large as the one before.
fn nested(count: u8, ratio: f32) -> TriangleMesh {
    let sizes = std::iter::successors(Some(1.0), |size| Some(size * ratio));
    let triangles = sizes
        .take(usize::from(count))
        .map(|size| [Vec3::X, Vec3::Y, Vec3::Z].map(|corner| corner * size));
    soup(triangles.collect())
}

#[test]
fn the_tree_is_the_same_for_every_number_of_threads() {
    // Enough triangles for subtrees, bins and the sorting of keys to be shared among tasks, and some to be set apart as larger than the others.
    let mut triangles = scattered_triangles(80_000);
    triangles.extend([
        [Vec3::X, Vec3::Y, Vec3::Z],
        [Vec3::ZERO, Vec3::ONE, Vec3::X],
    ]);
    let mesh = soup(triangles);
    for options in [
        BvhOptions::fast(),
        BvhOptions::balanced(),
        BvhOptions::high_quality(),
    ] {
        let trees = [1, 2, 4].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.expect("threads can be started")
                .install(|| build(&mesh, &options))
        });
        assert_eq!(trees[0].validate(), Ok(()));
        assert!(trees[0] == trees[1], "2 threads");
        assert!(trees[0] == trees[2], "4 threads");
    }
}

#[test]
fn coincident_centroids_give_a_tree_of_logarithmic_depth() {
    for count in [2, 5, 1000, 20_000] {
        let mesh = soup(vec![[Vec3::ZERO, Vec3::X, Vec3::Y]; count]);
        let bvh = build(&mesh, &BvhOptions::default().with_max_leaf_size(1));
        // Halvings, of which a node with eight children makes up to three.
        let halvings = count.next_power_of_two().trailing_zeros() as usize;
        let depths = 1 + halvings.div_ceil(3)..=1 + halvings;
        assert!(depths.contains(&bvh.depth()), "{count}: {}", bvh.depth());
        let leaves = bvh.statistics().leaves;
        assert_eq!(leaves, count, "one for each triangle");
        assert!(
            bvh.node_count() - leaves <= count / 3 + 1,
            "{count}: nodes of few children"
        );
        assert_eq!(bvh.validate(), Ok(()));
        // Clusters of odd number leave one unpaired.
        let bvh = build(&mesh, &BvhOptions::fast().with_max_leaf_size(1));
        assert!(
            bvh.depth() <= 2 + halvings,
            "{count} triangles: {}",
            bvh.depth()
        );
        assert_eq!(bvh.validate(), Ok(()));
    }
}

#[test]
fn nested_triangles_do_not_lead_below_the_greatest_depth() {
    let improved = BvhOptions::fast().with_reinsertion_rounds(64);
    for options in [BvhOptions::fast(), BvhOptions::high_quality(), improved] {
        for ratio in [0.5, 0.25] {
            // Binning 120 halvings would be deeper than 64 binary nodes if nothing stopped it.
            let mesh = nested(120, ratio);
            let bvh = build(&mesh, &options.clone().with_max_leaf_size(1));
            assert!(bvh.depth() <= 64, "{} levels", bvh.depth());
            assert_eq!(bvh.validate(), Ok(()));
        }
    }
}

#[test]
fn the_tree_does_not_depend_on_the_scale_of_the_coordinates() {
    // The cost of the tree does not depend on the scale, except where denormal numbers have no digits left.
    let mesh = scattered(5000);
    for options in [BvhOptions::fast(), BvhOptions::balanced()] {
        let scaled = |factor: f32| {
            let vertices = mesh
                .vertices()
                .iter()
                .map(|vertex| (*vertex - 0.5) * factor);
            let mesh = TriangleMesh::new(vertices.collect(), mesh.indices().to_vec());
            build(&mesh.expect("finite vertices"), &options).statistics()
        };
        let expected = scaled(1.0);
        for factor in [
            2.0f32.powi(-126),
            2.0f32.powi(-60),
            2.0f32.powi(60),
            2.0f32.powi(127),
        ] {
            assert_eq!(scaled(factor).nodes, expected.nodes, "{factor}");
            let ratio = scaled(factor).sah_cost / expected.sah_cost;
            assert!((ratio - 1.0).abs() < 1e-6, "{factor}: {ratio}");
        }
        let denormal = scaled(1e-39).sah_cost / expected.sah_cost;
        assert!((0.9..1.1).contains(&denormal), "{denormal}");
    }
}

#[test]
fn presets_trade_build_work_for_cheaper_trees() {
    let mesh = scattered(20_000);
    let [fast, balanced, high] = [
        BvhOptions::fast(),
        BvhOptions::balanced(),
        BvhOptions::high_quality(),
    ]
    .map(|options| {
        // A leaf costs queries about as much as a node, however many of its eight places are taken.
        let visits = build(&mesh, &options).statistics().expected_visits;
        visits.inner_nodes + visits.leaves
    });
    assert!(
        high < balanced && balanced < fast,
        "{fast} {balanced} {high}"
    );
}

#[test]
fn statistics_of_one_triangle_are_those_of_one_leaf() {
    let mesh = soup(vec![[Vec3::ZERO, Vec3::X, Vec3::Y]]);
    let statistics = build(&mesh, &BvhOptions::default()).statistics();
    let expected = TreeStatistics {
        primitives: 1,
        nodes: 1,
        leaves: 1,
        empty_leaves: 0,
        depth: 1,
        references: 1,
        bytes: statistics.bytes,
        expected_visits: ExpectedVisits {
            inner_nodes: 0.0,
            leaves: 1.0,
            triangle_tests: 1.0,
        },
        sah_cost: 1.0,
    };
    assert_eq!(statistics, expected);
    // Its block, and the empty one.
    assert_eq!(statistics.bytes, 2 * 320);
}

#[test]
fn expected_visits_are_ratios_of_areas() {
    // Flat boxes of 1 x 1, at the ends of one of 4 x 1: half areas 1, 1 and 4.
    let triangle = |x: f32| [Vec3::X * x, Vec3::X * (x + 1.0), Vec3::X * x + Vec3::Y];
    let mesh = soup(vec![triangle(0.0), triangle(3.0)]);
    let options = BvhOptions::default()
        .with_max_leaf_size(1)
        .with_costs(3.0, 2.0);
    let statistics = build(&mesh, &options).statistics();
    let expected = ExpectedVisits {
        inner_nodes: 1.0,
        leaves: 0.5,
        triangle_tests: 0.5,
    };
    assert_eq!(statistics.expected_visits, expected);
    assert_eq!(statistics.sah_cost, 1.5 + 0.5);
}

#[test]
fn a_mesh_without_triangles_gives_a_tree_without_nodes() {
    let bvh = build(&TriangleMesh::default(), &BvhOptions::default());
    assert_eq!((bvh.node_count(), bvh.depth()), (0, 0));
    assert!(bvh.bounds().is_empty(), "nothing to enclose");
    assert_eq!(bvh.statistics().sah_cost, 0.0);
    assert_eq!(bvh.validate(), Ok(()));
}

#[test]
fn bounds_without_area_have_a_finite_cost() {
    let segment = [Vec3::ZERO, Vec3::X, Vec3::X * 2.0];
    let bvh = build(&soup(vec![segment; 10]), &BvhOptions::default());
    let cost = bvh.statistics().sah_cost;
    assert!(cost.is_finite() && cost >= 10.0, "{cost}");
}

proptest! {
    #[test]
    fn statistics_add_up(
        mesh in mesh(),
        max_leaf_size in 1usize..10,
        method in prop::sample::select(vec![BuildMethod::Clusters, BuildMethod::TopDown]),
    ) {
        let options = BvhOptions::default().with_max_leaf_size(max_leaf_size).with_method(method);
        let bvh = build(&mesh, &options);
        let statistics = bvh.statistics();
        prop_assert_eq!(statistics.primitives, mesh.len());
        prop_assert_eq!(statistics.references, mesh.len());
        // All nodes but the root are one of two to eight children.
        let inner_nodes = statistics.nodes - statistics.leaves;
        let children = statistics.nodes.saturating_sub(1);
        prop_assert!((2 * inner_nodes..=8 * inner_nodes).contains(&children));
        prop_assert_eq!(statistics.nodes, bvh.node_count());
        prop_assert!(statistics.leaves * max_leaf_size >= mesh.len());
        prop_assert!(bvh.depth() <= statistics.leaves.max(1));
        prop_assert_eq!(bvh.bounds(), mesh.aabb());
        prop_assert_eq!(bvh.validate(), Ok(()));
    }
}

#[test]
fn degenerate_meshes_build_with_every_preset() {
    for (name, mesh) in degenerate_meshes() {
        for options in [
            BvhOptions::fast(),
            BvhOptions::balanced(),
            BvhOptions::high_quality(),
        ] {
            let bvh = build(&mesh, &options);
            assert_eq!(bvh.validate(), Ok(()), "{name}");
            let references = bvh.statistics().references;
            let most = mesh.len() as f64 * options.spatial_split_budget * options.presplit_budget;
            assert!(
                references >= mesh.len() && references as f64 <= most,
                "{name}"
            );
        }
    }
}

#[test]
fn options_out_of_range_are_refused() {
    let good = BvhOptions::default();
    let error = |options: &BvhOptions| {
        Bvh::build(&scattered(3), options).expect_err("an option is out of range")
    };
    for (option, options) in [
        ("bins", good.clone().with_bins(1)),
        ("bins", good.clone().with_bins(65)),
        ("sweep_size", good.clone().with_sweep_size(257)),
        (
            "reinsertion_rounds",
            good.clone().with_reinsertion_rounds(65),
        ),
        ("max_leaf_size", good.clone().with_max_leaf_size(0)),
        ("max_leaf_size", good.clone().with_max_leaf_size(256)),
    ] {
        let error = error(&options);
        assert!(
            matches!(error, BuildError::OutOfRange { option: named, .. } if named == option),
            "{error}"
        );
    }
    for (option, options) in [0.99, 2.01, f64::NAN]
        .map(|budget| good.clone().with_spatial_split_budget(budget))
        .map(|options| ("spatial_split_budget", options))
        .into_iter()
        .chain(
            [0.99, 32.01, f64::NAN]
                .map(|budget| good.clone().with_presplit_budget(budget))
                .map(|options| ("presplit_budget", options)),
        )
    {
        let error = error(&options);
        assert!(
            matches!(error, BuildError::InvalidBudget { option: named, .. } if named == option),
            "{error}"
        );
    }
    for cost in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = error(&good.clone().with_costs(cost, 1.0));
        assert!(matches!(error, BuildError::InvalidCost { .. }), "{error}");
    }
    let message = error(&good.with_bins(65)).to_string();
    assert_eq!(message, "option bins is 65, but must be from 2 to 64");
}

#[test]
fn the_precision_is_kept() {
    let options = BvhOptions::default().with_precision(Precision::Fast);
    let bvh = build(&scattered(3), &options);
    assert_eq!(bvh.options(), &options);
}

#[test]
fn one_far_vertex_does_not_make_the_tree_a_list() {
    // The area of the bounds is beyond the largest f32.
    let mut triangles: Vec<[Vec3; 3]> = scattered(1000).triangles().map(|t| t.vertices()).collect();
    triangles.push([Vec3::ZERO, Vec3::X * 1e30, Vec3::Y * 1e30]);
    let statistics = build(&soup(triangles), &BvhOptions::default()).statistics();
    assert!(statistics.leaves > 100, "{statistics:?}");
}
