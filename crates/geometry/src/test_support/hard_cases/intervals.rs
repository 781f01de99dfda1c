//! The interval of `t`, rays that start on a surface, and surfaces close together: cases 27, 29, 30 and 45.

use glam::{Vec3, vec3};

use super::shapes::{cube, joined, mapped, sphere};
use super::{HardCase, ratio};
use crate::Ray;
use crate::test_support::{invalid_rays, soup};

/// 27: The ray starts on a face of a cube, outwards and inwards: `t = 0` is in the interval. The triangle it starts on can be ignored.
pub(super) fn start_on_the_surface() -> Vec<HardCase> {
    let on_face = vec3(0.5, 0.25, 0.0);
    let from =
        |direction: Vec3, t_min: f32| Ray::with_interval(on_face, direction, t_min, f32::INFINITY);
    let case = HardCase::new(27, "start on the surface", cube())
        .closed()
        .hits(from(Vec3::NEG_Z, 0.0), 9, ratio(0, 1))
        .crosses(1)
        .ignoring_it_misses()
        .hits(from(Vec3::Z, 0.0), 9, ratio(0, 1))
        .crosses(2)
        .ignoring_it_hits(10, ratio(1, 1))
        .hits(from(vec3(0.5, 0.125, 2.0), 0.0), 9, ratio(0, 1))
        .ignoring_it_hits(10, ratio(1, 2))
        .hits(from(Vec3::Z, -0.0), 9, ratio(0, 1))
        .hits(from(Vec3::Z, 1e-45), 10, ratio(1, 1))
        .misses(from(Vec3::NEG_Z, 1e-45))
        // In the plane of the face it starts on: the next one is hit at its edge.
        .hits(from(Vec3::X, 0.0), 2, ratio(1, 2))
        // On an edge, the neighbour is still there when one of the two is ignored.
        .hits(Ray::new(vec3(0.5, 0.5, 0.0), Vec3::NEG_Z), 8, ratio(0, 1))
        .ignoring_it_hits(9, ratio(0, 1));
    vec![case]
}

/// 29: `t_min` and `t_max` at the very `t` of hits, of three coincident triangles and of a `t` that no f32 can be.
pub(super) fn interval_ends() -> Vec<HardCase> {
    let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let below = triangle.map(|corner| corner - Vec3::Z);
    let mesh = soup(vec![below, triangle, triangle, triangle]);
    let at = |t_min, t_max| Ray::with_interval(vec3(0.25, 0.25, 1.0), Vec3::NEG_Z, t_min, t_max);
    let (just_below, just_above) = (1.0f32.next_down(), 1.0f32.next_up());
    let coincident = HardCase::new(29, "ends at the t of coincident triangles", mesh)
        .hits(at(1.0, 1.0), 1, ratio(1, 1))
        .crosses(3)
        .ignoring_it_hits(2, ratio(1, 1))
        .hits(at(1.0, f32::INFINITY), 1, ratio(1, 1))
        .crosses(4)
        .hits(at(-5.0, 1.0), 1, ratio(1, 1))
        .crosses(3)
        .misses(at(0.0, just_below))
        .crosses(0)
        .hits(at(just_above, 2.0), 0, ratio(2, 1))
        .crosses(1)
        .hits(at(2.0, 2.0), 0, ratio(2, 1))
        .ignoring_it_misses()
        .misses(at(2.0f32.next_up(), f32::INFINITY))
        .misses(at(f32::NEG_INFINITY, just_below))
        .hits(at(f32::NEG_INFINITY, f32::INFINITY), 1, ratio(1, 1));
    // t is one third, and the f32 next to it is above it.
    let third = 1.0f32 / 3.0;
    let at = |t_min, t_max| {
        Ray::with_interval(vec3(0.25, 0.25, 1.0), vec3(0.0, 0.0, -3.0), t_min, t_max)
    };
    let rounded = HardCase::new(29, "ends next to a t of one third", soup(vec![triangle]))
        .hits(at(0.0, third), 0, ratio(1, 3))
        .misses(at(0.0, third.next_down()))
        .misses(at(third, 1.0))
        .misses(at(third, third))
        .hits(at(third.next_down(), 1.0), 0, ratio(1, 3))
        .hits(at(third.next_down(), third), 0, ratio(1, 3));
    vec![coincident, rounded]
}

/// 30: Intervals that are empty, behind the ray or infinite, and rays with NaN: a miss without a single visit.
pub(super) fn invalid_intervals() -> Vec<HardCase> {
    let good = Ray::new(vec3(0.5, 0.25, -1.0), Vec3::Z);
    let with = |t_min, t_max| Ray {
        t_min,
        t_max,
        ..good
    };
    let mut case = HardCase::new(30, "invalid rays and intervals", cube())
        .closed()
        .hits(with(0.0, f32::INFINITY), 9, ratio(1, 1))
        .misses(with(2.0, 1.0))
        .misses(with(0.0, -1.0))
        .misses(with(f32::INFINITY, 0.0))
        .misses(with(f32::NAN, 1.0))
        .misses(with(0.0, f32::NAN))
        .misses(with(f32::NEG_INFINITY, 0.5))
        .misses(with(f32::INFINITY, f32::INFINITY))
        .misses(with(-3.0, -1.0))
        .hits(with(-0.0, f32::MAX), 9, ratio(1, 1));
    for bad in invalid_rays(good) {
        case = case.misses(bad);
    }
    vec![case]
}

/// 45: Two spheres 4e-5 apart: both are hit, from outside, from the centre, and from the outer one when its triangle is ignored.
/// Starting secondary rays off the surface is not a part of these queries; ignoring a triangle is.
pub(super) fn close_spheres() -> Vec<HardCase> {
    let outer = sphere(2);
    let inner = mapped(&outer, |vertex| vertex * (1.0 - 4e-5));
    let both = joined(&outer, &inner);
    let mut case = HardCase::new(45, "spheres 4e-5 apart", both).closed();
    for triangle in outer.triangles().step_by(7) {
        let [a, b, c] = triangle.vertices();
        for target in [(a + b + c) / 3.0, a, a.midpoint(b)] {
            let outside = 3.0 * target;
            case = case
                .asks(Ray::new(outside, -outside))
                .crosses(4)
                .asks(Ray::new(Vec3::ZERO, target))
                .crosses(2)
                .asks(Ray::new(target, -target));
        }
    }
    vec![case]
}
