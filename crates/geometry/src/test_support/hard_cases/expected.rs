//! What the oracle and the author of a case expect of a ray.

use glam::Vec3;

use super::{Answer, Question};
use crate::oracle::{ExactHit, Oracle};
use crate::{Axis, Ray, TriangleMesh};

/// The exact answers for one ray.
#[derive(Debug)]
pub(super) struct Expected {
    pub(super) closest: Option<ExactHit>,
    /// Without the primitive of the closest hit.
    pub(super) ignoring: Option<ExactHit>,
    pub(super) crossings: Vec<ExactHit>,
}

impl Expected {
    pub(super) fn new(oracle: &Oracle, ray: &Ray) -> Self {
        let closest = oracle.closest_hit(ray);
        let ignoring = closest
            .as_ref()
            .and_then(|hit| oracle.closest_hit_ignoring(ray, hit.triangle));
        Self {
            closest,
            ignoring,
            crossings: oracle.crossings(ray),
        }
    }

    /// Whether the ray comes through the inside of a closed mesh deeper than the roundings of f32: through a point that is inside
    /// together with its surroundings. Then it hits also where the mesh is distorted by as much.
    ///
    /// A ray that only touches an edge from outside hits it too, but a watertight test with rounded coordinates may see it pass.
    pub(super) fn comes_deep_inside(
        &self,
        oracle: &Oracle,
        mesh: &TriangleMesh,
        ray: &Ray,
    ) -> bool {
        let bounds = mesh.aabb();
        let size = bounds
            .min
            .abs()
            .max(bounds.max.abs())
            .max(ray.origin.abs())
            .max_element();
        // Differences of coordinates may overflow: the faster precisions say that they may miss then.
        if !(2.0 * size).is_finite() {
            return false;
        }
        let margin = size / f32::from(1u16 << 15) / 8.0;
        let is_deep = |point: Vec3| {
            let steps = Axis::ALL
                .into_iter()
                .flat_map(|axis| [margin, -margin].map(|step| step * Vec3::AXES[axis as usize]));
            steps
                .into_iter()
                .chain([Vec3::ZERO])
                .all(|step| oracle.contains(point + step))
        };
        let mut ends: Vec<f32> = self.crossings.iter().map(ExactHit::rounded_t).collect();
        if ends.len() % 2 == 1 {
            ends.insert(0, ray.t_min.max(f32::MIN));
        }
        ends.chunks_exact(2)
            .any(|part| is_deep(ray.at(part[0].midpoint(part[1]))))
    }

    /// Where the oracle contradicts what is known by hand.
    pub(super) fn contradictions(&self, question: &Question) -> Vec<String> {
        let mut found = Vec::new();
        for (what, by_hand, exact) in [
            ("closest hit", &question.answer, &self.closest),
            (
                "closest hit without its primitive",
                &question.ignoring,
                &self.ignoring,
            ),
        ] {
            if !by_hand.agrees(exact.as_ref()) {
                found.push(format!(
                    "{what}: the oracle says {exact:?}, by hand {by_hand:?}"
                ));
            }
        }
        let crossings = self.crossings.len();
        if question
            .crossings
            .is_some_and(|by_hand| by_hand != crossings)
        {
            found.push(format!(
                "crossings: the oracle says {crossings}, by hand {:?}",
                question.crossings
            ));
        }
        if question
            .starts_inside
            .is_some_and(|inside| inside != (crossings % 2 == 1))
        {
            found.push(format!(
                "{crossings} crossings of a closed mesh, started inside: {:?}",
                question.starts_inside
            ));
        }
        found
    }
}

impl Answer {
    fn agrees(&self, exact: Option<&ExactHit>) -> bool {
        match (self, exact) {
            (Self::Unknown, _) | (Self::Miss, None) => true,
            (Self::Hit { primitive, t }, Some(exact)) => {
                primitive.is_none_or(|primitive| primitive == exact.triangle)
                    && t.as_ref().is_none_or(|t| *t == exact.t)
            }
            (Self::Miss, Some(_)) | (Self::Hit { .. }, None) => false,
        }
    }
}
