use proptest::prelude::*;
use tahko_geometry::TriangleMesh;
use tahko_geometry::glam::Vec3;
use tahko_geometry::test_support::{grid_point, point, soup};

use super::*;

fn costs(node: f32, max_leaf_size: usize) -> Costs {
    Costs {
        node,
        max_leaf_size,
    }
}

/// A binary tree whose leaves have at most `leaf_size` triangles.
fn tree(mesh: &TriangleMesh, leaf_size: usize) -> BinaryTree {
    let options = BvhOptions::default()
        .with_max_leaf_size(leaf_size)
        .with_costs(0.01, 1.0);
    BinaryTree::of(mesh, &options)
}

/// The references below a node of the binary tree.
fn count(tree: &BinaryTree, index: usize) -> usize {
    match tree.node(index).1 {
        Link::Leaf { count, .. } => count,
        Link::Inner(children) => children.map(|child| count(tree, child)).iter().sum(),
    }
}

fn area(tree: &BinaryTree, index: usize) -> f64 {
    tree.node(index).0.half_area() / tree.node(0).0.half_area()
}

fn cost_as_leaf(tree: &BinaryTree, index: usize) -> f64 {
    area(tree, index) * count(tree, index).div_ceil(LANES) as f64
}

/// All ways to cut a subtree into subtrees.
fn cuts(tree: &BinaryTree, index: usize) -> Vec<Vec<usize>> {
    let mut cuts = vec![vec![index]];
    if let Link::Inner(children) = tree.node(index).1 {
        cuts.extend(cuts_below(tree, children));
    }
    cuts
}

fn cuts_below(tree: &BinaryTree, [first, second]: [usize; 2]) -> Vec<Vec<usize>> {
    let (first, second) = (cuts(tree, first), cuts(tree, second));
    let pairs = first
        .iter()
        .flat_map(|a| second.iter().map(move |b| [&a[..], &b[..]].concat()));
    pairs.collect()
}

/// The least cost of a subtree as one tree, by trying all of them.
fn least_cost(tree: &BinaryTree, index: usize, costs: &Costs) -> f64 {
    let Link::Inner(children) = tree.node(index).1 else {
        return cost_as_leaf(tree, index);
    };
    let cuts = cuts_below(tree, children).into_iter();
    let inner = cuts.filter(|cut| cut.len() <= LANES).map(|cut| {
        let below: f64 = cut
            .iter()
            .map(|child| least_cost(tree, *child, costs))
            .sum();
        area(tree, index) * f64::from(costs.node) + below
    });
    let inner = inner.fold(f64::INFINITY, f64::min);
    if count(tree, index) <= costs.max_leaf_size {
        inner.min(cost_as_leaf(tree, index))
    } else {
        inner
    }
}

/// The cost of the trees that a collapse chose; checks that they are allowed.
fn cost(tree: &BinaryTree, collapse: &Collapse<'_>, root: Root, costs: &Costs) -> f64 {
    let is_leaf = matches!(tree.node(root.index()).1, Link::Leaf { .. });
    if root.is_leaf() {
        let count = count(tree, root.index());
        assert!(is_leaf || count <= costs.max_leaf_size, "{count} triangles");
        return cost_as_leaf(tree, root.index());
    }
    assert!(!is_leaf, "a leaf has no children");
    let mut children = Vec::new();
    collapse.children(root.index(), &mut children);
    let is_last = children.iter().map(|child| child.is_last());
    assert!(
        is_last
            .rev()
            .enumerate()
            .all(|(place, last)| last == (place == 0)),
        "the last one"
    );
    assert!((2..=LANES).contains(&children.len()), "{children:?}");
    let counts = children.iter().map(|child| count(tree, child.index()));
    assert_eq!(counts.sum::<usize>(), count(tree, root.index()));
    let below = children.iter();
    let below = below.map(|child| cost(tree, collapse, *child, costs));
    area(tree, root.index()) * f64::from(costs.node) + below.sum::<f64>()
}

fn small_mesh() -> impl Strategy<Value = TriangleMesh> {
    let small = (point(1.0), prop::array::uniform3(point(0.2)))
        .prop_map(|(center, offsets)| offsets.map(|offset| center + offset))
        .boxed();
    let grid = prop::array::uniform3(grid_point()).boxed();
    let soups = [small, grid].map(|corners| prop::collection::vec(corners, 1..13).prop_map(soup));
    let [small, grid] = soups;
    prop_oneof![small, grid]
}

proptest! {
    #[test]
    fn no_other_collapse_is_cheaper(
        mesh in small_mesh(),
        node in prop::sample::select(vec![0.0f32, 0.1, 0.5, 1.0, 1.5, 4.0]),
        max_leaf_size in 1usize..6,
    ) {
        let (tree, costs) = (tree(&mesh, 1), costs(node, max_leaf_size));
        prop_assume!(tree.node(0).0.half_area() > 0.0);
        let collapse = Collapse::new(&tree, &costs);
        let found = cost(&tree, &collapse, collapse.root(), &costs);
        let least = least_cost(&tree, 0, &costs);
        prop_assert!((found - least).abs() <= 1e-5 * least, "{found} instead of {least}");
    }
}

fn row(count: u16) -> TriangleMesh {
    let triangles = (0..count).map(|i| {
        let corner = Vec3::X * f32::from(i);
        [corner, corner + 0.5 * Vec3::X, corner + Vec3::Y]
    });
    soup(triangles.collect())
}

#[test]
fn full_blocks_are_made_where_nodes_are_dear_and_single_triangles_where_they_are_not() {
    let tree = tree(&row(64), 1);
    let leaves = |node: f32| {
        let costs = costs(node, 8);
        let collapse = Collapse::new(&tree, &costs);
        let (mut pending, mut sizes) = (vec![collapse.root()], Vec::new());
        while let Some(next) = pending.pop() {
            if next.is_leaf() {
                sizes.push(count(&tree, next.index()));
            } else {
                collapse.children(next.index(), &mut pending);
            }
        }
        sizes
    };
    assert_eq!(leaves(100.0), [8; 8]);
    assert_eq!(leaves(0.0), [1; 64]);
}

#[test]
fn costs_of_any_ratio_and_boxes_of_any_size_leave_no_leaf_that_is_too_large() {
    for size in [1e-38, 1e-20, 1.0, 1e18, 1e36] {
        let mesh = row(100);
        let vertices = mesh.vertices().iter().map(|vertex| *vertex * size);
        let mesh = TriangleMesh::new(vertices.collect(), mesh.indices().to_vec());
        let tree = tree(&mesh.expect("finite"), 1);
        for (traversal, intersection) in [(1.5, 1.0), (1e300, 1e-300), (1e-300, 1e300)] {
            let options = BvhOptions::default()
                .with_costs(traversal, intersection)
                .with_max_leaf_size(4);
            let costs = Costs::new(&options);
            let collapse = Collapse::new(&tree, &costs);
            let found = cost(&tree, &collapse, collapse.root(), &costs);
            assert!(found.is_finite(), "{size}: {found}");
        }
    }
}

#[test]
fn a_leaf_that_cannot_be_split_is_kept_whatever_its_size() {
    let tree = tree(&row(9), 9);
    let costs = costs(0.1, 1);
    let collapse = Collapse::new(&tree, &costs);
    let root = collapse.root();
    let is_leaf = matches!(tree.node(0).1, Link::Leaf { .. });
    assert_eq!(root.is_leaf(), is_leaf);
    assert!(cost(&tree, &collapse, root, &costs) > 0.0, "allowed");
}
