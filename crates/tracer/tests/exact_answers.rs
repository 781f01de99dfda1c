//! At the exact precision all structures give the bits of the oracle's answer: on any number of threads, one ray at a time and in
//! batches, on random and on adversarial meshes.

use std::ops::ControlFlow;

use proptest::prelude::*;
use rayon::prelude::*;
use tahko_bsp::{BspOptions, BspTree};
use tahko_bvh::{Bvh, BvhOptions};
use tahko_geometry::glam::Vec3;
use tahko_geometry::oracle::Oracle;
use tahko_geometry::test_support::{
    degenerate_meshes, grid_point, mesh, point, ray, rays_along_axes, rays_at_features, soup,
};
use tahko_geometry::{BruteForce, Hit, Precision, Ray, RayQuery, TriangleMesh};
use tahko_kdtree::{KdTree, KdTreeOptions};
use tahko_tracer::accelerator::{Accelerator, StructureKind};

/// What has to be equal, to the bit.
fn bits(hit: Hit) -> [u32; 4] {
    [
        hit.primitive,
        hit.t.to_bits(),
        hit.u.to_bits(),
        hit.v.to_bits(),
    ]
}

fn all_bits(hits: &[Option<Hit>]) -> Vec<Option<[u32; 4]>> {
    hits.iter().map(|hit| hit.map(bits)).collect()
}

fn crossings(query: &dyn RayQuery, ray: &Ray) -> Vec<[u32; 4]> {
    let mut found = Vec::new();
    query.all_hits(ray, &mut |hit| {
        found.push(bits(hit));
        ControlFlow::Continue(())
    });
    assert_eq!(query.crossings(ray), found.len(), "{ray:?}");
    found
}

/// The closest hits and crossings of brute force, after comparing them with the oracle's.
fn reference(mesh: &TriangleMesh, rays: &[Ray]) -> (Vec<Option<Hit>>, Vec<Vec<[u32; 4]>>) {
    let oracle = Oracle::new(mesh);
    let brute = Accelerator::build(StructureKind::Brute, Precision::Exact, mesh).expect("builds");
    let found = |ray: &Ray| {
        let hit = brute.query().closest_hit(ray);
        let exact = oracle.closest_hit(ray);
        assert_eq!(
            hit.map(|hit| (hit.primitive, hit.t.to_bits())),
            exact.map(|hit| (hit.triangle, hit.rounded_t().to_bits())),
            "{ray:?}"
        );
        let crossed = crossings(brute.query(), ray);
        let exact = oracle.crossings(ray);
        assert_eq!(
            crossed
                .iter()
                .map(|bits| (bits[0], bits[1]))
                .collect::<Vec<_>>(),
            exact
                .iter()
                .map(|hit| (hit.triangle, hit.rounded_t().to_bits()))
                .collect::<Vec<_>>(),
            "{ray:?}"
        );
        (hit, crossed)
    };
    rays.iter().map(found).unzip()
}

fn check(name: &str, mesh: &TriangleMesh, rays: &[Ray]) {
    let (expected, expected_crossings) = reference(mesh, rays);
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads");
        for kind in StructureKind::ALL {
            let context = format!("{name}, {}, {threads} threads", kind.name());
            let accelerator = pool
                .install(|| Accelerator::build(kind, Precision::Exact, mesh))
                .expect("builds");
            let query = accelerator.query();
            // On all threads at once, in batches of an odd size.
            let mut batch = vec![None; rays.len()];
            pool.install(|| {
                batch
                    .par_chunks_mut(7)
                    .zip(rays.par_chunks(7))
                    .for_each(|(hits, rays)| query.closest_hits(rays, hits));
            });
            assert_eq!(all_bits(&batch), all_bits(&expected), "batch, {context}");
            for ((ray, expected), crossed) in rays.iter().zip(&expected).zip(&expected_crossings) {
                let single = query.closest_hit(ray);
                assert_eq!(single.map(bits), expected.map(bits), "{context}, {ray:?}");
                assert_eq!(query.any_hit(ray), expected.is_some(), "{context}, {ray:?}");
                assert_eq!(&crossings(query, ray), crossed, "{context}, {ray:?}");
            }
        }
    }
}

/// Needles, nearly equal triangles, and grids at every power of two: what filters cannot decide.
fn adversarial_mesh() -> impl Strategy<Value = TriangleMesh> {
    let needle =
        (point(1.0), point(1.0), point(1.0), 0i32..40).prop_map(|(a, along, across, width)| {
            [a, a + along, a + along * 0.5 + across * 0.5f32.powi(width)]
        });
    let needles = prop::collection::vec(needle, 1..20).prop_map(soup);
    let nearly_equal = (
        prop::array::uniform3(grid_point()),
        prop::collection::vec(0usize..9, 1..20),
    )
        .prop_map(|(corners, changes)| {
            let changed = |change: usize| {
                let mut corners = corners;
                let coordinate = &mut corners[change / 3][change % 3];
                *coordinate = coordinate.next_up();
                corners
            };
            soup(
                [corners]
                    .into_iter()
                    .chain(changes.into_iter().map(changed))
                    .collect(),
            )
        });
    let scaled = (
        prop::collection::vec(prop::array::uniform3(grid_point()), 1..20),
        -120i32..120,
    )
        .prop_map(|(triangles, power)| {
            let scale = |corner: Vec3| corner * 2f32.powi(power);
            soup(
                triangles
                    .into_iter()
                    .map(|corners| corners.map(scale))
                    .collect(),
            )
        });
    prop_oneof![needles, nearly_equal, scaled]
}

/// As many of the rays at the features and along the axes as fit a test, evenly chosen.
fn some_rays(mesh: &TriangleMesh, count: usize) -> Vec<Ray> {
    let mut rays = rays_at_features(mesh);
    rays.extend(rays_along_axes(mesh));
    let step = rays.len().div_ceil(count).max(1);
    rays.into_iter().step_by(step).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(
        std::env::var("PROPTEST_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(24)
    ))]

    #[test]
    fn random_meshes(mesh in mesh(), rays in prop::collection::vec(ray(), 1..20)) {
        let mut rays = rays;
        rays.extend(some_rays(&mesh, 60));
        check("random", &mesh, &rays);
    }

    #[test]
    fn adversarial_meshes(mesh in adversarial_mesh()) {
        check("adversarial", &mesh, &some_rays(&mesh, 100));
    }
}

#[test]
fn degenerate_meshes_of_all_kinds() {
    for (name, mesh) in degenerate_meshes() {
        check(name, &mesh, &some_rays(&mesh, 100));
    }
}

/// The answers of a structure at another precision than it was built for are those of one that was built for it.
#[test]
fn a_tree_changes_its_precision_without_a_build() {
    fn check<T: RayQuery>(what: &str, changed: &T, built: &T, rays: &[Ray]) {
        assert_eq!(changed.precision(), Precision::Fast, "{what}");
        for ray in rays {
            let [changed, built] = [changed, built].map(|tree| tree.closest_hit(ray).map(bits));
            assert_eq!(changed, built, "{what} {ray:?}");
        }
    }
    let (fast, exact) = (Precision::Fast, Precision::Exact);
    for (name, mesh) in degenerate_meshes() {
        let rays = rays_at_features(&mesh);
        let [changed, built] = [exact, fast].map(|precision| BruteForce::new(&mesh, precision));
        check(name, &changed.with_precision(fast), &built, &rays);
        let [changed, built] = [exact, fast].map(|precision| {
            BspTree::build(&mesh, &BspOptions::default().with_precision(precision)).expect("builds")
        });
        check(name, &changed.with_precision(fast), &built, &rays);
        let [changed, built] = [exact, fast].map(|precision| {
            KdTree::build(&mesh, &KdTreeOptions::default().with_precision(precision))
                .expect("builds")
        });
        check(name, &changed.with_precision(fast), &built, &rays);
        let [changed, built] = [exact, fast].map(|precision| {
            Bvh::build(&mesh, &BvhOptions::default().with_precision(precision)).expect("builds")
        });
        check(name, &changed.with_precision(fast), &built, &rays);
    }
}
