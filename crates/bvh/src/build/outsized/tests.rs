use tahko_geometry::glam::Vec3;
use tahko_geometry::{TriangleMesh, simd::AvailableSimd};

use super::*;
use crate::build::reference::Bounds;
use crate::build::{BinaryTree, Link, binned};
use crate::{Bvh, BvhOptions};

const SIDE: u16 = 128;

/// A wavy square of `2 SIDE^2` triangles.
fn terrain() -> Vec<[Vec3; 3]> {
    let at = |x: u16, z: u16| {
        let [x, z] = [x, z].map(f32::from);
        Vec3::new(x, (0.3 * x).sin() + (0.2 * z).cos(), z)
    };
    let cells = (0..SIDE).flat_map(|x| (0..SIDE).map(move |z| (x, z)));
    cells
        .flat_map(|(x, z)| {
            let [a, b, c, d] = [at(x, z), at(x + 1, z), at(x, z + 1), at(x + 1, z + 1)];
            [[a, b, c], [b, c, d]]
        })
        .collect()
}

/// Halves of the square, at some heights.
fn water(layers: u16) -> Vec<[Vec3; 3]> {
    let side = f32::from(SIDE);
    let layers = (0..layers).map(f32::from);
    layers
        .flat_map(|layer| {
            let at = |x: f32, z: f32| Vec3::new(x * side, layer / 256.0, z * side);
            [
                [at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0)],
                [at(1.0, 0.0), at(0.0, 1.0), at(1.0, 1.0)],
            ]
        })
        .collect()
}

fn mesh(triangles: &[[Vec3; 3]]) -> TriangleMesh {
    let vertices: Vec<Vec3> = triangles.iter().flatten().copied().collect();
    let indices = (0u32..).step_by(3).take(triangles.len());
    TriangleMesh::new(vertices, indices.map(|i| [i, i + 1, i + 2]).collect()).expect("finite")
}

/// Few bins, so that a cut beside large triangles leaves many small ones with them.
fn options() -> BvhOptions {
    BvhOptions::balanced().with_bins(2)
}

/// What is expected of a ray with the water, and without it.
fn costs(triangles: &[[Vec3; 3]]) -> [f64; 2] {
    let without = &triangles[..2 * usize::from(SIDE) * usize::from(SIDE)];
    [triangles, without].map(|triangles| {
        let bvh = Bvh::build(&mesh(triangles), &options()).expect("options in range");
        let visits = bvh.statistics().expected_visits;
        visits.inner_nodes + visits.leaves
    })
}

#[test]
fn a_few_triangles_as_large_as_the_scene_cost_little() {
    let [with, without] = costs(&[terrain(), water(1)].concat());
    // The leaf of the water is met besides, and little more.
    assert!(with < without + 1.5, "{with} {without}");
}

/// The nodes on the way to a triangle, all of which are as large as the scene.
fn depth_of(tree: &BinaryTree, node: usize, number: u32) -> Option<usize> {
    match tree.node(node).1 {
        Link::Leaf { first, count } => {
            let mut listed = tree.references[first..][..count].iter();
            listed.any(|listed| listed.number() == number).then_some(1)
        }
        Link::Inner(children) => {
            let depths = children.map(|child| depth_of(tree, child, number));
            depths.into_iter().flatten().next().map(|depth| depth + 1)
        }
    }
}

#[test]
fn large_triangles_are_set_apart_near_the_root() {
    let ground = terrain();
    for layers in [1, 40] {
        let water = water(layers);
        let tree = BinaryTree::of(&mesh(&[&ground[..], &water].concat()), &options());
        for number in (0..).skip(ground.len()).take(water.len()) {
            let depth = depth_of(&tree, 0, u32::try_from(number).expect("few"));
            let depth = depth.expect("each triangle is listed");
            let most = 4 + water.len().next_power_of_two().ilog2() as usize;
            assert!(depth <= most, "{layers}, {number}: {depth} of {most}");
        }
    }
}

fn references(triangles: &[[Vec3; 3]]) -> (Vec<Reference>, CentroidScale) {
    let mesh = mesh(triangles);
    let references: Vec<Reference> = (0..mesh.len())
        .map(|number| Reference::new(&mesh, number))
        .collect();
    let scale = CentroidScale::new(&Bounds::of(&references).to_aabb());
    (references, scale)
}

#[test]
fn a_split_by_size_is_what_it_is_said_to_be() {
    let (mut references, scale) = references(&[water(3), terrain(), water(2)].concat());
    let extent = Extent::new(&references, scale);
    let candidate = candidate(&references, limit(&extent, scale), scale).expect("both sizes");
    let cost = candidate.cost;
    let parts = candidate
        .cut
        .apply(&mut references, scale, AvailableSimd::best());
    assert_eq!(parts.middle, 10);
    let (large, others) = references.split_at(parts.middle);
    let first_small = 6;
    let last_small = references.len() - 4;
    let is_large =
        |number: u32| !(first_small..last_small).contains(&usize::try_from(number).expect("few"));
    assert!(large.iter().all(|reference| is_large(reference.number())));
    assert!(!others.iter().any(|reference| is_large(reference.number())));
    let mut expected = 0.0;
    for (side, extent) in [(large, parts.first), (others, parts.second)] {
        let exact = Extent::new(side, scale);
        assert!(extent.bounds.equals(&exact.bounds), "{}", side.len());
        assert!(extent.centroids.equals(&exact.centroids), "{}", side.len());
        expected += side.len() as f64 * exact.bounds.half_area();
    }
    assert!((cost / expected - 1.0).abs() < 1e-9, "{cost} {expected}");
}

#[test]
fn where_all_are_of_one_size_none_is_set_apart() {
    for triangles in [terrain(), water(1000)] {
        let (references, scale) = references(&triangles);
        let extent = Extent::new(&references, scale);
        assert!(candidate(&references, limit(&extent, scale), scale).is_none());
        let found = binned::best(&references, &extent, scale, 16, AvailableSimd::best());
        let cut = found.expect("centroids differ").cut;
        assert!(matches!(cut, Cut::Bin { .. }));
    }
}
