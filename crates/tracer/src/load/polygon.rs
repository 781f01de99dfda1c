//! Polygons of mesh files as triangles.

use glam::{DVec3, Vec3};

/// Cuts polygons into fans of triangles from their first corner, and counts those that this does not suit.
///
/// A fan covers a polygon exactly if the whole polygon is seen from its first corner, as with all convex ones.
#[derive(Debug, Default)]
pub(crate) struct FanCutter {
    folded: usize,
}

impl FanCutter {
    /// Appends the triangles of a polygon with at least three corners.
    pub(crate) fn cut(
        &mut self,
        corners: &[u32],
        positions: &[Vec3],
        triangles: &mut Vec<[u32; 3]>,
    ) {
        let Some((first, rest)) = corners.split_first() else {
            return;
        };
        triangles.extend(rest.windows(2).map(|edge| [*first, edge[0], edge[1]]));
        if corners.len() > 3 && folds(corners, positions) {
            self.folded += 1;
        }
    }

    /// A note for the user, if one is due.
    pub(crate) fn note(&self) -> Option<String> {
        (self.folded > 0).then(|| {
            format!(
                "{} polygons are not convex: they are cut into triangles from their first corner, \
                 which may cover too much",
                self.folded
            )
        })
    }
}

/// Whether a triangle of the fan lies the other way round than the polygon as a whole, by more than
/// rounding the corners to f32 explains.
fn folds(corners: &[u32], positions: &[Vec3]) -> bool {
    let corner = |index: &u32| {
        positions
            .get(*index as usize)
            .map_or(DVec3::ZERO, |position| position.as_dvec3())
    };
    let first = corner(&corners[0]);
    let largest = corners
        .iter()
        .map(|index| corner(index).abs().max_element())
        .fold(0.0, f64::max);
    let fan = || {
        corners[1..].windows(2).map(|edge| {
            let [a, b] = [corner(&edge[0]) - first, corner(&edge[1]) - first];
            (a.cross(b), a.length() + b.length())
        })
    };
    let Some(normal) = fan().map(|(area, _)| area).sum::<DVec3>().try_normalize() else {
        return false;
    };
    // Corners that move by d change the cross product of two edges a and b by at most 2 d (|a| + |b|) and
    // a term in d^2, which the factor of 4 covers: an edge is not shorter than its rounding error, or zero.
    let rounding = 4.0 * f64::from(f32::EPSILON) * largest;
    fan().any(|(area, length)| area.dot(normal) < -rounding * length)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folded(points: &[[f32; 2]]) -> usize {
        let positions: Vec<_> = points.iter().map(|[x, y]| Vec3::new(*x, *y, 0.1)).collect();
        let corners: Vec<u32> = (0..).take(points.len()).collect();
        let mut cutter = FanCutter::default();
        let mut triangles = Vec::new();
        cutter.cut(&corners, &positions, &mut triangles);
        assert_eq!(triangles.len(), points.len() - 2);
        cutter.folded
    }

    #[test]
    fn fans_that_fold_over_are_counted() {
        let square = [[0.0, 0.0], [0.3, 0.0], [0.3, 0.3], [0.0, 0.3]];
        assert_eq!(folded(&square), 0);
        let collinear = [[0.1, 0.1], [0.2, 0.2], [0.3, 0.3], [0.7, 0.7], [0.0, 0.9]];
        assert_eq!(folded(&collinear), 0);
        let arrow = [[0.0, 0.0], [4.0, -4.0], [1.0, 0.0], [4.0, 4.0]];
        assert_eq!(folded(&arrow), 0, "the first corner sees all of it");
        let arrow = [[4.0, -4.0], [1.0, 0.0], [4.0, 4.0], [0.0, 0.0]];
        assert_eq!(folded(&arrow), 1);
        assert_eq!(folded(&[[1.0, 1.0]; 4]), 0, "a single point");
    }
}
