use proptest::prelude::*;
use tahko_geometry::test_support::{degenerate_meshes, mesh, soup};
use tahko_geometry::{Plane, Polygon, Split, Triangle, TriangleMesh};

use super::*;
use crate::BvhOptions;

/// Leaves of one triangle where the costs allow, and costs that are told apart.
fn options() -> BvhOptions {
    BvhOptions::high_quality()
        .with_max_leaf_size(2)
        .with_costs(0.75, 2.0)
}

fn build(mesh: &TriangleMesh, options: &BvhOptions) -> Bvh {
    Bvh::build(mesh, options).expect("options in range")
}

/// The overlap by its definition: every node against every triangle, the part in a box by the splitting of polygons.
fn by_definition(bvh: &Bvh) -> f64 {
    let layout = bvh.layout();
    let total: f64 = layout
        .triangles
        .iter()
        .map(|leaf| leaf.triangle.area())
        .sum();
    let mut sum = 0.0;
    for node in layout.nodes() {
        let mut is_below = vec![false; layout.triangles.len()];
        mark_below(layout, node, &mut is_below);
        let cost = if node.is_leaf() {
            node.count() as f64
        } else {
            bvh.options().traversal_cost / bvh.options().intersection_cost
        };
        let others = layout.triangles.iter().zip(&is_below);
        let others = others.filter(|(_, is_below)| !**is_below);
        sum += cost
            * others
                .map(|(leaf, _)| area_in(&leaf.triangle, &node.bounds()))
                .sum::<f64>();
    }
    if total > 0.0 { sum / total } else { 0.0 }
}

fn mark_below(layout: &Bvh2, node: &Node, is_below: &mut [bool]) {
    if node.is_leaf() {
        is_below[node.first()..][..node.count()].fill(true);
    } else {
        for child in &layout.siblings[node.first()].0 {
            mark_below(layout, child, is_below);
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
        for options in [options(), BvhOptions::fast().with_max_leaf_size(1)] {
            let bvh = build(&mesh, &options);
            let (found, expected) = (bvh.end_point_overlap(), by_definition(&bvh));
            prop_assert!((found - expected).abs() <= 1e-9 * expected.max(1.0), "{found} {expected}");
        }
    }
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
    // One leaf, a leaf of two, and two of those below an inner node with the same box: each has the triangles of the other in it.
    let slanted_area = 2.0 * 3f64.sqrt();
    for (count, cost) in [
        (1, 1.0),
        (2, 2.0),
        (4, 0.75 + 2.0 + 2.0 + 2.0 * 4.0 * slanted_area),
    ] {
        let mut triangles = vec![slanted; count];
        triangles.push(level);
        let options = BvhOptions::default()
            .with_max_leaf_size(2)
            .with_costs(0.75 * 0.5, 0.5);
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
    assert!(bvh.node_count() > 500, "many boxes");
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
