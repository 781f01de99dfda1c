//! The choice of a node's splitting plane.

use tahko_geometry::{Plane, glam::DVec3};

use super::outlines::Outlines;
use super::task::{Counts, Task};
use crate::cell::Cell;
use crate::divider::Divider;
use crate::piece::Piece;
use crate::{BspOptions, Candidates, Splitter, SplittingPlanes, parallel};

/// Candidates times polygons from which on candidates are compared on several threads: some 0.2 milliseconds of work.
const PARALLEL_WORK: usize = 1 << 14;

pub(super) struct Chooser<'a> {
    pub(super) options: &'a BspOptions,
    /// The planes of the mesh's polygons, by id. Parts of a polygon offer the plane of the whole, triangles of
    /// zero area have none.
    pub(super) planes: &'a [Option<Plane>],
    /// The largest absolute coordinates of the mesh.
    pub(super) largest_coordinates: DVec3,
}

/// How good a plane is, less is better: what counts, and what counts on a tie.
type Score = [f64; 2];

impl Chooser<'_> {
    /// The plane to split a node by; `None` if it should be a leaf.
    pub(super) fn choose(&self, task: &Task<'_>) -> Option<Divider> {
        let length = task.pieces.len();
        let sample = match self.options.candidates {
            Candidates::Sample(count) => count.min(length),
            Candidates::All => length,
        };
        match self.options.splitter {
            Splitter::First => self.first_possible(task, 0..sample),
            Splitter::Random => {
                self.first_possible(task, (0..sample).map(|draw| task.seed.pick(draw, length)))
            }
            _ => self.best(task, sample),
        }
    }

    fn first_possible(
        &self,
        task: &Task<'_>,
        pieces: impl Iterator<Item = usize>,
    ) -> Option<Divider> {
        let mut planes = Vec::new();
        for piece in pieces {
            planes.clear();
            self.add_polygon_planes(task, piece, false, &mut planes);
            for plane in &planes {
                let divider = self.divider(*plane);
                let counts = Counts::new(&divider, task.pieces.iter().map(Piece::vertices));
                if counts.makes_progress() && task.allows(&counts) {
                    return Some(divider);
                }
            }
        }
        None
    }

    fn divider(&self, plane: Plane) -> Divider {
        Divider::new(plane, self.largest_coordinates)
    }

    fn best(&self, task: &Task<'_>, sample: usize) -> Option<Divider> {
        let candidates = self.candidates(task, sample);
        let outlines = Outlines::new(&task.pieces);
        let area = task.cell.as_ref().map_or(0.0, Cell::area);
        let score = |divider: &Divider| {
            let counts = Counts::new(divider, outlines.iter());
            self.score(task, divider, &counts, area)
        };
        let scores: Vec<Option<Score>> = if candidates.len() * outlines.len() >= PARALLEL_WORK {
            parallel::map(&candidates, score)
        } else {
            candidates.iter().map(score).collect()
        };
        let mut best: Option<(Score, Divider)> = None;
        for (score, divider) in scores.into_iter().zip(candidates) {
            // Strictly better, so that the first of equals stays; a score with NaN never is.
            if let Some(score) = score
                && best.is_none_or(|(least, _)| score < least)
            {
                best = Some((score, divider));
            }
        }
        best.map(|(_, divider)| divider)
    }

    fn candidates(&self, task: &Task<'_>, sample: usize) -> Vec<Divider> {
        let mut planes = Vec::new();
        let with_axes = self.options.planes == SplittingPlanes::PolygonsEdgesAndAxes;
        let with_edges = self.options.planes != SplittingPlanes::Polygons;
        if with_axes {
            planes.extend(planes_around(task.pieces.iter().flat_map(Piece::vertices)));
        }
        for piece in task.seed.sample(sample, task.pieces.len()) {
            self.add_polygon_planes(task, piece, with_edges, &mut planes);
            if with_axes {
                planes.extend(planes_around(task.pieces[piece].vertices()));
            }
        }
        planes
            .into_iter()
            .map(|plane| self.divider(plane))
            .collect()
    }

    /// The plane of a polygon and, if wanted, those through its edges. Polygons that are in one plane already are
    /// separated by their edges only.
    fn add_polygon_planes(
        &self,
        task: &Task<'_>,
        piece: usize,
        with_edges: bool,
        planes: &mut Vec<Plane>,
    ) {
        let piece = &task.pieces[piece];
        let Some(own) = self.planes[piece.id() as usize] else {
            return;
        };
        if !task.is_flat {
            planes.push(own);
        }
        if with_edges || task.is_flat {
            planes.extend(edge_planes(piece.vertices(), &own));
        }
    }

    /// The score of a plane; `None` if it must not be taken.
    fn score(
        &self,
        task: &Task<'_>,
        divider: &Divider,
        counts: &Counts,
        area: f64,
    ) -> Option<Score> {
        if !task.allows(counts) {
            return None;
        }
        let difference = counts.front.abs_diff(counts.back) as f64;
        let spanning = counts.spanning as f64;
        let score = match self.options.splitter {
            Splitter::SurfaceArea => return self.expected_cost(task, divider, counts, area),
            Splitter::FewestSplits => [spanning, difference],
            Splitter::Weighted { balance, splits } => {
                [balance * difference + splits * spanning, 0.0]
            }
            _ => [difference, spanning],
        };
        counts.makes_progress().then_some(score)
    }

    /// The expected cost of a ray that meets the node's cell: the children's triangles, each by the probability that
    /// the ray meets the child.
    ///
    /// A plane with everything on one side may pay too, by the empty space that it cuts off. It cannot pay
    /// twice, as nothing is left to cut off there.
    fn expected_cost(
        &self,
        task: &Task<'_>,
        divider: &Divider,
        counts: &Counts,
        area: f64,
    ) -> Option<Score> {
        let parts = task.cell.as_ref()?.part_areas(&divider.plane, area);
        let in_front = (counts.front + counts.spanning) as f64;
        let behind = (counts.back + counts.spanning) as f64;
        // A cut is met from both of its sides.
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
