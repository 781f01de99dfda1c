//! The searches of the rays of a packet.

use std::ops::ControlFlow;

use glam::Vec3;

use super::HitCollector;
use crate::simd::{LANES, Simd, bits_of};
use crate::{Ray, RayLanes, TriangleKernel};

/// A ray on its way, and what it has found.
#[derive(Clone, Copy, Debug)]
pub struct RaySearch<'a, H> {
    /// The ray.
    pub ray: &'a Ray,
    /// What it has found.
    pub collector: H,
}

impl<'a, H: HitCollector> RaySearch<'a, H> {
    /// A search that has found nothing yet.
    #[inline(always)]
    #[must_use]
    pub fn new(ray: &'a Ray) -> Self {
        Self {
            ray,
            collector: H::new(ray),
        }
    }

    /// Keeps the ray's `t_max` after a step, in its lane. Whether the search is over, after which nothing matters to the ray.
    #[inline(always)]
    pub fn keep(&self, rays: &mut RayLanes, lane: usize, step: ControlFlow<()>) -> bool {
        let is_over = step.is_break();
        rays.t_max.0[lane % LANES] = if is_over {
            f32::NEG_INFINITY
        } else {
            self.collector.t_max()
        };
        is_over
    }
}

/// The searches of up to [`MOST`](Self::MOST) rays. Each begins where something may be hit: for a ray that meets nothing there is nothing to write, and nothing to read in the end.
#[derive(Clone, Debug)]
pub struct RaySearches<'a, H> {
    rays: &'a [Ray],
    /// Where in the list of rays that of each place is.
    indices: [u8; MOST],
    len: usize,
    /// A bit for each search that has begun. The others are those of other rays.
    begun: u64,
    all: Box<[RaySearch<'a, H>; MOST]>,
}

/// A bit each.
const MOST: usize = u64::BITS as usize;

/// Each in its own place.
#[expect(clippy::cast_possible_truncation, reason = "all are below 64")]
const ALL_INDICES: [u8; MOST] = {
    let mut indices = [0; MOST];
    let mut place = 0;
    while place < MOST {
        indices[place] = place as u8;
        place += 1;
    }
    indices
};

impl<'a, H: HitCollector> RaySearches<'a, H> {
    /// Rays at most.
    pub const MOST: usize = MOST;

    /// Room for searches, of no rays yet.
    #[must_use]
    pub fn new() -> Self {
        const ANYTHING: &Ray = &Ray::new(Vec3::ZERO, Vec3::ONE);
        Self {
            rays: &[],
            indices: ALL_INDICES,
            len: 0,
            begun: 0,
            all: Box::new(std::array::from_fn(|_| RaySearch::new(ANYTHING))),
        }
    }

    /// Makes them those of the first rays of a list, up to [`MOST`](Self::MOST).
    #[inline(always)]
    pub fn fill(&mut self, rays: &'a [Ray]) {
        self.rays = rays;
        self.indices = ALL_INDICES;
        self.len = rays.len().min(MOST);
        self.begun = 0;
    }

    /// Makes them those of some of the first rays of a list, a bit for each, in their order.
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "all are below 64")]
    pub fn fill_with(&mut self, rays: &'a [Ray], members: u64) {
        self.rays = rays;
        self.len = 0;
        self.begun = 0;
        for (index, place) in bits_of(members).zip(&mut self.indices) {
            *place = index as u8;
            self.len += 1;
        }
    }

    /// How many there are.
    #[inline(always)]
    #[must_use]
    pub const fn len(&self) -> usize {
        self.len
    }

    /// Whether there are none.
    #[inline(always)]
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The ray of a place, below [`len`](Self::len).
    #[inline(always)]
    #[must_use]
    pub fn ray(&self, place: usize) -> &'a Ray {
        &self.rays[usize::from(self.indices[place % MOST])]
    }

    /// The search of a place, below [`len`](Self::len). It begins here, if it has not.
    #[inline(always)]
    pub fn search(&mut self, place: usize) -> &mut RaySearch<'a, H> {
        let place = place % MOST;
        if self.begun >> place & 1 == 0 {
            self.begun |= 1 << place;
            self.all[place] = RaySearch::new(self.ray(place));
        }
        &mut self.all[place]
    }

    /// The answers of all, each with the index of its ray, given the rays in lanes.
    #[inline(always)]
    pub fn finish<'r, S: Simd, K: TriangleKernel>(
        &mut self,
        simd: S,
        lanes: impl Iterator<Item = &'r RayLanes>,
        mut answer: impl FnMut(usize, H::Answer),
    ) {
        for (group, lanes) in lanes.enumerate() {
            let first = LANES * group;
            let begun = (self.begun >> first & 0xff) as u32;
            for place in
                (first..self.len.min(first + LANES)).filter(|place| self.begun >> place & 1 == 0)
            {
                let ray = self.ray(place);
                let nothing = H::new(ray).finish::<S, K, ()>(simd, ray, &mut ());
                answer(usize::from(self.indices[place % MOST]), nothing);
            }
            if begun != 0
                && let Some(searches) = self.all[first..].first_chunk_mut()
            {
                H::finish_lanes::<S, K>(simd, lanes, searches, begun, |lane, found| {
                    answer(usize::from(self.indices[(first + lane) % MOST]), found);
                });
            }
        }
    }
}

impl<H: HitCollector> Default for RaySearches<'_, H> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::query::CertainHit;
    use crate::simd::{AvailableSimd, WithSimd};
    use crate::{AnyHit, Exact, Interval};

    /// As many as there may be, each with an origin of its own.
    fn rays() -> Vec<Ray> {
        (0..MOST)
            .map(|x| Ray::new(Vec3::new(x as f32, 0.0, 0.0), Vec3::Z))
            .collect()
    }

    struct Finish<'s, 'a>(&'s mut RaySearches<'a, AnyHit>, &'s [RayLanes]);

    impl WithSimd for Finish<'_, '_> {
        type Output = Vec<(usize, bool)>;

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
            let mut answers = Vec::new();
            let Self(searches, lanes) = self;
            searches.finish::<S, Exact>(simd, lanes.iter(), |index, found| {
                answers.push((index, found));
            });
            answers.sort_unstable();
            answers
        }
    }

    fn answers(searches: &mut RaySearches<'_, AnyHit>) -> Vec<(usize, bool)> {
        let lanes = [RayLanes::splat(searches.ray(0)); MOST / LANES];
        let used = searches.len().div_ceil(LANES);
        AvailableSimd::best().dispatch(Finish(searches, &lanes[..used]))
    }

    fn find(searches: &mut RaySearches<'_, AnyHit>, place: usize) {
        let certain = CertainHit {
            primitive: 1,
            vertices: [Vec3::ZERO.into(); 3],
            t: Interval {
                start: 1.0,
                end: 2.0,
            },
        };
        let RaySearch { ray, collector } = searches.search(place);
        let step = collector.collect_certain::<Exact, ()>(ray, &certain, &mut ());
        assert!(step.is_break(), "any hit will do");
    }

    #[test]
    fn rays_that_nothing_was_offered_to_hit_nothing() {
        let rays = rays();
        let mut searches = RaySearches::new();
        for count in [1, 8, 11, MOST] {
            searches.fill(&rays[..count]);
            assert_eq!((searches.len(), searches.is_empty()), (count, false));
            let hit = [0, count / 2, count - 1];
            for place in hit {
                assert_eq!(*searches.ray(place), rays[place]);
                find(&mut searches, place);
            }
            let expected: Vec<_> = (0..count)
                .map(|index| (index, hit.contains(&index)))
                .collect();
            assert_eq!(answers(&mut searches), expected);
            // What was found is forgotten.
            searches.fill(&rays[..count]);
            assert!(answers(&mut searches).into_iter().all(|(_, found)| !found));
        }
    }

    #[test]
    fn answers_have_the_index_of_their_ray() {
        let rays = rays();
        let mut searches = RaySearches::new();
        searches.fill_with(&rays, 1 << 5 | 1 << 17 | 1 << 63);
        assert_eq!(searches.len(), 3);
        assert_eq!(*searches.ray(1), rays[17]);
        find(&mut searches, 1);
        assert_eq!(
            answers(&mut searches),
            [(5, false), (17, true), (63, false)]
        );
    }
}
