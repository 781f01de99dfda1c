//! The tree over the clusters of all chunks.

use super::clusters::{Chunk, MAX_ROUNDS};
use super::node::{BuildNode, Link, Shift, concatenate};
use super::reference::Reference;
use super::{MAX_DEPTH, top_down};
use crate::control::Work;
use crate::{BuildControl, BuildError, BvhOptions};

/// The tree whose leaves are the clusters, with what is below them.
///
/// # Errors
/// If the build was cancelled.
pub(super) fn join(
    chunks: Vec<Chunk>,
    options: &BvhOptions,
    control: &BuildControl,
) -> Result<Vec<BuildNode>, BuildError> {
    let cluster_count = chunks.iter().map(|chunk| chunk.roots.len()).sum();
    let mut clusters = Vec::with_capacity(cluster_count);
    let mut blocks = Vec::with_capacity(chunks.len());
    let mut place = 0;
    for chunk in chunks {
        let shift = Shift::new(0, place);
        let roots = chunk.roots.iter();
        clusters.extend(roots.map(|root| root.moved(shift, Shift::NONE)));
        place += chunk.nodes.len();
        blocks.push(chunk.nodes);
    }
    let references = clusters.iter().enumerate();
    let mut references: Vec<Reference> = references
        .map(|(index, cluster)| Reference::of_box(&cluster.bounds(), index))
        .collect();
    let top_options = options.clone().with_max_leaf_size(1);
    // As much in all as one for each triangle, as a cluster has about sixteen.
    let work = Work {
        control,
        weight: 16,
    };
    let mut top = top_down::build(&mut references, &top_options, MAX_DEPTH - MAX_ROUNDS, &work)?;
    let shift = Shift::new(0, top.len());
    for node in &mut top {
        if let Link::Leaf { first, .. } = node.link() {
            let cluster = references[first].number() as usize;
            *node = clusters[cluster].moved(shift, Shift::NONE);
        }
    }
    Ok(concatenate(&top, &blocks))
}
