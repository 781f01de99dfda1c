use proptest::prelude::*;
use tahko_geometry::test_support::{degenerate_meshes, mesh, soup};
use tahko_geometry::{Plane, Polygon, Split, Triangle, TriangleBlock, TriangleMesh};

use super::*;
use crate::{BvhOptions, NodeFormat};

/// Leaves of one triangle where the costs allow, and costs that are told apart.
fn options() -> BvhOptions {
    BvhOptions::high_quality()
        .with_max_leaf_size(2)
        .with_costs(0.75, 2.0)
}

fn build(mesh: &TriangleMesh, options: &BvhOptions) -> Bvh {
    Bvh::build(mesh, options).expect("options in range")
}

/// The overlap by its definition: every node and leaf against every triangle, the part in a box by the splitting of polygons.
fn by_definition(layout: &WideBvh, inner_node_cost: f64) -> f64 {
    let mut triangles = vec![None; layout.triangle_count];
    for (number, triangle) in layout.blocks.iter().flat_map(TriangleBlock::triangles) {
        triangles[number as usize] = Some(triangle);
    }
    let triangles: Vec<Triangle> = triangles
        .into_iter()
        .map(|triangle| triangle.expect("listed"))
        .collect();
    let total: f64 = triangles.iter().map(Triangle::area).sum();
    let root = (layout.root != Child::NOTHING).then_some((layout.bounds, layout.root));
    let others = layout.nodes.iter();
    let others = others.flat_map(|node| node.children().collect::<Vec<_>>());
    let mut sum = 0.0;
    for (bounds, child) in root.into_iter().chain(others) {
        let mut below = Vec::new();
        list_below(layout, child, &mut below);
        let cost = match child.kind() {
            Kind::Inner(_) => inner_node_cost,
            Kind::Leaf(_) => below.len() as f64,
        };
        let others = (0u32..)
            .zip(&triangles)
            .filter(|(number, _)| !below.contains(number));
        sum += cost
            * others
                .map(|(_, triangle)| area_in(triangle, &bounds))
                .sum::<f64>();
    }
    if total > 0.0 { sum / total } else { 0.0 }
}

/// The numbers of the triangles below a child.
fn list_below(layout: &WideBvh, child: Child, numbers: &mut Vec<u32>) {
    match child.kind() {
        Kind::Inner(node) => {
            for (_, child) in layout.nodes.at(node).children() {
                list_below(layout, child, numbers);
            }
        }
        Kind::Leaf(first) => {
            let blocks = layout.leaf_blocks(first).iter();
            numbers.extend(
                blocks
                    .flat_map(TriangleBlock::triangles)
                    .map(|(number, _)| number),
            );
        }
    }
}

fn area_in(triangle: &Triangle, cell: &Aabb) -> f64 {
    let Some(mut part) = Polygon::from_triangle(triangle, 0) else {
        return 0.0;
    };
    for axis in DVec3::AXES {
        for (corner, inwards) in [(cell.min, axis), (cell.max, -axis)] {
            let plane = Plane::from_point_normal(corner.as_dvec3(), inwards);
            part = match part.split(&plane.expect("an axis has a length")) {
                Split::Front(part) | Split::Coplanar(part) => part,
                Split::Spanning { front, .. } => front,
                Split::Back(_) => return 0.0,
            };
        }
    }
    part.area()
}

proptest! {
    #[test]
    fn the_overlap_is_that_of_the_definition(mesh in mesh()) {
        assert_overlap_of_the_definition(&mesh);
    }
}

fn assert_overlap_of_the_definition(mesh: &TriangleMesh) {
    let single = BvhOptions::fast().with_max_leaf_size(1);
    let quantised = options().with_node_format(NodeFormat::Quantised);
    for options in [options(), single, quantised] {
        let bvh = build(mesh, &options);
        let found = bvh.end_point_overlap();
        let expected = by_definition(bvh.layout(), bvh.inner_node_cost());
        let tolerance = 1e-9 * expected.max(1.0);
        assert!((found - expected).abs() <= tolerance, "{found} {expected}");
    }
}

/// A triangle of which planes of the other one's box cut off two points a rounding apart, in the same place of a third plane.
#[test]
fn a_corner_that_was_cut_twice_counts_once() {
    let [a, b, c] = [Vec3::Y, 2.0 * Vec3::Z, -Vec3::X];
    let others = [Vec3::new(3.0, -2.0, 1.0), a, Vec3::new(-3.0, 2.0, 3.0)];
    assert_overlap_of_the_definition(&soup(vec![[a, b, c], others]));
}

/// A part of a row of triangles moved to a second leaf as well: it is below the ancestors of both.
#[test]
fn a_triangle_in_several_leaves_is_below_all_their_ancestors() {
    let options = BvhOptions::default()
        .with_max_leaf_size(1)
        .with_costs(0.1, 1.0);
    let triangles = (0..40u8).map(|i| {
        let corner = Vec3::X * 0.25 * f32::from(i);
        [corner, corner + Vec3::ONE, corner + Vec3::Y]
    });
    let bvh = build(&soup(triangles.collect()), &options);
    let mut layout = bvh.layout().clone();
    assert!(layout.nodes.len() > 2, "several levels");
    for (from, to) in [(1, 30), (20, 21), (7, 8), (7, 33), (40, 2)] {
        let copied = layout.blocks[from].triangles().next().expect("used");
        let kept: Vec<_> = layout.blocks[to].triangles().collect();
        layout.blocks[to] = TriangleBlock::new(kept.into_iter().chain([copied]));
    }
    let found = end_point_overlap(&layout, 0.75);
    let expected = by_definition(&layout, 0.75);
    assert!(expected > 1.0, "{expected}");
    assert!(
        (found - expected).abs() <= 1e-9 * expected,
        "{found} {expected}"
    );
    assert!(
        (found - bvh.end_point_overlap()).abs() > 0.01,
        "the copies show"
    );
}

#[test]
fn a_square_of_a_triangle_in_the_box_of_another_is_weighed_by_all_areas() {
    // The second triangle has the unit square at its corner in the box of the first; its own box is flat, and meets the first triangle in a
    // segment.
    let slanted = [
        Vec3::ZERO,
        Vec3::new(2.0, 0.0, 2.0),
        Vec3::new(0.0, 2.0, 2.0),
    ];
    let level = [
        Vec3::ONE,
        Vec3::new(5.0, 1.0, 1.0),
        Vec3::new(1.0, 5.0, 1.0),
    ];
    // One leaf, a leaf of two, and two of those: each has the triangles of the other in it.
    let slanted_area = 2.0 * 3f64.sqrt();
    for (count, cost) in [
        (1, 1.0),
        (2, 2.0),
        (4, 2.0 + 2.0 + 2.0 * 4.0 * slanted_area),
    ] {
        let mut triangles = vec![slanted; count];
        triangles.push(level);
        let options = BvhOptions::default()
            .with_max_leaf_size(2)
            .with_costs(0.05, 0.5);
        let overlap = build(&soup(triangles), &options).end_point_overlap();
        let total = slanted_area * count as f64 + 8.0;
        assert!((overlap - cost / total).abs() < 1e-14, "{count}: {overlap}");
    }
}

#[test]
fn a_triangle_in_the_flat_box_of_another_counts() {
    // Two halves of a square: each has the other in its box.
    let [a, b, c, d] = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y];
    let mesh = soup(vec![[a, b, c], [a, c, d]]);
    let bvh = build(&mesh, &BvhOptions::default().with_max_leaf_size(1));
    assert_eq!(bvh.end_point_overlap(), 1.0);
}

#[test]
fn disjoint_boxes_do_not_overlap() {
    let triangles = (0..1000u16).map(|index| {
        let place = Vec3::new(
            f32::from(index % 10),
            f32::from(index / 10 % 10),
            f32::from(index / 100),
        );
        [Vec3::X, Vec3::Y, Vec3::Z].map(|corner| place + 0.5 * corner)
    });
    let bvh = build(&soup(triangles.collect()), &BvhOptions::default());
    assert!(bvh.node_count() > 100, "many boxes");
    assert_eq!(bvh.end_point_overlap(), 0.0);
}

#[test]
fn degenerate_meshes_have_a_finite_overlap() {
    for (name, mesh) in degenerate_meshes() {
        let bvh = build(&mesh, &options());
        let overlap = bvh.end_point_overlap();
        assert!(overlap.is_finite() && overlap >= 0.0, "{name}: {overlap}");
        if mesh.triangles().all(|triangle| triangle.is_degenerate()) {
            assert_eq!(overlap, 0.0, "{name}");
        }
    }
}

#[test]
fn threads_do_not_show_in_the_overlap() {
    let point = |i: u32, factor: u32| (i.wrapping_mul(factor) % 8191) as f32;
    let triangles = (0..3000).map(|i| {
        let corner = Vec3::new(point(i, 48_271), point(i, 69_621), point(i, 16_807));
        [
            corner,
            corner + 500.0 * Vec3::X,
            corner + Vec3::new(0.0, 300.0, 700.0),
        ]
    });
    let bvh = build(&soup(triangles.collect()), &BvhOptions::default());
    let overlaps = [1, 2, 4].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads can be started")
            .install(|| bvh.end_point_overlap())
    });
    assert!(overlaps[0] > 1.0, "{overlaps:?}");
    assert_eq!(overlaps.map(f64::to_bits), [overlaps[0].to_bits(); 3]);
}
