//! The fast build: clusters bottom up, and a tree over the clusters top down.
//!
//! Triangles are sorted along a space-filling curve and cut into chunks of equal number. In each chunk the cheapest
//! neighbours on the curve merge, round by round, until a small part of them is left. Then the clusters of all
//! chunks are split top down by the surface area heuristic, as in [`top_down`](super::top_down): near the root, where it matters
//! most, the tree is as good as one built top down from triangles.
//!
//! Source: Meister and Bittner, "Parallel locally-ordered clustering for bounding volume hierarchy construction",
//! 2018, with the search radius of one of Benthin and others, "PLOC++", 2022: then clusters are runs of the curve, and leaves
//! of several triangles come for free. Differs in clustering by chunks, which share nothing and stay in the cache, and in
//! leaving the top to the heuristic, as Garanzha and others, "Simpler and faster HLBVH with work queues", 2011, do.

use tahko_geometry::{Triangle, TriangleMesh};

use super::node::{BuildNode, Link, Shift};
use super::reference::{Bounds, CentroidScale};
use super::{LEAF_SIZE, TriangleNumber, join};
use crate::control::Work;
use crate::parallel::map_range;
use crate::{BuildControl, BuildError, BvhOptions};

/// Triangles in a chunk: their clusters stay in the second level cache of any processor.
const CHUNK: usize = 2048;

/// Clustering in a chunk ends when this part of the triangles is left as clusters.
const SHRINK: usize = 16;

/// What a node costs below the size of a leaf, in tests of a leaf. Less than a visit: the layout joins nodes of few children,
/// so all that another node takes is a place among eight.
const NODE_COST: f32 = 0.3;

/// The most rounds of clustering. Each makes a cluster at most one level deeper, and usually a third fewer; where it does
/// not (triangles nested in geometric progression), more clusters are left to the build from the top.
pub(super) const MAX_ROUNDS: usize = 12;

/// The nodes of the tree of a mesh with at least one triangle, and the triangles in the order of the leaves.
///
/// Cost: O(n) time for the clusters and O(m log m) for the m clusters.
///
/// # Errors
/// If the build was cancelled.
#[expect(clippy::cast_possible_truncation, reason = "at most 4")]
pub(super) fn build(
    mesh: &TriangleMesh,
    numbers: &[TriangleNumber],
    scale: CentroidScale,
    options: &BvhOptions,
    control: &BuildControl,
) -> Result<(Vec<BuildNode>, Vec<TriangleNumber>), BuildError> {
    let clustering = Clustering {
        mesh,
        numbers,
        scale,
        max_leaf_size: options.max_leaf_size.min(LEAF_SIZE) as u32,
        work: Work { control, weight: 4 },
    };
    let chunks = map_range(numbers.len().div_ceil(CHUNK), |chunk| {
        clustering.chunk(chunk * CHUNK)
    });
    control.check()?;
    join::join(&chunks, numbers, options, control)
}

/// What is left of a chunk.
#[derive(Default)]
pub(super) struct Chunk {
    /// The nodes below the clusters, those of each cluster in a row, children after their parents.
    pub(super) nodes: Vec<BuildNode>,
    pub(super) clusters: Vec<Cluster>,
}

/// A subtree whose root is not yet in a list of nodes.
#[derive(Clone, Copy)]
pub(super) struct Cluster {
    pub(super) bounds: Bounds,
    /// Leaves that a ray through the scene is expected to test in it, times the area of the scene; nodes in proportion.
    cost: f32,
    /// Its triangles are neighbours in the order of the curve.
    pub(super) first: u32,
    pub(super) count: u32,
    pub(super) link: ClusterLink,
}

#[derive(Clone, Copy)]
pub(super) enum ClusterLink {
    /// The place of the first child in the chunk's list; the second follows it.
    Inner(u32),
    Leaf,
}

impl Cluster {
    /// Its node; the children of inner nodes are numbered as in the chunk's list.
    pub(super) fn node(&self) -> BuildNode {
        let link = match self.link {
            ClusterLink::Inner(child) => Link::Inner([child as usize, child as usize + 1]),
            ClusterLink::Leaf => Link::Leaf {
                first: self.first as usize,
                count: self.count as usize,
            },
        };
        BuildNode::new(&self.bounds.to_aabb(), link)
    }
}

struct Clustering<'a> {
    mesh: &'a TriangleMesh,
    /// The triangles in the order of the curve.
    numbers: &'a [TriangleNumber],
    scale: CentroidScale,
    max_leaf_size: u32,
    work: Work<'a>,
}

impl Clustering<'_> {
    /// Clusters the chunk that begins at a place in the order; nothing if the build was cancelled.
    fn chunk(&self, begin: usize) -> Chunk {
        if self.work.is_cancelled() {
            return Chunk::default();
        }
        let end = (begin + CHUNK).min(self.numbers.len());
        // Two loops, so that the processor has more loads under way at a time: where triangles lie scattered in memory this
        // saves an eighth of the build, and costs nothing elsewhere.
        let corners: Vec<[u32; 3]> = self.numbers[begin..end]
            .iter()
            .map(|number| self.mesh.indices()[number.number() as usize])
            .collect();
        let mut clusters: Vec<Cluster> = corners
            .into_iter()
            .zip(begin..)
            .map(|(corners, place)| self.leaf(corners, to_u32(place)))
            .collect();
        let mut pairs = Vec::with_capacity(2 * clusters.len());
        for _ in 0..MAX_ROUNDS {
            if clusters.len() * SHRINK <= CHUNK {
                break;
            }
            self.merge_neighbours(&mut clusters, &mut pairs);
        }
        // Pairs were listed before their parents, in the order of the rounds; in a tree they come after them.
        let mut nodes = Vec::with_capacity(pairs.len());
        for cluster in &mut clusters {
            if let ClusterLink::Inner(child) = &mut cluster.link {
                *child = to_u32(list(*child as usize, &pairs, &mut nodes));
            }
        }
        nodes.shrink_to_fit();
        clusters.shrink_to_fit();
        self.work.done(end - begin);
        Chunk { nodes, clusters }
    }

    /// The cluster of one triangle with some vertices, at a place in the order.
    fn leaf(&self, corners: [u32; 3], place: u32) -> Cluster {
        let [a, b, c] = corners.map(|vertex| self.mesh.vertices()[vertex as usize]);
        let bounds = Bounds::new(&Triangle::new(a, b, c).aabb());
        Cluster {
            bounds,
            cost: self.scale.half_area(&bounds),
            first: place,
            count: 1,
            link: ClusterLink::Leaf,
        }
    }

    /// Merges each two neighbours of which neither has a cheaper neighbour on its other side.
    ///
    /// On a tie a cluster at an even place takes the next one, a cluster at an odd place the one before: clusters that are all
    /// the same merge in pairs.
    fn merge_neighbours(&self, clusters: &mut Vec<Cluster>, pairs: &mut Vec<BuildNode>) {
        let length = clusters.len();
        let area = |clusters: &[Cluster], index: usize| {
            clusters.get(index + 1).map_or(f32::INFINITY, |next| {
                self.scale
                    .half_area(&clusters[index].bounds.union(next.bounds))
            })
        };
        let (mut read, mut written) = (0, 0);
        // Areas of the unions of the clusters at `read - 1` and `read`, and at `read` and `read + 1`.
        let mut before = f32::INFINITY;
        let mut here = area(clusters, 0);
        while read + 1 < length {
            let after = area(clusters, read + 1);
            let even = read.is_multiple_of(2);
            let best_of_this = here < before || (here == before && even);
            let best_of_next = here < after || (here == after && even);
            if best_of_this && best_of_next {
                let merged = self.merged(clusters[read], clusters[read + 1], here, pairs);
                clusters[written] = merged;
                read += 2;
                before = after;
                here = if read < length {
                    area(clusters, read)
                } else {
                    0.0
                };
            } else {
                clusters[written] = clusters[read];
                read += 1;
                before = here;
                here = after;
            }
            written += 1;
        }
        if read < length {
            clusters[written] = clusters[read];
            written += 1;
        }
        clusters.truncate(written);
    }

    /// A leaf over two clusters where that is cheaper than a node over both.
    #[inline]
    fn merged(
        &self,
        first: Cluster,
        second: Cluster,
        area: f32,
        pairs: &mut Vec<BuildNode>,
    ) -> Cluster {
        let count = first.count + second.count;
        let inner_cost = NODE_COST * area + first.cost + second.cost;
        let is_leaf = count <= self.max_leaf_size && area <= inner_cost;
        let link = if is_leaf {
            ClusterLink::Leaf
        } else {
            let place = to_u32(pairs.len());
            pairs.extend([first.node(), second.node()]);
            ClusterLink::Inner(place)
        };
        Cluster {
            bounds: first.bounds.union(second.bounds),
            cost: if is_leaf { area } else { inner_cost },
            first: first.first,
            count,
            link,
        }
    }
}

/// Appends a pair of nodes and what is below them to a list, depth first, and returns its place there.
fn list(pair: usize, pairs: &[BuildNode], nodes: &mut Vec<BuildNode>) -> usize {
    let place = nodes.len();
    nodes.extend_from_slice(&pairs[pair..pair + 2]);
    for parent in [place, place + 1] {
        if let Link::Inner([child, _]) = nodes[parent].link() {
            let below = list(child, pairs, nodes);
            nodes[parent] = nodes[parent].moved(Shift::new(child, below), Shift::NONE);
        }
    }
    place
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "meshes have at most 2^29 triangles"
)]
fn to_u32(index: usize) -> u32 {
    index as u32
}
