//! Builds that are watched, cancelled and kept within a limit of memory.

use std::thread;

use tahko_bvh::{BuildControl, BuildError, BuildPhase, Bvh, BvhOptions};
use tahko_geometry::{TriangleMesh, glam::Vec3};

fn presets() -> [BvhOptions; 3] {
    [
        BvhOptions::fast(),
        BvhOptions::balanced(),
        BvhOptions::high_quality(),
    ]
}

/// A wavy square of `2 * side * side` triangles.
fn waves(side: u16) -> TriangleMesh {
    let vertices = (0..=side).flat_map(|y| {
        (0..=side).map(move |x| {
            let [x, y] = [x, y].map(f32::from);
            Vec3::new(x, y, 3.0 * (0.1 * x).sin() * (0.07 * y).cos())
        })
    });
    let indices = (0..u32::from(side)).flat_map(|y| {
        (0..u32::from(side)).flat_map(move |x| {
            let row = u32::from(side) + 1;
            let corner = y * row + x;
            [
                [corner, corner + 1, corner + row],
                [corner + 1, corner + row + 1, corner + row],
            ]
        })
    });
    TriangleMesh::new(vertices.collect(), indices.collect()).expect("finite vertices")
}

#[test]
fn a_watched_build_gives_the_same_tree_and_a_report() {
    let mesh = waves(100);
    for options in presets() {
        let control = BuildControl::new();
        assert_eq!(control.progress(), 0.0);
        let (bvh, report) = Bvh::build_with(&mesh, &options, &control).expect("not cancelled");
        assert!(bvh == Bvh::build(&mesh, &options).expect("options in range"));
        assert_eq!(control.progress(), 1.0);
        let phases: Vec<_> = report.phases.iter().map(|(phase, _)| *phase).collect();
        let mut expected = vec![BuildPhase::References, BuildPhase::Tree];
        if options.reinsertion_rounds > 0 {
            expected.push(BuildPhase::Reinsertion);
        }
        expected.push(BuildPhase::Layout);
        assert_eq!(phases, expected);
        assert!(report.phases.iter().all(|(_, seconds)| *seconds >= 0.0));
        assert!(report.seconds() > 0.0, "{report:?}");
        let statistics = bvh.statistics();
        assert_eq!(report.sah_cost, statistics.sah_cost);
        let most = options.spatial_split_budget;
        assert!(
            (1.0..=most).contains(&report.references_per_triangle),
            "{report:?}"
        );
        let bytes = report.bytes_per_triangle * mesh.len() as f64;
        assert_eq!(bytes.round(), statistics.bytes as f64);
    }
}

#[test]
fn progress_never_falls_and_ends_at_one() {
    let mesh = waves(250);
    for options in presets() {
        let control = BuildControl::new();
        thread::scope(|scope| {
            let build = scope.spawn(|| Bvh::build_with(&mesh, &options, &control));
            let mut last = 0.0;
            while !build.is_finished() {
                let progress = control.progress();
                assert!((last..=1.0).contains(&progress), "{last} {progress}");
                last = progress;
                thread::yield_now();
            }
        });
        assert_eq!(control.progress(), 1.0);
    }
}

#[test]
fn a_build_that_is_cancelled_ends_with_an_error() {
    let mesh = waves(300);
    for options in presets() {
        // The build could be done before this thread gets to cancel it, if the machine is busy; not every time.
        let was_cancelled = (0..10).any(|_| {
            let control = BuildControl::new();
            let result = thread::scope(|scope| {
                let build = scope.spawn(|| Bvh::build_with(&mesh, &options, &control));
                while control.progress() == 0.0 && !build.is_finished() {
                    thread::yield_now();
                }
                control.cancel();
                build.join().expect("builds do not panic")
            });
            result.err() == Some(BuildError::Cancelled)
        });
        assert!(was_cancelled, "{options:?}");
    }
}

#[test]
fn a_build_that_was_cancelled_before_it_began_does_not_begin() {
    let control = BuildControl::new();
    control.cancel();
    assert!(control.is_cancelled());
    for mesh in [waves(3), TriangleMesh::default()] {
        let error = Bvh::build_with(&mesh, &BvhOptions::default(), &control).err();
        assert_eq!(error, Some(BuildError::Cancelled));
    }
}

#[test]
fn a_limit_of_memory_is_kept_by_not_building() {
    let mesh = waves(50);
    for options in presets() {
        let needed = options.build_memory(mesh.len());
        let enough = BuildControl::new().with_memory_limit(needed);
        assert!(Bvh::build_with(&mesh, &options, &enough).is_ok());
        let allowed = needed - 1;
        let too_little = BuildControl::new().with_memory_limit(allowed);
        let error = Bvh::build_with(&mesh, &options, &too_little).err();
        assert_eq!(error, Some(BuildError::MemoryLimit { needed, allowed }));
    }
}

#[test]
fn an_empty_mesh_is_reported_without_divisions_by_zero() {
    let control = BuildControl::new();
    let mesh = TriangleMesh::default();
    let (bvh, report) =
        Bvh::build_with(&mesh, &BvhOptions::default(), &control).expect("not cancelled");
    assert_eq!(bvh.node_count(), 0);
    assert_eq!(report.references_per_triangle, 0.0);
    assert!(report.bytes_per_triangle.is_finite());
    assert_eq!(control.progress(), 1.0);
}
