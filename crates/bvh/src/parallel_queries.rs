//! Batches on several threads.

use rayon::prelude::*;
use tahko_geometry::{Hit, Ray, RayQuery};

use crate::Bvh;

/// Rays that a thread answers at a time: some milliseconds of work.
const CHUNK: usize = 4096;

impl Bvh {
    /// [`closest_hits`](RayQuery::closest_hits) on the threads of the current rayon pool: the same answers, in the same order.
    ///
    /// # Panics
    /// If the slices differ in length.
    pub fn closest_hits_parallel(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        assert_eq!(rays.len(), hits.len(), "one hit per ray");
        let chunks = rays.par_chunks(CHUNK).zip(hits.par_chunks_mut(CHUNK));
        chunks.for_each(|(rays, hits)| self.closest_hits(rays, hits));
    }

    /// [`any_hits`](RayQuery::any_hits) on the threads of the current rayon pool: the same answers, in the same order.
    ///
    /// # Panics
    /// If the slices differ in length.
    pub fn any_hits_parallel(&self, rays: &[Ray], hits: &mut [bool]) {
        assert_eq!(rays.len(), hits.len(), "one hit per ray");
        let chunks = rays.par_chunks(CHUNK).zip(hits.par_chunks_mut(CHUNK));
        chunks.for_each(|(rays, hits)| self.any_hits(rays, hits));
    }
}

#[cfg(test)]
mod tests {
    use tahko_geometry::glam::Vec3;
    use tahko_geometry::test_support::soup;

    use super::*;
    use crate::BvhOptions;

    #[test]
    fn several_threads_answer_in_order() {
        let mesh = soup(vec![[Vec3::ZERO, Vec3::X, Vec3::Y]; 10]);
        let bvh = Bvh::build(&mesh, &BvhOptions::default()).expect("options in range");
        let rays: Vec<Ray> = (0..2 * CHUNK + 5)
            .map(|i| Ray::new(Vec3::new(i as f32 * 1e-4, 0.1, 1.0), Vec3::NEG_Z))
            .collect();
        let mut hits = vec![None; rays.len()];
        bvh.closest_hits_parallel(&rays, &mut hits);
        let mut found = vec![false; rays.len()];
        bvh.any_hits_parallel(&rays, &mut found);
        for ((ray, hit), found) in rays.iter().zip(hits).zip(found) {
            assert_eq!(hit, bvh.closest_hit(ray));
            assert_eq!(found, hit.is_some());
        }
    }
}
