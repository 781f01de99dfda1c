use proptest::prelude::*;
use tahko_geometry::TriangleMesh;
use tahko_geometry::glam::Vec3;
use tahko_geometry::test_support::{degenerate_meshes, mesh, soup};

use super::pairs::ROOT;
use super::*;
use crate::BvhOptions;
use crate::build::Link;

/// A tree that leaves much to improve.
fn build(mesh: &TriangleMesh) -> BinaryTree {
    let options = BvhOptions::fast().with_bins(2).with_max_leaf_size(1);
    BinaryTree::of(mesh, &options)
}

/// The sum of the half areas of all inner nodes.
fn cost(tree: &BinaryTree) -> f64 {
    let nodes = (0..tree.nodes.len()).map(|node| tree.node(node));
    let inner = nodes.filter(|(_, link)| matches!(link, Link::Inner(_)));
    inner.map(|(bounds, _)| bounds.half_area()).sum()
}

/// What the leaves list, in any order.
fn leaves(tree: &BinaryTree) -> Vec<(Vec<u32>, [[u32; 3]; 2])> {
    let mut leaves = Vec::new();
    for node in 0..tree.nodes.len() {
        if let (bounds, Link::Leaf { first, count }) = tree.node(node)
            && count > 0
        {
            let numbers = tree.references[first..][..count]
                .iter()
                .map(|reference| reference.number());
            let corners =
                [bounds.min, bounds.max].map(|corner| corner.to_array().map(f32::to_bits));
            leaves.push((numbers.collect(), corners));
        }
    }
    leaves.sort_unstable();
    leaves
}

/// Checks the form of a tree: all nodes reached once, tight boxes, depth.
fn check(name: &str, tree: &BinaryTree) {
    let reached = tree.reached(name);
    assert_eq!(reached.len(), tree.nodes.len(), "{name}");
    for node in reached {
        if let (bounds, Link::Inner(children)) = tree.node(node) {
            let [first, second] = children.map(|child| tree.node(child).0);
            assert_eq!(bounds, first.union(second), "{name}: {node}");
        }
    }
}

/// Improves a tree one round at a time and checks it after each. Returns the costs before and after.
fn improve_and_check(name: &str, mesh: &TriangleMesh) -> (f64, f64) {
    let mut tree = build(mesh);
    let expected = leaves(&tree);
    let before = cost(&tree);
    for _ in 0..6 {
        improve(&mut tree, 1, &BuildControl::new()).expect("nobody cancels it");
        check(name, &tree);
        assert_eq!(leaves(&tree), expected, "{name}");
    }
    (before, cost(&tree))
}

proptest! {
    #[test]
    fn trees_keep_their_form_and_their_leaves(mesh in mesh()) {
        if !mesh.is_empty() {
            improve_and_check("random", &mesh);
        }
    }
}

#[test]
fn degenerate_meshes_keep_their_form_and_their_leaves() {
    for (name, mesh) in degenerate_meshes() {
        if !mesh.is_empty() {
            improve_and_check(name, &mesh);
        }
    }
}

/// Rows of small triangles along the axes and some large triangles, at places from a linear congruential generator.
fn mixed_sizes(count: usize) -> TriangleMesh {
    let mut state = 1u32;
    let mut random = move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f32::from((state >> 16) as u16) / 65536.0
    };
    let mut triangles = Vec::new();
    while triangles.len() < count {
        let mut point = || Vec3::new(random(), random(), random());
        let (start, large) = (point(), [point(), point(), point()]);
        let axis = Vec3::AXES[triangles.len() % 3];
        triangles.extend((0..20u8).map(|step| {
            let corner = start + 0.02 * f32::from(step) * axis;
            [corner, corner + 0.01 * point(), corner + 0.01 * point()]
        }));
        triangles.push(large);
    }
    soup(triangles)
}

#[test]
fn triangles_of_mixed_sizes_get_a_cheaper_tree() {
    let (before, after) = improve_and_check("mixed", &mixed_sizes(3000));
    assert!(after < 0.97 * before, "{before} to {after}");
}

#[test]
fn to_look_near_changes_only_finds_nearly_all_that_there_is() {
    let mesh = mixed_sizes(3000);
    let [mut near, mut all] = [build(&mesh), build(&mesh)];
    improve(&mut near, 1, &BuildControl::new()).expect("nobody cancels it");
    let first = cost(&near);
    near = build(&mesh);
    improve(&mut near, 3, &BuildControl::new()).expect("nobody cancels it");
    for _ in 0..3 {
        // The first round of each looks at all.
        improve(&mut all, 1, &BuildControl::new()).expect("nobody cancels it");
    }
    let (near, all) = (first - cost(&near), first - cost(&all));
    assert!(near > 0.8 * all, "a gain of {near} for {all}");
}

#[test]
fn the_gain_that_a_search_promises_is_what_the_move_brings() {
    let tree = build(&mixed_sizes(1000));
    let pairs = PairTree::new(&tree);
    let candidates = pairs.largest(pairs.len());
    let moves = candidates
        .iter()
        .filter_map(|subtree| search::best(&pairs, *subtree as usize));
    let mut count = 0;
    for wanted in moves {
        let mut improved = PairTree::new(&tree);
        let mut changed = vec![false; improved.len()];
        assert!(improved.make(&wanted, &mut changed), "{wanted:?}");
        let mut after = build(&mixed_sizes(1000));
        improved.write_back(&mut after);
        check("one move", &after);
        let gain = cost(&tree) - cost(&after);
        assert!((gain - wanted.gain).abs() < 1e-9, "{gain} for {wanted:?}");
        count += 1;
    }
    assert!(count > 20, "{count} moves");
}

#[test]
fn a_move_into_a_subtree_that_has_moved_below_the_target_is_dropped() {
    // Root, with A (of B and C) and D (of E and F): A goes beside E, and then D cannot go beside B.
    let tree = build(&mixed_sizes(200));
    let mut pairs = PairTree::new(&tree);
    let [first, second] = pairs.children(ROOT).expect("more than a group");
    let below = |pairs: &PairTree, place: usize| pairs.children(place).expect("a large subtree");
    let [a, _] = below(&pairs, first);
    let [inside_a, _] = below(&pairs, a);
    let [d, _] = below(&pairs, second);
    let [inside_d, _] = below(&pairs, d);
    let to = |subtree: usize, target: usize| Move {
        subtree: u32::try_from(subtree).expect("a small tree"),
        target: u32::try_from(target).expect("a small tree"),
        gain: 1.0,
    };
    let mut changed = vec![false; pairs.len()];
    assert!(pairs.make(&to(a, inside_d), &mut changed), "possible");
    changed.fill(false);
    let ancestors = |pairs: &PairTree, mut place: usize| {
        let mut ancestors = Vec::new();
        while place != ROOT {
            place = pairs.parent(place);
            ancestors.push(place);
        }
        ancestors
    };
    let above = ancestors(&pairs, inside_a);
    let moved = above
        .iter()
        .find(|place| **place > 3 && ancestors(&pairs, **place).len() > 1);
    let moved = *moved.expect("an ancestor that may move");
    assert!(!pairs.make(&to(moved, inside_a), &mut changed), "a loop");
    let mut after = build(&mixed_sizes(200));
    pairs.write_back(&mut after);
    check("one of two moves", &after);
    assert_eq!(leaves(&after), leaves(&tree));
}
