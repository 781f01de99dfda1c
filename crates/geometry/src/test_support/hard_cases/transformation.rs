//! What is done to every case before it is asked: axes exchanged and mirrored, scaled, moved.

use std::fmt;

use glam::{Vec3, vec3};

use super::{HardCase, Question, shapes};
use crate::{Ray, TriangleMesh};

/// A permutation of the axes, then mirrorings, then a power of two, then a translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transformation {
    /// The axis that becomes x, y, z.
    axes: [usize; 3],
    /// The signs by which the axes are multiplied afterwards.
    signs: Vec3,
    exponent: i32,
    offset: Vec3,
}

/// A case after a transformation, in the f32 numbers that came out.
#[derive(Clone, Debug)]
pub struct TransformedCase<'case> {
    /// What the case was before.
    pub case: &'case HardCase,
    /// What was done to it.
    pub transformation: Transformation,
    /// The mesh as it is now.
    pub mesh: TriangleMesh,
    /// The questions that are finite as they are now.
    pub questions: Vec<TransformedQuestion<'case>>,
    /// How many questions are not asked, since their rays are not finite any more.
    pub skipped: usize,
}

/// A question after a transformation.
#[derive(Clone, Copy, Debug)]
pub struct TransformedQuestion<'case> {
    /// What it was before.
    pub question: &'case Question,
    /// Its ray as it is now.
    pub ray: Ray,
    /// Whether no number was rounded, neither of the ray nor of the mesh: then the answer by hand still holds.
    pub is_exact: bool,
}

/// More questions than these are thinned out where a case is transformed, other places at each transformation.
const MANY_QUESTIONS: usize = 24;
const PERMUTATIONS: [[usize; 3]; 6] = [
    [0, 1, 2],
    [1, 0, 2],
    [0, 2, 1],
    [2, 1, 0],
    [1, 2, 0],
    [2, 0, 1],
];
const MIRRORS: [Vec3; 5] = [
    Vec3::ONE,
    Vec3::NEG_ONE,
    vec3(-1.0, 1.0, 1.0),
    vec3(1.0, -1.0, 1.0),
    vec3(1.0, 1.0, -1.0),
];

impl Transformation {
    /// Changes nothing.
    pub const IDENTITY: Self = Self {
        axes: PERMUTATIONS[0],
        signs: Vec3::ONE,
        exponent: 0,
        offset: Vec3::ZERO,
    };

    /// An odd permutation and a mirrored axis: with the [`IDENTITY`](Self::IDENTITY), what is combined with scales and moves.
    const ODD: Self = Self {
        axes: PERMUTATIONS[1],
        signs: MIRRORS[4],
        ..Self::IDENTITY
    };

    /// All of them: the identity, each permutation with each mirroring, scales by 2^-40 and 2^40, and moves by 1e3, 1e5 and 1e6.
    #[must_use]
    pub fn all() -> Vec<Self> {
        let turned = PERMUTATIONS.into_iter().flat_map(|axes| {
            MIRRORS.map(|signs| Self {
                axes,
                signs,
                ..Self::IDENTITY
            })
        });
        let bases = [Self::IDENTITY, Self::ODD];
        let scaled = bases
            .into_iter()
            .flat_map(|base| [-40, 40].map(|exponent| Self { exponent, ..base }));
        let moved = bases.into_iter().flat_map(|base| {
            [1e3, 1e5, 1e6].map(|distance| Self {
                offset: vec3(distance, -distance, distance),
                ..base
            })
        });
        turned.chain(scaled).chain(moved).collect()
    }

    /// Whether all questions of a case are asked, not a part of them.
    #[must_use]
    pub fn asks_everything(&self) -> bool {
        [Self::IDENTITY, Self::ODD].contains(self)
    }

    /// Whether [`Precision::Fast`](crate::Precision::Fast) and [`Precision::Watertight`](crate::Precision::Watertight) are asked too.
    #[must_use]
    pub fn asks_all_precisions(&self) -> bool {
        self.asks_everything() || self.exponent != 0 || self.offset != Vec3::ZERO
    }

    fn direction(&self, vector: Vec3) -> Vec3 {
        let permuted = Vec3::from(self.axes.map(|axis| vector[axis]));
        // Zeros change their signs too: a direction of 0.0 becomes -0.0.
        permuted * self.signs * 2.0f32.powi(self.exponent)
    }

    fn point(&self, point: Vec3) -> Vec3 {
        let turned = self.direction(point);
        // Adding zero would turn -0.0 into 0.0.
        if self.offset == Vec3::ZERO {
            turned
        } else {
            turned + self.offset
        }
    }

    /// Whether no digit of the vector was lost in scaling.
    fn is_exact(&self, before: Vec3) -> bool {
        let permuted = Vec3::from(self.axes.map(|axis| before[axis]));
        let back = self.direction(before) * 2.0f32.powi(-self.exponent) * self.signs;
        self.offset == Vec3::ZERO && (back == permuted || before.is_nan())
    }
}

impl fmt::Display for Transformation {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            axes,
            signs,
            exponent,
            offset,
        } = self;
        if *self == Self::IDENTITY {
            return formatter.write_str("as given");
        }
        for axis in 0..3 {
            let sign = if signs[axis] < 0.0 { "-" } else { "" };
            write!(formatter, "{sign}{}", ["x", "y", "z"][axes[axis]])?;
        }
        if *exponent != 0 {
            write!(formatter, ", scaled by 2^{exponent}")?;
        }
        if *offset != Vec3::ZERO {
            write!(formatter, ", moved by {offset}")?;
        }
        Ok(())
    }
}

impl<'case> TransformedCase<'case> {
    /// The case after each transformation that leaves its mesh finite.
    #[must_use]
    pub fn all(case: &'case HardCase) -> Vec<Self> {
        (0..)
            .zip(Transformation::all())
            .filter_map(|(number, transformation)| Self::new(case, transformation, number))
            .collect()
    }

    /// `None` where the mesh does not fit the numbers any more. `number` says which of many questions are asked.
    fn new(case: &'case HardCase, transformation: Transformation, number: usize) -> Option<Self> {
        let vertices: Vec<Vec3> = case
            .mesh
            .vertices()
            .iter()
            .map(|vertex| transformation.point(*vertex))
            .collect();
        if vertices.iter().any(|vertex| !vertex.is_finite()) {
            return None;
        }
        let is_mesh_exact = case
            .mesh
            .vertices()
            .iter()
            .all(|vertex| transformation.is_exact(*vertex));
        let step = if transformation.asks_everything() {
            1
        } else {
            case.questions.len().div_ceil(MANY_QUESTIONS).max(1)
        };
        let mut skipped = 0;
        let asked = case.questions.iter().skip(number % step).step_by(step);
        let questions = asked.filter_map(|question| {
            let before = question.ray;
            let ray = Ray {
                origin: transformation.point(before.origin),
                direction: transformation.direction(before.direction),
                ..before
            };
            let overflows =
                before.is_valid() && !(ray.origin.is_finite() && ray.direction.is_finite());
            skipped += usize::from(overflows);
            let is_exact = is_mesh_exact
                && transformation.is_exact(before.origin)
                && transformation.is_exact(before.direction);
            (!overflows).then_some(TransformedQuestion {
                question,
                ray,
                is_exact,
            })
        });
        let questions = questions.collect();
        let mesh = shapes::mesh(vertices, case.mesh.indices().to_vec());
        Some(Self {
            case,
            transformation,
            mesh,
            questions,
            skipped,
        })
    }
}

impl fmt::Display for TransformedCase<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let HardCase { number, name, .. } = self.case;
        write!(formatter, "case {number} ({name}), {}", self.transformation)
    }
}
