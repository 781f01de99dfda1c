//! A filter in f64 that throws out the triangles which a ray certainly misses.
//!
//! The determinant and the numerators of `u`, `v` and `t` (Möller and Trumbore's terms) are computed with a bound of their errors.
//!
//! **No overflow, no underflow.** All factors are f32 numbers or rounded differences of two: zero, or multiples of `2^-149` of at most `2^129`. A
//! product of three is at most `2^387`, a sum of six below `2^390`. Rounding to 53 bits keeps a multiple of a power of two one, so products of two
//! are zero or multiples of `2^-298`, and those of three zero or multiples of `2^-447`; so are their sums. All are far inside
//! the normal range of f64, and so are their products with [`ERROR`] and with a bound of `t`, which is an f32 or,
//! as a quotient of two terms, between `2^-837` and `2^837` (products that do overflow become infinite and throw out nothing; one that underflows is
//! below `2^-1000` and is compared with multiples of `2^-550`). Hence every operation has a relative error of at most `e = 2^-53`.
//!
//! **The bound.** Each term is a sum of six monomials of three factors. The way from the inputs to a term has at most three roundings of differences, two of
//! products and three of sums: the computed monomials are the exact ones times `1 + d`, `|d| <= (1 + e)^8 - 1`. The sum of their
//! magnitudes, computed by the same operations without a subtraction, is `M`, at least `(1 - e)^8` times the exact sum. So the
//! error of a term is at most `8 e M` to first order, and less than `9 e M` in all. The bound used is [`ERROR`]` M` with `ERROR = 16 e`: the
//! remaining `7 e M` pay for the roundings of the comparisons, namely two each of `determinant - (u + v)`, of a term plus or minus
//! its bound, and of a product with a bound of `t` (each at most `e M` of the terms they are made of).

use glam::DVec3;

use crate::Ray;

/// Error of a term, in units of the sum of the magnitudes of its monomials.
const ERROR: f64 = 16.0 * f64::EPSILON / 2.0;

/// A ray, ready to be tested against triangles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Filter {
    origin: DVec3,
    direction: DVec3,
    t_min: f64,
    t_max: f64,
}

/// A triangle that the ray may hit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    /// Its place in the oracle's list.
    pub(super) place: usize,
    /// The numerator of `t`, for a positive determinant.
    numerator: Bounded,
    /// The determinant: positive, or of unknown sign.
    determinant: Bounded,
}

/// A value that is at most `error` from the exact one.
#[derive(Clone, Copy, Debug)]
struct Bounded {
    value: f64,
    error: f64,
}

impl Bounded {
    const fn is_positive(self) -> bool {
        self.value > self.error
    }

    const fn is_negative(self) -> bool {
        self.value < -self.error
    }

    fn negated_if(self, condition: bool) -> Self {
        let value = if condition { -self.value } else { self.value };
        Self { value, ..self }
    }
}

impl Filter {
    pub(super) fn new(ray: &Ray) -> Self {
        Self {
            origin: ray.origin.as_dvec3(),
            direction: ray.direction.as_dvec3(),
            t_min: ray.t_min.into(),
            t_max: ray.t_max.into(),
        }
    }

    /// The triangle, unless the ray certainly misses it.
    pub(super) fn candidate(&self, place: usize, [a, b, c]: &[DVec3; 3]) -> Option<Candidate> {
        let (edge1, edge2, from_a) = (b - a, c - a, self.origin - a);
        let p = Cross::new(self.direction, edge2);
        let q = Cross::new(from_a, edge1);
        let determinant = p.dot(edge1);
        // No monomial, no determinant: the ray is parallel to the plane.
        if determinant.error == 0.0 {
            return None;
        }
        let (u, v) = (p.dot(from_a), q.dot(self.direction));
        let w = Bounded {
            value: determinant.value - (u.value + v.value),
            error: determinant.error + u.error + v.error,
        };
        // A hit has weights and a determinant of one sign.
        let terms = [determinant, u, v, w];
        if terms.iter().any(|term| term.is_positive())
            && terms.iter().any(|term| term.is_negative())
        {
            return None;
        }
        let is_negative = determinant.is_negative();
        let candidate = Candidate {
            place,
            numerator: q.dot(edge2).negated_if(is_negative),
            determinant: determinant.negated_if(is_negative),
        };
        let is_outside =
            candidate.is_certainly_before(self.t_min) || candidate.is_certainly_beyond(self.t_max);
        (!is_outside).then_some(candidate)
    }
}

impl Candidate {
    /// `t`, roughly; minus infinity where nothing is known.
    pub(super) fn approximate_t(&self) -> f64 {
        if self.determinant.is_positive() {
            self.numerator.value / self.determinant.value
        } else {
            f64::NEG_INFINITY
        }
    }

    /// Whether `t` is certainly above a limit, which may be infinite.
    pub(super) fn is_certainly_beyond(&self, limit: f64) -> bool {
        let Bounded { value, error } = self.numerator;
        let [low, high] = self.times(limit);
        self.determinant.is_positive() && value - error > low.max(high)
    }

    /// Whether `t` is certainly below a limit, which may be infinite.
    fn is_certainly_before(&self, limit: f64) -> bool {
        let Bounded { value, error } = self.numerator;
        let [low, high] = self.times(limit);
        self.determinant.is_positive() && value + error < low.min(high)
    }

    /// A factor times the smallest and the largest value of the determinant.
    fn times(&self, factor: f64) -> [f64; 2] {
        let Bounded { value, error } = self.determinant;
        [factor * (value - error), factor * (value + error)]
    }
}

/// A cross product and, per component, the sum of the magnitudes of its two products.
struct Cross {
    value: DVec3,
    magnitude: DVec3,
}

impl Cross {
    fn new(a: DVec3, b: DVec3) -> Self {
        let first = DVec3::new(a.y * b.z, a.z * b.x, a.x * b.y);
        let second = DVec3::new(a.z * b.y, a.x * b.z, a.y * b.x);
        Self {
            value: first - second,
            magnitude: first.abs() + second.abs(),
        }
    }

    fn dot(&self, vector: DVec3) -> Bounded {
        Bounded {
            value: self.value.dot(vector),
            error: ERROR * self.magnitude.dot(vector.abs()),
        }
    }
}
