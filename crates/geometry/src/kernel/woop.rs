//! The watertight kernel.
//!
//! The ray is sheared onto the axis of its largest direction component, and each vertex is projected
//! along it by the same rounded operations whichever triangle asks. What is decided is whether the
//! *rounded* projection of a triangle contains the origin: neighbours share the rounded edge, so no ray
//! passes between them.
//!
//! **The sign of an edge function** `a*b - c*d` of f32 numbers: rounding is monotone, so where the rounded
//! products differ they are in the order of the exact ones. Where they are equal, f64 decides: there the
//! products of f32 numbers are exact (48 of 53 bits, no overflow, no underflow) and a difference of two
//! numbers has the right sign.
//!
//! **Reach.** A projected coordinate is `fl(dx - fl(s * dz))`, with `|s| <= 1` correct to one rounding.
//! Its error is at most `2^-24 (2 |dx| + 4 |dz|)` to first order, and that of the depth `2^-24 |dz|`:
//! at most `6 * 2^-24 m`, and `2^-150` where the product underflows. The weights of an accepted triangle are exact products subtracted once, hence
//! correct to `2^-53` of themselves, and of one sign: the point of the true triangle with these weights is
//! within that distance of the ray at the interpolated `t`. Where the ray meets the true triangle, as it does nearly always,
//! `t` and the weights are those of the confirmation instead, whose reach is larger.
//!
//! **Seams.** A triangle without area is never hit, though its rounded projection may have some. Where such a triangle closes
//! a T-junction, the rounded projections of its neighbours can leave a gap as wide as the rounding.
//!
//! Source: Woop, Benthin, Wald, "Watertight ray/triangle intersection", JCGT 2013. Differs in deciding the
//! sign by comparing products, and in confirming in f64.

use glam::{DVec3, Vec3};

use super::confirm;
use crate::{Axis, Ray, TraversalCounter, Triangle, TriangleHit, TriangleKernel};

/// The ray/triangle test of Woop, Benthin and Wald: the watertight kernel.
///
/// No ray passes between triangles that share an edge or a vertex. A ray may be seen to hit a triangle
/// that it misses by a few `2^-24` of its distance. Both sides of a triangle are hit.
#[derive(Clone, Copy, Debug)]
pub struct Woop {
    origin: Vec3,
    shear_x: f32,
    shear_y: f32,
    /// The axis of the largest direction component, and the two that follow it.
    z: usize,
    x: usize,
    y: usize,
    direction: Vec3,
    t_min: f32,
}

/// A vertex seen from the ray: projected along it, with its depth along the dominant axis.
#[derive(Clone, Copy)]
struct Projected {
    x: f32,
    y: f32,
    z: f32,
}

impl TriangleKernel for Woop {
    const REACH: f32 = confirm::REACH;

    type Block = super::ReachBlockFilter;

    fn new(ray: &Ray) -> Self {
        let axis = Axis::dominant(ray.direction);
        let [x, y, z] = [axis.next(), axis.next().next(), axis].map(|axis| axis as usize);
        Self {
            origin: ray.origin,
            shear_x: ray.direction[x] / ray.direction[z],
            shear_y: ray.direction[y] / ray.direction[z],
            z,
            x,
            y,
            direction: ray.direction,
            t_min: ray.t_min,
        }
    }

    #[inline]
    fn intersect<C: TraversalCounter>(
        &self,
        triangle: &Triangle,
        t_max: f32,
        _counter: &mut C,
    ) -> Option<TriangleHit> {
        let [a, b, c] = triangle.vertices().map(|vertex| self.project(vertex));
        let signs = [edge_sign(c, b), edge_sign(a, c), edge_sign(b, a)];
        let has_positive = signs.iter().any(|sign| *sign > 0);
        let has_negative = signs.iter().any(|sign| *sign < 0);
        if has_positive == has_negative {
            // Outside, or (all three zero) seen edge-on.
            return None;
        }
        // A triangle without area may have some in its rounded projection.
        if triangle.is_degenerate() {
            return None;
        }
        self.confirm(triangle, [a, b, c], t_max)
    }
}

impl Woop {
    #[inline]
    fn project(&self, vertex: Vec3) -> Projected {
        let from_origin = vertex - self.origin;
        let z = from_origin[self.z];
        Projected {
            x: from_origin[self.x] - self.shear_x * z,
            y: from_origin[self.y] - self.shear_y * z,
            z,
        }
    }

    /// `t` and the weights of a triangle whose rounded projection contains the origin: those of the confirmation
    /// where the ray does meet the triangle, and else those of the projection.
    #[inline(never)]
    fn confirm(
        &self,
        triangle: &Triangle,
        projected: [Projected; 3],
        t_max: f32,
    ) -> Option<TriangleHit> {
        let [t, u, v] = confirm::intersect(self.origin, self.direction, triangle)
            .unwrap_or_else(|| self.interpolate(projected));
        TriangleHit::rounded(t, u, v, self.t_min, t_max)
    }

    fn interpolate(&self, [a, b, c]: [Projected; 3]) -> [f64; 3] {
        let weights = DVec3::new(
            edge_function(c, b),
            edge_function(a, c),
            edge_function(b, a),
        );
        let depths = DVec3::new(f64::from(a.z), f64::from(b.z), f64::from(c.z));
        let determinant = weights.element_sum();
        let t = weights.dot(depths) / (determinant * f64::from(self.direction[self.z]));
        [t, weights.y / determinant, weights.z / determinant]
    }
}

/// Twice the signed area of the triangle of the origin and two projected vertices, correct to one rounding.
fn edge_function(from: Projected, to: Projected) -> f64 {
    f64::from(from.x) * f64::from(to.y) - f64::from(from.y) * f64::from(to.x)
}

/// The exact sign of [`edge_function`]: 1, 0 or -1. NaN, from coordinates that overflow, gives 0.
#[inline]
fn edge_sign(from: Projected, to: Projected) -> i8 {
    let left = from.x * to.y;
    let right = from.y * to.x;
    if left > right {
        1
    } else if left < right {
        -1
    } else {
        exact_edge_sign(from, to)
    }
}

#[cold]
fn exact_edge_sign(from: Projected, to: Projected) -> i8 {
    let value = edge_function(from, to);
    i8::from(value > 0.0) - i8::from(value < 0.0)
}
