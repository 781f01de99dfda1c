//! What is measured: the project's structures and, with the feature `peers`, other libraries, behind one interface.

use std::time::Instant;

use anyhow::Result;
use tahko_tracer::geometry::{Hit, Ray, RayQuery, TriangleMesh};

use crate::report::{self, RayClass, TreeRow};

/// Something that can be built over a mesh.
pub(crate) trait Recipe: Send + Sync {
    /// The contenders that it makes, one for each way of asking it.
    fn names(&self) -> Vec<report::Contender>;

    /// The largest mesh that it is built over.
    fn max_triangles(&self) -> usize {
        usize::MAX
    }

    /// Builds it with at most `threads` threads. The current pool of rayon has as many.
    fn build(&self, mesh: &TriangleMesh, threads: usize) -> Result<Built>;

    /// Builds it once more, as [`build`](Self::build) does, to know the seconds from the indexed mesh until it is ready for the first ray.
    fn time_build(&self, mesh: &TriangleMesh, threads: usize) -> Result<f64> {
        let start = Instant::now();
        let built = self.build(mesh, threads)?;
        let seconds = start.elapsed().as_secs_f64();
        drop(built);
        Ok(seconds)
    }
}

/// A built structure.
pub(crate) struct Built {
    /// One for each of [`Recipe::names`], in the same order.
    pub(crate) contenders: Vec<Box<dyn Contender>>,
    /// Memory that queries need, in bytes, where the library tells.
    pub(crate) bytes: Option<usize>,
    /// What the tree looks like, where it is one of the project's, or the library shows it.
    pub(crate) tree: Option<TreeRow>,
}

/// Something that answers rays.
///
/// The loop over the rays is inside, so that the call through the trait costs nothing per ray. Converting rays and hits to and from a library's own
/// form is part of what is measured.
pub(crate) trait Contender: Send + Sync {
    /// The closest hits; `hits[i]` answers `rays[i]`, and the slices are equally long.
    fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]);

    /// Whether anything is hit; `found[i]` answers `rays[i]`, and the slices are equally long.
    fn any_hits(&self, rays: &[Ray], found: &mut [bool]);

    /// Whether it takes part in a class of rays: packets are for coherent rays, say.
    fn answers(&self, _class: RayClass) -> bool {
        true
    }

    /// The structure to count node visits and tests with, if it is one of the project's.
    fn query(&self) -> Option<&dyn RayQuery> {
        None
    }
}
