use tahko_geometry::Aabb;
use tahko_geometry::glam::Vec3;

use super::*;

const FIRST: usize = 100;

/// Boxes of unit size along an axis, from these places on.
fn boxes(places: &[f32]) -> Vec<Bounds> {
    let boxes = places.iter().map(|x| {
        let corner = Vec3::new(*x, 0.0, 0.0);
        Bounds::new(&Aabb::new(corner, corner + Vec3::ONE))
    });
    boxes.collect()
}

fn rules(boxes: &[Bounds], max_leaf_size: usize) -> Rules {
    let all = boxes
        .iter()
        .fold(Bounds::EMPTY, |all, bounds| all.union(*bounds));
    let options = BvhOptions::fast().with_max_leaf_size(max_leaf_size);
    Rules::new(CentroidScale::new(&all.to_aabb()), &options)
}

/// The triangles of each cluster after a round, by their places.
fn after_a_round(places: &[f32]) -> Vec<Vec<usize>> {
    let boxes = boxes(places);
    let rules = rules(&boxes, 1);
    let mut clusters = Clusters::new(boxes, FIRST, &rules);
    clusters.merge_neighbours(&rules);
    let (nodes, roots) = clusters.finish();
    roots.iter().map(|root| listed(root, &nodes)).collect()
}

fn listed(node: &BuildNode, nodes: &[BuildNode]) -> Vec<usize> {
    match node.link() {
        Link::Leaf { first, count } => (first - FIRST..first - FIRST + count).collect(),
        Link::Inner(children) => {
            let below = children.map(|child| listed(&nodes[child], nodes));
            below.concat()
        }
    }
}

#[test]
fn neighbours_merge_that_have_no_cheaper_one() {
    // Distances 3, 2, 4, 1: the second and the fourth are the least on both sides.
    let found = after_a_round(&[0.0, 3.0, 5.0, 9.0, 10.0]);
    assert_eq!(found, [vec![0], vec![1, 2], vec![3, 4]]);
    // Ever nearer: only the last two.
    let found = after_a_round(&[0.0, 8.0, 12.0, 14.0, 15.0]);
    assert_eq!(found, [vec![0], vec![1], vec![2], vec![3, 4]]);
    // Ever farther: only the first two.
    let found = after_a_round(&[0.0, 1.0, 3.0, 7.0]);
    assert_eq!(found, [vec![0, 1], vec![2], vec![3]]);
}

#[test]
fn equal_clusters_merge_in_pairs() {
    for count in 1..10 {
        let found = after_a_round(&vec![0.0; count]);
        let pairs: Vec<Vec<usize>> = (0..count)
            .step_by(2)
            .map(|first| (first..count.min(first + 2)).collect())
            .collect();
        assert_eq!(found, pairs, "{count}");
    }
    assert!(after_a_round(&[]).is_empty(), "nothing to merge");
}

/// Merges scattered boxes round by round and checks what stays true.
#[test]
fn clusters_are_trees_over_their_triangles_in_order_at_any_time() {
    let mut state = 1u32;
    let places = std::iter::repeat_with(|| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 20) as f32
    });
    let places: Vec<f32> = places.take(300).collect();
    let boxes = boxes(&places);
    for max_leaf_size in [1, 3, 8, 100] {
        let rules = rules(&boxes, max_leaf_size);
        for rounds in 0..10 {
            let mut clusters = Clusters::new(boxes.clone(), FIRST, &rules);
            for _ in 0..rounds {
                let before = clusters.len();
                clusters.merge_neighbours(&rules);
                assert!(
                    clusters.len() < before || before == 1,
                    "at least one merges"
                );
            }
            let (nodes, roots) = clusters.finish();
            let all = roots.iter().flat_map(|root| listed(root, &nodes));
            assert!(all.eq(0..300), "{rounds} rounds");
            for node in nodes.iter().chain(&roots) {
                check(node, &nodes, &boxes, max_leaf_size.min(LANES));
            }
        }
    }
}

/// A node's box is that of the boxes that it lists, and a leaf is not too large.
fn check(node: &BuildNode, nodes: &[BuildNode], boxes: &[Bounds], max_leaf_size: usize) {
    let listed = listed(node, nodes).into_iter();
    let bounds = listed.fold(Bounds::EMPTY, |all, place| all.union(boxes[place]));
    assert_eq!(node.bounds(), bounds.to_aabb());
    if let Link::Leaf { count, .. } = node.link() {
        assert!((1..=max_leaf_size).contains(&count), "{count}");
    }
}
