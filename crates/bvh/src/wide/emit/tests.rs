use tahko_geometry::glam::Vec3;
use tahko_geometry::test_support::soup;

use super::*;
use crate::BvhOptions;
use crate::wide::{Costs, Kind};

/// Separate triangles on a grid.
fn mesh(count: u16) -> TriangleMesh {
    let triangles = (0..count).map(|i| {
        let corner = 2.0
            * Vec3::new(
                f32::from(i % 10),
                f32::from(i / 10 % 10),
                f32::from(i / 100),
            );
        [corner, corner + Vec3::X, corner + Vec3::Y]
    });
    soup(triangles.collect())
}

/// Leaves of at most `leaf_size` triangles in the binary tree, joined up to `max_leaf_size` where nodes cost so much.
fn layout(count: u16, leaf_size: usize, max_leaf_size: usize, node: f32) -> WideBvh {
    let mesh = mesh(count);
    let options = BvhOptions::default()
        .with_max_leaf_size(leaf_size)
        .with_costs(0.01, 1.0);
    let tree = BinaryTree::of(&mesh, &options);
    emit_with(&tree, &mesh, max_leaf_size, node)
}

fn emit_with(tree: &BinaryTree, mesh: &TriangleMesh, max_leaf_size: usize, node: f32) -> WideBvh {
    let costs = Costs {
        node,
        max_leaf_size,
    };
    emit(tree, &Collapse::new(tree, &costs), mesh, NodeFormat::Full)
}

fn numbers(layout: &WideBvh, first: usize) -> Vec<u32> {
    let blocks = layout.leaf_blocks(first).iter();
    blocks
        .flat_map(TriangleBlock::triangles)
        .map(|(number, _)| number)
        .collect()
}

#[test]
fn a_mesh_without_triangles_has_the_empty_block_alone() {
    let layout = layout(0, 1, 8, 1.0);
    assert_eq!((layout.root, layout.nodes.len()), (Child::NOTHING, 0));
    assert_eq!(layout.blocks.len(), 1);
    assert_eq!((layout.depth, layout.node_count()), (0, 0));
}

#[test]
fn a_root_that_is_a_leaf_fills_block_after_block_in_the_order_of_the_mesh() {
    let layout = layout(20, 1, 20, 1000.0);
    assert_eq!((layout.root, layout.depth), (Child::leaf(1), 1));
    let used: Vec<u32> = layout
        .blocks
        .iter()
        .map(|block| block.used().count_ones())
        .collect();
    assert_eq!(used, [0, 8, 8, 4]);
    let continues: Vec<bool> = layout.blocks.iter().map(TriangleBlock::continues).collect();
    assert_eq!(continues, [false, true, true, false]);
    assert!(numbers(&layout, 1).into_iter().eq(0..20), "ascending");
    let mesh = mesh(20);
    for (number, triangle) in layout.blocks.iter().flat_map(TriangleBlock::triangles) {
        assert_eq!(triangle, mesh.triangle(number as usize));
    }
}

#[test]
fn a_triangle_that_two_joined_leaves_list_is_listed_once() {
    let mesh = mesh(8);
    let options = BvhOptions::default()
        .with_max_leaf_size(1)
        .with_costs(0.01, 1.0);
    let mut tree = BinaryTree::of(&mesh, &options);
    let kept = tree.references[3].number();
    let lost = [1, 6].map(|place| tree.references[place].number());
    tree.references[1] = tree.references[3];
    tree.references[6] = tree.references[3];
    let layout = emit_with(&tree, &mesh, 8, 1000.0);
    let found = numbers(&layout, 1);
    assert!(found.is_sorted() && found.contains(&kept), "{found:?}");
    assert!(
        (0..8).filter(|number| !lost.contains(number)).eq(found),
        "each once"
    );
}

/// What traversals and the end-point overlap rely on.
#[test]
fn nodes_stand_depth_first_and_blocks_below_a_node_stand_together() {
    for (leaf_size, max_leaf_size, node) in [(1, 1, 1.0), (1, 8, 1.0), (3, 3, 0.1), (1, 20, 2.0)] {
        let layout = layout(900, leaf_size, max_leaf_size, node);
        assert!(layout.nodes.len() > 5, "{} nodes", layout.nodes.len());
        let mut blocks_below = vec![0..0; layout.nodes.len()];
        for (index, node) in layout.nodes.iter().enumerate().rev() {
            let mut ranges = Vec::new();
            let inner = node.children().filter_map(|(_, child)| match child.kind() {
                Kind::Inner(child) => Some(child),
                Kind::Leaf(_) => None,
            });
            let inner: Vec<usize> = inner.collect();
            assert!(inner.is_sorted(), "{inner:?} below {index}");
            assert!(
                inner.first().is_none_or(|first| *first == index + 1),
                "{index}"
            );
            for (_, child) in node.children() {
                ranges.push(match child.kind() {
                    Kind::Inner(child) => blocks_below[child].clone(),
                    Kind::Leaf(first) => first..first + layout.leaf_blocks(first).len(),
                });
            }
            ranges.sort_unstable_by_key(|range| range.start);
            let follow = ranges.windows(2).all(|pair| pair[0].end == pair[1].start);
            assert!(follow, "{ranges:?} below {index}");
            blocks_below[index] = ranges[0].start..ranges[ranges.len() - 1].end;
        }
        assert_eq!(blocks_below[0], 1..layout.blocks.len());
    }
}

#[test]
fn the_depth_is_that_of_the_deepest_way() {
    // Single triangles in full nodes: 8, 64 and 512 of them take one, two and three levels of nodes.
    for (count, levels) in [(1, 0), (8, 1), (9, 2), (64, 2), (512, 3)] {
        let layout = layout(count, 1, 1, 1.0);
        assert!(
            (levels + 1..=levels + 2).contains(&layout.depth),
            "{count}: {}",
            layout.depth
        );
    }
}

#[test]
fn what_is_larger_than_the_caches_is_known() {
    assert!(layout(20, 1, 8, 1.0).is_cached);
    // More blocks than there is room for.
    let count = CACHED / size_of::<TriangleBlock>() + 1;
    let corners = (0..count).map(|i| Vec3::new(i as f32, 0.0, 0.0));
    let mesh = soup(corners.map(|at| [at, at + Vec3::X, at + Vec3::Y]).collect());
    let tree = BinaryTree::of(&mesh, &BvhOptions::fast().with_max_leaf_size(1));
    assert!(!emit_with(&tree, &mesh, 1, 1.0).is_cached);
}
