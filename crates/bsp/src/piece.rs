//! The polygons that the build distributes.

use std::borrow::Cow;

use tahko_geometry::{Plane, Polygon, Split, Triangle, glam::DVec3};

use crate::Straddlers;

/// A polygon of the mesh or a part of one, or a triangle of zero area.
///
/// The latter are listed like all others: a kernel may see them as slivers, because it rounds the
/// projection of their vertices, and the watertight one needs that to close the seam that they fill.
#[derive(Clone, Debug)]
pub(crate) enum Piece<'a> {
    Polygon(Cow<'a, Polygon>),
    Flat(&'a Flat),
}

/// A triangle of zero area.
#[derive(Clone, Debug)]
pub(crate) struct Flat {
    vertices: [DVec3; 3],
    id: u32,
}

/// A triangle of the mesh as the build sees it.
#[derive(Clone, Debug)]
pub(crate) enum Source {
    Polygon(Polygon),
    Flat(Flat),
}

impl Source {
    pub(crate) fn new(triangle: &Triangle, id: u32) -> Self {
        match Polygon::from_triangle(triangle, id) {
            Some(polygon) => Self::Polygon(polygon),
            None => Self::Flat(Flat {
                vertices: triangle
                    .vertices()
                    .map(tahko_geometry::glam::Vec3::as_dvec3),
                id,
            }),
        }
    }

    pub(crate) const fn piece(&self) -> Piece<'_> {
        match self {
            Self::Polygon(polygon) => Piece::Polygon(Cow::Borrowed(polygon)),
            Self::Flat(flat) => Piece::Flat(flat),
        }
    }
}

impl Piece<'_> {
    pub(crate) fn id(&self) -> u32 {
        match self {
            Self::Polygon(polygon) => polygon.id(),
            Self::Flat(flat) => flat.id,
        }
    }

    pub(crate) fn vertices(&self) -> &[DVec3] {
        match self {
            Self::Polygon(polygon) => polygon.vertices(),
            Self::Flat(flat) => &flat.vertices,
        }
    }

    /// What goes to the front and to the back of a plane on which the piece is on both sides.
    pub(crate) fn parts(self, plane: &Plane, straddlers: Straddlers) -> [Option<Self>; 2] {
        let polygon = match (self, straddlers) {
            (Self::Polygon(polygon), Straddlers::Split) => polygon.into_owned(),
            (whole, _) => return [Some(whole.clone()), Some(whole)],
        };
        let part = |polygon| Some(Self::Polygon(Cow::Owned(polygon)));
        match polygon.split(plane) {
            Split::Spanning { front, back } => [part(front), part(back)],
            Split::Front(front) => [part(front), None],
            Split::Back(back) => [None, part(back)],
            Split::Coplanar(whole) => [part(whole.clone()), part(whole)],
        }
    }
}
