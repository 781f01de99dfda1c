use tahko_geometry::{Aabb, TriangleMesh, glam::Vec3};

use super::*;
use crate::BvhOptions;
use crate::node::Siblings;

/// A tree over four separate triangles with one triangle per leaf: seven nodes.
fn layout() -> Bvh2 {
    let vertices = (0u8..4).flat_map(|i| {
        let corner = Vec3::X * 4.0 * f32::from(i);
        [corner, corner + Vec3::X, corner + Vec3::Y]
    });
    let indices = vec![[0, 1, 2], [3, 4, 5], [6, 7, 8], [9, 10, 11]];
    let mesh = TriangleMesh::new(vertices.collect(), indices).expect("finite vertices");
    let options = BvhOptions::default().with_max_leaf_size(1);
    let bvh = Bvh::build(&mesh, &options).expect("options in range");
    assert_eq!(bvh.node_count(), 7);
    bvh.layout().clone()
}

fn fault(break_it: impl FnOnce(&mut Bvh2)) -> ValidationError {
    let mut layout = layout();
    break_it(&mut layout);
    Validation::new(&layout)
        .run()
        .expect_err("the tree is broken")
}

fn leaf_of(layout: &mut Bvh2) -> &mut Node {
    let nodes = layout.siblings.iter_mut().flat_map(|Siblings(pair)| pair);
    nodes
        .into_iter()
        .find(|node| node.is_leaf())
        .expect("a tree has leaves")
}

#[test]
fn a_tree_as_built_is_well_formed() {
    assert_eq!(Validation::new(&layout()).run(), Ok(()));
}

#[test]
fn a_missing_root_is_found() {
    assert_eq!(fault(|tree| tree.root = None), ValidationError::NoRoot);
}

#[test]
fn children_out_of_range_are_found() {
    let error = fault(|tree| tree.root = Some(Node::inner(&tree.bounds(), 99)));
    let expected = ValidationError::ChildrenOutOfRange {
        node: 0,
        index: 99,
        count: 3,
    };
    assert_eq!(error, expected);
}

#[test]
fn a_loop_is_found_and_ends() {
    let error = fault(|tree| {
        let bounds = tree.bounds();
        let pair = &mut tree.siblings[0].0;
        pair[1] = Node::inner(&bounds, 0);
    });
    assert_eq!(error, ValidationError::ReachedTwice { node: 1 });
}

#[test]
fn nodes_that_nothing_reaches_are_found() {
    let error = fault(|tree| tree.siblings.push(tree.siblings[0]));
    assert_eq!(error, ValidationError::NotReached { node: 7 });
}

#[test]
fn leaves_out_of_range_are_found() {
    let error = fault(|tree| {
        let leaf = leaf_of(tree);
        *leaf = Node::leaf(&leaf.bounds(), 3, 2);
    });
    assert!(
        matches!(
            error,
            ValidationError::TrianglesOutOfRange {
                end: 5,
                count: 4,
                ..
            }
        ),
        "{error}"
    );
}

#[test]
fn a_box_that_is_too_small_is_found() {
    let error = fault(|tree| {
        let leaf = leaf_of(tree);
        let Aabb { min, max } = leaf.bounds();
        let small = Aabb::new(min, max - Vec3::X * 0.5);
        let first = u32::try_from(leaf.first()).expect("one of four triangles");
        *leaf = Node::leaf(&small, first, 1);
    });
    assert!(
        matches!(error, ValidationError::NotCovered { times: 1, .. }),
        "{error}"
    );
    let error = fault(|tree| {
        let Aabb { min, max } = tree.bounds();
        tree.root = Some(Node::inner(&Aabb::new(min, 0.5 * max), 0));
    });
    assert!(
        matches!(
            error,
            ValidationError::NotEnclosed {
                node: 0,
                content: Content::Node(_)
            }
        ),
        "{error}"
    );
}

#[test]
fn a_triangle_that_is_lost_or_unknown_is_found() {
    let error = fault(|tree| {
        let twin = tree.triangles[0];
        tree.triangles[0].number = tree.triangles[1].number;
        assert_ne!(twin.number, tree.triangles[0].number);
    });
    assert!(
        matches!(error, ValidationError::NotListed { .. }),
        "{error}"
    );
    let error = fault(|tree| tree.triangles[2].number = 4);
    assert!(
        matches!(error, ValidationError::NoSuchTriangle { triangle: 4, .. }),
        "{error}"
    );
}

#[test]
fn a_wrong_depth_is_found() {
    let error = fault(|tree| tree.depth += 1);
    assert!(matches!(error, ValidationError::Depth { .. }), "{error}");
}
