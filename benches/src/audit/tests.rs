use std::sync::Mutex;

use tahko_geometry::test_support;
use tahko_tracer::geometry::{
    BruteForce, Ray, RayQuery,
    glam::{DVec3, Vec3},
};

use super::*;
use examine::Examined;

/// A closed surface with many short edges: a sphere of `4 * steps * steps` triangles or so.
fn sphere(steps: u16) -> TriangleMesh {
    let columns = 2 * steps;
    let ring = |row: u16| {
        (0..columns).map(move |column| {
            let latitude = f32::from(row) / f32::from(steps) * std::f32::consts::PI;
            let longitude = f32::from(column) / f32::from(columns) * std::f32::consts::TAU;
            let (sin, cos) = latitude.sin_cos();
            Vec3::new(sin * longitude.cos(), sin * longitude.sin(), cos)
        })
    };
    let mut vertices: Vec<Vec3> = (1..steps).flat_map(ring).collect();
    let south = (steps - 2) * columns;
    let poles = [(steps - 1) * columns, (steps - 1) * columns + 1];
    vertices.extend([Vec3::Z, Vec3::NEG_Z]);
    let mut indices = Vec::new();
    for column in 0..columns {
        let next = (column + 1) % columns;
        indices.push([poles[0], column, next]);
        indices.push([poles[1], south + next, south + column]);
        for row in 0..steps - 2 {
            let (upper, lower) = (row * columns, (row + 1) * columns);
            indices.push([upper + column, lower + column, lower + next]);
            indices.push([upper + column, lower + next, upper + next]);
        }
    }
    let indices = indices.into_iter().map(|corners| corners.map(u32::from));
    TriangleMesh::new(vertices, indices.collect()).unwrap()
}

fn quick() -> AuditOptions {
    AuditOptions::default().with_rays(4000)
}

fn silent(_progress: Progress) {}

#[test]
fn fast_errs_on_a_closed_mesh_and_all_structures_err_alike() {
    let mesh = sphere(12);
    let report = audit(&mesh, &quick(), &silent).unwrap();
    assert_eq!(report.runs.len(), 4 * Precision::ALL.len());
    for run in &report.runs {
        let name = format!("{:?} {:?}", run.structure, run.precision);
        let same = |other: &&Run| other.precision == run.precision;
        let brute = report.runs.iter().find(same).unwrap();
        for mistake in Mistake::ALL {
            let counts = [run, brute].map(|run| run.all.count(mistake));
            assert!(
                mistake == Mistake::Crossings || counts[0] == counts[1],
                "{name}: {mistake:?} {counts:?}"
            );
        }
        assert_eq!(
            (run.rays, run.all.rays, run.all.hits),
            (4000, 4000, brute.all.hits),
            "{name}"
        );
        assert_eq!(run.all.count(Mistake::Batch), 0, "{name}");
        let by_kind = run.kinds.iter().map(|kind| kind.count(Mistake::FalseMiss));
        assert_eq!(
            by_kind.sum::<usize>(),
            run.all.count(Mistake::FalseMiss),
            "{name}"
        );
        assert_eq!(
            run.example.is_some(),
            Mistake::ALL
                .iter()
                .any(|mistake| run.all.count(*mistake) > 0)
        );
        match run.precision {
            Precision::Fast => {
                assert!(run.all.count(Mistake::FalseMiss) > 0, "{name}");
                assert_eq!(
                    run.kinds[0].count(Mistake::FalseMiss),
                    0,
                    "{name}: random rays"
                );
            }
            // It keeps what crosses the surface once, not what just touches a silhouette.
            Precision::Watertight => {
                let fast = &report.runs[0].all;
                let misses = [&run.all, fast].map(|errors| errors.count(Mistake::FalseMiss));
                assert!(misses[0] < misses[1], "{name}: {misses:?}");
            }
            _ => assert_eq!(run.example, None, "{name}"),
        }
    }
}

#[test]
fn watertight_keeps_every_ray_that_leaves_a_closed_mesh() {
    let mesh = sphere(12);
    let rays = rays(&mesh, 10_000, 1);
    let answers = reference::answers(&Oracle::new(&mesh), &rays, &|_| {});
    let query = BruteForce::new(&mesh, Precision::Watertight);
    let mut leaving = 0;
    for (ray, answer) in rays.iter().zip(&answers) {
        let is_half_line = (ray.t_min, ray.t_max) == (0.0, f32::INFINITY);
        if is_half_line && answer.crossings.len() % 2 == 1 {
            leaving += 1;
            assert!(query.any_hit(ray), "{ray:?}");
        }
    }
    assert!(leaving > 1000, "{leaving} rays begin inside");
}

#[test]
fn a_mesh_without_triangles_has_a_report_without_rays() {
    let report = audit(&TriangleMesh::default(), &quick(), &silent).unwrap();
    assert_eq!((report.triangles, report.rays), (0, 0));
    for run in &report.runs {
        assert_eq!((run.rays, run.all), (0, Errors::default()));
    }
    assert_eq!(report.broken_promises().count(), 0);
}

#[test]
fn brute_force_gets_fewer_rays_of_a_large_mesh_and_the_report_says_so() {
    let mesh = sphere(12);
    let options = AuditOptions {
        brute_force_tests: 6 * 100 * mesh.len() as u64,
        ..quick()
    };
    let report = audit(&mesh, &options, &silent).unwrap();
    for run in &report.runs {
        let expected = if run.structure == StructureKind::Brute {
            100
        } else {
            4000
        };
        assert_eq!((run.rays, run.all.rays), (expected, expected));
        let rays: Vec<usize> = run.kinds.iter().map(|kind| kind.rays).collect();
        assert_eq!(rays, [expected / 5; 5]);
    }
}

#[test]
fn progress_goes_up_to_the_total_and_thread_counts_do_not_matter() {
    let mesh = sphere(8);
    let last = Mutex::new(Vec::new());
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let record = |progress: Progress| last.lock().unwrap().push(progress);
        pool.unwrap()
            .install(|| audit(&mesh, &quick(), &record).unwrap())
    };
    let report = run(1);
    let steps = std::mem::take(&mut *last.lock().unwrap());
    assert!(steps.is_sorted_by_key(|step| step.done), "{steps:?}");
    let end = steps.last().unwrap();
    assert_eq!(end.done, end.total);
    assert_eq!(run(2), report);
    assert_ne!(
        audit(&mesh, &quick().with_seed(2), &silent).unwrap().runs,
        report.runs
    );
}

/// What is found about the answers of one mesh, held against the exact ones of another.
fn examine_other(asked: &TriangleMesh, exact: &TriangleMesh) -> Examined {
    let rays = rays(exact, 1000, 1);
    let answers = reference::answers(&Oracle::new(exact), &rays, &|_| {});
    let query = BruteForce::new(asked, Precision::Watertight);
    examine::examine(&query, &rays, &answers, true, &|_| {})
}

#[test]
fn every_kind_of_mistake_is_found() {
    let mesh = sphere(6);
    let with =
        |indices: Vec<[u32; 3]>| TriangleMesh::new(mesh.vertices().to_vec(), indices).unwrap();
    let found = |asked: &TriangleMesh, mistake| {
        let examined = examine_other(asked, &mesh);
        let example = examined.example.unwrap();
        assert!(!example.mistakes.is_empty(), "{example:?}");
        examined.all.count(mistake)
    };
    let indices = mesh.indices().to_vec();
    let half = with(indices[..indices.len() / 2].to_vec());
    assert!(
        found(&half, Mistake::FalseMiss) > 50,
        "half of the mesh is missing"
    );
    assert!(
        found(&half, Mistake::AnyHit) > 50,
        "half of the mesh is missing"
    );
    let reversed = with(indices.iter().rev().copied().collect());
    assert!(
        found(&reversed, Mistake::WrongTriangle) > 200,
        "other numbers"
    );
    let turned = with(indices.iter().map(|[a, b, c]| [*b, *c, *a]).collect());
    assert!(
        found(&turned, Mistake::InexactWeights) > 200,
        "other weights"
    );
    let larger = mesh.vertices().iter().map(|vertex| *vertex * 1.1).collect();
    let larger = TriangleMesh::new(larger, indices).unwrap();
    assert!(found(&larger, Mistake::FalseHit) > 20, "larger");
    assert!(found(&larger, Mistake::InexactT) > 200, "larger");
    assert!(found(&larger, Mistake::Crossings) > 200, "larger");
    assert!(found(&reversed, Mistake::Crossings) > 200, "other numbers");
    assert!(
        found(&half, Mistake::Crossings) > 50,
        "half of the mesh is missing"
    );
}

#[test]
fn rays_are_valid_and_larger_sets_begin_with_smaller_ones() {
    for (name, mesh) in test_support::degenerate_meshes() {
        let rays_of = |count| rays(&mesh, count, 7);
        let set = rays_of(1000);
        assert_eq!(set.len(), if mesh.is_empty() { 0 } else { 1000 }, "{name}");
        for ray in &set {
            assert!(ray.is_valid(), "{name}: {ray:?}");
        }
        assert_eq!(rays_of(100), set[..set.len().min(100)], "{name}");
        assert!(
            mesh.is_empty() || rays(&mesh, 1000, 8) != set,
            "{name}: another seed"
        );
    }
}

#[test]
fn rays_are_aimed_as_their_kinds_say() {
    let mesh = sphere(6);
    let set = rays(&mesh, 5000, 3);
    let of_kind = |kind: RayKind| set.iter().skip(kind as usize).step_by(RayKind::ALL.len());
    for ray in of_kind(RayKind::AxisParallel) {
        let zeros = ray
            .direction
            .to_array()
            .into_iter()
            .filter(|component| *component == 0.0);
        assert_eq!(zeros.count(), 2, "{ray:?}");
    }
    let signs = |sign: f32| {
        of_kind(RayKind::AxisParallel).any(|ray| ray.direction.y.to_bits() == sign.to_bits())
    };
    assert!(signs(0.0) && signs(-0.0), "zeros of both signs");

    // Distance of a line from a point, in units of the larger of both coordinates.
    let distance = |ray: &Ray, point: Vec3| {
        let from_origin = point.as_dvec3() - ray.origin.as_dvec3();
        let direction = ray.direction.as_dvec3();
        from_origin.cross(direction).length() / direction.length() / from_origin.length().max(1.0)
    };
    for ray in of_kind(RayKind::Vertex) {
        let nearest = mesh.vertices().iter().map(|vertex| distance(ray, *vertex));
        let nearest = nearest.min_by(f64::total_cmp).unwrap();
        assert!(nearest < 1e-6, "{nearest} {ray:?}");
    }
    let exact = of_kind(RayKind::Vertex).filter(|ray| {
        mesh.vertices()
            .iter()
            .any(|vertex| distance(ray, *vertex) == 0.0)
    });
    assert!(exact.count() > 20, "some pass exactly through a vertex");

    let angle = |ray: &Ray| {
        let direction = ray.direction.as_dvec3().normalize();
        let sines = mesh.triangles().map(|triangle| {
            let normal: DVec3 = triangle.scaled_normal().normalize();
            normal.dot(direction).abs()
        });
        sines.min_by(f64::total_cmp).unwrap()
    };
    let angles: Vec<f64> = of_kind(RayKind::Grazing).map(angle).collect();
    assert!(angles.iter().all(|angle| *angle < 0.11), "{angles:?}");
    assert!(
        angles.iter().filter(|angle| **angle < 1e-5).count() > 200,
        "{angles:?}"
    );
}
