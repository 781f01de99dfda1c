//! The hard cases, asked of trees by every policy.

use tahko_geometry::test_support::hard_cases::{
    Structure, check_cost_of_a_stadium, check_many_duplicates, stacked_triangles,
};
use tahko_geometry::{Precision, hard_case_tests};
use tahko_kdtree::{AxisChoice, KdTree, KdTreeOptions, SplitPolicy};

fn structure(name: &str, options: KdTreeOptions) -> Structure {
    Structure::new(
        format!("kd-tree, {name}"),
        move |mesh, precision: Precision| {
            let options = options.clone().with_precision(precision);
            KdTree::build(mesh, &options).expect("options in range")
        },
    )
}

/// Splits as far as it can.
fn splitting() -> KdTreeOptions {
    KdTreeOptions::default()
        .with_costs(0.0, 1.0)
        .with_empty_space_factor(0.1)
        .with_max_leaf_size(1)
        .with_max_depth(Some(60))
}

fn structures() -> Vec<Structure> {
    let median = SplitPolicy::ObjectMedian(AxisChoice::Cycling);
    let middle = SplitPolicy::SpatialMiddle(AxisChoice::Longest);
    vec![
        structure("balanced", KdTreeOptions::balanced()),
        structure("splitting", splitting()),
        structure(
            "median",
            KdTreeOptions::balanced()
                .with_split_policy(median)
                .with_max_leaf_size(1),
        ),
        structure(
            "middle",
            KdTreeOptions::balanced()
                .with_split_policy(middle)
                .with_max_leaf_size(1),
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
    check_cost_of_a_stadium(&[structure("balanced", KdTreeOptions::balanced())]);
}

#[test]
fn stacked_triangles_make_a_tree_deeper_than_a_hundred() {
    let middle = SplitPolicy::SpatialMiddle(AxisChoice::Longest);
    let options = splitting()
        .with_split_policy(middle)
        .with_max_depth(Some(KdTreeOptions::MAX_DEPTH));
    let tree = KdTree::build(&stacked_triangles(), &options).expect("options in range");
    assert!(tree.depth() > 100, "{}", tree.depth());
    assert_eq!(tree.validate(), Ok(()));
}
