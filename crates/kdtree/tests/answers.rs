//! Every policy at every precision answers like brute force, and every tree is well formed.

use proptest::prelude::*;
use tahko_geometry::test_support::{
    BruteForceAnswers, degenerate_meshes, mesh, ray, rays_along_axes, rays_at_features,
};
use tahko_geometry::{Precision, Ray, TriangleMesh};
use tahko_kdtree::{KdTree, KdTreeOptions, SplitPolicy};

/// Options that make trees differ: all policies with small and large leaves, and costs that split far.
fn options() -> Vec<KdTreeOptions> {
    let policies = SplitPolicy::ALL.into_iter().flat_map(|policy| {
        let options = KdTreeOptions::default().with_split_policy(policy);
        [1, 6].map(|size| options.clone().with_max_leaf_size(size))
    });
    let splitting = KdTreeOptions::default()
        .with_costs(0.0, 1.0)
        .with_empty_space_factor(0.1)
        .with_max_leaf_size(1)
        .with_max_depth(Some(60));
    policies.chain([KdTreeOptions::fast(), splitting]).collect()
}

fn check(name: &str, mesh: &TriangleMesh, rays: &[Ray]) {
    for precision in Precision::ALL {
        let answers = BruteForceAnswers::new(mesh, precision, rays);
        for options in options() {
            let options = options.with_precision(precision);
            let tree = KdTree::build(mesh, &options).expect("the options are valid");
            assert_eq!(tree.validate(), Ok(()), "{name}, {options:?}");
            answers.assert_equal((name, &options), &tree);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(
        std::env::var("PROPTEST_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(64)
    ))]

    #[test]
    fn random_rays_hit_what_brute_force_hits(
        mesh in mesh(),
        rays in prop::collection::vec(ray(), 1..40),
    ) {
        check("random", &mesh, &rays);
    }
}

#[test]
fn rays_at_features_of_degenerate_meshes_hit_what_brute_force_hits() {
    for (name, mesh) in degenerate_meshes() {
        let mut rays = rays_at_features(&mesh);
        rays.extend(rays_along_axes(&mesh));
        // Some of the meshes have thousands of features that differ in nothing.
        let step = rays.len().div_ceil(500).max(1);
        let rays: Vec<Ray> = rays.into_iter().step_by(step).collect();
        check(name, &mesh, &rays);
    }
}
