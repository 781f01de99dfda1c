//! Cuts long thin diagonal triangles in pieces before the tree is built, where the numbers of the mesh say that it pays.
//!
//! The box of a sliver along a diagonal is as large as if it were full, and where many such boxes lie in each other no tree over them is any good: every line tests
//! all triangles whose boxes it meets. Nor does a build find its way out by cutting, for a plane through such boxes halves each of them and puts
//! all of them on both sides: at first it gains nothing. Cut across its length in `k` equal parts, a diagonal of the unit cube has `k` boxes of side `1/k`, with a `k`th of the area
//! in sum. So here pieces buy speed in proportion. In ordinary meshes they buy nothing, as areas of triangles that are no slivers hardly shrink. [`price`] tells the two apart.
//!
//! A triangle is cut by a plane across the longest axis of its box, then its parts, each in as many pieces as are its share, until the boxes of all have about
//! the same size. No hit falls between pieces: each cut is one of [`clip::halves`], as those of spatial splits are, and the proof at the head of [`spatial`](super) holds with
//! the pieces as the references of the beginning. The boxes of a triangle's pieces together are its box, so that of the root stays what it was.
//!
//! Sources: Ernst, Greiner, *Early split clipping for bounding volume hierarchies*, 2007; Karras, Aila, *Fast parallel construction of high-quality bounding volume
//! hierarchies*, 2013, section 4.2. They choose by the size of boxes, and cut at the planes of a grid over the scene, so that pieces of neighbours end in one plane. Here the choice is by what
//! cuts gain; and parts of equal size, whose areas have a sum smaller by a fifth to a quarter than between planes of a grid, made trees that test as much fewer triangles.

mod price;

use tahko_geometry::{Axis, TriangleMesh};

use self::price::Price;
use super::clip;
use crate::BuildError;
use crate::build::reference::{Bounds, Reference};
use crate::control::Work;
use crate::parallel::map;

/// References that a task cuts.
const CHUNK: usize = 1 << 10;

/// Cuts the references to all triangles of a mesh, at least one, in pieces: in `most` at most, and in none if that pays too little.
///
/// Cost: O(n) time, some 200 ns for each piece; the pieces twice, for a moment.
///
/// # Errors
/// If the build was cancelled.
pub(in crate::build) fn split(
    references: Vec<Reference>,
    mesh: &TriangleMesh,
    most: usize,
    work: &Work<'_>,
) -> Result<Vec<Reference>, BuildError> {
    let Some(price) = Price::find(&references, mesh, most) else {
        return Ok(references);
    };
    let chunks: Vec<&[Reference]> = references.chunks(CHUNK).collect();
    let chunks = map(&chunks, |chunk| {
        if work.is_cancelled() {
            return Vec::new();
        }
        let counts: Vec<usize> = chunk.iter().map(|r| price.pieces(r, mesh)).collect();
        let mut pieces = Vec::with_capacity(counts.iter().sum());
        let mut waiting = Vec::new();
        for (reference, count) in chunk.iter().zip(counts) {
            cut(reference, count, mesh, &mut waiting, &mut pieces);
        }
        pieces
    });
    work.control.check()?;
    drop(references);
    let mut pieces = Vec::with_capacity(chunks.iter().map(Vec::len).sum());
    for chunk in chunks {
        pieces.extend(chunk);
    }
    Ok(pieces)
}

/// A part of a triangle that is still to be cut in some pieces.
struct Part {
    reference: Reference,
    pieces: usize,
}

/// Appends the pieces of a reference, `count` or less; `waiting` is empty before and after. The parts that wait are no more than
/// the halvings of the count.
fn cut(
    reference: &Reference,
    count: usize,
    mesh: &TriangleMesh,
    waiting: &mut Vec<Part>,
    pieces: &mut Vec<Reference>,
) {
    let triangle = mesh.triangle(reference.number() as usize);
    let mut next = Some(Part {
        reference: *reference,
        pieces: count,
    });
    while let Some(part) = next {
        let bounds = part.reference.bounds();
        let first_pieces = part.pieces / 2;
        let share = first_pieces as f32 / part.pieces as f32;
        next = match plane(&bounds, share) {
            Some((axis, plane)) if first_pieces > 0 => {
                let [first, second] = clip::halves(&triangle, &bounds, axis, plane);
                if first.is_empty() || second.is_empty() {
                    // The box was larger than the part, which is now all on one side.
                    let rest = if first.is_empty() { second } else { first };
                    pieces.push(part.reference.with_bounds(&rest));
                    waiting.pop()
                } else {
                    waiting.push(Part {
                        reference: part.reference.with_bounds(&second),
                        pieces: part.pieces - first_pieces,
                    });
                    Some(Part {
                        reference: part.reference.with_bounds(&first),
                        pieces: first_pieces,
                    })
                }
            }
            _ => {
                pieces.push(part.reference);
                waiting.pop()
            }
        };
    }
}

/// The plane that cuts a share off the longest axis of a box, as an axis and a position strictly inside; `None` if rounding leaves none.
fn plane(bounds: &Bounds, share: f32) -> Option<(usize, f32)> {
    let axis = Axis::dominant(bounds.extent()) as usize;
    let (start, end) = (bounds.lower()[axis], bounds.upper()[axis]);
    // Without the difference, which may be too large for f32.
    let plane = start * (1.0 - share) + end * share;
    (start < plane && plane < end).then_some((axis, plane))
}

#[cfg(test)]
mod tests;
