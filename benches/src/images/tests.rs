//! Pictures of a small scene, right and wrong.

use tahko_tracer::accelerator::Accelerator;
use tahko_tracer::geometry::glam::Vec3;
use tahko_tracer::geometry::{BruteForce, Transform, TriangleMesh};
use tahko_tracer::scene::{Material, MeshPart, SceneBuilder};

use super::*;

const SMALL: Effort = Effort {
    width: 24,
    height: 16,
    most_samples: 4,
    reference_samples: 16,
    rounds: 2,
    turn: Duration::from_secs(1000),
    brute_tests: 1e7,
};

/// A bumpy sheet: edges, shadows and mirrors.
fn scene() -> Scene {
    let side = 8u32;
    let corner = |x: u32, y: u32| {
        let height = [0.0, 0.7, 0.3, 0.9, 0.1][((3 * x + 2 * y) % 5) as usize];
        Vec3::new(x as f32, height, y as f32)
    };
    let positions = (0..=side).flat_map(|y| (0..=side).map(move |x| corner(x, y)));
    let cells = (0..side).flat_map(|y| (0..side).map(move |x| y * (side + 1) + x));
    let part = MeshPart {
        positions: positions.collect(),
        indices: cells
            .flat_map(|first| {
                let below = first + side + 1;
                [[first, below, first + 1], [first + 1, below, below + 1]]
            })
            .collect(),
        ..MeshPart::default()
    };
    let mut builder = SceneBuilder::new();
    let material = builder.add_material(Material {
        color: Vec3::new(0.8, 0.3, 0.2),
        mirror: 0.3,
        ..Material::default()
    });
    builder
        .add_part(part, material, &Transform::IDENTITY)
        .unwrap();
    builder.finish().unwrap()
}

fn build_all(mesh: &TriangleMesh) -> Vec<(StructureKind, Precision, Accelerator)> {
    let mut built = Vec::new();
    for precision in Precision::ALL {
        for kind in StructureKind::ALL {
            built.push((
                kind,
                precision,
                Accelerator::build(kind, precision, mesh).unwrap(),
            ));
        }
    }
    built
}

fn candidates(built: &[(StructureKind, Precision, Accelerator)]) -> Vec<Candidate<'_>> {
    built
        .iter()
        .map(|(kind, precision, accelerator)| Candidate {
            kind: *kind,
            precision: *precision,
            query: accelerator.query(),
        })
        .collect()
}

#[test]
fn each_precision_and_number_of_samples_has_a_row_of_all_structures_and_exact_is_without_error() {
    let scene = scene();
    let built = build_all(scene.mesh());
    let rows = measure("sheet", &scene, &candidates(&built), &SMALL, None).unwrap();
    let found: Vec<_> = rows
        .iter()
        .map(|row| (row.samples, row.precision.as_str()))
        .collect();
    let expected =
        [1, 2, 4].map(|samples| Precision::ALL.map(|precision| (samples, precision.name())));
    assert_eq!(found, expected.as_flattened());
    for row in &rows {
        assert_eq!(row.structures, ["brute", "bsp", "kdtree", "bvh"]);
        assert!(
            row.seconds.len() == 4 && row.seconds.iter().all(|seconds| *seconds > 0.0),
            "{row:?}"
        );
        assert!(
            row.rmse_reference > 0.0 && row.flip_reference > 0.0,
            "{row:?}"
        );
        if row.precision == "exact" {
            assert_eq!((row.rmse_precision, row.flip_precision), (0.0, 0.0));
        }
    }
}

#[test]
fn more_samples_come_nearer_to_the_reference() {
    let scene = scene();
    let built = build_all(scene.mesh());
    let rows = measure("sheet", &scene, &candidates(&built), &SMALL, None).unwrap();
    let exact: Vec<_> = rows.iter().filter(|row| row.precision == "exact").collect();
    assert!(
        exact[2].rmse_reference < exact[0].rmse_reference,
        "{exact:?}"
    );
    assert!(
        exact[2].flip_reference < exact[0].flip_reference,
        "{exact:?}"
    );
}

#[test]
fn brute_force_that_costs_too_much_is_left_out() {
    let scene = scene();
    let built = build_all(scene.mesh());
    let effort = Effort {
        brute_tests: 0.0,
        ..SMALL
    };
    let rows = measure("sheet", &scene, &candidates(&built), &effort, None).unwrap();
    assert!(
        rows.iter()
            .all(|row| row.structures == ["bsp", "kdtree", "bvh"]),
        "{rows:?}"
    );
}

#[test]
fn of_slow_structures_only_the_fastest_at_each_precision_gets_more_samples() {
    let scene = scene();
    let built = build_all(scene.mesh());
    let effort = Effort {
        turn: Duration::ZERO,
        ..SMALL
    };
    let rows = measure("sheet", &scene, &candidates(&built), &effort, None).unwrap();
    let structures: Vec<usize> = rows.iter().map(|row| row.structures.len()).collect();
    assert_eq!(structures, [4, 4, 4, 1, 1, 1, 1, 1, 1]);
}

#[test]
fn a_structure_that_loses_a_triangle_is_an_error_with_scene_precision_and_structures() {
    let scene = scene();
    let built = build_all(scene.mesh());
    let mesh = scene.mesh();
    let fewer = mesh.indices()[..mesh.len() - 9].to_vec();
    let holed = TriangleMesh::new(mesh.vertices().to_vec(), fewer).unwrap();
    let holed = BruteForce::new(&holed, Precision::Watertight);
    let mut candidates = candidates(&built);
    let wrong = candidates
        .iter_mut()
        .find(|one| one.kind == StructureKind::KdTree && one.precision == Precision::Watertight);
    wrong.unwrap().query = &holed;
    let error = measure("sheet", &scene, &candidates, &SMALL, None).unwrap_err();
    let message = format!("{error:#}");
    let start = "sheet, 1 samples per pixel: brute and kdtree give different pictures at the watertight precision: ";
    assert!(message.starts_with(start), "{message}");
}

#[test]
fn errors_need_an_exact_candidate() {
    let scene = scene();
    let fast = BruteForce::new(scene.mesh(), Precision::Fast);
    let candidates = [Candidate {
        kind: StructureKind::Bvh,
        precision: Precision::Fast,
        query: &fast,
    }];
    let error = measure("sheet", &scene, &candidates, &SMALL, None).unwrap_err();
    assert_eq!(
        error.to_string(),
        "sheet: no structure at the exact precision"
    );
}

#[test]
fn pictures_and_maps_can_be_looked_at() {
    let scene = scene();
    let built = build_all(scene.mesh());
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path().join("pictures");
    measure("sheet", &scene, &candidates(&built), &SMALL, Some(&folder)).unwrap();
    let size = |file: &str| image::image_dimensions(folder.join(file)).unwrap();
    for file in [
        "sheet-reference.png",
        "sheet-fast-2.png",
        "sheet-exact-4-flip.png",
        "sheet-watertight-1-flip-precision.png",
    ] {
        assert_eq!(size(file), (24, 16), "{file}");
    }
    let map = image::open(folder.join("sheet-exact-4-flip-precision.png"))
        .unwrap()
        .to_rgb8();
    assert!(
        map.pixels().all(|pixel| pixel.0 == [0, 0, 4]),
        "exact is without error"
    );
}
