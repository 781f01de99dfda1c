//! Nodes with planes, and the loops that are timed.

use std::hint::black_box;

use anyhow::{Result, ensure};
use tahko_bench::random::Random;
use tahko_geometry::oracle::{RBig, error_in_ulps};
use tahko_tracer::geometry::Ray;
use tahko_tracer::geometry::glam::DVec3;

use super::operations::{BOUNDS, Crossing, PlaneTest};
use crate::check;

/// A plane and where to go from it.
#[derive(Clone, Copy)]
struct Node<P> {
    plane: P,
    /// Two nodes, each of which is reached from one other node by the first of its links, and from one by the second.
    children: [u32; 2],
}

/// Rays and the nodes that they are tested with.
pub(super) struct Nodes<T: PlaneTest> {
    rays: Vec<Ray>,
    /// The rays, prepared: preparing is no part of what is timed.
    tests: Vec<T>,
    nodes: Vec<Node<T::Plane>>,
    /// All nodes in a random order.
    order: Vec<u32>,
    crossings: Vec<Crossing>,
}

/// A ray's interval: a crossing outside it decides for one child. About half of the crossings lie outside.
const INTERVAL: [f32; 2] = [0.0, 1.0];

impl<T: PlaneTest> Nodes<T> {
    /// Small enough for the first level cache.
    pub(super) const LEN: usize = 256;
    const RAYS: usize = 16;

    pub(super) fn new() -> Self {
        let mut random = Random::new(3);
        let children = [(); 2].map(|()| random_order(Self::LEN, &mut random));
        let node = |index: usize| Node {
            plane: T::random_plane(&mut random),
            children: children.each_ref().map(|children| children[index]),
        };
        let nodes = (0..Self::LEN).map(node).collect();
        let rays = check::random_rays(&BOUNDS, Self::RAYS);
        Self {
            tests: rays.iter().map(T::new).collect(),
            rays,
            nodes,
            order: random_order(Self::LEN, &mut random),
            crossings: vec![Crossing::default(); Self::LEN],
        }
    }

    /// Tests all planes, `passes` times. The order keeps the compiler from testing several planes with one instruction, which a
    /// traversal cannot.
    #[inline(never)]
    pub(super) fn test_independently(&mut self, passes: usize) {
        for test in self.tests.iter().cycle().take(passes) {
            for (crossing, index) in self.crossings.iter_mut().zip(&self.order) {
                *crossing = test.cross(&self.nodes[*index as usize].plane);
            }
            black_box(&mut self.crossings);
        }
    }

    /// Makes as many tests, each of the plane that the one before has chosen.
    #[inline(never)]
    pub(super) fn descend(&mut self, passes: usize) {
        let [start, end] = black_box(INTERVAL);
        for test in self.tests.iter().cycle().take(passes) {
            let mut node = 0;
            for _ in 0..Self::LEN {
                let Node { plane, children } = &self.nodes[node];
                let crossing = test.cross(plane);
                let is_outside = (crossing.end < start) | (crossing.start > end);
                node = children[usize::from(is_outside ^ crossing.comes_from_front)] as usize;
            }
            black_box(node);
        }
    }

    /// Holds the crossings of the first rays with all planes against the exact ones.
    pub(super) fn accuracy(&self, rays: usize) -> Accuracy {
        let mut accuracy = Accuracy {
            encloses: T::ENCLOSES,
            ..Accuracy::default()
        };
        for (ray, test) in self.rays.iter().zip(&self.tests).take(rays) {
            for node in &self.nodes {
                let (normal, offset) = T::coefficients(&node.plane);
                if let Some(exact) = exact_crossing(ray, normal, offset) {
                    accuracy.add(&test.cross(&node.plane), &exact);
                }
            }
        }
        accuracy
    }
}

/// 0 to `len - 1` in a random order (Fisher and Yates).
fn random_order(len: usize, random: &mut Random) -> Vec<u32> {
    let mut order: Vec<u32> = (0..).take(len).collect();
    for last in (1..len).rev() {
        order.swap(last, random.below(last + 1));
    }
    order
}

/// Where the ray crosses the plane exactly; `None` along the plane.
fn exact_crossing(ray: &Ray, normal: DVec3, offset: f64) -> Option<RBig> {
    let exact = |value: f64| RBig::try_from(value).expect("a finite number");
    let dot = |vector: DVec3| {
        let products = normal.to_array().into_iter().zip(vector.to_array());
        products.fold(RBig::ZERO, |sum, (a, b)| sum + exact(a) * exact(b))
    };
    let speed = dot(ray.direction.as_dvec3());
    (speed != RBig::ZERO).then(|| -(dot(ray.origin.as_dvec3()) + exact(offset)) / speed)
}

/// How good some crossings are.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Accuracy {
    encloses: bool,
    crossings: usize,
    /// Those from the ray's start on that are outside the interval that was computed: what is behind it is not to be relied on.
    outside: usize,
    largest_error: f64,
}

impl Accuracy {
    fn add(&mut self, crossing: &Crossing, exact: &RBig) {
        let rational = |value: f32| RBig::try_from(value);
        // An infinite end encloses everything on its side.
        let is_after_start = rational(crossing.start).is_ok_and(|start| start > *exact);
        let is_before_end = rational(crossing.end).is_ok_and(|end| end < *exact);
        self.crossings += 1;
        let is_ahead = *exact >= RBig::ZERO;
        self.outside += usize::from(is_ahead && (is_after_start || is_before_end));
        self.largest_error = self
            .largest_error
            .max(error_in_ulps(crossing.start, exact))
            .max(error_in_ulps(crossing.end, exact));
    }

    /// An error if an interval does not enclose the crossing and the test promises so.
    pub(super) fn require_enclosed(&self, form: &str) -> Result<()> {
        ensure!(
            !self.encloses || self.outside == 0,
            "{} of {} crossings are outside their intervals: {form}",
            self.outside,
            self.crossings
        );
        Ok(())
    }

    pub(super) fn text(&self) -> String {
        if self.encloses {
            format!("{} of {} outside", self.outside, self.crossings)
        } else {
            format!("t off by up to {:.1} ulp", self.largest_error)
        }
    }
}

#[cfg(test)]
mod tests {
    use tahko_tracer::geometry::glam::Vec3;

    use super::super::operations::{
        AxisConservative, AxisPlain, GeneralConservative, GeneralPlain,
    };
    use super::*;

    #[test]
    fn conservative_tests_enclose_every_exact_crossing() {
        for accuracy in [
            Nodes::<AxisConservative>::new().accuracy(4),
            Nodes::<GeneralConservative>::new().accuracy(4),
        ] {
            accuracy.require_enclosed("both").unwrap();
            assert_eq!(accuracy.crossings, 1024);
        }
    }

    /// Far off where planes are nearly parallel to a ray, but never by more than that explains.
    #[test]
    fn plain_tests_compute_the_crossing_with_rounding() {
        let axis = Nodes::<AxisPlain>::new().accuracy(4);
        assert!((0.5..8.0).contains(&axis.largest_error), "{axis:?}");
        let general = Nodes::<GeneralPlain>::new().accuracy(4);
        assert!(general.largest_error > 0.5, "{general:?}");
    }

    #[test]
    fn an_exact_crossing_is_a_fraction() {
        let ray = Ray::new(Vec3::X, Vec3::new(3.0, 1.0, 0.0));
        let third = exact_crossing(&ray, DVec3::X, -2.0);
        assert_eq!(third, Some(RBig::from_parts(1.into(), 3u8.into())));
        assert_eq!(exact_crossing(&ray, DVec3::Z, -2.0), None);
    }
}
