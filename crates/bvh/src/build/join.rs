//! The tree over the clusters of all chunks.

use super::clusters::{Chunk, Cluster, ClusterLink, MAX_ROUNDS};
use super::node::{BuildNode, Link, Shift};
use super::reference::Reference;
use super::{MAX_DEPTH, TriangleNumber, top_down};
use crate::control::Work;
use crate::filling::Filling;
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

    // Where the clusters go.
    let node_count = top.len() + chunks.iter().map(|chunk| chunk.nodes.len()).sum::<usize>();
    let (mut next_node, mut next_listed) = (top.len(), 0);
    let roots = references.iter().map(|reference| {
        let (cluster, below, place) = clusters[reference.number() as usize];
        let node_shift = Shift::new(place, next_node);
        let listed_shift = Shift::new(cluster.first as usize, next_listed);
        next_node += below.len();
        next_listed += cluster.count as usize;
        cluster.node().moved(node_shift, listed_shift)
    });
    let roots: Vec<BuildNode> = roots.collect();

    let mut nodes = Filling::new(node_count);
    let mut listed = Filling::new(numbers.len());
    let (mut nodes_left, mut listed_left) = (nodes.whole(), listed.whole());
    let mut tasks = Vec::with_capacity(references.len().div_ceil(TASK));
    for task in references.chunks(TASK).rev() {
        let of_task = || {
            task.iter()
                .map(|reference| clusters[reference.number() as usize])
        };
        let node_count = of_task().map(|(_, below, _)| below.len()).sum();
        let listed_count = of_task().map(|(cluster, ..)| cluster.count as usize).sum();
        let parts = (
            nodes_left.split_last(node_count),
            listed_left.split_last(listed_count),
        );
        tasks.push((task, parts));
    }
    nodes_left.fill_last(top.iter().map(|node| match node.link() {
        Link::Leaf { first, .. } => roots[first],
        Link::Inner(_) => *node,
    }));
    drop((nodes_left, listed_left));
    for_each(tasks, |(task, (mut nodes, mut listed))| {
        for reference in task.iter().rev() {
            let (cluster, below, place) = clusters[reference.number() as usize];
            let (first, count) = (cluster.first as usize, cluster.count as usize);
            let node_shift = Shift::new(place, nodes.end() - below.len());
            let listed_shift = Shift::new(first, listed.end() - count);
            nodes.fill_last(
                below
                    .iter()
                    .map(|node| node.moved(node_shift, listed_shift)),
            );
            listed.fill_last(numbers[first..first + count].iter().copied());
        }
    });
    Ok((nodes.finish(), listed.finish()))
}

/// Clusters that a task copies: some thousand nodes.
const TASK: usize = 256;

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
