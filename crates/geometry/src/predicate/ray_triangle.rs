//! A ray against a triangle in exact arithmetic: the last rung.

use std::cmp::Ordering;

use glam::Vec3;

use super::whole::WholeLine;
use super::{Expansion, F64_ERROR, Rung, Sign};
use crate::{Ray, Triangle, TriangleHit};

/// Who owns the edges of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum EdgeRule {
    /// The triangle is a closed set: a ray through an edge hits the triangles on both sides of it.
    Closed,
    /// The ray's origin is moved by `(e, e^2, e^3)` with an infinitesimal `e > 0`, so that it passes no edge of any triangle
    /// exactly, and crosses a closed surface as often inwards as outwards.
    ///
    /// The derivative of `D . ((P - O) x (Q - O))` by the movement of the origin is `D x (Q - P)`. So where the edge function is zero, the first
    /// component of that vector which is not decides; if all are zero, the edge is parallel to the ray, and its triangle is never crossed.
    /// The rule depends on the ray and on the edge alone, with opposite signs for opposite directions: neighbours agree.
    ///
    /// Source: Edelsbrunner and Mücke, "Simulation of simplicity", 1990.
    Perturbed,
}

/// The edges of a triangle: each opposite of the vertex of the same place, whose weight its edge function is.
pub(super) const EDGES: [[usize; 2]; 3] = [[1, 2], [2, 0], [0, 1]];

/// A hit, known exactly.
pub(crate) struct ExactHit {
    /// `t = numerator / determinant`.
    numerator: Expansion,
    determinant: Expansion,
    /// The weights of the second and third vertex, times the determinant.
    weights: [Expansion; 2],
}

type Vector = [Expansion; 3];

fn difference(a: Vec3, b: Vec3) -> Vector {
    [0, 1, 2].map(|axis| Expansion::difference(a[axis], b[axis]))
}

fn cross(a: &Vector, b: &Vector) -> Vector {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| a[i].times(&b[j]).minus(&a[j].times(&b[i])))
}

fn cross_vector(a: Vec3, b: &Vector) -> Vector {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| b[j].scaled(a[i].into()).minus(&b[i].scaled(a[j].into())))
}

fn dot(a: &Vector, b: &Vector) -> Expansion {
    let [x, y, z] = [0, 1, 2].map(|axis| a[axis].times(&b[axis]));
    x.plus(&y).plus(&z)
}

/// The dot product with a vector of single numbers.
fn dot_vector(a: &Vector, b: Vec3) -> Expansion {
    let [x, y, z] = [0, 1, 2].map(|axis| a[axis].scaled(f64::from(b[axis])));
    x.plus(&y).plus(&z)
}

/// `(B - A) x (C - A)`.
pub(super) fn normal(triangle: &Triangle) -> Vector {
    cross(
        &difference(triangle.b, triangle.a),
        &difference(triangle.c, triangle.a),
    )
}

/// `D . ((from - O) x (to - O))`, as `(to - from) . (D x (from - O))`.
fn edge_function(ray: &Ray, from: Vec3, to: Vec3) -> Expansion {
    let moment = cross_vector(ray.direction, &difference(from, ray.origin));
    dot(&difference(to, from), &moment)
}

/// The side of an edge.
pub(super) fn edge_side(ray: &Ray, from: Vec3, to: Vec3) -> Sign {
    match WholeLine::new(ray, [from, to]) {
        Some(line) => Sign::of_whole(line.edge_function([0, 1])),
        None => edge_function(ray, from, to).sign(),
    }
}

/// Whether a ray passes some of a triangle's edges, each that opposite of the vertex of the same place, on a side or, where the triangle is
/// [closed](EdgeRule::Closed), meets them.
#[cold]
#[inline(never)]
pub(crate) fn passes_edges(
    ray: &Ray,
    triangle: &Triangle,
    edges: [bool; 3],
    side: Sign,
    rule: EdgeRule,
) -> bool {
    let vertices = triangle.vertices();
    let line = WholeLine::new(ray, vertices);
    (0..3).filter(|edge| edges[*edge]).all(|edge| {
        let sign = if let Some(line) = &line {
            line.settled_side(edge, line.edge_function(EDGES[edge]), rule)
        } else {
            let [from, to] = EDGES[edge].map(|vertex| vertices[vertex]);
            let sign = edge_function(ray, from, to).sign();
            settled(sign, rule, || derivative(ray, from, to))
        };
        sign == side || (rule == EdgeRule::Closed && sign == Sign::Zero)
    })
}

/// `D . N`.
fn determinant(direction: Vec3, triangle: &Triangle) -> Expansion {
    dot_vector(&normal(triangle), direction)
}

/// The sign of [`determinant`].
pub(super) fn direction_side(direction: Vec3, triangle: &Triangle) -> Sign {
    // The sum of the edges does not depend on the origin.
    match WholeLine::new(&Ray::new(triangle.a, direction), triangle.vertices()) {
        Some(line) => Sign::of_whole(line.determinant()),
        None => determinant(direction, triangle).sign(),
    }
}

/// `(A - O) . N`: how far the triangle's plane is in front of a point, in lengths of the normal.
fn depth(origin: Vec3, triangle: &Triangle) -> Expansion {
    dot(&difference(triangle.a, origin), &normal(triangle))
}

/// The sign of minus [`depth`].
pub(super) fn point_side(point: Vec3, triangle: &Triangle) -> Sign {
    // The direction takes no part.
    let sign = match WholeLine::new(&Ray::new(point, Vec3::ZERO), triangle.vertices()) {
        Some(line) => Sign::of_whole(line.depth()),
        None => depth(point, triangle).sign(),
    };
    sign.flipped()
}

/// The sign of an edge function, where it is zero settled by a rule from the signs of its [`derivative`].
pub(super) fn settled(sign: Sign, rule: EdgeRule, derivative: impl FnOnce() -> [Sign; 3]) -> Sign {
    if sign != Sign::Zero || rule == EdgeRule::Closed {
        return sign;
    }
    derivative()
        .into_iter()
        .find(|sign| *sign != Sign::Zero)
        .unwrap_or(Sign::Zero)
}

/// The signs of the derivative of an edge function by the movement of the origin.
fn derivative(ray: &Ray, from: Vec3, to: Vec3) -> [Sign; 3] {
    let derivative = cross_vector(ray.direction, &difference(to, from));
    derivative.each_ref().map(Expansion::sign)
}

/// Where a ray's line meets a triangle; `None` for a miss.
pub(crate) fn intersect_exactly(
    ray: &Ray,
    triangle: &Triangle,
    rule: EdgeRule,
) -> Option<ExactHit> {
    match WholeLine::new(ray, triangle.vertices()) {
        Some(line) => intersect_whole(&line, rule),
        None => intersect_expansions(ray, triangle, rule),
    }
}

/// [`intersect_exactly`] in whole numbers. The weights are edge functions, and their sum is the determinant.
fn intersect_whole(line: &WholeLine<3>, rule: EdgeRule) -> Option<ExactHit> {
    let weights = line.edge_functions();
    let sides = [0, 1, 2].map(|edge| line.settled_side(edge, weights[edge], rule));
    let determinant = line.determinant();
    (is_inside(sides, rule) && determinant != 0).then(|| ExactHit {
        numerator: line.value_of_depth(line.depth()),
        determinant: line.value_of_edges(determinant),
        weights: [1, 2].map(|index| line.value_of_edges(weights[index])),
    })
}

/// [`intersect_exactly`] for all coordinates.
///
/// The weight of the first vertex is the side of the opposite edge, from the second vertex to the third, and so on in turn. In the
/// terms of the [exact kernel](crate::kernel::Exact): `-(e2 . r)` for the second vertex, `e1 . r` for the third, with `r = D x (A - O)`.
fn intersect_expansions(ray: &Ray, triangle: &Triangle, rule: EdgeRule) -> Option<ExactHit> {
    let Triangle { a, b, c } = *triangle;
    let from_origin = difference(a, ray.origin);
    let moment = cross_vector(ray.direction, &from_origin);
    let [edge1, edge2] = [b, c].map(|vertex| difference(vertex, a));
    let of_b = Expansion::zero().minus(&dot(&edge2, &moment));
    let sign_b = settled(of_b.sign(), rule, || derivative(ray, c, a));
    let of_c = dot(&edge1, &moment);
    let sign_c = settled(of_c.sign(), rule, || derivative(ray, a, b));
    if are_opposite(sign_b, sign_c) {
        return None;
    }
    let normal = cross(&edge1, &edge2);
    let determinant = dot_vector(&normal, ray.direction);
    let of_a = determinant.minus(&of_b).minus(&of_c);
    let sign_a = settled(of_a.sign(), rule, || derivative(ray, b, c));
    if !is_inside([sign_a, sign_b, sign_c], rule) || determinant.sign() == Sign::Zero {
        return None;
    }
    Some(ExactHit {
        numerator: dot(&from_origin, &normal),
        determinant,
        weights: [of_b, of_c],
    })
}

/// Whether a ray with these sides of edges, settled by the rule, goes through the triangle.
fn is_inside([a, b, c]: [Sign; 3], rule: EdgeRule) -> bool {
    let is_outside = are_opposite(a, b) || are_opposite(b, c) || are_opposite(c, a);
    let misses_by_perturbation = rule == EdgeRule::Perturbed && [a, b, c].contains(&Sign::Zero);
    !is_outside && !misses_by_perturbation
}

fn are_opposite(first: Sign, second: Sign) -> bool {
    first != Sign::Zero && second == first.flipped()
}

impl ExactHit {
    /// Where the ray's line meets the triangle's plane; `None` if it is parallel to it.
    fn of_plane(ray: &Ray, triangle: &Triangle) -> Option<Self> {
        let (numerator, determinant) = match WholeLine::new(ray, triangle.vertices()) {
            Some(line) => (
                line.value_of_depth(line.depth()),
                line.value_of_edges(line.determinant()),
            ),
            None => (
                depth(ray.origin, triangle),
                determinant(ray.direction, triangle),
            ),
        };
        (determinant.sign() != Sign::Zero).then(|| Self {
            numerator,
            determinant,
            weights: [Expansion::zero(), Expansion::zero()],
        })
    }

    /// `t`, `u` and `v` rounded, if the exact `t` is in the ray's interval.
    pub(crate) fn rounded_in_interval(&self, ray: &Ray) -> Option<TriangleHit> {
        let is_inside = self.compare_t(ray.t_min) != Ordering::Less
            && self.compare_t(ray.t_max) != Ordering::Greater;
        is_inside.then(|| {
            let determinant = self.determinant.approximation();
            let [u, v] = [0, 1].map(|index| self.weights[index].approximation() / determinant);
            TriangleHit::new(self.rounded_t(), u, v)
        })
    }

    /// Compares `t` with a number that is not NaN.
    fn compare_t(&self, t: f32) -> Ordering {
        if t.is_infinite() {
            return if t > 0.0 {
                Ordering::Less
            } else {
                Ordering::Greater
            };
        }
        self.compare_t_f64(f64::from(t))
    }

    /// Compares `t` with a number of at most 25 bits in the range of f32.
    fn compare_t_f64(&self, t: f64) -> Ordering {
        let difference = self.numerator.minus(&self.determinant.scaled(t));
        self.order(difference.sign())
    }

    /// The order of two values from the sign of their difference times the determinant.
    fn order(&self, sign: Sign) -> Ordering {
        let order = sign.compared_with_zero();
        if self.determinant.sign() == Sign::Negative {
            order.reverse()
        } else {
            order
        }
    }

    /// The order of two hits.
    fn compare(&self, other: &Self) -> Ordering {
        let left = self.numerator.times(&other.determinant);
        let right = other.numerator.times(&self.determinant);
        let order = self.order(left.minus(&right).sign());
        if other.determinant.sign() == Sign::Negative {
            order.reverse()
        } else {
            order
        }
    }

    /// `t` rounded to the nearest f32, ties to even, and to the largest finite one instead of infinity.
    fn rounded_t(&self) -> f32 {
        // Off by less than 2^-48 of itself.
        let t = self.numerator.approximation() / self.determinant.approximation();
        #[expect(
            clippy::cast_possible_truncation,
            reason = "rounds to the nearest f32, mended below"
        )]
        let nearest = (t as f32).clamp(f32::MIN, f32::MAX);
        for (inner, outer) in [(nearest.next_down(), nearest), (nearest, nearest.next_up())] {
            if inner.is_infinite() || outer.is_infinite() {
                continue;
            }
            // Exact: 25 bits.
            let middle = f64::midpoint(f64::from(inner), f64::from(outer));
            if (t - middle).abs() <= t.abs() * f64::EPSILON * 16.0 {
                let is_even = |value: f32| value.to_bits().is_multiple_of(2);
                return match self.compare_t_f64(middle) {
                    Ordering::Less => inner,
                    Ordering::Greater => outer,
                    Ordering::Equal if is_even(inner) => inner,
                    Ordering::Equal => outer,
                };
            }
        }
        nearest
    }
}

/// `t` in f64 with a bound of its error; `None` where too much cancels.
fn approximate_t(ray: &Ray, triangle: &Triangle) -> Option<(f64, f64)> {
    let [origin, direction, a, b, c] = [
        ray.origin,
        ray.direction,
        triangle.a,
        triangle.b,
        triangle.c,
    ]
    .map(Vec3::as_dvec3);
    let (from_origin, edge1, edge2) = (a - origin, b - a, c - a);
    let normal = edge1.cross(edge2);
    let determinant = direction.dot(normal);
    let [d, f, e1, e2] =
        [direction, from_origin, edge1, edge2].map(|vector| vector.abs().max_element());
    let error = F64_ERROR * e1 * e2;
    quotient(from_origin.dot(normal), error * f, determinant, error * d)
}

/// A quotient with a bound of its error, from numbers with bounds; `None` if the divisor is not certain to two bits.
#[inline]
pub(crate) fn quotient(
    value: f64,
    value_error: f64,
    divisor: f64,
    divisor_error: f64,
) -> Option<(f64, f64)> {
    // One division, which is slow, in place of two.
    let reciprocal = 1.0 / divisor;
    let quotient = value * reciprocal;
    // The divisor is at least half of what was computed, hence the factor 2; the last term is the two roundings of the quotient
    // and those of the bound itself.
    let error = 2.0 * (value_error + quotient.abs() * divisor_error) * reciprocal.abs()
        + quotient.abs() * (2.0 * f64::EPSILON);
    (divisor.abs() > 2.0 * divisor_error).then_some((quotient, error))
}

pub(super) fn compare_t(ray: &Ray, triangle: &Triangle, t: f32) -> Option<Ordering> {
    if let Some((value, error)) = approximate_t(ray, triangle)
        && let Some(sign) = Sign::certain(value - f64::from(t), error * 2.0)
    {
        return Some(sign.compared_with_zero());
    }
    ExactHit::of_plane(ray, triangle).map(|hit| hit.compare_t(t))
}

/// The order in which a ray's line meets the planes of two triangles, and the rung that decided; equal where it is parallel to one of them.
pub(crate) fn order_of_planes(ray: &Ray, first: &Triangle, second: &Triangle) -> (Ordering, Rung) {
    // First, as it is the usual reason to ask: f64 cannot tell equal from nearly equal.
    if are_in_a_plane_of_an_axis(first, second) || meet_where_the_ray_does(ray, first, second) {
        return (Ordering::Equal, Rung::Exact);
    }
    if let (Some((first, first_error)), Some((second, second_error))) =
        (approximate_t(ray, first), approximate_t(ray, second))
        && let Some(sign) = Sign::certain(first - second, 2.0 * (first_error + second_error))
    {
        return (sign.compared_with_zero(), Rung::F64);
    }
    let [first, second] = [first, second].map(|triangle| ExactHit::of_plane(ray, triangle));
    let order = first
        .zip(second)
        .map(|(first, second)| first.compare(&second));
    (order.unwrap_or(Ordering::Equal), Rung::Exact)
}

/// Whether two triangles lie in the same plane across an axis: doubled floors and walls are the usual reason for many hits at the same `t`.
fn are_in_a_plane_of_an_axis(first: &Triangle, second: &Triangle) -> bool {
    let [first, second] = [first.vertices(), second.vertices()];
    (0..3).any(|axis| {
        let mut others = first.iter().chain(&second);
        others.all(|vertex| vertex[axis] == first[0][axis])
    })
}

/// Whether a ray's line passes through a point of an edge or vertex that two triangles have in common: the usual reason for two
/// hits at the same `t`, and much cheaper to see than to compare products of six factors.
fn meet_where_the_ray_does(ray: &Ray, first: &Triangle, second: &Triangle) -> bool {
    let of_second = second.vertices();
    let of_first = first.vertices().into_iter();
    let mut common = of_first.filter(|vertex| of_second.contains(vertex));
    match (common.next(), common.next()) {
        (None, _) => false,
        (Some(vertex), None) => match WholeLine::new(ray, [vertex]) {
            Some(line) => line.meets(0),
            None => {
                let moment = cross_vector(ray.direction, &difference(vertex, ray.origin));
                moment.iter().all(|part| part.sign() == Sign::Zero)
            }
        },
        (Some(from), Some(to)) => edge_side(ray, from, to) == Sign::Zero,
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::test_support::{grid_point, point};

    fn corners() -> impl Strategy<Value = [Vec3; 4]> {
        let points = prop::array::uniform4(point(1.0));
        prop_oneof![points, prop::array::uniform4(grid_point())]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        /// Most coordinates are whole numbers after scaling: expansions are seldom asked, but must say the same.
        #[test]
        fn expansions_and_whole_numbers_agree([a, b, c, origin] in corners(), target in 0usize..4) {
            let triangle = Triangle::new(a, b, c);
            let ray = Ray::new(origin, [a, b.midpoint(c), a + 0.25 * (b - a) + 0.5 * (c - a), b][target] - origin);
            let Some(line) = WholeLine::new(&ray, triangle.vertices()) else {
                return Ok(());
            };
            for rule in [EdgeRule::Closed, EdgeRule::Perturbed] {
                let hits = [intersect_whole(&line, rule), intersect_expansions(&ray, &triangle, rule)];
                let [found, expected] = hits.each_ref().map(|hit| {
                    hit.as_ref().map(|hit| [&hit.numerator, &hit.determinant, &hit.weights[0], &hit.weights[1]].map(Expansion::exact_value))
                });
                prop_assert_eq!(found, expected, "{:?}", rule);
            }
            prop_assert_eq!(edge_side(&ray, a, b), edge_function(&ray, a, b).sign());
            prop_assert_eq!(direction_side(ray.direction, &triangle), determinant(ray.direction, &triangle).sign());
            prop_assert_eq!(point_side(origin, &triangle), depth(origin, &triangle).sign().flipped());
        }
    }
}
