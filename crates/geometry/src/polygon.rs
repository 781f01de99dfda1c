//! Convex polygons and their splitting by planes.

use glam::DVec3;
use thiserror::Error;

use crate::{Aabb, Plane, Side, Triangle};

/// A convex polygon with at least three vertices in one plane, in f64.
///
/// The front is where the vertices are seen counter-clockwise: the normal of the first three vertices that
/// are not in a line is `(p2 - p1) x (p3 - p1)`. Parts of a split polygon keep the id of the original.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon {
    vertices: Vec<DVec3>,
    id: u32,
}

/// Why a list of vertices is not a convex polygon.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum PolygonError {
    /// Fewer than three vertices.
    #[error("a polygon needs at least 3 vertices, not {count}")]
    TooFewVertices {
        /// The number of vertices given.
        count: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} has a coordinate that is not finite")]
    NonFiniteVertex {
        /// Index of the vertex.
        vertex: usize,
    },
    /// All vertices lie on a line.
    #[error("the polygon has no area")]
    NoArea,
    /// A vertex is not in the plane of the others.
    #[error("vertex {vertex} is {distance:.3e} away from the polygon's plane")]
    NotPlanar {
        /// Index of the vertex.
        vertex: usize,
        /// How far it is away.
        distance: f64,
    },
    /// The polygon turns the other way at a vertex, or around itself more than once.
    #[error("the polygon is not convex at vertex {vertex}")]
    NotConvex {
        /// Index of the vertex.
        vertex: usize,
    },
}

/// The parts of a polygon on both sides of a plane.
#[derive(Clone, Debug, PartialEq)]
pub enum Split {
    /// The whole polygon is in front of the plane; it may touch it.
    Front(Polygon),
    /// The whole polygon is behind the plane; it may touch it.
    Back(Polygon),
    /// The polygon lies in the plane, as far as rounding can tell.
    Coplanar(Polygon),
    /// The polygon is on both sides.
    Spanning {
        /// The part in front.
        front: Polygon,
        /// The part behind.
        back: Polygon,
    },
}

/// How far vertices given as f32 may be out of a common plane or a convex line, as a part of the largest
/// coordinate: four roundings to f32.
const INPUT_ROUNDING: f64 = 4.0 / (1u64 << 24) as f64;

/// How far apart two vertices may be that count as one point of a plane, as a part of the largest coordinate `m`.
///
/// A vertex counts as coplanar within [`Plane::rounding_error`], here at most `16 u * 2 sqrt(3) m < 2^-47 m`, of the plane. So two of them on an edge across the plane are less
/// than `2^-46 m` apart. Four times that allows for edges that cross it at an angle. Where they are farther apart the polygon counts as coplanar, which keeps it whole.
const CUT_ROUNDING: f64 = 1.0 / (1u64 << 44) as f64;

impl Polygon {
    /// A polygon from its vertices, counter-clockwise seen from the front.
    ///
    /// Vertices may miss the common plane, and corners may bend inwards, by what rounding the coordinates
    /// to f32 can cause: `2^-22` of the largest coordinate.
    ///
    /// # Errors
    /// If there are fewer than three vertices, one of them is not finite, they enclose no area, or they are not
    /// coplanar or not convex.
    pub fn new(vertices: Vec<DVec3>, id: u32) -> Result<Self, PolygonError> {
        if vertices.len() < 3 {
            return Err(PolygonError::TooFewVertices {
                count: vertices.len(),
            });
        }
        if let Some(vertex) = vertices.iter().position(|vertex| !vertex.is_finite()) {
            return Err(PolygonError::NonFiniteVertex { vertex });
        }
        let polygon = Self { vertices, id };
        let plane = polygon.plane().ok_or(PolygonError::NoArea)?;
        polygon.check_planar(&plane)?;
        polygon.check_convex(plane.normal)?;
        Ok(polygon)
    }

    /// The polygon of a triangle; `None` if its area is zero.
    #[must_use]
    pub fn from_triangle(triangle: &Triangle, id: u32) -> Option<Self> {
        Plane::from_triangle(triangle)?;
        let vertices = triangle.vertices().map(glam::Vec3::as_dvec3).to_vec();
        Some(Self { vertices, id })
    }

    /// The vertices, counter-clockwise seen from the front; at least three.
    #[must_use]
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    /// The id of the original polygon.
    #[must_use]
    pub const fn id(&self) -> u32 {
        self.id
    }

    /// Twice the area, in the direction of the front: the sum of the cross products of the fan from the first
    /// vertex (Newell's normal).
    #[must_use]
    pub fn scaled_normal(&self) -> DVec3 {
        let first = self.vertices[0];
        self.vertices[1..]
            .windows(2)
            .map(|edge| (edge[0] - first).cross(edge[1] - first))
            .sum()
    }

    /// The area.
    #[must_use]
    pub fn area(&self) -> f64 {
        0.5 * self.scaled_normal().length()
    }

    /// The plane of the polygon; `None` if the area is zero.
    #[must_use]
    pub fn plane(&self) -> Option<Plane> {
        Plane::from_point_normal(self.vertices[0], self.scaled_normal())
    }

    /// The smallest f32 box around the polygon: the exact bounds rounded outward.
    #[must_use]
    pub fn aabb(&self) -> Aabb {
        let min = self
            .vertices
            .iter()
            .copied()
            .fold(DVec3::INFINITY, DVec3::min);
        let max = self
            .vertices
            .iter()
            .copied()
            .fold(DVec3::NEG_INFINITY, DVec3::max);
        Aabb {
            min: min.to_array().map(round_down).into(),
            max: max.to_array().map(round_up).into(),
        }
    }

    /// The side of a plane that the polygon is on.
    #[must_use]
    pub fn side_of(&self, plane: &Plane) -> Side {
        plane.side_of_points(self.vertices.iter().copied())
    }

    /// The parts of the polygon in front of and behind a plane.
    ///
    /// Vertices on the plane, as far as rounding can tell ([`Plane::side_of`]), go to both parts. A new vertex
    /// is computed from the front end of its edge to the back end, so two polygons that share the edge get the same
    /// vertex. Area, plane and winding are kept up to the rounding of the new vertices.
    ///
    /// The outline of a convex polygon on both sides of a plane meets it in two points. Where there seem to be more that are apart, the polygon lies
    /// in the plane but for the roundings of its vertices, and counts as coplanar: cut there, its parts would overlap.
    #[must_use]
    pub fn split(self, plane: &Plane) -> Split {
        match self.side_of(plane) {
            Side::Front => Split::Front(self),
            Side::Back => Split::Back(self),
            Side::Coplanar => Split::Coplanar(self),
            Side::Spanning => self.cut(plane),
        }
    }

    fn cut(self, plane: &Plane) -> Split {
        let sides: Vec<Side> = self
            .vertices
            .iter()
            .map(|vertex| plane.side_of(*vertex))
            .collect();
        if self.meeting_points(&sides) > 2 {
            return Split::Coplanar(self);
        }
        let capacity = self.vertices.len() + 1;
        let mut front = Vec::with_capacity(capacity);
        let mut back = Vec::with_capacity(capacity);
        for (index, &start) in self.vertices.iter().enumerate() {
            let next = (index + 1) % self.vertices.len();
            let end = self.vertices[next];
            if sides[index] != Side::Back {
                front.push(start);
            }
            if sides[index] != Side::Front {
                back.push(start);
            }
            let crossing = match (sides[index], sides[next]) {
                (Side::Front, Side::Back) => crossing_point(plane, start, end),
                (Side::Back, Side::Front) => crossing_point(plane, end, start),
                _ => continue,
            };
            front.push(crossing);
            back.push(crossing);
        }
        let id = self.id;
        Split::Spanning {
            front: Self {
                vertices: front,
                id,
            },
            back: Self { vertices: back, id },
        }
    }

    /// In how many points the outline meets the plane, given the sides of the vertices.
    ///
    /// Neighbours in the plane that are as near as roundings count once: an earlier cut close to a vertex leaves two for one.
    fn meeting_points(&self, sides: &[Side]) -> usize {
        let nearest = CUT_ROUNDING * self.largest_coordinate();
        let meets = |index: usize| {
            let next = (index + 1) % sides.len();
            if sides[index] == Side::Coplanar {
                let way = self.vertices[next] - self.vertices[index];
                sides[next] != Side::Coplanar || way.abs().max_element() > nearest
            } else {
                sides[next] != Side::Coplanar && sides[next] != sides[index]
            }
        };
        (0..sides.len()).filter(|index| meets(*index)).count()
    }

    fn largest_coordinate(&self) -> f64 {
        self.vertices
            .iter()
            .map(|vertex| vertex.abs().max_element())
            .fold(0.0, f64::max)
    }

    fn check_planar(&self, plane: &Plane) -> Result<(), PolygonError> {
        let tolerance = INPUT_ROUNDING * self.largest_coordinate();
        for (vertex, point) in self.vertices.iter().enumerate() {
            let distance = plane.signed_distance(*point).abs();
            if distance > tolerance {
                return Err(PolygonError::NotPlanar { vertex, distance });
            }
        }
        Ok(())
    }

    /// Every corner turns left and every triangle of the fan runs counter-clockwise: together this excludes
    /// outlines that turn left all the way but go around more than once.
    fn check_convex(&self, normal: DVec3) -> Result<(), PolygonError> {
        let count = self.vertices.len();
        let tolerance = INPUT_ROUNDING * self.largest_coordinate();
        let turns_right = |a: DVec3, b: DVec3, c: DVec3| {
            let longest = (b - a).length().max((c - a).length());
            normal.dot((b - a).cross(c - a)) < -tolerance * longest
        };
        for vertex in 0..count {
            let [before, here, after] =
                [vertex + count - 1, vertex, vertex + 1].map(|index| self.vertices[index % count]);
            if turns_right(before, here, after) || turns_right(self.vertices[0], here, after) {
                return Err(PolygonError::NotConvex { vertex });
            }
        }
        Ok(())
    }
}

fn crossing_point(plane: &Plane, front: DVec3, back: DVec3) -> DVec3 {
    let front_distance = plane.signed_distance(front);
    let back_distance = plane.signed_distance(back);
    front + (back - front) * (front_distance / (front_distance - back_distance))
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "corrected to the f32 below"
)]
fn round_down(value: f64) -> f32 {
    let nearest = value as f32;
    if f64::from(nearest) > value {
        nearest.next_down()
    } else {
        nearest
    }
}

fn round_up(value: f64) -> f32 {
    -round_down(-value)
}

#[cfg(test)]
mod tests;
