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

/// Candidates times polygons up to which all are counted to rank the candidates: some 10 milliseconds of work.
const RANKING_WORK: usize = 1 << 20;
/// The least number of polygons that are counted; the relative error of a share of one half is then 6 %.
const MIN_RANKED: usize = 256;
/// The most candidates that are counted in full after they were ranked by a part of the polygons.
const MAX_RECOUNTS: usize = 16;

pub(super) struct Chooser<'a> {
    pub(super) options: &'a BspOptions,
    /// The planes of the mesh's polygons, by id; none for triangles without area. Parts of a polygon offer the plane
    /// of the whole.
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

    /// The best of the candidates that may be taken. Where there is too much to count, they are ranked by a part
    /// of the polygons, and only the foremost are counted in full.
    fn best(&self, task: &Task<'_>, sample: usize) -> Option<Divider> {
        let candidates = self.candidates(task, sample);
        let stride = ranking_stride(candidates.len(), task.pieces.len());
        let outlines = Outlines::new(&task.pieces, stride);
        let area = task.cell.as_ref().map_or(0.0, Cell::area);
        let rank = |divider: &Divider| {
            let counts = Counts::new(divider, outlines.iter()).times(stride);
            (self.score(task, divider, &counts, area), counts)
        };
        let ranks = if candidates.len() * outlines.len() >= PARALLEL_WORK {
            parallel::map(&candidates, rank)
        } else {
            candidates.iter().map(rank).collect()
        };
        let mut ranked: Vec<((Score, Counts), Divider)> = ranks
            .into_iter()
            .zip(candidates)
            .filter(|((score, _), _)| !score[0].is_nan())
            .collect();
        // Stable, so that the first of equals stays.
        ranked
            .sort_by(|((a, _), _), ((b, _), _)| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        if stride == 1 {
            let accepted = |((score, counts), _): &&((Score, Counts), Divider)| {
                self.accepts(task, counts, *score)
            };
            return ranked.iter().find(accepted).map(|(_, divider)| *divider);
        }
        let foremost = ranked.into_iter().take(MAX_RECOUNTS);
        let mut dividers = foremost.map(|(_, divider)| divider);
        dividers.find(|divider| {
            let counts = Counts::new(divider, task.pieces.iter().map(Piece::vertices));
            let score = self.score(task, divider, &counts, area);
            self.accepts(task, &counts, score)
        })
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

    fn score(&self, task: &Task<'_>, divider: &Divider, counts: &Counts, area: f64) -> Score {
        let difference = counts.front.abs_diff(counts.back) as f64;
        let spanning = counts.spanning as f64;
        match self.options.splitter {
            Splitter::SurfaceArea => [self.expected_cost(task, divider, counts, area), 0.0],
            Splitter::FewestSplits => [spanning, difference],
            Splitter::Weighted { balance, splits } => {
                [balance * difference + splits * spanning, 0.0]
            }
            _ => [difference, spanning],
        }
    }

    /// Whether a plane with exact counts may be taken.
    ///
    /// For the surface area heuristic it must be cheaper than a leaf. A plane with everything on one side may be
    /// so, by the empty space that it cuts off; not twice, as nothing is left to cut off there.
    fn accepts(&self, task: &Task<'_>, counts: &Counts, score: Score) -> bool {
        let is_worth_it = match self.options.splitter {
            // False for NaN, which cells without area give.
            Splitter::SurfaceArea => score[0] < task.pieces.len() as f64,
            _ => counts.makes_progress(),
        };
        is_worth_it && task.allows(counts)
    }

    /// The expected cost of a ray that meets the node's cell: the children's triangles, each by the probability that
    /// the ray meets the child.
    fn expected_cost(&self, task: &Task<'_>, divider: &Divider, counts: &Counts, area: f64) -> f64 {
        let Some(cell) = &task.cell else {
            return f64::NAN;
        };
        let parts = cell.part_areas(&divider.plane, area);
        let in_front = (counts.front + counts.spanning) as f64;
        let behind = (counts.back + counts.spanning) as f64;
        // A cut is met from both of its sides.
        let tests =
            parts.front * in_front + parts.back * behind + 2.0 * parts.cut * counts.coplanar as f64;
        self.options.traversal_cost + tests / area
    }
}

/// Every which polygon is counted to rank candidates.
fn ranking_stride(candidates: usize, pieces: usize) -> usize {
    let counted = (RANKING_WORK / candidates.max(1)).max(MIN_RANKED);
    pieces.div_ceil(counted).max(1)
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
