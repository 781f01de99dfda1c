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

use tahko_geometry::TriangleMesh;

use super::merging::{Clusters, Rules};
use super::node::BuildNode;
use super::reference::{Bounds, CentroidScale};
use super::{TriangleNumber, join};
use crate::control::Work;
use crate::parallel::map_range;
use crate::{BuildControl, BuildError, BvhOptions};

/// Triangles in a chunk: their clusters stay in the second level cache of any processor.
const CHUNK: usize = 2048;

/// Clustering in a chunk ends when this part of the triangles is left as clusters.
const SHRINK: usize = 16;

/// The most rounds of clustering. Each makes a cluster at most one level deeper, and usually a third fewer; where it does
/// not (triangles nested in geometric progression), more clusters are left to the build from the top.
pub(super) const MAX_ROUNDS: usize = 12;

/// The nodes of the tree of a mesh with at least one triangle; its leaves list the triangles in the order given.
///
/// Cost: O(n) time for the clusters and O(m log m) for the m clusters.
///
/// # Errors
/// If the build was cancelled.
pub(super) fn build(
    mesh: &TriangleMesh,
    numbers: &[TriangleNumber],
    scale: CentroidScale,
    options: &BvhOptions,
    control: &BuildControl,
) -> Result<Vec<BuildNode>, BuildError> {
    let clustering = Clustering {
        mesh,
        numbers,
        rules: Rules::new(scale, options),
        work: Work { control, weight: 4 },
    };
    let chunks = map_range(numbers.len().div_ceil(CHUNK), |chunk| {
        clustering.chunk(chunk * CHUNK)
    });
    control.check()?;
    join::join(chunks, options, control)
}

/// What is left of a chunk.
#[derive(Default)]
pub(super) struct Chunk {
    /// The nodes below the clusters, siblings side by side.
    pub(super) nodes: Vec<BuildNode>,
    /// The clusters, in the order of the curve.
    pub(super) roots: Vec<BuildNode>,
}

struct Clustering<'a> {
    mesh: &'a TriangleMesh,
    /// The triangles in the order of the curve.
    numbers: &'a [TriangleNumber],
    rules: Rules,
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
        let vertices = self.mesh.vertices();
        let boxes = corners
            .into_iter()
            .map(|corners| Bounds::of_points(corners.map(|vertex| vertices[vertex as usize])));
        let mut clusters = Clusters::new(boxes.collect(), begin, &self.rules);
        for _ in 0..MAX_ROUNDS {
            if clusters.len() * SHRINK <= CHUNK {
                break;
            }
            clusters.merge_neighbours(&self.rules);
        }
        let (nodes, roots) = clusters.finish();
        self.work.done(end - begin);
        Chunk { nodes, roots }
    }
}
