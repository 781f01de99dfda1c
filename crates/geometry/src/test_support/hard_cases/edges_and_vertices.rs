//! Rays through edges and vertices that triangles share, or nearly share: cases 8 to 12.

use glam::{Vec3, vec3};

use super::aimed::aimed_at_features;
use super::shapes::{bipyramid, cube, height_field, mapped, sphere};
use super::{HardCase, ratio};
use crate::Ray;
use crate::test_support::soup;

/// 8: A grid of rays over closed and open meshes with integer coordinates, so that many rays pass through edges and vertices.
pub(super) fn shared_edges() -> Vec<HardCase> {
    let blob = mapped(&sphere(2), |vertex| {
        let bumps = 1.0 + 0.25 * (vertex.x * 5.0).sin() * (vertex.y * 3.0).cos();
        (vertex * bumps * 12.0).round()
    });
    let grid = || {
        (-12i8..=12).step_by(3).flat_map(|i| {
            (-12i8..=12)
                .step_by(4)
                .map(move |j| (f32::from(i), f32::from(j)))
        })
    };
    let mut closed = HardCase::new(8, "grid of rays over a closed mesh of integers", blob).closed();
    for (first, second) in grid() {
        closed = closed
            .asks(Ray::new(vec3(first, second, 64.0), vec3(0.0, -0.0, -1.0)))
            .starting_outside()
            .asks(Ray::new(vec3(-64.0, first, second), Vec3::X))
            .starting_outside()
            .asks(Ray::new(vec3(first, 64.0, second), vec3(1.0, -16.0, 1.0)))
            .starting_outside();
    }
    let terrain = height_field(6, |x, y| (x * 3.0 + y * 5.0) % 7.0);
    let mut open = HardCase::new(8, "grid of rays over a terrain of integers", terrain);
    for (i, j) in (0..=6u8).flat_map(|i| (0..=6u8).map(move |j| (f32::from(i), f32::from(j)))) {
        open = open
            .hits_something(Ray::new(vec3(i, j, 16.0), Vec3::NEG_Z))
            .hits_something(Ray::new(vec3(i, j, -16.0), Vec3::Z));
        if i < 6.0 && j < 6.0 {
            // The middle of each diagonal.
            open = open
                .hits_something(Ray::new(vec3(i + 0.5, j + 0.5, 16.0), Vec3::NEG_Z))
                .crosses(1);
        }
    }
    vec![closed, open]
}

/// 9: Rays through a vertex that 3, 6 and 100 triangles share, from outside and inside.
pub(super) fn vertices_of_high_valence() -> Vec<HardCase> {
    [("valence 3", 3), ("valence 6", 6), ("valence 100", 100)]
        .into_iter()
        .map(|(name, valence)| {
            let to_tip = |origin: Vec3| Ray::new(origin, Vec3::Z - origin);
            let mesh = bipyramid(valence);
            let mut aimed =
                aimed_at_features(&mesh, &[vec3(3.0, 2.0, -5.0)], &[vec3(0.125, 0.0625, 0.25)]);
            if valence == 100 {
                let mut number = 0;
                aimed.retain(|_| {
                    number += 1;
                    number % 11 == 0
                });
            }
            let mut case = HardCase::new(9, name, mesh)
                .closed()
                .hits(Ray::new(vec3(0.0, 0.0, 5.0), Vec3::NEG_Z), 0, ratio(4, 1))
                .starting_outside()
                .hits(Ray::new(Vec3::ZERO, Vec3::Z), 0, ratio(1, 1))
                .starting_inside()
                .hits(
                    Ray::new(Vec3::ZERO, Vec3::NEG_Z),
                    u32::from(valence),
                    ratio(1, 1),
                )
                .starting_inside();
            for outside in [
                vec3(3.0, 2.0, 5.0),
                vec3(-2.5, 0.25, 4.0),
                vec3(0.0, -1.0, 3.0),
            ] {
                case = case
                    .hits(to_tip(outside), 0, ratio(1, 1))
                    .starting_outside();
            }
            for inside in [vec3(0.125, 0.0625, -0.25), vec3(-0.0625, 0.125, 0.25)] {
                case = case.hits(to_tip(inside), 0, ratio(1, 1)).starting_inside();
            }
            case.asks_all(aimed)
        })
        .collect()
}

/// 10: All hits of rays through diagonals, edges and corners of a cube: each crossing of the surface once.
pub(super) fn all_hits_on_edges() -> Vec<HardCase> {
    let case = HardCase::new(10, "all hits on edges", cube())
        .closed()
        // Through the diagonals of two faces.
        .hits(Ray::new(vec3(0.5, 0.5, -1.0), Vec3::Z), 8, ratio(1, 1))
        .crosses(2)
        .hits(
            Ray::new(vec3(0.25, 0.25, 3.0), vec3(-0.0, 0.0, -2.0)),
            10,
            ratio(1, 1),
        )
        .crosses(2)
        // In through an edge, out through the opposite one.
        .hits(
            Ray::new(vec3(2.0, 0.5, -1.0), vec3(-1.0, 0.0, 1.0)),
            2,
            ratio(1, 1),
        )
        .crosses(2)
        // In through a corner, out through the opposite one.
        .hits(Ray::new(vec3(-1.0, -1.0, -1.0), Vec3::ONE), 0, ratio(1, 1))
        .crosses(2)
        // From inside through an edge.
        .hits(
            Ray::new(vec3(0.5, 0.5, 0.5), vec3(1.0, 0.0, 1.0)),
            3,
            ratio(1, 2),
        )
        .crosses(1)
        .starting_inside()
        // It touches an edge, or runs along one, from outside: no crossing or two, as the perturbation has it.
        .hits(
            Ray::new(vec3(2.0, 0.5, 1.0), vec3(-1.0, 0.0, -1.0)),
            2,
            ratio(1, 1),
        )
        .starting_outside()
        .hits(Ray::new(vec3(-1.0, 0.0, 0.0), Vec3::X), 0, ratio(1, 1))
        .starting_outside()
        .hits(
            Ray::new(vec3(-1.0, 1.0, 0.0), vec3(1.0, -1.0, 0.0)),
            0,
            ratio(1, 1),
        )
        .starting_outside();
    vec![case]
}

/// 11: Two small triangles on a large one's edge, their common vertex one step off it: the gap is real.
pub(super) fn t_junction_with_a_gap() -> Vec<HardCase> {
    let junction = |y: f32| {
        let (a, b, middle, top) = (
            vec3(0.0, 1.0, 0.0),
            vec3(2.0, 1.0, 0.0),
            vec3(1.0, y, 0.0),
            vec3(1.0, 3.0, 0.0),
        );
        soup(vec![[a, Vec3::X, b], [a, middle, top], [middle, b, top]])
    };
    let (above, below) = (1.0f32.next_up(), 1.0f32.next_down());
    let down = |y: f32| Ray::new(vec3(1.0, y, 1.0), Vec3::NEG_Z);
    // The ray meets the plane half a step above or below 1.
    let between = |step: f32| Ray::new(vec3(1.0, 1.0, 1.0), vec3(0.0, 0.5 * step, -1.0));
    let gap = HardCase::new(11, "a gap of one ulp", junction(above))
        .hits(down(1.0), 0, ratio(1, 1))
        .misses(between(above - 1.0))
        .hits(down(above), 1, ratio(1, 1))
        .hits(Ray::new(vec3(0.0, 1.0, 1.0), Vec3::NEG_Z), 0, ratio(1, 1));
    let overlap = HardCase::new(11, "an overlap of one ulp", junction(below))
        .hits(down(1.0), 0, ratio(1, 1))
        .hits(between(below - 1.0), 0, ratio(1, 1))
        .crosses(2)
        .hits(down(below), 0, ratio(1, 1))
        .hits(down(above), 1, ratio(1, 1));
    vec![gap, overlap]
}

/// 12: A T-junction whose vertex is exactly on the edge: no ray passes, and it crosses once.
pub(super) fn exact_t_junction() -> Vec<HardCase> {
    let (a, b, middle) = (Vec3::ZERO, vec3(6.0, 3.0, 0.0), vec3(2.0, 1.0, 0.0));
    let (below, above) = (vec3(4.0, -2.0, 0.0), vec3(1.0, 5.0, 0.0));
    let mesh = soup(vec![[a, below, b], [a, middle, above], [middle, b, above]]);
    let mut case = HardCase::new(12, "a vertex exactly on an edge", mesh);
    for step in 1..24u8 {
        let x = 0.25 * f32::from(step);
        let target = vec3(x, 0.5 * x, 0.0);
        for origin in [target + Vec3::Z, vec3(4.0, 1.0, 8.0), vec3(-1.0, 7.0, -3.0)] {
            case = case
                .hits(Ray::new(origin, target - origin), 0, ratio(1, 1))
                .crosses(1);
        }
    }
    vec![case]
}
