//! The hard cases, asked of trees by every kind of build.

use tahko_bvh::{BuildMethod, Bvh, BvhOptions};
use tahko_geometry::test_support::hard_cases::{
    Structure, check_cost_of_a_stadium, check_many_duplicates, nested_triangles, stacked_triangles,
};
use tahko_geometry::{Precision, hard_case_tests};

fn structure(name: &str, options: BvhOptions) -> Structure {
    Structure::new(format!("bvh, {name}"), move |mesh, precision: Precision| {
        let options = options.clone().with_precision(precision);
        Bvh::build(mesh, &options).expect("options in range")
    })
}

fn structures() -> Vec<Structure> {
    vec![
        structure("balanced", BvhOptions::balanced()),
        structure("high quality", BvhOptions::high_quality()),
        structure(
            "two bins, single triangles",
            BvhOptions::fast().with_bins(2).with_max_leaf_size(1),
        ),
        structure(
            "large leaves",
            BvhOptions::balanced()
                .with_costs(50.0, 1.0)
                .with_max_leaf_size(20),
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
    check_cost_of_a_stadium(&structures());
}

#[test]
fn halvings_stop_at_the_depth_that_a_traversal_has_room_for() {
    // 120 halvings would make a tree of as many levels; from some depth on the builder halves the number of triangles.
    let options = BvhOptions::balanced().with_bins(2).with_max_leaf_size(1);
    for mesh in [nested_triangles(), stacked_triangles()] {
        let tree = Bvh::build(&mesh, &options).expect("options in range");
        assert!((60..=64).contains(&tree.depth()), "{}", tree.depth());
        assert_eq!(tree.validate(), Ok(()));
        // Clusters take some of the halvings, the build above them has room for the rest.
        let options = options.clone().with_method(BuildMethod::Clusters);
        let tree = Bvh::build(&mesh, &options).expect("options in range");
        assert!((30..=64).contains(&tree.depth()), "{}", tree.depth());
        assert_eq!(tree.validate(), Ok(()));
    }
}
