//! Rays aimed at the places where closed meshes leak.

use glam::Vec3;

use super::Question;
use super::shapes::edges;
use crate::{Axis, Ray, TriangleMesh};

/// Rays at every vertex, at the midpoint of every edge, and along every edge: from the given points outside and inside, and parallel to every axis.
///
/// The points `outside` are beyond the bounds of the closed mesh, those `inside` within its solid: the questions say so, and the
/// parity of the crossings follows.
pub(super) fn aimed_at_features(
    mesh: &TriangleMesh,
    outside: &[Vec3],
    inside: &[Vec3],
) -> Vec<Question> {
    let vertex = |index: u32| mesh.vertices()[index as usize];
    let edges = edges(mesh);
    let midpoints = edges.iter().map(|(a, b)| vertex(*a).midpoint(vertex(*b)));
    let targets: Vec<Vec3> = mesh.vertices().iter().copied().chain(midpoints).collect();
    let mut questions = Vec::new();
    for (index, target) in targets.iter().enumerate() {
        let towards = |origin: &Vec3| Question::new(Ray::new(*origin, *target - *origin));
        questions.extend(
            outside
                .iter()
                .map(|origin| towards(origin).starting_outside()),
        );
        questions.extend(
            inside
                .iter()
                .map(|origin| towards(origin).starting_inside()),
        );
        for axis in Axis::ALL {
            let ray = parallel(mesh, *target, axis, index % 2 == 0);
            questions.push(Question::new(ray).starting_outside());
        }
    }
    for (a, b) in edges {
        let (a, b) = (vertex(a), vertex(b));
        questions.push(Question::new(Ray::new(a - (b - a), b - a)));
    }
    questions
}

/// The ray along an axis through a point, from outside the bounds; the zeros of its direction have the sign of the way it runs.
fn parallel(mesh: &TriangleMesh, through: Vec3, axis: Axis, forward: bool) -> Ray {
    let (bounds, axis) = (mesh.aabb(), axis as usize);
    let reach = bounds.extent()[axis] + 1.0;
    let sign: f32 = if forward { 1.0 } else { -1.0 };
    let mut direction = Vec3::splat(0.0f32.copysign(sign));
    direction[axis] = sign;
    let mut origin = through;
    origin[axis] = if forward {
        bounds.min[axis] - reach
    } else {
        bounds.max[axis] + reach
    };
    Ray::new(origin, direction)
}
