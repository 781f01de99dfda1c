//! The comparison of structures with the oracle.

use std::fmt::Display;
use std::ops::ControlFlow;

use glam::Vec3;

use super::expected::Expected;
use super::{HardCase, TransformedCase, TransformedQuestion, cases, closed_meshes};
use crate::oracle::{ExactHit, Oracle};
use crate::{BruteForce, Hit, Precision, QueryCounts, Ray, RayQuery, TriangleMesh};

/// The function that builds a structure.
type Build = dyn Fn(&TriangleMesh, Precision) -> Box<dyn RayQuery>;

/// A way to build a structure, with a name for messages.
#[expect(
    missing_debug_implementations,
    reason = "a closure has nothing to show"
)]
pub struct Structure {
    name: String,
    build: Box<Build>,
}

impl Structure {
    /// A structure from the function that builds it over a mesh.
    pub fn new<S: RayQuery + 'static>(
        name: impl Into<String>,
        build: impl Fn(&TriangleMesh, Precision) -> S + 'static,
    ) -> Self {
        Self {
            name: name.into(),
            build: Box::new(move |mesh, precision| Box::new(build(mesh, precision))),
        }
    }

    /// The name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Builds it.
    #[must_use]
    pub fn build(&self, mesh: &TriangleMesh, precision: Precision) -> Box<dyn RayQuery> {
        (self.build)(mesh, precision)
    }
}

/// Checks the answers of structures to all configurations of a row of the table of [hard cases](super).
///
/// # Panics
/// If an answer is wrong, with the first of them; or if there is no such row.
pub fn check_case(number: u8, structures: &[Structure]) {
    let cases = cases(number);
    assert!(!cases.is_empty(), "there is no case {number}");
    check(&cases, structures);
}

/// Checks the answers of structures for one of the [closed meshes](super::closed_meshes) with rays at all vertices and edges.
///
/// # Panics
/// If an answer is wrong, with the first of them; or if there is no such mesh.
pub fn check_closed_mesh(name: &str, structures: &[Structure]) {
    let mut cases = closed_meshes();
    cases.retain(|case| case.name == name);
    assert!(!cases.is_empty(), "there is no closed mesh {name}");
    check(&cases, structures);
}

fn check(cases: &[HardCase], structures: &[Structure]) {
    let mut failures = Failures::default();
    for transformed in cases.iter().flat_map(TransformedCase::all) {
        check_transformed(&transformed, structures, &mut failures);
    }
    failures.report();
}

/// How many wrong answers a message shows.
const SHOWN: usize = 12;

/// Wrong answers: all are counted, the first ones are told.
#[derive(Default)]
struct Failures {
    count: usize,
    shown: Vec<String>,
}

impl Failures {
    fn add(&mut self, place: impl Display, message: impl Display) {
        self.count += 1;
        if self.shown.len() < SHOWN {
            self.shown.push(format!("{place}: {message}"));
        }
    }

    fn report(self) {
        assert!(
            self.count == 0,
            "{} wrong answers, first\n{}",
            self.count,
            self.shown.join("\n")
        );
    }
}

fn check_transformed(
    transformed: &TransformedCase<'_>,
    structures: &[Structure],
    failures: &mut Failures,
) {
    let oracle = Oracle::new(&transformed.mesh);
    let expected: Vec<Expected> = transformed
        .questions
        .iter()
        .map(|asked| Expected::new(&oracle, &asked.ray))
        .collect();
    for (asked, expected) in transformed
        .questions
        .iter()
        .zip(&expected)
        .filter(|(asked, _)| asked.is_exact)
    {
        for contradiction in expected.contradictions(asked.question) {
            failures.add(format!("{transformed}, {:?}", asked.ray), contradiction);
        }
    }
    let points = points_to_locate(transformed);
    let is_inside: Vec<bool> = points.iter().map(|point| oracle.contains(*point)).collect();
    let asks_for_leaks =
        transformed.case.is_closed && transformed.transformation.asks_all_precisions();
    let must_hit: Vec<bool> = transformed
        .questions
        .iter()
        .zip(&expected)
        .map(|(asked, expected)| {
            asks_for_leaks && expected.comes_deep_inside(&oracle, &transformed.mesh, &asked.ray)
        })
        .collect();
    for structure in structures {
        let place = format!("{}, {transformed}", structure.name);
        let exact = structure.build(&transformed.mesh, Precision::Exact);
        for (asked, expected) in transformed.questions.iter().zip(&expected) {
            for message in wrong_answers(exact.as_ref(), &asked.ray, expected) {
                failures.add(format!("{place}, {:?}", asked.ray), message);
            }
        }
        for message in wrong_batches(exact.as_ref(), &transformed.questions, &expected) {
            failures.add(&place, message);
        }
        for (point, is_inside) in points.iter().zip(&is_inside) {
            if exact.contains(*point) != *is_inside {
                failures.add(&place, format!("contains({point:?}) is not {is_inside}"));
            }
        }
        if transformed.case.is_closed {
            for odd in odd_lines(exact.as_ref(), transformed) {
                failures.add(&place, odd);
            }
        }
        if transformed.transformation.asks_all_precisions() {
            for precision in [Precision::Fast, Precision::Watertight] {
                for message in broken_promises(structure, precision, transformed, &must_hit) {
                    failures.add(&place, format!("{precision:?}: {message}"));
                }
            }
        }
    }
}

/// Whether a hit is the exact one: the same primitive, `t` rounded correctly, and weights inside the triangle within two ulp of 1.
fn is_exact_hit(hit: Option<Hit>, exact: Option<&ExactHit>) -> bool {
    match (hit, exact) {
        (None, None) => true,
        (Some(hit), Some(exact)) => {
            let is_close = |weight: f32, exact: f64| {
                (f64::from(weight) - exact).abs() <= 2.0 * f64::from(f32::EPSILON)
            };
            hit.primitive == exact.triangle
                && hit.t.to_bits() == exact.rounded_t().to_bits()
                && is_inside(&hit)
                && is_close(hit.u, exact.u.to_f64().value())
                && is_close(hit.v, exact.v.to_f64().value())
        }
        _ => false,
    }
}

fn is_inside(hit: &Hit) -> bool {
    hit.u >= 0.0 && hit.v >= 0.0 && hit.u + hit.v <= 1.0 && !hit.t.is_nan()
}

/// What is wrong with the single queries of a structure for a ray.
fn wrong_answers(structure: &dyn RayQuery, ray: &Ray, expected: &Expected) -> Vec<String> {
    let mut wrong = Vec::new();
    let mut counts = QueryCounts::default();
    let closest = expected.closest.as_ref();
    let hits = [
        ("closest hit", structure.closest_hit(ray), closest),
        (
            "closest hit, counted",
            structure.closest_hit_counted(ray, &mut counts),
            closest,
        ),
    ];
    let ignored = closest.map(|hit| hit.triangle);
    let ignoring = ignored.map(|primitive| {
        let hit = structure.closest_hit_ignoring(ray, primitive);
        (
            "closest hit without that primitive",
            hit,
            expected.ignoring.as_ref(),
        )
    });
    for (what, hit, exact) in hits.into_iter().chain(ignoring) {
        if !is_exact_hit(hit, exact) {
            wrong.push(format!("{what}: {hit:?} instead of {}", shown(exact)));
        }
    }
    let any = [
        ("any hit", structure.any_hit(ray), closest.is_some()),
        (
            "any hit, counted",
            structure.any_hit_counted(ray, &mut counts),
            closest.is_some(),
        ),
    ];
    let any_ignoring = ignored.map(|primitive| {
        let hit = structure.any_hit_ignoring(ray, primitive);
        (
            "any hit without that primitive",
            hit,
            expected.ignoring.is_some(),
        )
    });
    for (what, found, is_hit) in any.into_iter().chain(any_ignoring) {
        if found != is_hit {
            wrong.push(format!("{what}: {found}"));
        }
    }
    if !ray.is_valid() && counts != QueryCounts::default() {
        wrong.push(format!("an invalid ray costs {counts:?}"));
    }
    wrong.extend(wrong_crossings(structure, ray, &expected.crossings));
    wrong
}

/// What is wrong with the crossings of a structure: their order, their number, or that a visitor can end the query.
fn wrong_crossings(structure: &dyn RayQuery, ray: &Ray, expected: &[ExactHit]) -> Vec<String> {
    let mut wrong = Vec::new();
    let mut hits = Vec::new();
    structure.all_hits(ray, &mut |hit| {
        hits.push(hit);
        ControlFlow::Continue(())
    });
    let mut pairs = hits.iter().zip(expected);
    if hits.len() != expected.len()
        || !pairs.all(|(hit, exact)| is_exact_hit(Some(*hit), Some(exact)))
    {
        let expected: Vec<String> = expected.iter().map(|exact| shown(Some(exact))).collect();
        wrong.push(format!("all hits: {hits:?} instead of {expected:?}"));
    }
    let crossings = structure.crossings(ray);
    if crossings != expected.len() {
        wrong.push(format!(
            "{crossings} crossings instead of {}",
            expected.len()
        ));
    }
    let mut visits = 0;
    structure.all_hits(ray, &mut |_| {
        visits += 1;
        ControlFlow::Break(())
    });
    if visits != expected.len().min(1) {
        wrong.push(format!(
            "{visits} visits of a visitor that ends at the first"
        ));
    }
    wrong
}

/// What is wrong with the batch queries of a structure.
fn wrong_batches(
    structure: &dyn RayQuery,
    questions: &[TransformedQuestion<'_>],
    expected: &[Expected],
) -> Vec<String> {
    let rays: Vec<Ray> = questions.iter().map(|asked| asked.ray).collect();
    let mut hits = vec![None; rays.len()];
    structure.closest_hits(&rays, &mut hits);
    let mut any = vec![false; rays.len()];
    structure.any_hits(&rays, &mut any);
    let mut wrong = Vec::new();
    for (((ray, hit), any), expected) in rays.iter().zip(hits).zip(any).zip(expected) {
        let exact = expected.closest.as_ref();
        if !is_exact_hit(hit, exact) {
            wrong.push(format!(
                "{ray:?}: closest hit of a batch: {hit:?} instead of {}",
                shown(exact)
            ));
        }
        if any != exact.is_some() {
            wrong.push(format!("{ray:?}: any hit of a batch: {any}"));
        }
    }
    wrong
}

/// Vertices and origins of rays of closed meshes, some of each.
fn points_to_locate(transformed: &TransformedCase<'_>) -> Vec<Vec3> {
    const OF_EACH: usize = 24;
    if !transformed.case.is_closed {
        return Vec::new();
    }
    let vertices = transformed.mesh.vertices();
    let (vertex_step, ray_step) = (
        vertices.len().div_ceil(OF_EACH).max(1),
        transformed.questions.len().div_ceil(OF_EACH).max(1),
    );
    let origins = transformed
        .questions
        .iter()
        .map(|asked| asked.ray.origin)
        .step_by(ray_step);
    vertices
        .iter()
        .copied()
        .step_by(vertex_step)
        .chain(origins)
        .collect()
}

/// Whole lines that cross a closed mesh an odd number of times, which cannot be, whatever the oracle says.
fn odd_lines(structure: &dyn RayQuery, transformed: &TransformedCase<'_>) -> Vec<String> {
    let whole = |asked: &TransformedQuestion<'_>| Ray {
        t_min: f32::NEG_INFINITY,
        t_max: f32::INFINITY,
        ..asked.ray
    };
    let lines = transformed.questions.iter().map(whole);
    let odd = lines.filter(|line| structure.crossings(line) % 2 == 1);
    odd.map(|line| format!("{line:?}: a line crosses a closed mesh an odd number of times"))
        .collect()
}

/// What the faster precisions do not keep of their promises: the answers of brute force bit for bit, hits that are numbers inside
/// their triangles, and at [`Precision::Watertight`] no miss where a ray comes [deep inside](Expected::comes_deep_inside) a closed mesh.
fn broken_promises(
    structure: &Structure,
    precision: Precision,
    transformed: &TransformedCase<'_>,
    must_hit: &[bool],
) -> Vec<String> {
    let mut broken = Vec::new();
    let built = structure.build(&transformed.mesh, precision);
    let reference = BruteForce::new(&transformed.mesh, precision);
    for (TransformedQuestion { ray, .. }, must_hit) in transformed.questions.iter().zip(must_hit) {
        let (hit, by_brute_force) = (built.closest_hit(ray), reference.closest_hit(ray));
        if hit != by_brute_force || built.any_hit(ray) != hit.is_some() {
            broken.push(format!(
                "{ray:?}: {hit:?}, and brute force {by_brute_force:?}"
            ));
        }
        if hit.is_some_and(|hit| !is_inside(&hit)) {
            broken.push(format!("{ray:?}: {hit:?}"));
        }
        if precision == Precision::Watertight && *must_hit && hit.is_none() {
            broken.push(format!("{ray:?}: a miss"));
        }
    }
    broken
}

fn shown(exact: Option<&ExactHit>) -> String {
    exact.map_or_else(
        || "no hit".to_owned(),
        |exact| {
            let [u, v] = [&exact.u, &exact.v].map(|weight| weight.to_f64().value());
            format!(
                "primitive {} at {} (u {u:e}, v {v:e})",
                exact.triangle,
                exact.rounded_t()
            )
        },
    )
}
