//! The hard cases, asked of trees by every kind of build.

use tahko_bvh::{BuildMethod, Bvh, BvhOptions, NodeFormat};
use tahko_geometry::simd::SimdLevel;
use tahko_geometry::test_support::hard_cases::{
    Structure, check_cost_of_a_stadium, check_many_duplicates, nested_triangles, stacked_triangles,
};
use tahko_geometry::{Precision, hard_case_tests};

/// The trees of some options at every level of instructions that this processor has.
fn at_all_levels(name: &str, options: &BvhOptions) -> impl Iterator<Item = Structure> {
    let levels = SimdLevel::ALL.into_iter();
    levels
        .filter(|level| level.is_available())
        .map(move |level| {
            let options = options.clone();
            let name = format!("bvh, {name}, {}", level.name());
            Structure::new(name, move |mesh, precision: Precision| {
                let options = options.clone().with_precision(precision);
                let bvh = Bvh::build(mesh, &options).expect("options in range");
                bvh.with_simd(level).expect("the level is available")
            })
        })
}

/// Trees with nodes in f32.
fn full() -> Vec<Structure> {
    let all = [
        ("balanced", BvhOptions::balanced()),
        ("high quality", BvhOptions::high_quality()),
        (
            "two bins, single triangles",
            BvhOptions::fast().with_bins(2).with_max_leaf_size(1),
        ),
        (
            "spatial splits, single triangles",
            BvhOptions::fast()
                .with_spatial_split_budget(2.0)
                .with_max_leaf_size(1),
        ),
        (
            "large leaves",
            BvhOptions::balanced()
                .with_costs(50.0, 1.0)
                .with_max_leaf_size(20),
        ),
    ];
    all.iter()
        .flat_map(|(name, options)| at_all_levels(name, options))
        .collect()
}

/// Trees with quantised nodes: as they are used, and as many nodes as can be.
fn quantised() -> Vec<Structure> {
    let single = BvhOptions::high_quality().with_max_leaf_size(1);
    let all = [
        ("quantised", BvhOptions::balanced()),
        ("quantised, single triangles", single),
    ];
    let all = all.map(|(name, options)| (name, options.with_node_format(NodeFormat::Quantised)));
    all.iter()
        .flat_map(|(name, options)| at_all_levels(name, options))
        .collect()
}

fn structures() -> Vec<Structure> {
    let mut structures = full();
    structures.extend(quantised());
    structures
}

hard_case_tests!(structures);

#[test]
fn a_hundred_thousand_duplicates_are_told_apart() {
    check_many_duplicates(&structures());
}

#[test]
fn a_large_floor_does_not_make_a_small_object_dear() {
    // Where the object's parts are children of a node with the floor they have boxes as large as a step of the floor's grid, and all are visited: quantised nodes
    // do not promise this.
    check_cost_of_a_stadium(&full());
}

#[test]
fn halvings_stop_at_the_depth_that_a_traversal_has_room_for() {
    // 120 halvings would make a tree of as many levels; from some depth on the builder halves the number of triangles. Where the areas are
    // too small to be told apart, nodes have few children.
    let options = BvhOptions::balanced().with_bins(2).with_max_leaf_size(1);
    for mesh in [nested_triangles(), stacked_triangles()] {
        let tree = Bvh::build(&mesh, &options).expect("options in range");
        assert!((8..=64).contains(&tree.depth()), "{}", tree.depth());
        assert_eq!(tree.validate(), Ok(()));
        // Clusters take some of the halvings, the build above them has room for the rest.
        let options = options.clone().with_method(BuildMethod::Clusters);
        let tree = Bvh::build(&mesh, &options).expect("options in range");
        assert!((8..=64).contains(&tree.depth()), "{}", tree.depth());
        assert_eq!(tree.validate(), Ok(()));
    }
}
