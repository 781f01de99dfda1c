//! Tests of rays against triangles, by precision and by how hard they are to decide.

use std::hint::black_box;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, Throughput};
use tahko_bench::random::Random;
use tahko_geometry::glam::Vec3;
use tahko_geometry::{
    Aabb, Exact, MollerTrumbore, Precision, QueryCounts, Ray, RungCounts, Triangle, TriangleKernel,
    Woop,
};

const TESTS: usize = 4096;

/// Rays, each with the triangle that it is tested against.
type Tests = Vec<(Ray, Triangle)>;

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    let inputs = [
        ("half hits", half_hits()),
        ("misses", misses()),
        ("edges, f64 decides", edges()),
        ("vertices, expansions decide", vertices()),
    ];
    let mut group = criterion.benchmark_group("ray/triangle test");
    group.throughput(Throughput::Elements(TESTS as u64));
    for (name, tests) in &inputs {
        intersect::<MollerTrumbore>(&mut group, Precision::Fast, name, tests);
        intersect::<Woop>(&mut group, Precision::Watertight, name, tests);
        intersect::<Exact>(&mut group, Precision::Exact, name, tests);
    }
    group.finish();
    let mut group = criterion.benchmark_group("preparation of a ray");
    group.throughput(Throughput::Elements(TESTS as u64));
    let (_, tests) = &inputs[0];
    prepare::<MollerTrumbore>(&mut group, Precision::Fast, tests);
    prepare::<Woop>(&mut group, Precision::Watertight, tests);
    prepare::<Exact>(&mut group, Precision::Exact, tests);
    group.finish();
    criterion.final_summary();
}

fn intersect<K: TriangleKernel>(
    group: &mut BenchmarkGroup<'_, WallTime>,
    precision: Precision,
    name: &str,
    tests: &Tests,
) {
    let prepared: Vec<(K, Triangle)> = tests
        .iter()
        .map(|(ray, triangle)| (K::new(ray), *triangle))
        .collect();
    group.bench_function(format!("{}, {name}", precision.name()), |bencher| {
        bencher.iter(|| {
            let hits = black_box(&prepared).iter().filter(|(kernel, triangle)| {
                kernel.intersect(triangle, f32::INFINITY, &mut ()).is_some()
            });
            hits.count()
        });
    });
}

fn prepare<K: TriangleKernel>(
    group: &mut BenchmarkGroup<'_, WallTime>,
    precision: Precision,
    tests: &Tests,
) {
    group.bench_function(precision.name(), |bencher| {
        bencher.iter(|| {
            for (ray, _) in black_box(tests) {
                black_box(K::new(ray));
            }
        });
    });
}

fn unit_cube() -> Aabb {
    Aabb::new(Vec3::ZERO, Vec3::ONE)
}

fn random_triangle(random: &mut Random) -> Triangle {
    let [a, b, c] = [(); 3].map(|()| random.point_in(&unit_cube()));
    Triangle::new(a, b, c)
}

/// Rays at a place in each triangle's plane, given by the weights of the edges from the first vertex.
fn aimed(seed: u64, mut weights: impl FnMut(&mut Random) -> [f32; 2]) -> Tests {
    let mut random = Random::new(seed);
    let mut test = || {
        let triangle = random_triangle(&mut random);
        let [u, v] = weights(&mut random);
        let target = triangle.a + u * (triangle.b - triangle.a) + v * (triangle.c - triangle.a);
        let origin = random.point_in(&unit_cube()) + 2.0 * Vec3::X;
        (Ray::new(origin, target - origin), triangle)
    };
    (0..TESTS).map(|_| test()).collect()
}

/// Rays into the parallelogram of which each triangle is a half, the two halves in random order.
fn half_hits() -> Tests {
    aimed(1, |random| [random.unit(), random.unit()])
}

/// Rays past the triangles, as nearly all tests in a leaf are.
fn misses() -> Tests {
    aimed(2, |random| [1.1 + random.unit(), random.unit()])
}

/// Rays at points of edges, off by the rounding of f32.
fn edges() -> Tests {
    let tests = aimed(3, |random| [random.unit(), 0.0]);
    let counts = rungs(&tests);
    assert!(
        2 * counts.f64 > TESTS as u64,
        "f64 has to decide most: {counts:?}"
    );
    tests
}

/// Rays exactly through vertices: all coordinates are small whole numbers.
fn vertices() -> Tests {
    let mut random = Random::new(4);
    let mut point = || Vec3::from([(); 3].map(|()| (16.0 * random.unit()).floor()));
    let mut test = || {
        let triangle = Triangle::new(point(), point(), point());
        let origin = point() + 32.0 * Vec3::X;
        (Ray::new(origin, triangle.a - origin), triangle)
    };
    let tests: Tests = (0..TESTS).map(|_| test()).collect();
    let counts = rungs(&tests);
    assert!(
        2 * counts.exact > TESTS as u64,
        "expansions have to decide most: {counts:?}"
    );
    tests
}

/// What settles the tests at the exact precision.
fn rungs(tests: &Tests) -> RungCounts {
    let mut counts = QueryCounts::default();
    for (ray, triangle) in tests {
        Exact::new(ray).intersect(triangle, f32::INFINITY, &mut counts);
    }
    counts.rungs
}
