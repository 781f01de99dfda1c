//! Cutting: polygons by planes, triangles by boxes.

use std::hint::black_box;

use criterion::{BatchSize, Criterion, Throughput};
use tahko_bench::random::Random;
use tahko_geometry::glam::{DVec3, Vec3};
use tahko_geometry::{Aabb, ClippedTriangle, Plane, Polygon, Side, Triangle};

const CUTS: usize = 1024;

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    splits(&mut criterion);
    clips(&mut criterion);
    criterion.final_summary();
}

fn unit_cube() -> Aabb {
    Aabb::new(Vec3::ZERO, Vec3::ONE)
}

fn random_triangle(random: &mut Random) -> Triangle {
    let [a, b, c] = [(); 3].map(|()| random.point_in(&unit_cube()));
    Triangle::new(a, b, c)
}

/// The plane that a polygon is split by in a case.
fn plane(side: Side, polygon: &Polygon) -> Plane {
    let center = polygon.vertices().iter().sum::<DVec3>() / polygon.vertices().len() as f64;
    let plane = match side {
        Side::Coplanar => polygon.plane(),
        Side::Spanning => Plane::from_point_normal(center, DVec3::new(1.0, 2.0, 3.0)),
        Side::Front => Plane::from_point_normal(DVec3::splat(-1.0), DVec3::new(1.0, 2.0, 3.0)),
        Side::Back => Plane::from_point_normal(DVec3::splat(2.0), DVec3::new(1.0, 2.0, 3.0)),
    };
    plane.expect("the normal is not zero")
}

fn splits(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("split of a polygon");
    group.throughput(Throughput::Elements(CUTS as u64));
    for (name, side) in [
        ("on one side", Side::Front),
        ("coplanar", Side::Coplanar),
        ("straddling", Side::Spanning),
    ] {
        let mut random = Random::new(1);
        let mut triangle = || Polygon::from_triangle(&random_triangle(&mut random), 0);
        let polygons: Vec<Polygon> = std::iter::repeat_with(&mut triangle)
            .flatten()
            .take(CUTS)
            .collect();
        let cuts: Vec<(Polygon, Plane)> = polygons
            .into_iter()
            .map(|polygon| (polygon.clone(), plane(side, &polygon)))
            .collect();
        let is_case = cuts
            .iter()
            .all(|(polygon, plane)| polygon.side_of(plane) == side);
        assert!(is_case, "all polygons have to be {name}");
        group.bench_function(name, |bencher| {
            let split = |cuts: Vec<(Polygon, Plane)>| {
                let parts = cuts
                    .into_iter()
                    .map(|(polygon, plane)| polygon.split(&plane));
                parts.collect::<Vec<_>>()
            };
            bencher.iter_batched(|| cuts.clone(), split, BatchSize::SmallInput);
        });
    }
    group.finish();
}

/// The part of a triangle in a box, and its area.
fn clips(criterion: &mut Criterion) {
    let mut random = Random::new(2);
    let triangles: Vec<Triangle> = (0..CUTS).map(|_| random_triangle(&mut random)).collect();
    let mut group = criterion.benchmark_group("clip of a triangle to a box");
    group.throughput(Throughput::Elements(CUTS as u64));
    for (name, low, high) in [
        ("inside", 0.0, 1.0),
        ("by three planes", 0.3, 2.0),
        ("by six planes", 0.3, 0.7),
    ] {
        let [min, max] = [low, high].map(DVec3::splat);
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                let areas = black_box(&triangles)
                    .iter()
                    .map(|triangle| ClippedTriangle::new(triangle).in_box(min, max).area());
                areas.sum::<f64>()
            });
        });
    }
    group.finish();
}
