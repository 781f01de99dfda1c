//! The polygons that the build distributes.

use std::borrow::Cow;

use tahko_geometry::{Plane, Polygon, Split, glam::DVec3};

use crate::Straddlers;

/// A polygon of the mesh or a part of one.
#[derive(Clone, Debug)]
pub(crate) struct Piece<'a>(Cow<'a, Polygon>);

impl<'a> Piece<'a> {
    pub(crate) const fn whole(polygon: &'a Polygon) -> Self {
        Self(Cow::Borrowed(polygon))
    }

    pub(crate) fn id(&self) -> u32 {
        self.0.id()
    }

    pub(crate) fn vertices(&self) -> &[DVec3] {
        self.0.vertices()
    }

    /// What goes to the front and to the back of a plane on which the piece is on both sides.
    pub(crate) fn parts(self, plane: &Plane, straddlers: Straddlers) -> [Option<Self>; 2] {
        if straddlers == Straddlers::ListInBoth {
            return [Some(self.clone()), Some(self)];
        }
        let part = |polygon| Some(Self(Cow::Owned(polygon)));
        let polygon: Polygon = self.0.into_owned();
        match polygon.split(plane) {
            Split::Spanning { front, back } => [part(front), part(back)],
            Split::Front(front) => [part(front), None],
            Split::Back(back) => [None, part(back)],
            Split::Coplanar(whole) => [part(whole.clone()), part(whole)],
        }
    }
}
