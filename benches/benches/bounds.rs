//! Tests of rays against boxes and splitting planes, and of triangles against planes.

use std::hint::black_box;

use criterion::{Criterion, Throughput};
use tahko_bench::random::Random;
use tahko_geometry::glam::{DVec3, Vec3};
use tahko_geometry::{Aabb, Axis, ConservativeRay, Exact, Interval, Plane, Ray, TriangleKernel};

const TESTS: usize = 4096;

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    boxes(&mut criterion);
    axis_planes(&mut criterion);
    planes(&mut criterion);
    criterion.final_summary();
}

fn unit_cube() -> Aabb {
    Aabb::new(Vec3::ZERO, Vec3::ONE)
}

/// Rays across the unit cube.
fn random_rays(random: &mut Random) -> Vec<ConservativeRay> {
    let mut ray = || {
        let [origin, target] = [(); 2].map(|()| random.point_in(&unit_cube()));
        let ray = Ray::new(origin, target - origin);
        ConservativeRay::new(&ray, &unit_cube(), Exact::REACH)
    };
    (0..TESTS).map(|_| ray()).collect()
}

const WHOLE: Interval = Interval {
    start: 0.0,
    end: f32::INFINITY,
};

/// Boxes of a few sizes: about half of them are hit.
fn boxes(criterion: &mut Criterion) {
    let mut random = Random::new(1);
    let rays = random_rays(&mut random);
    let mut random_box = |size: f32| {
        let corners = [(); 2].map(|()| random.point_in(&unit_cube()));
        let center = random.point_in(&unit_cube());
        Aabb::from_points(corners.map(|corner| center + size * (corner - center)))
    };
    let mut group = criterion.benchmark_group("box test");
    group.throughput(Throughput::Elements(TESTS as u64));
    for (name, size) in [("large", 1.0), ("middling", 0.3), ("small", 0.03)] {
        let tests: Vec<(ConservativeRay, Aabb)> =
            rays.iter().map(|ray| (*ray, random_box(size))).collect();
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                let tests = black_box(&tests).iter();
                tests
                    .filter(|(ray, bounds)| ray.clip(bounds, WHOLE).is_some())
                    .count()
            });
        });
    }
    group.finish();
}

/// The splitting planes of a kd-tree.
fn axis_planes(criterion: &mut Criterion) {
    let mut random = Random::new(2);
    let rays = random_rays(&mut random);
    let tests: Vec<(ConservativeRay, Axis, f32)> = rays
        .iter()
        .map(|ray| (*ray, Axis::ALL[random.below(3)], random.unit()))
        .collect();
    let mut group = criterion.benchmark_group("crossing of an axis plane");
    group.throughput(Throughput::Elements(TESTS as u64));
    group.bench_function("random", |bencher| {
        bencher.iter(|| {
            for (ray, axis, position) in black_box(&tests) {
                black_box(ray.crossing(*axis, *position));
            }
        });
    });
    group.finish();
}

/// The sides of triangles, as a BSP tree's build asks for them.
fn planes(criterion: &mut Criterion) {
    let mut random = Random::new(3);
    let mut point = || random.point_in(&unit_cube()).as_dvec3();
    let mut group = criterion.benchmark_group("side of a triangle");
    group.throughput(Throughput::Elements(TESTS as u64));
    let inputs = [("random", 0.0), ("vertices in the plane", 1.0)].map(|(name, in_plane)| {
        let mut test = || {
            let plane = Plane::from_points(point(), point(), point()).expect("not on a line");
            let triangle = [(); 3].map(|()| {
                let point = point();
                point - in_plane * plane.signed_distance(point) * plane.normal
            });
            (plane, triangle)
        };
        let tests: Vec<(Plane, [DVec3; 3])> = (0..TESTS).map(|_| test()).collect();
        (name, tests)
    });
    for (name, tests) in &inputs {
        group.bench_function(*name, |bencher| {
            bencher.iter(|| {
                for (plane, triangle) in black_box(tests) {
                    black_box(plane.side_of_points(*triangle));
                }
            });
        });
    }
    group.finish();
}
