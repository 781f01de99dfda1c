//! What builds promise: determinism, limits, termination, refused options, statistics that add up.

use tahko_geometry::glam::Vec3;
use tahko_geometry::test_support::{degenerate_meshes, soup};
use tahko_geometry::{QueryCounts, Ray, RayQuery, TriangleMesh};
use tahko_kdtree::{AxisChoice, BuildError, KdTree, KdTreeOptions, SplitPolicy};

/// A bumpy surface of `2 * side * side` triangles.
fn terrain(side: u16) -> TriangleMesh {
    let stride = u32::from(side) + 1;
    let vertices = (0..=side).flat_map(|z| {
        (0..=side).map(move |x| {
            let (x, z) = (f32::from(x), f32::from(z));
            Vec3::new(x, (0.7 * x).sin() * (0.9 * z).cos() * 3.0, z)
        })
    });
    let corner = |x: u32, z: u32| z * stride + x;
    let side = u32::from(side);
    let indices = (0..side).flat_map(|z| {
        (0..side).flat_map(move |x| {
            [
                [corner(x, z), corner(x + 1, z), corner(x, z + 1)],
                [corner(x + 1, z), corner(x + 1, z + 1), corner(x, z + 1)],
            ]
        })
    });
    TriangleMesh::new(vertices.collect(), indices.collect()).expect("a valid grid")
}

fn build(mesh: &TriangleMesh, options: &KdTreeOptions) -> KdTree {
    KdTree::build(mesh, options).expect("the options are valid")
}

/// Long thin triangles in all directions through the origin: each straddles most planes.
fn needles(count: u16) -> TriangleMesh {
    let needle = |i: u16| {
        let angle = f32::from(i);
        let direction = Vec3::new(angle.cos(), (1.3 * angle).sin(), (0.7 * angle).cos());
        [
            -direction,
            direction,
            direction + 0.01 * Vec3::new(angle.sin(), 0.3, 1.0),
        ]
    };
    soup((0..count).map(needle).collect())
}

#[cfg(feature = "parallel")]
#[test]
fn the_tree_is_the_same_for_every_number_of_threads() {
    // Enough for the axes of large cells to be swept in parallel.
    let mesh = terrain(100);
    for policy in SplitPolicy::ALL {
        let options = KdTreeOptions::default()
            .with_split_policy(policy)
            .with_max_leaf_size(1);
        let trees = [1, 2, 4].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.expect("threads can be started")
                .install(|| build(&mesh, &options))
        });
        assert_eq!(trees[0].validate(), Ok(()));
        assert!(trees[0] == trees[1] && trees[0] == trees[2], "{policy:?}");
    }
}

/// One test run has the feature `parallel`, another has not: both have to find these numbers. They may change
/// when the build is changed on purpose.
#[test]
fn the_tree_does_not_depend_on_the_feature() {
    let options = KdTreeOptions::default().with_max_leaf_size(1);
    let statistics = build(&terrain(60), &options).statistics();
    assert_eq!(
        (statistics.nodes, statistics.references, statistics.depth),
        (17129, 7212, 19)
    );
}

#[test]
fn statistics_add_up() {
    let mesh = terrain(20);
    for policy in SplitPolicy::ALL {
        let tree = build(&mesh, &KdTreeOptions::default().with_split_policy(policy));
        let statistics = tree.statistics();
        assert_eq!(statistics.primitives, 800);
        assert_eq!(statistics.nodes, 2 * statistics.leaves - 1, "a binary tree");
        assert_eq!(
            (statistics.nodes, statistics.depth),
            (tree.node_count(), tree.depth())
        );
        assert!(statistics.references >= 800, "{statistics:?}");
        assert!(
            statistics.empty_leaves < statistics.leaves,
            "{statistics:?}"
        );
        assert_eq!(
            statistics.bytes,
            8 * statistics.nodes + 4 * statistics.references + 40 * statistics.primitives
        );
        let visits = statistics.expected_visits;
        let cost = 0.75 * visits.inner_nodes + visits.triangle_tests;
        assert_eq!(statistics.sah_cost, cost, "{statistics:?}");
        assert!(
            visits.leaves > 1.0 && visits.triangle_tests > 0.0,
            "{visits:?}"
        );
    }
}

#[test]
fn a_better_policy_expects_a_lower_cost() {
    let mesh = terrain(40);
    let cost = |policy| {
        let options = KdTreeOptions::default()
            .with_split_policy(policy)
            .with_max_leaf_size(2);
        build(&mesh, &options).statistics().sah_cost
    };
    let surface_area = cost(SplitPolicy::SurfaceArea);
    for policy in SplitPolicy::ALL {
        assert!(surface_area <= cost(policy), "{policy:?} is cheaper");
    }
}

#[test]
fn degenerate_meshes_stay_within_the_limits() {
    for (name, mesh) in degenerate_meshes() {
        for policy in SplitPolicy::ALL {
            let options = KdTreeOptions::default()
                .with_split_policy(policy)
                .with_max_depth(Some(12))
                .with_max_references_per_triangle(3.0);
            let statistics = build(&mesh, &options).statistics();
            assert!(statistics.depth <= 13, "{name}, {policy:?}: {statistics:?}");
            assert!(
                statistics.references_per_primitive() <= 3.0,
                "{name}, {policy:?}: {statistics:?}"
            );
        }
    }
}

#[test]
fn equal_triangles_make_one_list_and_the_smallest_number_is_hit() {
    let mesh = soup(vec![[Vec3::ZERO, Vec3::X, Vec3::Y]; 20_000]);
    for policy in SplitPolicy::ALL {
        let tree = build(&mesh, &KdTreeOptions::default().with_split_policy(policy));
        assert_eq!(tree.validate(), Ok(()));
        let statistics = tree.statistics();
        assert!(statistics.references < 50_000, "{policy:?}: {statistics:?}");
        let hit = tree.closest_hit(&Ray::new(Vec3::new(0.2, 0.2, 1.0), Vec3::NEG_Z));
        assert_eq!(hit.map(|hit| hit.primitive), Some(0), "{policy:?}");
    }
}

#[test]
fn the_budget_holds_where_every_triangle_straddles_every_plane() {
    let mesh = needles(1000);
    for limit in [1.0, 2.0, 8.0] {
        for policy in SplitPolicy::ALL {
            let options = KdTreeOptions::default()
                .with_split_policy(policy)
                .with_max_references_per_triangle(limit)
                .with_max_depth(Some(40));
            let tree = build(&mesh, &options);
            let references = tree.statistics().references_per_primitive();
            assert!(
                references <= f64::from(limit),
                "{policy:?}: {references} > {limit}"
            );
            assert_eq!(tree.validate(), Ok(()));
        }
    }
}

#[test]
fn triangles_as_large_as_their_cell_are_separated_where_the_heuristic_gives_up() {
    let corner = |seed: f32| {
        Vec3::new(
            (12.9 * seed).sin(),
            (78.2 * seed).sin(),
            (37.7 * seed).sin(),
        )
    };
    let triangle = |i: u16| [0.1, 0.4, 0.7].map(|part| corner(f32::from(i) + part));
    let mesh = soup((0..3000).map(triangle).collect());
    let tree = build(&mesh, &KdTreeOptions::default());
    assert_eq!(tree.validate(), Ok(()));
    let mut counts = QueryCounts::default();
    for i in 0..100u8 {
        let angle = f32::from(i);
        let origin = 4.0 * Vec3::new(angle.cos(), angle.sin(), (0.3 * angle).cos());
        tree.closest_hit_counted(&Ray::new(origin, -origin), &mut counts);
    }
    assert!(counts.triangle_tests < 100 * 3000 / 4, "{counts:?}");
}

#[test]
fn triangles_with_equal_vertices_are_counted_but_not_listed() {
    let mesh = soup(vec![
        [Vec3::ONE; 3],
        [Vec3::ZERO, Vec3::X, Vec3::Y],
        [Vec3::ZERO, Vec3::ONE, Vec3::ZERO],
    ]);
    let tree = build(&mesh, &KdTreeOptions::default());
    let statistics = tree.statistics();
    assert_eq!((statistics.primitives, statistics.references), (3, 1));
    assert_eq!(tree.bounds().max, Vec3::new(1.0, 1.0, 0.0));
}

#[test]
fn an_empty_mesh_gives_a_tree_without_nodes() {
    let tree = build(&soup(Vec::new()), &KdTreeOptions::default());
    assert_eq!((tree.node_count(), tree.depth()), (0, 0));
    assert!(tree.bounds().is_empty(), "there is nothing to bound");
    assert_eq!(tree.statistics().sah_cost, 0.0);
    assert_eq!(tree.closest_hit(&Ray::new(Vec3::ZERO, Vec3::X)), None);
}

#[test]
fn deep_trees_are_traversed_without_a_usual_stack() {
    // Each split cuts off half of the rest: triangles at 1, 1/2, 1/4 and so on.
    let at = |i: i16| Vec3::X * 2.0f32.powi(-i32::from(i));
    let mesh = soup(
        (0..100)
            .map(|i| [at(i), at(i) + Vec3::Y, at(i) + Vec3::Z])
            .collect(),
    );
    let options = KdTreeOptions::default()
        .with_split_policy(SplitPolicy::SpatialMiddle(AxisChoice::Longest))
        .with_max_depth(Some(300));
    let tree = build(&mesh, &options);
    assert!(tree.depth() > 64, "the depth is {}", tree.depth());
    let hit = tree.closest_hit(&Ray::new(Vec3::new(0.0, 0.2, 0.2), Vec3::X));
    assert_eq!(hit.map(|hit| hit.primitive), Some(99));
}

#[test]
fn options_out_of_range_are_refused_by_name() {
    let good = KdTreeOptions::default;
    let bad = [
        ("max_leaf_size", good().with_max_leaf_size(0)),
        (
            "max_depth",
            good().with_max_depth(Some(KdTreeOptions::MAX_DEPTH + 1)),
        ),
        ("traversal_cost", good().with_costs(-1.0, 1.0)),
        ("traversal_cost", good().with_costs(f32::NAN, 1.0)),
        ("intersection_cost", good().with_costs(1.0, 0.0)),
        ("intersection_cost", good().with_costs(1.0, f32::INFINITY)),
        ("empty_space_factor", good().with_empty_space_factor(0.0)),
        ("empty_space_factor", good().with_empty_space_factor(1.5)),
        (
            "max_references_per_triangle",
            good().with_max_references_per_triangle(0.5),
        ),
        (
            "max_references_per_triangle",
            good().with_max_references_per_triangle(f32::NAN),
        ),
    ];
    for (name, options) in bad {
        let error = KdTree::build(&soup(Vec::new()), &options).expect_err("out of range");
        assert!(
            matches!(error, BuildError::OptionOutOfRange { option, .. } if option == name),
            "{name}: {error}"
        );
    }
}
