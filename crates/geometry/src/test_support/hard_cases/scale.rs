//! Cases that are too large for the oracle, with answers by hand, and what queries cost.

use std::ops::ControlFlow;

use glam::{Vec3, vec3};

use super::duplicates_and_degenerate::{nested_halves, stack_of_halves, teapot_in_a_stadium};
use super::shapes::mapped;
use super::{Structure, shapes};
use crate::test_support::soup;
use crate::{Precision, QueryCounts, Ray, TriangleMesh};

/// Case 18: a hundred thousand equal triangles. The build ends, of all equal hits the first is the closest, and each is
/// crossed once.
///
/// # Panics
/// If an answer is wrong.
pub fn check_many_duplicates(structures: &[Structure]) {
    const COUNT: usize = 100_000;
    let mesh = soup(vec![[Vec3::ZERO, Vec3::X, Vec3::Y]; COUNT]);
    let down = Ray::new(vec3(0.25, 0.25, 1.0), Vec3::NEG_Z);
    for structure in structures {
        let name = structure.name();
        let built = structure.build(&mesh, Precision::Exact);
        let [closest, next] = [
            built.closest_hit(&down),
            built.closest_hit_ignoring(&down, 0),
        ];
        assert_eq!(
            closest.map(|hit| (hit.primitive, hit.t)),
            Some((0, 1.0)),
            "{name}"
        );
        assert_eq!(
            next.map(|hit| (hit.primitive, hit.t)),
            Some((1, 1.0)),
            "{name}, ignoring the first"
        );
        assert_eq!(built.crossings(&down), COUNT, "{name}");
        let mut first = Vec::new();
        built.all_hits(&down, &mut |hit| {
            first.push(hit.primitive);
            if first.len() < 4 {
                ControlFlow::Continue(())
            } else {
                ControlFlow::Break(())
            }
        });
        assert_eq!(first, [0, 1, 2, 3], "{name}");
        let beside = Ray::new(vec3(0.5, 0.5f32.next_up(), 1.0), Vec3::NEG_Z);
        assert!(!built.any_hit(&beside), "{name}, beside the edge");
    }
}

/// Case 20: 120 triangles, each inside of the one twice its size: for the depth of trees over objects.
#[must_use]
pub fn nested_triangles() -> TriangleMesh {
    nested_halves(120)
}

/// Case 20: 120 triangles apart from each other, at distances that halve: for the depth of trees that divide space.
#[must_use]
pub fn stacked_triangles() -> TriangleMesh {
    stack_of_halves(120)
}

/// Case 21: a sphere of 2048 triangles, 1e-2 in size, costs a ray at most twice as many triangle tests on a floor of 1e5 as it does
/// alone.
///
/// # Panics
/// If it costs more, or if the floor changes which triangle of the sphere is hit.
pub fn check_cost_of_a_stadium(structures: &[Structure]) {
    let stadium = teapot_in_a_stadium(4);
    let alone = mapped(&shapes::sphere(4), |vertex| vertex * 1e-2);
    let rays: Vec<Ray> = shapes::sphere(3)
        .vertices()
        .iter()
        .map(|target| {
            let origin = vec3(0.03, 0.02, 0.05);
            Ray::new(origin, *target * 0.0099 - origin)
        })
        .collect();
    for structure in structures {
        let name = structure.name();
        let cost = |mesh: &TriangleMesh| {
            let built = structure.build(mesh, Precision::Exact);
            let mut counts = QueryCounts::default();
            let hits: Vec<_> = rays
                .iter()
                .map(|ray| built.closest_hit_counted(ray, &mut counts))
                .collect();
            (hits, counts.triangle_tests)
        };
        let ((hits, tests), (hits_in_stadium, tests_in_stadium)) = (cost(&alone), cost(&stadium));
        assert!(
            hits.iter().all(Option::is_some),
            "{name}: rays at points inside the sphere hit it"
        );
        assert_eq!(hits, hits_in_stadium, "{name}");
        assert!(
            tests_in_stadium <= 2 * tests,
            "{name}: {tests_in_stadium} tests instead of {tests}"
        );
    }
}
