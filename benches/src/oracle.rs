//! The exact reference that errors are counted against: brute force in rational numbers.
//!
//! Every f32 is a rational number, so hit or miss, the order of hits and `t` have exact values. A filter in f64 throws out
//! the triangles that a ray certainly misses; the few that remain are decided by rational arithmetic.

use dashu_ratio::RBig;
use glam::{DVec3, Vec3};
use tahko_tracer::geometry::{Hit, Ray, RayQuery, Triangle, TriangleMesh};

/// How the closest hits of a structure differ from the exact ones.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Errors {
    pub(crate) rays: usize,
    /// Rays that the structure says hit something, and that hit nothing.
    pub(crate) false_hits: usize,
    /// Rays that hit something, and that the structure says hit nothing.
    pub(crate) false_misses: usize,
    /// Rays for which the structure names another triangle than the closest one.
    pub(crate) wrong_triangles: usize,
    /// The largest error of `t`, in units in the last place of an f32, where the triangle is right.
    pub(crate) largest_t_error: f64,
}

/// The exact closest hit of a ray.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ExactHit {
    t: RBig,
    triangle: u32,
}

/// Compares the closest hits of a structure with the exact ones.
pub(crate) fn compare(query: &dyn RayQuery, rays: &[Ray], exact: &[Option<ExactHit>]) -> Errors {
    let mut errors = Errors {
        rays: rays.len(),
        ..Errors::default()
    };
    for (ray, exact) in rays.iter().zip(exact) {
        match (query.closest_hit(ray), exact) {
            (Some(_), None) => errors.false_hits += 1,
            (None, Some(_)) => errors.false_misses += 1,
            (Some(Hit { t, primitive, .. }), Some(exact)) => {
                if primitive == exact.triangle {
                    errors.largest_t_error = errors.largest_t_error.max(ulps(t, &exact.t));
                } else {
                    errors.wrong_triangles += 1;
                }
            }
            (None, None) => {}
        }
    }
    errors
}

/// The distance of an f32 from an exact value, in units in the last place of the f32.
fn ulps(t: f32, exact: &RBig) -> f64 {
    let ulp = f64::from(t.abs().next_up()) - f64::from(t.abs());
    (rational(t) - exact).to_f64().value().abs() / ulp
}

/// The exact closest hit of each ray: smallest `t`, then smallest index.
pub(crate) fn closest_hits(mesh: &TriangleMesh, rays: &[Ray]) -> Vec<Option<ExactHit>> {
    let triangles: Vec<Triangle> = mesh.triangles().collect();
    rays.iter()
        .map(|ray| closest_hit(ray, &triangles))
        .collect()
}

fn closest_hit(ray: &Ray, triangles: &[Triangle]) -> Option<ExactHit> {
    let filter = Filter::new(ray);
    let mut closest: Option<ExactHit> = None;
    for (index, triangle) in (0u32..).zip(triangles) {
        if filter.is_certain_miss(triangle) {
            continue;
        }
        let Some(t) = exact_t(ray, triangle) else {
            continue;
        };
        if closest.as_ref().is_none_or(|closest| t < closest.t) {
            closest = Some(ExactHit { t, triangle: index });
        }
    }
    closest
}

/// Möller and Trumbore's terms in f64 with an error bound.
struct Filter {
    origin: DVec3,
    direction: DVec3,
}

/// Each term is a sum of products of three factors that are differences of inputs: at most 3 roundings of
/// differences, 2 products and 5 sums, `10 * 2^-53` of the sum of magnitudes to first order.
const ERROR: f64 = 16.0 * f64::EPSILON / 2.0;

impl Filter {
    fn new(ray: &Ray) -> Self {
        Self {
            origin: ray.origin.as_dvec3(),
            direction: ray.direction.as_dvec3(),
        }
    }

    fn is_certain_miss(&self, triangle: &Triangle) -> bool {
        let [a, b, c] = triangle.vertices().map(Vec3::as_dvec3);
        let (edge1, edge2, from_a) = (b - a, c - a, self.origin - a);
        let p = self.direction.cross(edge2);
        let q = from_a.cross(edge1);
        let determinant = edge1.dot(p);
        let (u, v) = (from_a.dot(p), self.direction.dot(q));
        let [direction, edge1, edge2, from_a] =
            [self.direction, edge1, edge2, from_a].map(DVec3::abs);
        let p = cross_of_magnitudes(direction, edge2);
        let determinant_error = ERROR * edge1.dot(p);
        let u_error = ERROR * from_a.dot(p);
        let v_error = ERROR * direction.dot(cross_of_magnitudes(from_a, edge1));
        if determinant.abs() <= determinant_error {
            return false;
        }
        let sign = determinant.signum();
        u * sign < -u_error
            || v * sign < -v_error
            || (u + v - determinant) * sign > 2.0 * (u_error + v_error + determinant_error)
    }
}

fn cross_of_magnitudes(a: DVec3, b: DVec3) -> DVec3 {
    DVec3::new(
        a.y * b.z + a.z * b.y,
        a.z * b.x + a.x * b.z,
        a.x * b.y + a.y * b.x,
    )
}

/// The exact `t` of a hit of the closed triangle in the closed interval; `None` for a miss, a ray in the plane of the triangle, and
/// a triangle without area.
fn exact_t(ray: &Ray, triangle: &Triangle) -> Option<RBig> {
    let [origin, direction, a, b, c] = [
        ray.origin,
        ray.direction,
        triangle.a,
        triangle.b,
        triangle.c,
    ]
    .map(exact_vector);
    let (edge1, edge2, from_a) = (minus(&b, &a), minus(&c, &a), minus(&origin, &a));
    let p = cross(&direction, &edge2);
    let q = cross(&from_a, &edge1);
    let determinant = dot(&edge1, &p);
    if determinant == RBig::ZERO {
        return None;
    }
    let u = dot(&from_a, &p) / &determinant;
    let v = dot(&direction, &q) / &determinant;
    let t = dot(&edge2, &q) / &determinant;
    let inside = u >= RBig::ZERO && v >= RBig::ZERO && u + v <= RBig::ONE;
    let is_in_interval =
        t >= rational(ray.t_min) && (ray.t_max == f32::INFINITY || t <= rational(ray.t_max));
    (inside && is_in_interval).then_some(t)
}

type ExactVector = [RBig; 3];

fn rational(value: f32) -> RBig {
    RBig::try_from(value).unwrap_or(RBig::ZERO)
}

fn exact_vector(vector: Vec3) -> ExactVector {
    vector.to_array().map(rational)
}

fn minus(a: &ExactVector, b: &ExactVector) -> ExactVector {
    [0, 1, 2].map(|axis| &a[axis] - &b[axis])
}

fn cross(a: &ExactVector, b: &ExactVector) -> ExactVector {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| &a[i] * &b[j] - &a[j] * &b[i])
}

fn dot(a: &ExactVector, b: &ExactVector) -> RBig {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

#[cfg(test)]
mod tests {
    use tahko_tracer::geometry::{BruteForce, Precision};

    use super::*;

    fn mesh() -> TriangleMesh {
        TriangleMesh::new(
            vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            vec![[0, 1, 2], [0, 1, 2]],
        )
        .unwrap()
    }

    fn down(x: f32, y: f32) -> Ray {
        Ray::new(Vec3::new(x, y, 1.0), Vec3::NEG_Z)
    }

    fn are_hits(rays: &[Ray]) -> Vec<bool> {
        closest_hits(&mesh(), rays)
            .iter()
            .map(Option::is_some)
            .collect()
    }

    #[test]
    fn edges_belong_to_the_triangle_and_one_step_beyond_is_a_miss() {
        let beyond = 0.5f32.next_up();
        let rays = [
            down(0.5, 0.5),
            down(beyond, 0.5),
            down(0.0, 0.0),
            down(-f32::MIN_POSITIVE, 0.0),
        ];
        assert_eq!(are_hits(&rays), [true, false, true, false]);
    }

    #[test]
    fn ties_go_to_the_smallest_index_and_the_interval_is_closed() {
        let hit = closest_hit(&down(0.2, 0.2), &mesh().triangles().collect::<Vec<_>>()).unwrap();
        assert_eq!((hit.triangle, hit.t), (0, RBig::ONE));
        let until = |t_max| Ray::with_interval(Vec3::new(0.2, 0.2, 1.0), Vec3::NEG_Z, 0.0, t_max);
        assert_eq!(
            are_hits(&[until(1.0), until(1.0f32.next_down())]),
            [true, false]
        );
    }

    #[test]
    fn errors_of_a_structure_are_counted_by_kind() {
        let rays = [down(0.2, 0.2), down(0.9, 0.9)];
        let exact = closest_hits(&mesh(), &rays);
        let query = BruteForce::new(&mesh(), Precision::Fast);
        let count = |exact: &[Option<ExactHit>]| {
            let errors = compare(&query, &rays, exact);
            (
                errors.false_hits,
                errors.false_misses,
                errors.wrong_triangles,
                errors.largest_t_error,
            )
        };
        assert_eq!(count(&exact), (0, 0, 0, 0.0));
        let hit = |t: f32, triangle| {
            Some(ExactHit {
                t: rational(t),
                triangle,
            })
        };
        assert_eq!(count(&[None, hit(1.0, 0)]), (1, 1, 0, 0.0));
        assert_eq!(count(&[hit(1.0, 1), None]), (0, 0, 1, 0.0));
        assert_eq!(count(&[hit(1.0f32.next_up(), 0), None]), (0, 0, 0, 1.0));
    }
}
