//! Records what a rendering asks, and plays the answers back.

use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use tahko_tracer::geometry::glam::Vec3;
use tahko_tracer::geometry::{Hit, Precision, QueryCounts, Ray, RayQuery};

/// A ray and its answer.
#[derive(Clone, Copy, Debug)]
pub(super) enum Asked {
    Closest(Ray, Option<Hit>),
    Any(Ray, bool),
}

impl Asked {
    pub(super) const fn ray(&self) -> &Ray {
        match self {
            Self::Closest(ray, _) | Self::Any(ray, _) => ray,
        }
    }
}

/// A structure that records its plain queries, or answers them from a recording without looking at its triangles.
///
/// A recording is played in the order in which it was made: by one thread. Queries other than those of a rendering without counters go to
/// the structure.
pub(super) struct Tape<'a> {
    structure: &'a dyn RayQuery,
    mode: Mode<'a>,
}

enum Mode<'a> {
    Recording(Mutex<Vec<Asked>>),
    Playing {
        recording: &'a [Asked],
        next: AtomicUsize,
    },
}

impl<'a> Tape<'a> {
    pub(super) const fn record(structure: &'a dyn RayQuery) -> Self {
        Self {
            structure,
            mode: Mode::Recording(Mutex::new(Vec::new())),
        }
    }

    pub(super) const fn play(structure: &'a dyn RayQuery, recording: &'a [Asked]) -> Self {
        Self {
            structure,
            mode: Mode::Playing {
                recording,
                next: AtomicUsize::new(0),
            },
        }
    }

    /// What was asked; nothing of a tape that was played.
    pub(super) fn into_recording(self) -> Vec<Asked> {
        match self.mode {
            Mode::Recording(asked) => asked.into_inner().expect("no query panicked"),
            Mode::Playing { .. } => Vec::new(),
        }
    }
}

fn add(asked: &Mutex<Vec<Asked>>, new: Asked) {
    asked.lock().expect("no query panicked").push(new);
}

/// The next answer; none behind the end.
fn next<'a>(recording: &'a [Asked], next: &AtomicUsize) -> Option<&'a Asked> {
    recording.get(next.fetch_add(1, Ordering::Relaxed))
}

impl RayQuery for Tape<'_> {
    fn precision(&self) -> Precision {
        self.structure.precision()
    }

    fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        match &self.mode {
            Mode::Recording(asked) => {
                let hit = self.structure.closest_hit(ray);
                add(asked, Asked::Closest(*ray, hit));
                hit
            }
            Mode::Playing {
                recording,
                next: place,
            } => match next(recording, place) {
                Some(Asked::Closest(_, hit)) => *hit,
                Some(Asked::Any(..)) | None => None,
            },
        }
    }

    fn any_hit(&self, ray: &Ray) -> bool {
        match &self.mode {
            Mode::Recording(asked) => {
                let found = self.structure.any_hit(ray);
                add(asked, Asked::Any(*ray, found));
                found
            }
            Mode::Playing {
                recording,
                next: place,
            } => matches!(next(recording, place), Some(Asked::Any(_, true))),
        }
    }

    fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        assert_eq!(rays.len(), hits.len(), "one hit per ray");
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.closest_hit(ray);
        }
    }

    fn any_hits(&self, rays: &[Ray], hits: &mut [bool]) {
        assert_eq!(rays.len(), hits.len(), "one hit per ray");
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.any_hit(ray);
        }
    }

    fn closest_hit_counted(&self, ray: &Ray, counts: &mut QueryCounts) -> Option<Hit> {
        self.structure.closest_hit_counted(ray, counts)
    }

    fn any_hit_counted(&self, ray: &Ray, counts: &mut QueryCounts) -> bool {
        self.structure.any_hit_counted(ray, counts)
    }

    fn closest_hit_ignoring(&self, ray: &Ray, primitive: u32) -> Option<Hit> {
        self.structure.closest_hit_ignoring(ray, primitive)
    }

    fn any_hit_ignoring(&self, ray: &Ray, primitive: u32) -> bool {
        self.structure.any_hit_ignoring(ray, primitive)
    }

    fn all_hits(&self, ray: &Ray, visitor: &mut dyn FnMut(Hit) -> ControlFlow<()>) {
        self.structure.all_hits(ray, visitor);
    }

    fn crossings(&self, ray: &Ray) -> usize {
        self.structure.crossings(ray)
    }

    fn contains(&self, point: Vec3) -> bool {
        self.structure.contains(point)
    }
}

#[cfg(test)]
mod tests {
    use tahko_tracer::geometry::{BruteForce, TriangleMesh};

    use super::*;

    #[test]
    fn a_recording_gives_the_answers_back_in_their_order() {
        let mesh = TriangleMesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]).unwrap();
        let structure = BruteForce::new(&mesh, Precision::Exact);
        let [hits, misses] = [0.2, 0.9].map(|x| Ray::new(Vec3::new(x, x, 1.0), Vec3::NEG_Z));
        let ask = |tape: &Tape<'_>| {
            let mut batch = [None; 2];
            tape.closest_hits(&[misses, hits], &mut batch);
            (
                tape.closest_hit(&hits),
                tape.any_hit(&misses),
                tape.any_hit(&hits),
                batch,
            )
        };
        let tape = Tape::record(&structure);
        let answers = ask(&tape);
        let recording = tape.into_recording();
        assert_eq!(recording.len(), 5);
        let nothing = TriangleMesh::new(Vec::new(), Vec::new()).unwrap();
        let empty = BruteForce::new(&nothing, Precision::Exact);
        assert_eq!(ask(&Tape::play(&empty, &recording)), answers);
    }
}
