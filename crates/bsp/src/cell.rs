//! Convex polytopes: the cells into which splitting planes cut the bounds.
//!
//! Cells serve the surface area heuristic and the statistics only. No query depends on them, so their rounding
//! costs nothing but a slightly different measure of cost.

use tahko_geometry::{Aabb, Plane, glam::DVec3};

/// A convex polytope as its faces; or a convex polygon, as two faces back to back.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Cell {
    faces: Vec<Face>,
}

/// An outline that is counter-clockwise seen from outside.
#[derive(Clone, Debug, PartialEq)]
struct Face {
    outline: Vec<DVec3>,
    /// The area in the direction of the front, and its length.
    vector_area: DVec3,
    area: f64,
}

impl Face {
    fn new(outline: Vec<DVec3>) -> Self {
        let vector_area = vector_area(&outline);
        Self {
            outline,
            vector_area,
            area: vector_area.length(),
        }
    }
}

/// Surface areas of the two parts of a cell, and the area of the cut between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PartAreas {
    pub(crate) front: f64,
    pub(crate) back: f64,
    /// The cut, counted once; both parts contain it.
    pub(crate) cut: f64,
}

impl Cell {
    /// The cell that is a box. Flat boxes have faces without area.
    pub(crate) fn from_aabb(bounds: &Aabb) -> Self {
        let corners = [bounds.min.as_dvec3(), bounds.max.as_dvec3()];
        let corner = |bits: usize| {
            DVec3::new(
                corners[bits & 1].x,
                corners[(bits >> 1) & 1].y,
                corners[(bits >> 2) & 1].z,
            )
        };
        let faces = [
            [0, 4, 6, 2],
            [1, 3, 7, 5],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 2, 3, 1],
            [4, 5, 7, 6],
        ];
        Self {
            faces: faces
                .map(|face| Face::new(face.map(corner).to_vec()))
                .to_vec(),
        }
    }

    /// The area of the surface.
    pub(crate) fn area(&self) -> f64 {
        self.faces.iter().map(|face| face.area).sum()
    }

    /// The areas of the parts that a plane would cut, without cutting. `area` is that of the whole surface.
    ///
    /// The vector areas of a closed surface sum to zero, so the cut's area is the length of the sum over the front parts
    /// of all faces.
    pub(crate) fn part_areas(&self, plane: &Plane, area: f64) -> PartAreas {
        let mut front = 0.0;
        let mut sum = DVec3::ZERO;
        for face in &self.faces {
            let distances = face
                .outline
                .iter()
                .map(|point| plane.signed_distance(*point));
            let (least, most) = distances.fold((f64::INFINITY, f64::NEG_INFINITY), |range, d| {
                (range.0.min(d), range.1.max(d))
            });
            if least >= 0.0 {
                front += face.area;
                sum += face.vector_area;
            } else if most > 0.0 {
                let part = clipped_vector_area(&face.outline, plane);
                front += part.length();
                sum += part;
            }
        }
        let cut = sum.length();
        PartAreas {
            front: front + cut,
            back: (area - front).max(0.0) + cut,
            cut,
        }
    }

    /// The parts in front of and behind a plane, and the cut between them.
    pub(crate) fn cut(&self, plane: &Plane) -> [Self; 3] {
        let mut on_cut = Vec::new();
        for face in &self.faces {
            clip(&face.outline, plane, |point| {
                // A kept vertex on the plane, or a new one. Where rounding puts such a vertex beside the plane, the edge is cut next to
                // it; cells only weigh splits, so no hit depends on it.
                if !face.outline.contains(&point) || plane.signed_distance(point) == 0.0 {
                    on_cut.push(point);
                }
            });
        }
        let section = outline(on_cut, plane.normal);
        let reversed = |points: &[DVec3]| points.iter().rev().copied().collect();
        let [front_cap, back_cap] = match section {
            Some(section) => [
                Some(Face::new(reversed(&section))),
                Some(Face::new(section)),
            ],
            None => [None, None],
        };
        let caps = front_cap.iter().chain(&back_cap).cloned().collect();
        [
            self.part(plane, front_cap),
            self.part(&plane.flipped(), back_cap),
            Self { faces: caps },
        ]
    }

    fn part(&self, plane: &Plane, cap: Option<Face>) -> Self {
        let mut faces = Vec::with_capacity(self.faces.len() + 1);
        for face in &self.faces {
            let mut part = Vec::with_capacity(face.outline.len() + 1);
            clip(&face.outline, plane, |point| part.push(point));
            if part.len() >= 3 {
                faces.push(Face::new(part));
            }
        }
        faces.extend(cap);
        Self { faces }
    }
}

/// Half the sum of the cross products of a fan: the area in the direction of the front.
#[derive(Default)]
struct Fan {
    first: Option<DVec3>,
    before: DVec3,
    sum: DVec3,
}

impl Fan {
    #[inline]
    fn add(&mut self, point: DVec3) {
        let first = *self.first.get_or_insert(point);
        let here = point - first;
        self.sum += self.before.cross(here);
        self.before = here;
    }

    fn vector_area(&self) -> DVec3 {
        0.5 * self.sum
    }
}

fn vector_area(outline: &[DVec3]) -> DVec3 {
    let mut fan = Fan::default();
    for point in outline {
        fan.add(*point);
    }
    fan.vector_area()
}

fn clipped_vector_area(outline: &[DVec3], plane: &Plane) -> DVec3 {
    let mut fan = Fan::default();
    clip(outline, plane, |point| fan.add(point));
    fan.vector_area()
}

/// Calls a function with the vertices of the part of an outline in front of a plane, in order.
#[inline]
fn clip(outline: &[DVec3], plane: &Plane, mut vertex: impl FnMut(DVec3)) {
    let Some(last) = outline.last() else {
        return;
    };
    let mut before = (*last, plane.signed_distance(*last));
    for point in outline {
        let here = (*point, plane.signed_distance(*point));
        if before.1 * here.1 < 0.0 {
            vertex(before.0 + (here.0 - before.0) * (before.1 / (before.1 - here.1)));
        }
        if here.1 >= 0.0 {
            vertex(here.0);
        }
        before = here;
    }
}

/// Points in convex position, ordered counter-clockwise around a normal.
fn outline(points: Vec<DVec3>, normal: DVec3) -> Option<Vec<DVec3>> {
    let center = points.iter().copied().sum::<DVec3>() / points.len() as f64;
    let [x, y] = normal.try_normalize()?.any_orthonormal_pair().into();
    let mut ordered: Vec<(f64, DVec3)> = points
        .into_iter()
        .map(|point| {
            (
                pseudo_angle(x.dot(point - center), y.dot(point - center)),
                point,
            )
        })
        .collect();
    ordered.sort_by(|a, b| a.0.total_cmp(&b.0));
    let outline: Vec<DVec3> = ordered.into_iter().map(|(_, point)| point).collect();
    (outline.len() >= 3).then_some(outline)
}

/// Grows with the angle of `(x, y)`, from -2 to 2; the same on every platform, as the arc tangent is not.
fn pseudo_angle(x: f64, y: f64) -> f64 {
    let sine = y / (x.abs() + y.abs());
    if x >= 0.0 {
        sine
    } else {
        2.0f64.copysign(y) - sine
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tahko_geometry::glam::Vec3;

    fn cube() -> Cell {
        Cell::from_aabb(&Aabb::new(Vec3::ZERO, Vec3::ONE))
    }

    fn plane(point: DVec3, normal: DVec3) -> Plane {
        Plane::from_point_normal(point, normal).expect("a normal that is not zero")
    }

    fn assert_close(a: f64, b: f64) {
        assert!((a - b).abs() < 1e-12, "{a} {b}");
    }

    #[test]
    fn a_diagonal_cut_through_a_cube_is_a_rectangle() {
        let diagonal = plane(DVec3::ZERO, DVec3::new(1.0, -1.0, 0.0));
        let areas = cube().part_areas(&diagonal, cube().area());
        let root = 2.0f64.sqrt();
        assert_close(areas.cut, root);
        assert_close(areas.front, 3.0 + root);
        assert_close(areas.back, 3.0 + root);
    }

    #[test]
    fn parts_have_the_areas_that_were_announced() {
        let cuts = [
            plane(DVec3::splat(0.5), DVec3::ONE),
            plane(DVec3::new(0.2, 0.9, 0.4), DVec3::new(-0.3, 1.0, 0.2)),
            plane(DVec3::splat(0.4), DVec3::X),
            plane(DVec3::splat(0.6), DVec3::new(0.1, -2.0, 5.0)),
        ];
        let mut cells = vec![cube()];
        for cut in cuts {
            let mut parts = Vec::new();
            for cell in cells {
                let announced = cell.part_areas(&cut, cell.area());
                let [front, back, section] = cell.cut(&cut);
                let is_cut = announced.cut > 0.0;
                if is_cut {
                    assert_close(front.area(), announced.front);
                    assert_close(back.area(), announced.back);
                    assert_close(section.area(), 2.0 * announced.cut);
                    parts.extend([front, back]);
                } else {
                    parts.push(cell);
                }
            }
            cells = parts;
        }
        assert!(cells.len() > 8, "{} parts of the cube", cells.len());
    }

    #[test]
    fn a_plane_beside_a_cell_leaves_it_whole() {
        let beside = plane(DVec3::splat(2.0), DVec3::X);
        let areas = cube().part_areas(&beside, cube().area());
        assert_eq!(
            areas,
            PartAreas {
                front: 0.0,
                back: 6.0,
                cut: 0.0
            }
        );
        let [front, back, section] = cube().cut(&beside);
        assert_close(front.area(), 0.0);
        assert_close(back.area(), 6.0);
        assert_close(section.area(), 0.0);
    }

    #[test]
    fn a_flat_box_has_two_faces_with_area() {
        let flat = Cell::from_aabb(&Aabb::new(Vec3::ZERO, Vec3::new(2.0, 3.0, 0.0)));
        assert_close(flat.area(), 12.0);
        let areas = flat.part_areas(&plane(DVec3::X, DVec3::X), 12.0);
        assert_close(areas.front, 6.0);
        assert_close(areas.cut, 0.0);
    }
}
