//! Exact arithmetic on whole numbers: the quick way of the last rung.
//!
//! The points of a test are multiplied by the power of two that brings the largest coordinate into `[2^38, 2^39)`, and the ray's direction by one of its own. Where all
//! products are whole numbers, integers hold what is asked for, exactly: differences of points are below `2^40`, a triple product of them, or of two and the direction,
//! is below `6 * 2^120`, and the sum of three of those below `2^125`, inside of 128 bits.
//!
//! An f32 is a multiple of `2^-23` of the power of two below it. So a coordinate is whole unless it is smaller than `2^-15` of the largest one and has low bits that are set, as
//! one in some thirty thousand random ones does. Tests with such coordinates are left to [expansions](Expansion), which have room for every f32.
//!
//! Expansions are slowest where a sum of products vanishes, for nothing short of all their parts tells that; and rays through vertices and edges are the usual reason to come
//! here. To integers a zero is a number like any other.

use glam::Vec3;

use super::ray_triangle::{EDGES, settled};
use super::{EdgeRule, Expansion, Sign};
use crate::Ray;

/// The largest number is between this power of two and the next one.
const LARGEST: u64 = 38;

/// A vector of whole numbers.
type Whole = [i64; 3];

/// A ray's line and points around it, in whole numbers.
#[derive(Clone, Debug)]
pub(super) struct WholeLine<const N: usize> {
    direction: Whole,
    /// From the ray's origin.
    points: [Whole; N],
    /// What a unit of the direction is.
    direction_unit: f64,
    /// What a unit of the points is.
    unit: f64,
}

impl<const N: usize> WholeLine<N> {
    /// `None` if not all numbers are whole after scaling, or not all are finite.
    pub(super) fn new(ray: &Ray, points: [Vec3; N]) -> Option<Self> {
        let size = points
            .iter()
            .fold(largest(ray.origin), |size, point| size.max(largest(*point)));
        let (scale, unit) = power_for(size)?;
        let (direction_scale, direction_unit) = power_for(largest(ray.direction))?;
        let mut are_whole = true;
        let direction = scaled(ray.direction, direction_scale, &mut are_whole);
        let origin = scaled(ray.origin, scale, &mut are_whole);
        // Not mapped: a closure for an array of arrays is called.
        let mut whole = [[0; 3]; N];
        for (whole, point) in whole.iter_mut().zip(points) {
            *whole = scaled(point, scale, &mut are_whole);
        }
        if !are_whole {
            return None;
        }
        for point in &mut whole {
            *point = difference(point, &origin);
        }
        Some(Self {
            direction,
            points: whole,
            direction_unit,
            unit,
        })
    }

    /// `D . ((P - O) x (Q - O))` for two of the points, in units.
    #[inline]
    pub(super) fn edge_function(&self, [from, to]: [usize; 2]) -> i128 {
        dot(
            &self.direction,
            &cross(&self.points[from], &self.points[to]),
        )
    }

    /// `D x (Q - P)` for two of the points, in units.
    fn derivative(&self, [from, to]: [usize; 2]) -> [i128; 3] {
        let edge = difference(&self.points[to], &self.points[from]);
        cross(&self.direction, &edge)
    }

    /// Whether the line passes through a point.
    pub(super) fn meets(&self, point: usize) -> bool {
        cross(&self.direction, &self.points[point]) == [0; 3]
    }

    /// An edge function, or a sum of some, as a number.
    pub(super) fn value_of_edges(&self, units: i128) -> Expansion {
        Expansion::of_whole(units, self.direction_unit * self.unit * self.unit)
    }
}

impl WholeLine<3> {
    /// The edge functions of a triangle, in units.
    #[inline]
    pub(super) fn edge_functions(&self) -> [i128; 3] {
        EDGES.map(|edge| self.edge_function(edge))
    }

    /// `D . ((B - A) x (C - A))`, which is the sum of the edge functions, in units.
    #[inline]
    pub(super) fn determinant(&self) -> i128 {
        let [a, b, c] = self.edge_functions();
        a + b + c
    }

    /// The side of an edge whose function is known, where that is zero settled by a rule.
    #[inline]
    pub(super) fn settled_side(&self, edge: usize, units: i128, rule: EdgeRule) -> Sign {
        settled(Sign::of_whole(units), rule, || {
            self.derivative(EDGES[edge]).map(Sign::of_whole)
        })
    }

    /// `(A - O) . ((B - A) x (C - A))`, which is `(A - O) . ((B - O) x (C - O))`, in units of their own.
    #[inline]
    pub(super) fn depth(&self) -> i128 {
        let [a, b, c] = &self.points;
        dot(a, &cross(b, c))
    }

    /// A depth as a number.
    pub(super) fn value_of_depth(&self, units: i128) -> Expansion {
        Expansion::of_whole(units, self.unit * self.unit * self.unit)
    }
}

/// The largest magnitude of a component; NaN counts for nothing.
#[inline]
fn largest(vector: Vec3) -> f32 {
    vector.abs().max_element()
}

/// The power of two that brings a number into the range of the largest ones, and its reciprocal; `None` if it is infinite.
#[inline]
fn power_for(size: f32) -> Option<(f64, f64)> {
    /// The sum of the exponents' fields of a power of two and its reciprocal.
    const OF_RECIPROCALS: u64 = 2 * 1023;
    // A normal number as all f32 are in f64, but for zero.
    let exponent = f64::from(size.max(f32::MIN_POSITIVE)).to_bits() >> 52;
    let unit = exponent - LARGEST;
    let power = |exponent: u64| f64::from_bits(exponent << 52);
    (size < f32::INFINITY).then(|| (power(OF_RECIPROCALS - unit), power(unit)))
}

/// A vector times a power of two; clears the flag if that is not whole.
#[inline]
fn scaled(vector: Vec3, scale: f64, are_whole: &mut bool) -> Whole {
    /// Added to a number below `2^51`, it rounds that to a whole one, which is then in the low bits.
    const ROUNDING: f64 = (3u64 << 51) as f64;
    let mut whole = |value: f32| {
        // Exact.
        let scaled = f64::from(value) * scale;
        let rounded = scaled + ROUNDING;
        // Not so for NaN.
        *are_whole &= rounded - ROUNDING == scaled;
        let bits = rounded.to_bits().wrapping_sub(ROUNDING.to_bits());
        bits.cast_signed()
    };
    [whole(vector.x), whole(vector.y), whole(vector.z)]
}

#[inline]
fn difference(a: &Whole, b: &Whole) -> Whole {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline]
fn cross(a: &Whole, b: &Whole) -> [i128; 3] {
    let product = |i: usize, j: usize| i128::from(a[i]) * i128::from(b[j]);
    let component = |i: usize, j: usize| product(i, j) - product(j, i);
    [component(1, 2), component(2, 0), component(0, 1)]
}

#[inline]
fn dot(a: &Whole, b: &[i128; 3]) -> i128 {
    let product = |axis: usize| i128::from(a[axis]) * b[axis];
    product(0) + product(1) + product(2)
}

#[cfg(test)]
mod tests {
    use glam::Vec3Swizzles;
    use proptest::prelude::*;

    use super::*;
    use crate::oracle::RBig;
    use crate::test_support::{grid_point, point};

    fn exact(value: f64) -> RBig {
        RBig::try_from(value).expect("finite")
    }

    fn exact_difference(a: Vec3, b: Vec3) -> [RBig; 3] {
        [0, 1, 2].map(|axis| exact(f64::from(a[axis])) - exact(f64::from(b[axis])))
    }

    fn exact_cross(a: &[RBig; 3], b: &[RBig; 3]) -> [RBig; 3] {
        [(1, 2), (2, 0), (0, 1)].map(|(i, j)| &a[i] * &b[j] - &a[j] * &b[i])
    }

    fn exact_dot(a: &[RBig; 3], b: &[RBig; 3]) -> RBig {
        &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
    }

    /// Holds all values of a line and three points against rational numbers; whether there are any.
    fn check(ray: &Ray, points: [Vec3; 3]) -> bool {
        let Some(line) = WholeLine::new(ray, points) else {
            return false;
        };
        let direction = exact_difference(ray.direction, Vec3::ZERO);
        let from_origin = points.map(|point| exact_difference(point, ray.origin));
        let value = |units| line.value_of_edges(units).exact_value();
        let mut sum = RBig::ZERO;
        for edge in EDGES {
            let [p, q] = edge.map(|point| &from_origin[point]);
            let expected = exact_dot(&direction, &exact_cross(p, q));
            let found = value(line.edge_function(edge));
            assert_eq!(found, expected, "{ray:?} {points:?}");
            sum += expected;
            let [p, q] = edge.map(|point| points[point]);
            let derivative = exact_cross(&direction, &exact_difference(q, p));
            for (found, expected) in line.derivative(edge).into_iter().zip(derivative) {
                assert_eq!(
                    found.cmp(&0),
                    expected.cmp(&RBig::ZERO),
                    "{ray:?} {points:?}"
                );
            }
            let moment = exact_cross(&direction, &from_origin[edge[0]]);
            let meets = moment.iter().all(|part| *part == RBig::ZERO);
            assert_eq!(line.meets(edge[0]), meets, "{ray:?} {points:?}");
        }
        assert_eq!(value(line.determinant()), sum, "{ray:?} {points:?}");
        let [a, b, c] = &from_origin;
        let depth = line.value_of_depth(line.depth()).exact_value();
        assert_eq!(
            depth,
            exact_dot(a, &exact_cross(b, c)),
            "{ray:?} {points:?}"
        );
        true
    }

    fn any_point() -> impl Strategy<Value = Vec3> {
        let corners = prop_oneof![Just(1.0f32), Just(-1.0), Just(0.0)];
        let extreme =
            (prop::array::uniform3(corners), any::<bool>()).prop_map(|(signs, is_large)| {
                Vec3::from(signs)
                    * if is_large {
                        f32::MAX
                    } else {
                        f32::from_bits(3)
                    }
            });
        let scaled = (point(1.0), -20i32..20).prop_map(|(point, power)| point * 2f32.powi(power));
        prop_oneof![3 => point(1.0), 3 => grid_point(), 1 => extreme, 1 => scaled]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn whole_values_are_exact(points in prop::array::uniform4(any_point()), direction in any_point()) {
            let [origin, a, b, c] = points;
            check(&Ray::new(origin, direction), [a, b, c]);
            check(&Ray::new(origin, a - origin), [a, b, c]);
        }
    }

    #[test]
    fn the_largest_numbers_of_both_signs_fit() {
        for sign in [1.0, -1.0] {
            for point in [
                Vec3::ONE,
                Vec3::new(1.0, -1.0, 1.0),
                Vec3::new(-1.0, 1.0, 1.0),
            ] {
                let largest = f32::MAX * sign;
                let ray = Ray::new(point * -largest, point.zxy() * largest);
                let points = [point, point.yzx(), point.zxy()].map(|point| point * largest);
                assert!(check(&ray, points), "{ray:?} {points:?}");
            }
        }
    }

    #[test]
    fn what_is_not_whole_is_left_to_expansions() {
        let is_whole =
            |x: f32| WholeLine::new(&Ray::new(Vec3::ONE, Vec3::Y), [Vec3::X * x]).is_some();
        // The largest coordinate is 1, a unit is `2^-38`.
        let unit = 2f32.powi(-38);
        assert!(
            is_whole(unit) && is_whole(2f32.powi(-14).next_down()),
            "multiples of a unit"
        );
        assert!(!is_whole(unit / 2.0), "half a unit");
        assert!(!is_whole(2f32.powi(-15).next_down()), "a low bit");
        for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert!(!is_whole(value), "{value}");
        }
        let ray = Ray::new(Vec3::ONE, Vec3::new(f32::NAN, 1.0, 1.0));
        assert!(WholeLine::new(&ray, [Vec3::X]).is_none(), "no direction");
    }
}
