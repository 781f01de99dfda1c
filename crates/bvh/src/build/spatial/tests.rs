use proptest::prelude::*;
use tahko_geometry::glam::DVec3;
use tahko_geometry::test_support::{degenerate_meshes, mesh, soup};
use tahko_geometry::{Aabb, Triangle, glam::Vec3};

use super::*;
use crate::BuildControl;
use crate::build::BinaryTree;

/// Cuts wherever a cut is cheaper.
const EAGER: Policy = Policy {
    overlap: 0.0,
    node_overlap: -1.0,
    size: 2,
};

fn build_eagerly(mesh: &TriangleMesh, budget: f64) -> BinaryTree {
    let references = collect(mesh.len(), |number| Reference::new(mesh, number));
    let options = BvhOptions::high_quality()
        .with_spatial_split_budget(budget)
        .with_max_leaf_size(1);
    let control = BuildControl::new();
    let work = Work {
        control: &control,
        weight: 1,
    };
    let (nodes, references) =
        build_by(EAGER, references, mesh, &options, &work).expect("nobody cancels it");
    BinaryTree {
        nodes,
        references,
        is_ordered: false,
        pieces: mesh.len(),
    }
}

/// Whether a leaf below a node lists a triangle and, with all nodes above it, contains a point.
fn finds(tree: &BinaryTree, node: usize, number: u32, point: DVec3) -> bool {
    let (bounds, link) = tree.node(node);
    let [min, max] = [bounds.min, bounds.max].map(Vec3::as_dvec3);
    if point.cmplt(min).any() || point.cmpgt(max).any() {
        return false;
    }
    match link {
        Link::Inner(children) => children
            .iter()
            .any(|child| finds(tree, *child, number, point)),
        Link::Leaf { first, count } => tree.references[first..][..count]
            .iter()
            .any(|reference| reference.number() == number),
    }
}

/// Checks that points of each triangle are found, and the form of the tree. Returns how many triangles the leaves list.
pub(super) fn check(name: &str, mesh: &TriangleMesh, tree: &BinaryTree) -> usize {
    let mut is_listed = vec![false; tree.references.len()];
    for node in tree.reached(name) {
        let (bounds, link) = tree.node(node);
        match link {
            Link::Inner(children) => {
                for child in children {
                    let inside = tree.node(child).0;
                    assert!(bounds.contains_box(&inside), "{name}: {child}");
                }
            }
            Link::Leaf { first, count } => {
                for is_listed in &mut is_listed[first..][..count] {
                    assert!(!*is_listed, "{name}: another leaf lists a part of {node}");
                    *is_listed = true;
                }
                let listed = tree.references[first..][..count].iter();
                let mut numbers: Vec<u32> = listed.map(|listed| listed.number()).collect();
                numbers.sort_unstable();
                numbers.dedup();
                assert!(count > 0, "{name}: an empty leaf");
                assert_eq!(numbers.len(), count, "{name}: a triangle twice");
            }
        }
    }
    assert_eq!(tree.node(0).0, mesh.aabb(), "{name}");
    for (triangle, number) in mesh.triangles().zip(0..) {
        for point in points(&triangle) {
            assert!(finds(tree, 0, number, point), "{name}: {number} at {point}");
        }
    }
    is_listed.into_iter().filter(|listed| *listed).count()
}

/// Points of a triangle whose coordinates are multiples of 2^-20 or have few digits: exact in f64.
pub(super) fn points(triangle: &Triangle) -> impl Iterator<Item = DVec3> {
    let [a, b, c] = triangle.vertices().map(Vec3::as_dvec3);
    let weights = (0..=8u8).flat_map(|i| (0..=8 - i).map(move |j| [i, j, 8 - i - j]));
    weights.map(move |weights| {
        let [i, j, k] = weights.map(|weight| f64::from(weight) / 8.0);
        a * i + b * j + c * k
    })
}

/// The same mesh with coordinates rounded to multiples of 2^-20.
pub(super) fn rounded(mesh: &TriangleMesh) -> TriangleMesh {
    let unit = 1.0 / (1u32 << 20) as f32;
    let vertices = mesh
        .vertices()
        .iter()
        .map(|vertex| (*vertex / unit).round() * unit);
    TriangleMesh::new(vertices.collect(), mesh.indices().to_vec()).expect("finite vertices")
}

pub(super) fn any_mesh() -> impl Strategy<Value = TriangleMesh> {
    mesh()
        .prop_filter("no triangle", |mesh| !mesh.is_empty())
        .prop_map(|mesh| rounded(&mesh))
}

proptest! {
    #[test]
    fn every_point_of_a_triangle_is_in_a_leaf_that_lists_it(
        mesh in any_mesh(),
        budget in 1.0f64..2.0,
    ) {
        let tree = build_eagerly(&mesh, budget);
        let listed = check("random", &mesh, &tree);
        prop_assert!(listed as f64 <= mesh.len() as f64 * budget);
    }
}

#[test]
fn long_diagonals_are_cut_in_many_parts() {
    let diagonals = (0..40u8).map(|index| {
        let start = Vec3::new(f32::from(index % 8), f32::from(index / 8), 0.0);
        [
            start,
            start + Vec3::splat(40.0),
            start + Vec3::new(40.0, 40.5, 40.0),
        ]
    });
    let mesh = soup(diagonals.collect());
    let tree = build_eagerly(&mesh, 2.0);
    let listed = check("diagonals", &mesh, &tree);
    assert!(listed > 70, "{listed}");
}

#[test]
fn degenerate_meshes_are_covered() {
    for (name, mesh) in degenerate_meshes() {
        // Points of triangles are exact only where coordinates do not differ too much in size.
        let mut sizes = mesh.vertices().iter().flat_map(Vec3::to_array);
        let is_exact = |size: f32| size == 0.0 || (1e-4..1e4).contains(&size.abs());
        if !mesh.is_empty() && mesh.len() < 2000 && sizes.all(is_exact) {
            check(name, &mesh, &build_eagerly(&mesh, 2.0));
        }
    }
}

#[test]
fn room_is_shared_in_the_ratio_of_the_references() {
    let bounds = Triangle::new(Vec3::X, Vec3::Y, Vec3::Z).aabb();
    let corner = |number: usize| Reference::of_box(&bounds, number);
    for (middle, total, capacity, start) in
        [(1, 3, 3, 1), (1, 4, 8, 2), (3, 4, 12, 9), (2, 3, 30, 20)]
    {
        let mut buffer: Vec<Reference> = (0..capacity).map(corner).collect();
        let mut parts = SpatialParts {
            middle: 0,
            total: 0,
            first: Extent::EMPTY,
            second: Extent::EMPTY,
        };
        (parts.middle, parts.total) = (middle, total);
        assert_eq!(share_room(&mut buffer, &parts), start);
        let numbers = |references: &[Reference]| {
            let mut numbers: Vec<usize> = references.iter().map(|r| r.number() as usize).collect();
            numbers.sort_unstable();
            numbers
        };
        assert_eq!(numbers(&buffer[..middle]), (0..middle).collect::<Vec<_>>());
        let second = numbers(&buffer[start..][..total - middle]);
        assert_eq!(second, (middle..total).collect::<Vec<_>>());
    }
}

#[test]
fn a_plane_that_all_references_turn_out_to_miss_on_one_side_is_not_used() {
    // Large triangles that reach over each other's ends: their boxes overlap wherever they are cut.
    let fans = (0..64u8).map(|index| {
        let angle = f32::from(index) * 0.1;
        let spoke = Vec3::new(angle.cos(), angle.sin(), 0.3 * angle);
        [Vec3::ZERO, spoke, spoke + Vec3::splat(0.01)]
    });
    let mesh = rounded(&soup(fans.collect()));
    for budget in [1.0, 1.05, 1.5, 2.0] {
        let tree = build_eagerly(&mesh, budget);
        check("fan", &mesh, &tree);
        let expected = Aabb::from_points(mesh.vertices().iter().copied());
        assert_eq!(tree.node(0).0, expected);
    }
}
