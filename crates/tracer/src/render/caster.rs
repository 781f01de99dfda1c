//! Sends rays into a structure and counts them by kind.

use tahko_geometry::{Hit, Precision, Ray, RayQuery};

use super::RenderStatistics;

/// One thread's access to the structure.
pub(crate) struct RayCaster<'a> {
    query: &'a dyn RayQuery,
    count: bool,
    statistics: RenderStatistics,
}

impl<'a> RayCaster<'a> {
    pub(crate) fn new(query: &'a dyn RayQuery, count: bool) -> Self {
        Self {
            query,
            count,
            statistics: RenderStatistics::default(),
        }
    }

    pub(crate) const fn statistics(&self) -> RenderStatistics {
        self.statistics
    }

    /// The precision of the hits, which decides where the rays start that leave them.
    pub(crate) fn precision(&self) -> Precision {
        self.query.precision()
    }

    pub(crate) fn camera_hits(&mut self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        self.statistics.camera_rays += rays.len() as u64;
        if self.count {
            for (ray, hit) in rays.iter().zip(hits) {
                *hit = self
                    .query
                    .closest_hit_counted(ray, &mut self.statistics.counts);
            }
        } else {
            self.query.closest_hits(rays, hits);
        }
    }

    /// The closest hit of a reflected or refracted ray.
    pub(crate) fn secondary_hit(&mut self, ray: &Ray) -> Option<Hit> {
        self.statistics.secondary_rays += 1;
        if self.count {
            self.query
                .closest_hit_counted(ray, &mut self.statistics.counts)
        } else {
            self.query.closest_hit(ray)
        }
    }

    /// Whether a shadow ray meets anything.
    pub(crate) fn is_blocked(&mut self, ray: &Ray) -> bool {
        self.statistics.shadow_rays += 1;
        if self.count {
            self.query.any_hit_counted(ray, &mut self.statistics.counts)
        } else {
            self.query.any_hit(ray)
        }
    }
}
