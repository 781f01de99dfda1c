//! The tree over the clusters of all chunks.

use super::clusters::{Chunk, Cluster, ClusterLink, MAX_ROUNDS};
use super::node::{BuildNode, Link, Shift, take};
use super::reference::Reference;
use super::{MAX_DEPTH, TriangleNumber, top_down};
use crate::control::Work;
use crate::parallel::for_each;
use crate::{BuildControl, BuildError, BvhOptions};

/// The tree whose leaves are the clusters, with what is below them; and the triangles in the order of its leaves.
///
/// # Errors
/// If the build was cancelled.
pub(super) fn join(
    chunks: &[Chunk],
    numbers: &[TriangleNumber],
    options: &BvhOptions,
    control: &BuildControl,
) -> Result<(Vec<BuildNode>, Vec<TriangleNumber>), BuildError> {
    let clusters: Vec<(&Cluster, &[BuildNode], usize)> = chunks.iter().flat_map(located).collect();
    let mut references: Vec<Reference> = clusters
        .iter()
        .enumerate()
        .map(|(index, (cluster, ..))| cluster.bounds.to_reference(index))
        .collect();
    let top_options = options.clone().with_max_leaf_size(1);
    // As much in all as one for each triangle, as a cluster has about sixteen.
    let work = Work {
        control,
        weight: 16,
    };
    let top = top_down::build(&mut references, &top_options, MAX_DEPTH - MAX_ROUNDS, &work)?;

    let node_count = top.len() + chunks.iter().map(|chunk| chunk.nodes.len()).sum::<usize>();
    let mut nodes = vec![BuildNode::UNUSED; node_count];
    let mut listed = vec![TriangleNumber(0); numbers.len()];
    let (top_nodes, mut nodes_left) = nodes.split_at_mut(top.len());
    top_nodes.copy_from_slice(&top);
    let mut listed_left = &mut *listed;
    let mut next_node = top.len();
    let mut next_listed = 0;
    let mut roots = Vec::with_capacity(clusters.len());
    let mut copies = Vec::with_capacity(clusters.len());
    for reference in references {
        let (cluster, below, place) = clusters[reference.number() as usize];
        let first = cluster.first as usize;
        let triangles = &numbers[first..first + cluster.count as usize];
        let shifts = (Shift::new(place, next_node), Shift::new(first, next_listed));
        roots.push(cluster.node().moved(shifts.0, shifts.1));
        next_node += below.len();
        next_listed += triangles.len();
        copies.push((
            (take(&mut nodes_left, below.len()), below),
            (take(&mut listed_left, triangles.len()), triangles),
            shifts,
        ));
    }
    for_each(copies, |(nodes, numbers, (node_shift, number_shift))| {
        for (target, node) in nodes.0.iter_mut().zip(nodes.1) {
            *target = node.moved(node_shift, number_shift);
        }
        numbers.0.copy_from_slice(numbers.1);
    });
    for node in top_nodes {
        if let Link::Leaf { first, .. } = node.link() {
            *node = roots[first];
        }
    }
    Ok((nodes, listed))
}

/// The clusters of a chunk, each with the nodes below it and their place in the chunk's list.
fn located(chunk: &Chunk) -> impl Iterator<Item = (&Cluster, &[BuildNode], usize)> {
    let place = |cluster: &Cluster| match cluster.link {
        ClusterLink::Inner(child) => Some(child as usize),
        ClusterLink::Leaf => None,
    };
    let mut end = chunk.nodes.len();
    // Backwards: the nodes of a cluster end where those of the next one begin.
    let located = chunk.clusters.iter().rev().map(move |cluster| {
        let begin = place(cluster).unwrap_or(end);
        let below = &chunk.nodes[begin..end];
        end = begin;
        (cluster, below, begin)
    });
    located.collect::<Vec<_>>().into_iter().rev()
}
