use proptest::prelude::*;
use tahko_geometry::simd::SimdLevel;
use tahko_geometry::test_support::{invalid_rays, mesh, ray, rays_at_features};
use tahko_geometry::{
    AnyHit, ClosestHit, Exact, Hit, MollerTrumbore, Precision, RayQuery, TriangleMesh, Woop,
};

use super::*;
use crate::wide::access::with_source;
use crate::{Bvh, BvhOptions, NodeFormat};

/// The searches of a batch in turns, whatever the size of the tree.
fn in_turns<K: TriangleKernel, H: HitCollector>(bvh: &Bvh, rays: &[Ray]) -> Vec<H::Answer>
where
    H::Answer: Clone + Default,
{
    let mut answers = vec![H::Answer::default(); rays.len()];
    with_source!(bvh.layout(), source => bvh.simd().dispatch(Turns(Batch::<K, H, _> {
        bvh: source.view(),
        rays,
        answers: &mut answers,
        kernel: PhantomData,
    })));
    answers
}

/// The same in packets, however different the rays.
fn in_packets<K: TriangleKernel, H: HitCollector>(bvh: &Bvh, rays: &[Ray]) -> Vec<H::Answer>
where
    H::Answer: Clone + Default,
{
    let mut answers = vec![H::Answer::default(); rays.len()];
    with_source!(bvh.layout(), source => bvh.simd().dispatch(Packets(Batch::<K, H, _> {
        bvh: source.view(),
        rays,
        answers: &mut answers,
        kernel: PhantomData,
    })));
    answers
}

fn check<K: TriangleKernel>(mesh: &TriangleMesh, rays: &[Ray], precision: Precision) {
    for format in NodeFormat::ALL {
        let options = BvhOptions::default().with_node_format(format);
        check_options::<K>(mesh, rays, &options.with_precision(precision));
    }
}

fn check_options<K: TriangleKernel>(mesh: &TriangleMesh, rays: &[Ray], options: &BvhOptions) {
    let bvh = Bvh::build(mesh, options).expect("options in range");
    for level in SimdLevel::ALL
        .into_iter()
        .filter(|level| level.is_available())
    {
        let bvh = bvh
            .clone()
            .with_simd(level)
            .expect("the level is available");
        let closest: Vec<Option<Hit>> = rays.iter().map(|ray| bvh.closest_hit(ray)).collect();
        let any: Vec<bool> = rays.iter().map(|ray| bvh.any_hit(ray)).collect();
        assert_eq!(in_turns::<K, ClosestHit>(&bvh, rays), closest, "{level:?}");
        assert_eq!(in_turns::<K, AnyHit>(&bvh, rays), any, "{level:?}");
        assert_eq!(
            in_packets::<K, ClosestHit>(&bvh, rays),
            closest,
            "{level:?}"
        );
        assert_eq!(in_packets::<K, AnyHit>(&bvh, rays), any, "{level:?}");
        let mut hits = vec![None; rays.len()];
        bvh.closest_hits(rays, &mut hits);
        assert_eq!(hits, closest, "{level:?}");
        let mut found = vec![false; rays.len()];
        bvh.any_hits(rays, &mut found);
        assert_eq!(found, any, "{level:?}");
    }
}

fn check_all_precisions(mesh: &TriangleMesh, rays: &[Ray]) {
    check::<MollerTrumbore>(mesh, rays, Precision::Fast);
    check::<Woop>(mesh, rays, Precision::Watertight);
    check::<Exact>(mesh, rays, Precision::Exact);
}

proptest! {
    #[test]
    fn a_batch_answers_as_single_rays_do(mesh in mesh(), rays in prop::collection::vec(ray(), 0..60)) {
        check_all_precisions(&mesh, &rays);
    }

    #[test]
    fn rays_at_features_are_answered_as_single_rays_are(mesh in mesh()) {
        let rays: Vec<Ray> = rays_at_features(&mesh).into_iter().take(100).collect();
        check_all_precisions(&mesh, &rays);
    }
}

/// Rays side by side from one place to all over a mesh, in its vertices among them, so that packets are full and split up on their way.
fn fan_at_features(mesh: &TriangleMesh, from: Vec3) -> Vec<Ray> {
    let corners = (0..mesh.len()).flat_map(|index| mesh.triangle(index).vertices());
    let targets = corners.flat_map(|corner| [corner, corner + Vec3::new(0.01, -0.02, 0.005)]);
    let targets = targets.take(192).enumerate();
    let origin = |index: usize| from + (index % 3) as f32 * 1e-3;
    targets
        .map(|(index, target)| Ray::new(origin(index), target - origin(index)))
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn packets_answer_as_single_rays_do(
        mesh in mesh(),
        from in prop::sample::select(vec![Vec3::new(9.0, 8.0, 7.0), Vec3::new(-6.0, 0.5, 0.0), Vec3::ZERO]),
        segments in any::<bool>(),
    ) {
        let mut rays = fan_at_features(&mesh, from);
        if segments {
            rays.iter_mut().for_each(|ray| ray.t_max = 1.0);
        }
        check_all_precisions(&mesh, &rays);
    }
}

/// Rays of an octant that no axis suits, for which filters of eight rays do not decide.
#[test]
fn a_packet_of_rays_across_each_other_is_answered_as_single_rays_are() {
    let facing = |axis: Vec3, a: Vec3, b: Vec3| {
        let corner = 5.0 * axis - a - b;
        [corner, corner + 4.0 * a, corner + 4.0 * b]
    };
    let mesh = tahko_geometry::test_support::soup(vec![
        facing(Vec3::X, Vec3::Y, Vec3::Z),
        facing(Vec3::Y, Vec3::Z, Vec3::X),
    ]);
    let rays: Vec<Ray> = (0..64u8)
        .map(|index| {
            let aside = f32::from(index) * 1e-3;
            let directions = [Vec3::new(1.0, 0.0, aside), Vec3::new(0.0, 1.0, aside)];
            Ray::new(Vec3::ZERO, directions[usize::from(index % 2)])
        })
        .collect();
    let bvh = Bvh::build(&mesh, &BvhOptions::default()).expect("options in range");
    assert!(rays.iter().all(|ray| bvh.any_hit(ray)), "all are hits");
    check_all_precisions(&mesh, &rays);
}

#[test]
fn rays_that_are_not_valid_hit_nothing_and_keep_their_places() {
    let mesh = tahko_geometry::test_support::soup(vec![[Vec3::ZERO, Vec3::X, Vec3::Y]; 20]);
    let good = Ray::new(Vec3::new(0.25, 0.25, 1.0), Vec3::NEG_Z);
    let rays: Vec<Ray> = invalid_rays(good)
        .into_iter()
        .flat_map(|bad| [bad, good, bad])
        .collect();
    check_all_precisions(&mesh, &rays);
    check_all_precisions(&TriangleMesh::default(), &rays);
}

#[test]
fn a_fan_of_rays_is_coherent_and_scattered_rays_are_not() {
    let fan: Vec<Ray> = (0..100u8)
        .map(|i| Ray::new(Vec3::ZERO, Vec3::new(f32::from(i) * 0.001, 0.0, 1.0)))
        .collect();
    assert!(are_coherent(&fan, 1.0), "neighbours go the same way");
    let scattered: Vec<Ray> = (0..100u8)
        .map(|i| {
            Ray::new(
                Vec3::ZERO,
                Vec3::new(f32::from(u16::from(i) * 37 % 100) - 50.0, 20.0, 1.0),
            )
        })
        .collect();
    assert!(!are_coherent(&scattered, 1.0), "neighbours go other ways");
    assert!(!are_coherent(&fan[..1], 1.0), "no neighbours");
    assert!(!are_coherent(&[], 1.0), "no rays");
}
