use tahko_geometry::glam::Vec3;
use tahko_geometry::test_support::soup;
use tahko_geometry::{Triangle, TriangleBlock, TriangleMesh};

use super::*;
use crate::wide::WideNode;
use crate::{BvhOptions, NodeFormat};

/// Separate triangles in a row, one per leaf.
fn mesh(count: u8) -> TriangleMesh {
    let triangles = (0..count).map(|i| {
        let corner = Vec3::X * 4.0 * f32::from(i);
        [corner, corner + Vec3::X, corner + Vec3::Y]
    });
    soup(triangles.collect())
}

fn layout(count: u8, format: NodeFormat) -> WideBvh {
    let options = BvhOptions::default()
        .with_node_format(format)
        .with_max_leaf_size(1)
        .with_costs(0.1, 1.0);
    let bvh = Bvh::build(&mesh(count), &options).expect("options in range");
    bvh.layout().clone()
}

/// A tree of a root with four leaves: blocks 1 to 4.
fn small(format: NodeFormat) -> WideBvh {
    let layout = layout(4, format);
    assert_eq!((layout.nodes.len(), layout.blocks.len()), (1, 5));
    layout
}

fn validate(layout: &WideBvh) -> Result<(), ValidationError> {
    Validation::new(layout).run()
}

/// What is found in a tree of a format that is broken in some way.
fn fault_of(format: NodeFormat, break_it: impl FnOnce(&mut WideBvh)) -> ValidationError {
    let mut layout = small(format);
    break_it(&mut layout);
    validate(&layout).expect_err("the tree is broken")
}

/// What is found in a tree that is broken in some way, whatever its format.
fn fault(break_it: impl Fn(&mut WideBvh)) -> ValidationError {
    let [full, quantised] = NodeFormat::ALL.map(|format| fault_of(format, &break_it));
    assert_eq!(full, quantised);
    full
}

/// Changes a child of the root.
fn change_child(tree: &mut WideBvh, lane: usize, change: impl FnOnce(&mut Aabb, &mut Child)) {
    tree.nodes.change(0, |node| {
        let (mut bounds, mut child) = node.children().nth(lane).expect("the lane is used");
        change(&mut bounds, &mut child);
        node.set(lane, &bounds, child);
    });
}

/// The block of one triangle.
fn block(number: u32, triangle: Triangle) -> TriangleBlock {
    TriangleBlock::new([(number, triangle)])
}

#[test]
fn trees_as_built_are_well_formed() {
    for format in NodeFormat::ALL {
        for count in [0, 1, 4, 60] {
            assert_eq!(
                validate(&layout(count, format)),
                Ok(()),
                "{count} triangles"
            );
        }
    }
}

#[test]
fn a_missing_root_is_found() {
    assert_eq!(
        fault(|tree| tree.root = Child::NOTHING),
        ValidationError::NoRoot
    );
}

#[test]
fn triangles_in_the_place_of_missing_children_are_found() {
    let expected = ValidationError::FirstBlockInUse;
    assert_eq!(fault(|tree| tree.blocks[0] = tree.blocks[1]), expected);
    assert_eq!(
        fault(|tree| tree.blocks[0] = tree.blocks[0].continued()),
        expected
    );
    assert_eq!(fault(|tree| tree.blocks.clear()), expected);
}

#[test]
fn nodes_and_blocks_out_of_range_are_found() {
    let error = fault(|tree| tree.root = Child::inner(99));
    let (content, count) = (Content::Node(99), 1);
    assert_eq!(error, ValidationError::OutOfRange { content, count });
    let error = fault(|tree| tree.root = Child::leaf(5));
    let (content, count) = (Content::Leaf(5), 5);
    assert_eq!(error, ValidationError::OutOfRange { content, count });
    let error = fault(|tree| tree.blocks[4] = tree.blocks[4].continued());
    assert_eq!(error, ValidationError::OutOfRange { content, count });
}

#[test]
fn a_loop_is_found_and_ends() {
    let error = fault(|tree| {
        let bounds = tree.bounds;
        tree.nodes
            .change(0, |node| node.set(3, &bounds, Child::inner(0)));
    });
    let content = Content::Node(0);
    assert_eq!(error, ValidationError::ReachedTwice { content });
}

#[test]
fn a_leaf_of_two_nodes_is_found() {
    let error = fault(|tree| {
        let bounds = tree.bounds;
        let (_, first) = tree.nodes.at(0).children().next().expect("four children");
        tree.nodes.change(0, |node| node.set(4, &bounds, first));
    });
    assert!(
        matches!(error, ValidationError::ReachedTwice { content } if content != Content::Node(0)),
        "{error}"
    );
}

#[test]
fn nodes_and_blocks_that_nothing_reaches_are_found() {
    let error = fault(|tree| tree.nodes.push_copy(0));
    let content = Content::Node(1);
    assert_eq!(error, ValidationError::NotReached { content });
    let error = fault(|tree| tree.blocks.push(tree.blocks[1]));
    let content = Content::Leaf(5);
    assert_eq!(error, ValidationError::NotReached { content });
}

#[test]
fn a_leaf_without_triangles_is_found() {
    let error = fault(|tree| tree.blocks[2] = TriangleBlock::EMPTY);
    assert_eq!(error, ValidationError::EmptyBlock { block: 2 });
}

#[test]
fn a_box_that_is_too_small_is_found() {
    let error = fault_of(NodeFormat::Full, |tree| tree.bounds.max *= 0.5);
    assert!(
        matches!(error, ValidationError::NotEnclosed { node: 0, .. }),
        "{error}"
    );
    // Boxes that are rounded outward may be larger than the bounds; triangles are seen not to be inside.
    let error = fault_of(NodeFormat::Quantised, |tree| tree.bounds.max *= 0.5);
    assert!(matches!(error, ValidationError::NotMet { .. }), "{error}");
    let error = fault(|tree| {
        change_child(tree, 0, |bounds, _| bounds.max.x -= 0.5);
    });
    assert!(
        matches!(error, ValidationError::NotCovered { corner: 1, .. }),
        "{error}"
    );
    let error = fault(|tree| {
        change_child(tree, 0, |bounds, _| {
            bounds.min.y = 2.0;
            bounds.max.y = 1.0;
        });
    });
    assert!(
        matches!(error, ValidationError::NotEnclosed { node: 0, .. }),
        "an empty box: {error}"
    );
}

#[test]
fn a_leaf_that_has_nothing_of_a_triangle_is_found() {
    let error = fault(|tree| {
        let [first, second] = [1, 2].map(|block| tree.blocks[block].triangle(0));
        let [a, b] = [1, 2].map(|block| tree.blocks[block].number(0).expect("used"));
        tree.blocks[1] = block(b, second);
        tree.blocks[2] = block(a, first);
    });
    assert!(matches!(error, ValidationError::NotMet { .. }), "{error}");
}

#[test]
fn a_triangle_that_is_lost_or_listed_twice_or_unknown_is_found() {
    let error = fault(|tree| {
        let triangle = tree.blocks[1].triangle(0);
        let number = tree.blocks[2].number(0).expect("used");
        tree.blocks[1] = block(number, triangle);
    });
    assert!(matches!(error, ValidationError::Differs { .. }), "{error}");
    let error = fault(|tree| {
        let triangle = tree.blocks[2].triangle(0);
        tree.blocks[2] = block(4, triangle);
    });
    let expected = ValidationError::NoSuchTriangle {
        leaf: 2,
        triangle: 4,
        count: 4,
    };
    assert_eq!(error, expected);
    let error = fault(|tree| {
        let (number, triangle) = tree.blocks[2].triangles().next().expect("used");
        tree.blocks[2] = TriangleBlock::new([(number, triangle); 2]);
    });
    assert!(
        matches!(error, ValidationError::ListedTwice { leaf: 2, .. }),
        "{error}"
    );
    let error = fault(|tree| tree.triangle_count = 5);
    assert_eq!(error, ValidationError::NotListed { triangle: 4 });
}

/// A root with two leaves that both list one triangle, each with a box of a part of it.
fn split_triangle([first, second]: [Aabb; 2]) -> WideBvh {
    let mut layout = small(NodeFormat::Full);
    let triangle = Triangle::new(Vec3::ZERO, Vec3::X * 4.0, Vec3::new(1.0, 1.0, 0.0));
    layout.nodes.change(0, |node| {
        *node = WideNode::EMPTY;
        node.set(0, &first, Child::leaf(1));
        node.set(1, &second, Child::leaf(2));
    });
    layout.bounds = triangle.aabb();
    layout.blocks.truncate(1);
    layout.blocks.extend([block(0, triangle); 2]);
    layout.triangle_count = 1;
    layout
}

#[test]
fn leaves_may_share_a_triangle_that_they_cover_together() {
    let cut = |from: f32, to: f32| Aabb::new(Vec3::X * from, Vec3::new(to, 1.0, 0.0));
    let covered = split_triangle([cut(0.0, 2.0), cut(2.0, 4.0)]);
    assert_eq!(validate(&covered), Ok(()));
    let error = validate(&split_triangle([cut(0.0, 2.0), cut(2.0, 3.0)]));
    let (triangle, corner) = (0, 1);
    assert_eq!(error, Err(ValidationError::NotCovered { triangle, corner }));
}

#[test]
fn a_wrong_depth_is_found() {
    let error = fault(|tree| tree.depth += 1);
    assert!(matches!(error, ValidationError::Depth { .. }), "{error}");
}
