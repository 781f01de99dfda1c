//! Boxes of consecutive triangles, boxes of consecutive boxes, and a test that never loses a hit.
//!
//! **The test.** If a ray meets a triangle inside a box at the exact `t`, then on every axis with a direction component `d` that is not zero, `t` lies
//! between the exact quotients `(min - o) / d` and `(max - o) / d`. In f64 each is computed by a difference of two f32
//! numbers and a division, each with a relative error of at most `e = 2^-53`: differences of f32 numbers are zero or at least `2^-149`, and at most
//! `2^129`, so that quotients stay between `2^-277` and `2^278`, where nothing over- or underflows. The computed quotient `q` is zero exactly where
//! the exact one is, and else within `(2 e + 3 e^2) |q|` of it. Moving it outwards by `4 e |q|`, an exact product and
//! one more rounding of at most `e (1 + 4 e) |q|`, puts it beyond the exact one. So an interval that comes out empty is empty. Where
//! `d` is zero, the origin is compared with the box, which is exact.

use std::ops::Range;

use glam::DVec3;

use crate::Ray;

/// Triangles in a group, and groups in a larger group.
const SIZE: usize = 16;

/// A box: a closed set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bounds {
    min: DVec3,
    max: DVec3,
}

/// Groups of triangles, groups of these groups, and so on.
#[derive(Clone, Debug)]
pub(super) struct Groups {
    /// The box `i` of the first level holds the triangles from `i * SIZE`, that of another one the boxes from `i * SIZE` of the level
    /// before. The last level has at most `SIZE` boxes.
    levels: Vec<Vec<Bounds>>,
    triangles: usize,
}

impl Bounds {
    const EMPTY: Self = Self {
        min: DVec3::INFINITY,
        max: DVec3::NEG_INFINITY,
    };

    pub(super) fn contains(&self, point: DVec3) -> bool {
        point.cmpge(self.min).all() && point.cmple(self.max).all()
    }

    fn union(self, other: &Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }
}

impl Groups {
    pub(super) fn new(triangles: &[[DVec3; 3]]) -> Self {
        let around_triangle = |corners: &[DVec3; 3]| Bounds {
            min: corners[0].min(corners[1]).min(corners[2]),
            max: corners[0].max(corners[1]).max(corners[2]),
        };
        let around = |boxes: &[Bounds]| boxes.iter().fold(Bounds::EMPTY, Bounds::union);
        let boxes: Vec<Bounds> = triangles.iter().map(around_triangle).collect();
        let mut levels = vec![boxes.chunks(SIZE).map(around).collect::<Vec<_>>()];
        while let Some(last) = levels.last().filter(|last| last.len() > SIZE) {
            levels.push(last.chunks(SIZE).map(around).collect());
        }
        Self {
            levels,
            triangles: triangles.len(),
        }
    }

    /// Gives `take` the places of all triangles in groups whose boxes `is_wanted`.
    pub(super) fn visit(
        &self,
        is_wanted: impl Fn(&Bounds) -> bool,
        mut take: impl FnMut(Range<usize>),
    ) {
        let top = self.levels.len() - 1;
        let mut waiting: Vec<(usize, Range<usize>)> = vec![(top, 0..self.levels[top].len())];
        while let Some((level, boxes)) = waiting.pop() {
            for index in boxes {
                if !is_wanted(&self.levels[level][index]) {
                    continue;
                }
                let first = index * SIZE;
                match level.checked_sub(1) {
                    Some(below) => {
                        let end = (first + SIZE).min(self.levels[below].len());
                        waiting.push((below, first..end));
                    }
                    None => take(first..(first + SIZE).min(self.triangles)),
                }
            }
        }
    }
}

/// A ray, ready to be tested against boxes.
#[derive(Clone, Copy, Debug)]
pub(super) struct RayInterval {
    origin: DVec3,
    direction: DVec3,
    t_min: f64,
    t_max: f64,
}

/// `4 e` of the module's documentation: `f64::EPSILON` is `2^-52`.
const WIDENING: f64 = 2.0 * f64::EPSILON;

impl RayInterval {
    pub(super) fn new(ray: &Ray) -> Self {
        Self {
            origin: ray.origin.as_dvec3(),
            direction: ray.direction.as_dvec3(),
            t_min: ray.t_min.into(),
            t_max: ray.t_max.into(),
        }
    }

    /// Whether the ray may meet something in a box: false only if it certainly does not.
    pub(super) fn may_meet(&self, bounds: &Bounds) -> bool {
        let (mut begin, mut end) = (self.t_min, self.t_max);
        for axis in 0..3 {
            let (origin, direction) = (self.origin[axis], self.direction[axis]);
            let (min, max) = (bounds.min[axis], bounds.max[axis]);
            if direction == 0.0 {
                if origin < min || max < origin {
                    return false;
                }
                continue;
            }
            let (near, far) = if direction > 0.0 {
                (min, max)
            } else {
                (max, min)
            };
            let near = (near - origin) / direction;
            let far = (far - origin) / direction;
            begin = begin.max(near - WIDENING * near.abs());
            end = end.min(far + WIDENING * far.abs());
        }
        begin <= end
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn all_triangles_are_in_one_group_each() {
        for count in [0, 1, SIZE, SIZE + 1, SIZE * SIZE + 1, 5000] {
            let triangles = vec![[DVec3::ZERO, DVec3::X, DVec3::Y]; count];
            let mut seen = vec![0; count];
            let groups = Groups::new(&triangles);
            groups.visit(
                |bounds| bounds.contains(DVec3::ZERO),
                |places| places.for_each(|place| seen[place] += 1),
            );
            assert!(seen.iter().all(|times| *times == 1), "{count}");
            groups.visit(|_| false, |places| panic!("not wanted: {places:?}"));
        }
    }

    #[test]
    fn boxes_are_met_at_their_faces_and_not_beyond() {
        let bounds = Bounds {
            min: DVec3::ZERO,
            max: DVec3::new(1.0, 2.0, 0.0),
        };
        let is_met = |origin: [f32; 3], direction: [f32; 3], t_max| {
            let ray = Ray::with_interval(origin.into(), direction.into(), 0.0, t_max);
            RayInterval::new(&ray).may_meet(&bounds)
        };
        assert!(
            is_met([0.0, 2.0, 5.0], [0.0, -0.0, -1.0], f32::INFINITY),
            "corner"
        );
        assert!(is_met([1.0, 1.0, 5.0], [0.0, 0.0, -1.0], 5.0), "end");
        assert!(
            !is_met([1.0, 1.0, 5.0], [0.0, 0.0, -1.0], 5.0f32.next_down()),
            "before"
        );
        assert!(
            !is_met([1.0f32.next_up(), 1.0, 5.0], [0.0, 0.0, -1.0], 9.0),
            "beside"
        );
        assert!(!is_met([-1.0, 1.0, 5.0], [-1.0, 0.0, -1.0], 9.0), "away");
        let far = Ray::new(Vec3::splat(f32::MAX), Vec3::splat(-f32::from_bits(1)));
        assert!(
            RayInterval::new(&far).may_meet(&bounds),
            "t of 2^277 does not overflow"
        );
    }

    #[test]
    fn a_point_is_met_though_every_quotient_is_rounded() {
        let mut bits = 0x00c0_ffeeu32;
        for _ in 0..1000 {
            // Numbers of 20 bits.
            let direction = Vec3::from([(); 3].map(|()| {
                bits = bits.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
                1.0 + (bits >> 13) as f32 / (1u32 << 19) as f32
            }));
            // The ray meets the point at t = 2^51 + 13/16, which does not fit f64.
            let ray = Ray::new(direction * -2.0f32.powi(51), direction);
            let point = (direction * 13.0 / 16.0).as_dvec3();
            let bounds = Bounds {
                min: point,
                max: point,
            };
            assert!(RayInterval::new(&ray).may_meet(&bounds), "{point}");
        }
    }
}
