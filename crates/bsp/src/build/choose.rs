//! The choice of a node's splitting plane.

use tahko_geometry::{Plane, glam::DVec3};

use super::task::{Counts, Task};
use crate::piece::Piece;
use crate::{BspOptions, Candidates, Splitter, SplittingPlanes, parallel};

/// Candidates times polygons from which on candidates are compared on several threads: some 0.2 milliseconds of work.
const PARALLEL_WORK: usize = 1 << 13;

pub(super) struct Chooser<'a> {
    pub(super) options: &'a BspOptions,
    /// The planes of the mesh's polygons, by id. Parts of a polygon offer the plane of the whole, triangles of
    /// zero area have none.
    pub(super) planes: &'a [Option<Plane>],
}

/// How good a plane is, less is better: what counts, and what counts on a tie.
type Score = [f64; 2];

impl Chooser<'_> {
    /// The plane to split a node by; `None` if it should be a leaf.
    pub(super) fn choose(&self, task: &Task<'_>) -> Option<Plane> {
        let sample = match self.options.candidates {
            Candidates::Sample(count) => count,
            Candidates::All => task.pieces.len(),
        };
        match self.options.splitter {
            Splitter::First => self.first_possible(task, 0..sample.min(task.pieces.len())),
            Splitter::Random => {
                let length = task.pieces.len();
                self.first_possible(task, (0..sample).map(|draw| task.seed.pick(draw, length)))
            }
            _ => self.best(task, sample),
        }
    }

    fn first_possible(
        &self,
        task: &Task<'_>,
        mut pieces: impl Iterator<Item = usize>,
    ) -> Option<Plane> {
        pieces.find_map(|piece| {
            let plane = self.plane_of(task, piece)?;
            let counts = Counts::new(&plane, &task.pieces);
            let is_possible = counts.makes_progress() && counts.references() <= task.budget;
            is_possible.then_some(plane)
        })
    }

    fn plane_of(&self, task: &Task<'_>, piece: usize) -> Option<Plane> {
        self.planes[task.pieces[piece].id() as usize]
    }

    fn best(&self, task: &Task<'_>, sample: usize) -> Option<Plane> {
        let candidates = self.candidates(task, sample);
        let area = task.cell.as_ref().map_or(0.0, crate::cell::Cell::area);
        let score = |plane: &Plane| self.score(task, plane, area);
        let scores: Vec<Option<Score>> = if candidates.len() * task.pieces.len() >= PARALLEL_WORK {
            parallel::map(&candidates, score)
        } else {
            candidates.iter().map(score).collect()
        };
        let mut best: Option<(Score, Plane)> = None;
        for (score, plane) in scores.into_iter().zip(candidates) {
            // Strictly better, so that the first of equals stays; a score with NaN never is.
            if let Some(score) = score
                && best.is_none_or(|(least, _)| score < least)
            {
                best = Some((score, plane));
            }
        }
        best.map(|(_, plane)| plane)
    }

    fn candidates(&self, task: &Task<'_>, sample: usize) -> Vec<Plane> {
        let mut candidates = Vec::new();
        if self.options.planes == SplittingPlanes::PolygonsEdgesAndAxes {
            let points = task.pieces.iter().flat_map(Piece::vertices);
            candidates.extend(planes_around(points));
        }
        for index in task.seed.sample(sample, task.pieces.len()) {
            let own = self.plane_of(task, index);
            let vertices = task.pieces[index].vertices();
            if let Some(own) = own {
                candidates.push(own);
                if self.options.planes != SplittingPlanes::Polygons {
                    candidates.extend(edge_planes(vertices, &own));
                }
            }
            if self.options.planes == SplittingPlanes::PolygonsEdgesAndAxes {
                candidates.extend(planes_around(vertices));
            }
        }
        candidates
    }

    /// The score of a plane; `None` if it must not be taken.
    fn score(&self, task: &Task<'_>, plane: &Plane, area: f64) -> Option<Score> {
        let counts = Counts::new(plane, &task.pieces);
        if counts.references() > task.budget {
            return None;
        }
        let difference = counts.front.abs_diff(counts.back) as f64;
        let spanning = counts.spanning as f64;
        let score = match self.options.splitter {
            Splitter::SurfaceArea => return self.expected_cost(task, plane, counts, area),
            Splitter::FewestSplits => [spanning, difference],
            Splitter::Weighted { balance, splits } => {
                [balance * difference + splits * spanning, 0.0]
            }
            _ => [difference, spanning],
        };
        counts.makes_progress().then_some(score)
    }

    /// The expected cost of a ray that meets the node's cell: the children's triangles, each by the probability that
    /// the ray meets the child, and those in the plane by the probability that it meets the cut.
    fn expected_cost(
        &self,
        task: &Task<'_>,
        plane: &Plane,
        counts: Counts,
        area: f64,
    ) -> Option<Score> {
        let parts = task.cell.as_ref()?.part_areas(plane, area);
        let in_front = (counts.front + counts.spanning) as f64;
        let behind = (counts.back + counts.spanning) as f64;
        // Both sides of the cut are surface.
        let tests =
            parts.front * in_front + parts.back * behind + 2.0 * parts.cut * counts.coplanar as f64;
        let cost = self.options.traversal_cost + tests / area;
        // False for NaN, which cells without area give.
        (cost < task.pieces.len() as f64).then_some([cost, 0.0])
    }
}

/// The planes through the edges of a polygon at right angles to it, with the polygon behind.
fn edge_planes(vertices: &[DVec3], own: &Plane) -> impl Iterator<Item = Plane> {
    let next = vertices.iter().cycle().skip(1);
    vertices.iter().zip(next).filter_map(|(start, end)| {
        Plane::from_point_normal(*start, (*end - *start).cross(own.normal))
    })
}

/// The planes around some points at right angles to the axes.
fn planes_around<'p>(points: impl IntoIterator<Item = &'p DVec3>) -> impl Iterator<Item = Plane> {
    let mut min = DVec3::INFINITY;
    let mut max = DVec3::NEG_INFINITY;
    for point in points {
        min = min.min(*point);
        max = max.max(*point);
    }
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    axes.into_iter().flat_map(move |normal| {
        [min, max].map(|corner| Plane {
            normal,
            offset: -normal.dot(corner),
        })
    })
}
