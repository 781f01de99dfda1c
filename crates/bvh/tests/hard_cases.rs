//! The hard cases, asked of trees by every kind of build.

use tahko_bvh::{BuildMethod, Bvh, BvhOptions};
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

fn structures() -> Vec<Structure> {
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

hard_case_tests!(structures);

#[test]
fn a_hundred_thousand_duplicates_are_told_apart() {
    check_many_duplicates(&structures());
}

#[test]
fn a_large_floor_does_not_make_a_small_object_dear() {
    check_cost_of_a_stadium(&structures());
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
