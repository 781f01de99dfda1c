use proptest::prelude::*;
use tahko_geometry::glam::{DVec3, Vec3};
use tahko_geometry::test_support::soup;
use tahko_geometry::{Aabb, TriangleMesh};

use super::*;
use crate::build::BinaryTree;
use crate::build::spatial::tests::{any_mesh, check, points, rounded};
use crate::parallel::collect;
use crate::{BuildControl, BuildError, BvhOptions};

fn references(mesh: &TriangleMesh) -> Vec<Reference> {
    collect(mesh.len(), |number| Reference::new(mesh, number))
}

fn pieces(mesh: &TriangleMesh, number: usize, count: usize) -> Vec<Aabb> {
    let (mut waiting, mut pieces) = (Vec::new(), Vec::new());
    let reference = Reference::new(mesh, number);
    cut(&reference, count, mesh, &mut waiting, &mut pieces);
    assert!(waiting.is_empty());
    assert!(pieces.iter().all(|piece| piece.number() as usize == number));
    let boxes = pieces.iter().map(|piece| piece.bounds().to_aabb());
    boxes.collect()
}

fn contains(bounds: &Aabb, point: DVec3) -> bool {
    bounds.min.as_dvec3().cmple(point).all() && bounds.max.as_dvec3().cmpge(point).all()
}

/// Slivers between points of a cube, of one width.
fn slivers(count: u32, width: f32) -> TriangleMesh {
    let mut state = 1u32;
    let mut random = move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f32::from((state >> 16) as u16) / 65536.0
    };
    let mut point = move || Vec3::new(random(), random(), random());
    let sliver = |_| {
        let [start, end, side] = [point(), point(), point()];
        [start, end, end + width * side]
    };
    rounded(&soup((0..count).map(sliver).collect()))
}

proptest! {
    #[test]
    fn every_point_of_a_triangle_is_in_a_piece(mesh in any_mesh(), count in 1usize..50) {
        for (number, triangle) in mesh.triangles().enumerate() {
            let pieces = pieces(&mesh, number, count);
            prop_assert!((1..=count).contains(&pieces.len()), "{}", pieces.len());
            for point in points(&triangle) {
                prop_assert!(pieces.iter().any(|piece| contains(piece, point)), "{}", point);
            }
            let whole = pieces.iter().fold(Aabb::EMPTY, |whole, piece| whole.union(*piece));
            prop_assert_eq!(whole, triangle.aabb());
        }
    }
}

#[test]
fn a_diagonal_is_cut_in_parts_of_equal_length() {
    let end = Vec3::new(60.0, -60.0, 60.5);
    let mesh = soup(vec![[Vec3::ZERO, end, end + Vec3::X * 0.25]]);
    for count in [1, 2, 3, 5, 7, 16, 100] {
        let pieces = pieces(&mesh, 0, count);
        assert_eq!(pieces.len(), count);
        let length = 60.5 / count as f32;
        for piece in pieces {
            let extent = piece.max - piece.min;
            assert!(
                extent.max_element() < length * 1.05 + 0.3,
                "{count}: {extent}"
            );
        }
    }
}

#[test]
fn triangles_too_small_or_too_large_for_their_digits_are_cut_as_far_as_they_can_be() {
    let step = 1.0f32.next_up() - 1.0;
    let near_one = Vec3::ONE + Vec3::splat(3.0 * step);
    let huge = Vec3::splat(3e38);
    let mesh = soup(vec![
        [Vec3::ONE, near_one, near_one],
        [-huge, huge, huge.with_x(2.9e38)],
        [Vec3::ZERO, Vec3::splat(1e-44), Vec3::splat(1e-44)],
        [Vec3::ONE; 3],
    ]);
    let counts: [usize; 4] = std::array::from_fn(|number| pieces(&mesh, number, 100).len());
    let [digits, large, tiny, point] = counts;
    assert!((2..100).contains(&digits), "{digits}");
    assert_eq!(large, 100);
    assert!((2..100).contains(&tiny), "{tiny}");
    assert_eq!(point, 1);
}

#[test]
fn trees_over_pieces_cover_their_triangles() {
    let mesh = slivers(800, 1.0 / 1024.0);
    for (presplit, splits) in [(4.0, 1.0), (8.0, 1.0), (8.0, 1.3), (32.0, 2.0)] {
        let options = BvhOptions::high_quality()
            .with_reinsertion_rounds(0)
            .with_max_leaf_size(1)
            .with_presplit_budget(presplit)
            .with_spatial_split_budget(splits);
        let tree = BinaryTree::of(&mesh, &options);
        check("slivers", &mesh, &tree);
        let pieces = tree.pieces as f64 / 800.0;
        assert!(
            (presplit.min(8.0) * 0.75..=presplit).contains(&pieces),
            "{pieces} of {presplit}"
        );
        assert!(tree.references.len() as f64 <= splits * tree.pieces as f64);
    }
}

#[test]
fn boxes_shrink_as_expected() {
    let mesh = slivers(2000, 1e-3);
    let area = |references: &[Reference]| -> f64 {
        let areas = references.iter().map(|r| r.bounds().half_area());
        areas.sum()
    };
    let control = BuildControl::new();
    let work = Work {
        control: &control,
        weight: 1,
    };
    let whole = references(&mesh);
    let before = area(&whole);
    let pieces = split(whole, &mesh, 16_000, &work).expect("nobody cancels it");
    assert!((12_000..=16_000).contains(&pieces.len()));
    let after = area(&pieces);
    assert!(after < before / 6.0, "{before} to {after}");
    control.cancel();
    let cancelled = split(references(&mesh), &mesh, 16_000, &work);
    assert_eq!(cancelled.err(), Some(BuildError::Cancelled));
}

#[test]
fn a_triangle_whose_boxes_would_not_shrink_stays_whole() {
    let mut triangles: Vec<[Vec3; 3]> = slivers(800, 1e-3)
        .triangles()
        .map(|triangle| triangle.vertices())
        .collect();
    triangles.push(Vec3::AXES);
    let mesh = soup(triangles);
    let control = BuildControl::new();
    let work = Work {
        control: &control,
        weight: 1,
    };
    let pieces = split(references(&mesh), &mesh, 6400, &work).expect("nobody cancels it");
    assert!(pieces.len() > 4000, "{}", pieces.len());
    let of_last = pieces.iter().filter(|piece| piece.number() == 800);
    assert_eq!(of_last.count(), 1);
}
