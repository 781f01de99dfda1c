//! The exact predicates, on input that f64 decides and on input that only expansion arithmetic does.

use std::cmp::Ordering;
use std::hint::black_box;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, Throughput};
use tahko_bench::random::Random;
use tahko_geometry::glam::Vec3;
use tahko_geometry::predicate::{
    Sign, compare_hits, compare_t, direction_side, edge_side, point_side,
};
use tahko_geometry::{Aabb, Ray, Triangle};

const CASES: usize = 1024;

/// A ray, and two triangles that share an edge.
struct Case {
    ray: Ray,
    /// A point of the ray's line.
    target: Vec3,
    triangle: Triangle,
    neighbour: Triangle,
}

impl Case {
    /// A ray to a target, and two triangles that share the edge between the first two corners.
    fn new([a, b, c, d]: [Vec3; 4], origin: Vec3, target: Vec3) -> Self {
        Self {
            ray: Ray::new(origin, target - origin),
            target,
            triangle: Triangle::new(a, b, c),
            neighbour: Triangle::new(b, a, d),
        }
    }
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    let [easy, degenerate] = [easy(), degenerate()];
    check_degenerate(&degenerate);
    for (name, test) in predicates() {
        let mut group = criterion.benchmark_group(name);
        group.throughput(Throughput::Elements(CASES as u64));
        bench(&mut group, "easy", &easy, test);
        bench(&mut group, "degenerate", &degenerate, test);
        group.finish();
    }
    criterion.final_summary();
}

/// Whether a predicate finds its case degenerate.
type Predicate = fn(&Case) -> bool;

fn predicates() -> [(&'static str, Predicate); 5] {
    [
        ("edge_side", |case| {
            edge_side(&case.ray, case.triangle.a, case.triangle.b) == Sign::Zero
        }),
        ("direction_side", |case| {
            direction_side(case.target - case.triangle.a, &case.triangle) == Sign::Zero
        }),
        ("point_side", |case| {
            point_side(case.target, &case.triangle) == Sign::Zero
        }),
        ("compare_t", |case| {
            compare_t(&case.ray, &case.triangle, 1.0) == Some(Ordering::Equal)
        }),
        ("compare_hits", |case| {
            compare_hits(&case.ray, &case.triangle, &case.neighbour) == Some(Ordering::Equal)
        }),
    ]
}

fn bench(
    group: &mut BenchmarkGroup<'_, WallTime>,
    name: &str,
    cases: &[Case],
    is_degenerate: Predicate,
) {
    group.bench_function(name, |bencher| {
        bencher.iter(|| {
            black_box(cases)
                .iter()
                .filter(|case| is_degenerate(case))
                .count()
        });
    });
}

fn easy() -> Vec<Case> {
    let mut random = Random::new(1);
    let cube = Aabb::new(Vec3::ZERO, Vec3::ONE);
    let mut case = || {
        let [a, b, c, d, origin, target] = [(); 6].map(|()| random.point_in(&cube));
        Case::new([a, b, c, d], origin, target)
    };
    (0..CASES).map(|_| case()).collect()
}

/// Rays exactly through the middle of the common edge, at t = 1: all coordinates are small whole numbers.
fn degenerate() -> Vec<Case> {
    let mut random = Random::new(2);
    let mut point = || Vec3::from([(); 3].map(|()| 2.0 * (64.0 * random.unit()).floor()));
    let mut case = || {
        let [a, b, c, d] = [(); 4].map(|()| point());
        let origin = point() + 200.0 * Vec3::X;
        let target = 0.5 * (a + b);
        Case::new([a, b, c, d], origin, target)
    };
    (0..CASES).map(|_| case()).collect()
}

/// The degenerate cases have to be what they are called, but for the few triangles that have the ray in their plane.
fn check_degenerate(cases: &[Case]) {
    for (name, is_degenerate) in predicates() {
        let count = cases.iter().filter(|case| is_degenerate(case)).count();
        assert!(count * 100 >= CASES * 99, "{name}: {count} of {CASES}");
    }
}
