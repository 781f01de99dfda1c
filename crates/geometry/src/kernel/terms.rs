//! A ray and a triangle in f64: the terms of the [exact kernel](super::Exact), with bounds of their errors.
//!
//! The bounds are those of [`predicate`](crate::predicate), relative to the product of the largest components of the factors. Where a test has to be quick, the sums of components take
//! the place of the largest ones, which are not larger: compilers make branches of maxima, and which component is the largest is anyone's guess.

use glam::{DVec3, Vec3, Vec3A};

use crate::predicate::{F64_ERROR, quotient};
use crate::simd::{Doubles, Scalar, Simd};
use crate::{Ray, Triangle, TriangleHit};

/// Weights are taken from the f64 rung if their error is below this.
pub(crate) const WEIGHT_ERROR: f64 = 1.0 / (1u64 << 26) as f64;
/// [`F64_ERROR`], and the roundings of bounds: a hit that is certain by this one is so by the other one.
const CERTAIN_ERROR: f64 = F64_ERROR * (1.0 + 1.0 / (1u64 << 40) as f64);

/// The terms of a ray and a triangle in f64, with bounds of their errors.
#[derive(Clone, Copy)]
pub(super) struct Terms {
    pub(super) of_b: f64,
    pub(super) of_c: f64,
    pub(super) determinant: f64,
    depth: f64,
    pub(super) error_b: f64,
    pub(super) error_c: f64,
    determinant_error: f64,
    depth_error: f64,
}

impl Terms {
    #[inline(always)]
    pub(super) fn new(ray: &Ray, triangle: &Triangle) -> Self {
        let [origin, direction] = [ray.origin, ray.direction].map(Vec3::as_dvec3);
        let [a, b, c] = triangle.vertices().map(Vec3::as_dvec3);
        let (from_origin, edge1, edge2) = (a - origin, b - a, c - a);
        let normal = edge1.cross(edge2);
        let moment = direction.cross(from_origin);
        let [d, f, e1, e2] = [direction, from_origin, edge1, edge2].map(largest_component_f64);
        Self {
            of_b: -edge2.dot(moment),
            of_c: edge1.dot(moment),
            determinant: direction.dot(normal),
            depth: from_origin.dot(normal),
            error_b: F64_ERROR * d * f * e2,
            error_c: F64_ERROR * d * f * e1,
            determinant_error: F64_ERROR * d * e1 * e2,
            depth_error: F64_ERROR * f * e1 * e2,
        }
    }

    /// Whether the triangle's plane is certainly met before the origin.
    #[inline(always)]
    pub(super) fn are_behind(&self) -> bool {
        let depth = self.depth * 1f64.copysign(self.determinant);
        depth < -self.depth_error && self.determinant.abs() > self.determinant_error
    }

    /// The weight of the first vertex and the bound of its error.
    #[inline(always)]
    pub(super) fn of_a(&self) -> (f64, f64) {
        (
            self.determinant - self.of_b - self.of_c,
            self.determinant_error + self.error_b + self.error_c,
        )
    }

    /// `t` and the bound of its error; `None` if it or the weights are too uncertain.
    #[inline(always)]
    pub(super) fn t(&self) -> Option<(f64, f64)> {
        let (_, error_a) = self.of_a();
        let is_well_conditioned = error_a <= WEIGHT_ERROR * self.determinant.abs();
        let t = quotient(
            self.depth,
            self.depth_error,
            self.determinant,
            self.determinant_error,
        );
        t.filter(|_| is_well_conditioned)
    }

    /// The hit at a `t` that is certain.
    #[inline(always)]
    pub(super) fn hit(&self, t: f32) -> TriangleHit {
        let reciprocal = 1.0 / self.determinant;
        TriangleHit::new(t, self.of_b * reciprocal, self.of_c * reciprocal)
    }
}

/// The largest magnitude of a component.
#[inline(always)]
fn largest_component_f64(vector: DVec3) -> f64 {
    let larger = |a: f64, b: f64| if a > b { a } else { b };
    larger(vector.x.abs(), larger(vector.y.abs(), vector.z.abs()))
}

/// What is known of a hit that is certain; for one ray and triangle, or four.
pub(super) struct CertainTerms<D: Doubles> {
    /// Not above `t`, and not below it.
    pub(super) ends: [D::F64s; 2],
    pub(super) u: D::F64s,
    pub(super) v: D::F64s,
    /// Negative if the weights are not sure enough.
    pub(super) slack: D::F64s,
}

/// A ray and a triangle: origin, direction and vertices.
pub(super) type RayAndTriangle<F> = [[F; 3]; 5];

/// What the terms are made of: sums over the axes.
pub(super) struct Sums<F> {
    /// The determinant, minus the weight of the second vertex, the weight of the third one, and the depth.
    products: [F; 4],
    /// Of the magnitudes of components: of the direction, of the way from the origin to the first vertex, and of the edges that leave it.
    magnitudes: [F; 4],
}

impl<F: Copy> Sums<F> {
    /// The sums of four rays and triangles, a lane for each; the bits are those [of one](Sums::of_one).
    #[inline(always)]
    pub(super) fn of_lanes<D: Doubles<F64s = F>>(
        n: D,
        [origin, d, a, b, c]: RayAndTriangle<F>,
    ) -> Self {
        let (f, e1, e2) = (minus(n, a, origin), minus(n, b, a), minus(n, c, a));
        let (normal, moment) = (cross(n, e1, e2), cross(n, d, f));
        Self {
            products: [
                dot(n, d, normal),
                dot(n, e2, moment),
                dot(n, e1, moment),
                dot(n, f, normal),
            ],
            magnitudes: [length(n, d), length(n, f), length(n, e1), length(n, e2)],
        }
    }
}

impl Sums<f64> {
    /// The sums of a ray and a triangle: a lane for each axis.
    #[inline(always)]
    fn of_one<S: Simd>(simd: S, ray: &Ray, [a, b, c]: &[Vec3A; 3]) -> Self {
        let (origin, direction) = (ray.origin, ray.direction);
        // The fourth numbers mean nothing: those of the ray follow in memory, so this is one load each.
        let origin = simd.widen_four([origin.x, origin.y, origin.z, direction.x]);
        let d = simd.widen_four([direction.x, direction.y, direction.z, ray.t_min]);
        let a = simd.widen_four(a.extend(0.0).to_array());
        let b = simd.widen_four(b.extend(0.0).to_array());
        let c = simd.widen_four(c.extend(0.0).to_array());
        let f = simd.sub_f64(a, origin);
        let (e1, e2) = (simd.sub_f64(b, a), simd.sub_f64(c, a));
        let (normal, moment) = (cross_of_one(simd, e1, e2), cross_of_one(simd, d, f));
        Self {
            products: simd.sums_of_three([
                simd.mul_f64(d, normal),
                simd.mul_f64(e2, moment),
                simd.mul_f64(e1, moment),
                simd.mul_f64(f, normal),
            ]),
            magnitudes: simd.sums_of_three([
                simd.abs_f64(d),
                simd.abs_f64(f),
                simd.abs_f64(e1),
                simd.abs_f64(e2),
            ]),
        }
    }
}

/// The f64 rung without its decisions, for triangles that the ray certainly hits.
///
/// The bounds are those of the rung with the sums of components in place of the largest ones, of which the compiler makes branches. That the
/// determinant is certain follows from the weights; and as the exact `t` is in the ray's interval, so is the rounded one.
#[inline(always)]
pub(super) fn certain_terms<D: Doubles>(n: D, sums: &Sums<D::F64s>) -> CertainTerms<D> {
    let [determinant, minus_of_b, of_c, depth] = sums.products;
    let [of_d, of_f, of_e1, of_e2] = sums.magnitudes;
    let of_b = n.mul_f64(minus_of_b, n.splat_f64(-1.0));
    let certain_error = n.splat_f64(CERTAIN_ERROR);
    let area_error = n.mul_f64(n.mul_f64(certain_error, of_e1), of_e2);
    let determinant_error = n.mul_f64(area_error, of_d);
    let error_of_edges = n.mul_f64(
        n.mul_f64(n.mul_f64(certain_error, of_d), of_f),
        n.add_f64(of_e1, of_e2),
    );
    let error_of_a = n.add_f64(determinant_error, error_of_edges);
    // As `quotient`.
    let reciprocal = n.div_f64(n.splat_f64(1.0), determinant);
    let t = n.mul_f64(depth, reciprocal);
    let magnitude = n.abs_f64(t);
    let error = n.add_f64(
        n.mul_f64(area_error, of_f),
        n.mul_f64(magnitude, determinant_error),
    );
    let error = n.mul_f64(n.mul_f64(n.splat_f64(2.0), error), n.abs_f64(reciprocal));
    let error = n.add_f64(error, n.mul_f64(magnitude, n.splat_f64(2.0 * f64::EPSILON)));
    let limit = n.mul_f64(n.splat_f64(WEIGHT_ERROR), n.abs_f64(determinant));
    CertainTerms {
        ends: [n.sub_f64(t, error), n.add_f64(t, error)],
        u: n.mul_f64(of_b, reciprocal),
        v: n.mul_f64(of_c, reciprocal),
        slack: n.sub_f64(limit, error_of_a),
    }
}

/// The hit of a triangle that the ray certainly hits; `None` if f64 is not sure of `t` and the weights.
#[inline(always)]
pub(super) fn certain_hit<S: Simd>(
    simd: S,
    ray: &Ray,
    vertices: &[Vec3A; 3],
) -> Option<TriangleHit> {
    let sums = Sums::of_one(simd, ray, vertices);
    let CertainTerms { ends, u, v, slack } = certain_terms(Scalar, &sums);
    #[expect(clippy::cast_possible_truncation, reason = "rounds to the nearest f32")]
    let [low, high] = [ends[0] as f32, ends[1] as f32];
    let is_certain = (slack >= 0.0) & (low == high) & (low.abs() < f32::INFINITY);
    is_certain.then(|| TriangleHit::new(low, u, v))
}

/// The cross product, a lane for each axis.
#[inline(always)]
fn cross_of_one<S: Simd>(simd: S, p: S::F64s, q: S::F64s) -> S::F64s {
    let (next_p, next_q) = (simd.rotate_three(p), simd.rotate_three(q));
    // Its last component comes first.
    let rotated = simd.sub_f64(simd.mul_f64(p, next_q), simd.mul_f64(next_p, q));
    simd.rotate_three(rotated)
}

#[inline(always)]
fn minus<D: Doubles>(n: D, p: [D::F64s; 3], q: [D::F64s; 3]) -> [D::F64s; 3] {
    [
        n.sub_f64(p[0], q[0]),
        n.sub_f64(p[1], q[1]),
        n.sub_f64(p[2], q[2]),
    ]
}

#[inline(always)]
fn dot<D: Doubles>(n: D, p: [D::F64s; 3], q: [D::F64s; 3]) -> D::F64s {
    let sum = n.add_f64(n.mul_f64(p[0], q[0]), n.mul_f64(p[1], q[1]));
    n.add_f64(sum, n.mul_f64(p[2], q[2]))
}

#[inline(always)]
fn cross<D: Doubles>(n: D, p: [D::F64s; 3], q: [D::F64s; 3]) -> [D::F64s; 3] {
    let component = |i: usize, j: usize| n.sub_f64(n.mul_f64(p[i], q[j]), n.mul_f64(p[j], q[i]));
    [component(1, 2), component(2, 0), component(0, 1)]
}

/// The sum of the magnitudes of components.
#[inline(always)]
fn length<D: Doubles>(n: D, vector: [D::F64s; 3]) -> D::F64s {
    let [x, y, z] = vector;
    n.add_f64(n.add_f64(n.abs_f64(x), n.abs_f64(y)), n.abs_f64(z))
}
