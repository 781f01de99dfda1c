//! The vertices of many polygons in one run of memory, to be read once per candidate plane.

use tahko_geometry::glam::DVec3;

use crate::piece::Piece;

pub(super) struct Outlines {
    vertices: Vec<DVec3>,
    /// Where each polygon's vertices end and the next one's begin.
    ends: Vec<usize>,
}

impl Outlines {
    /// The outlines of every `stride`-th piece.
    pub(super) fn new(pieces: &[Piece<'_>], stride: usize) -> Self {
        let mut outlines = Self {
            vertices: Vec::with_capacity(4 * pieces.len() / stride),
            ends: Vec::with_capacity(pieces.len() / stride + 1),
        };
        for piece in pieces.iter().step_by(stride) {
            outlines.vertices.extend_from_slice(piece.vertices());
            outlines.ends.push(outlines.vertices.len());
        }
        outlines
    }

    pub(super) fn len(&self) -> usize {
        self.ends.len()
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &[DVec3]> {
        let mut start = 0;
        self.ends.iter().map(move |end| {
            let outline = &self.vertices[start..*end];
            start = *end;
            outline
        })
    }
}
