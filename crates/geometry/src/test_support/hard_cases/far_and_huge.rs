//! Coordinates far from the origin, huge, denormal or unevenly scaled, and directions of any length: cases 22 to 24, 26 and 42
//! to 44.

use glam::{DAffine3, DMat3, DVec3, Vec3, vec3};

use super::aimed::aimed_at_features;
use super::shapes::{cube, joined, mapped, sphere};
use super::{HardCase, exact, ratio};
use crate::test_support::soup;
use crate::{Ray, Transform, TriangleMesh};

/// 22: A sphere moved so far that its vertices are rounded to 1/16 and to 1: no leak, and exact for the vertices as they are.
pub(super) fn moved_far() -> Vec<HardCase> {
    [("moved by 1e6", 1e6f32), ("moved by 1e7", 1e7)]
        .into_iter()
        .map(|(name, distance)| {
            let center = vec3(distance, -distance, 0.5 * distance);
            let shape = mapped(&sphere(1), |vertex| 100.0 * vertex + center);
            let outside = [center + vec3(300.0, 200.0, -150.0), Vec3::ZERO];
            let aimed = aimed_at_features(&shape, &outside, &[center]);
            HardCase::new(22, name, shape).closed().asks_all(aimed)
        })
        .collect()
}

/// 23: The origin is 1e8 away from objects of size 1.
pub(super) fn far_origin() -> Vec<HardCase> {
    let triangle = soup(vec![[Vec3::ZERO, Vec3::X, Vec3::Y]]);
    let far = 1e8;
    let single = HardCase::new(23, "origin 1e8 away from a triangle", triangle)
        .hits(Ray::new(vec3(0.25, 0.25, far), Vec3::NEG_Z), 0, exact(far))
        .hits(Ray::new(vec3(0.5, 0.5, far), Vec3::NEG_Z), 0, exact(far))
        .misses(Ray::new(vec3(0.5, 0.5f32.next_up(), far), Vec3::NEG_Z))
        .hits(
            Ray::new(vec3(0.25, 0.0, far), vec3(0.0, 0.0, -far)),
            0,
            ratio(1, 1),
        )
        .asks(Ray::new(vec3(far, far, far), vec3(-1.0, -1.0, -1.0)))
        .asks(Ray::new(vec3(far, 0.0, far), vec3(-1.0, 0.0, -1.0)))
        .asks(Ray::new(vec3(far, 0.25, far), vec3(-1.0, 0.0, -1.0)))
        // The smallest slope that leaves the triangle.
        .asks(Ray::new(vec3(0.25, 0.25, far), vec3(0.75e-8, 0.0, -1.0)))
        .asks(Ray::new(vec3(0.25, 0.25, far), vec3(0.5e-8, 0.0, -1.0)))
        .asks(Ray::new(
            vec3(0.25, 0.25, far),
            vec3(0.5e-8f32.next_up(), 0.0, -1.0),
        ));
    let shape = mapped(&sphere(1), |vertex| vertex * 0.5);
    let outside = [vec3(far, 0.0, 0.0), vec3(-far, 0.5 * far, 0.25 * far)];
    let aimed = aimed_at_features(&shape, &outside, &[]);
    let closed = HardCase::new(23, "origin 1e8 away from a sphere", shape);
    vec![single, closed.closed().asks_all(aimed)]
}

/// 24: Cubes as large as 1e18, 3e18, 1e19 and 3e38. Any finite coordinates are legal: differences and products that overflow f32 do
/// not change the answer.
pub(super) fn huge_coordinates() -> Vec<HardCase> {
    let sizes = [
        ("size 1e18", 1e18f32),
        ("size 3e18", 3e18),
        ("size 1e19", 1e19),
        ("size 3e38", 3e38),
    ];
    sizes
        .into_iter()
        .map(|(name, size)| {
            let shape = mapped(&cube(), |corner| (2.0 * corner - Vec3::ONE) * size);
            let inside = |direction: Vec3| Ray::new(Vec3::ZERO, direction);
            let beyond = 1.1 * size;
            let before = exact(beyond) - exact(size);
            let mut case = HardCase::new(24, name, shape)
                .closed()
                .hits(inside(Vec3::X), 2, exact(size))
                .starting_inside()
                .hits(inside(vec3(1.0, 0.5, 0.25)), 2, exact(size))
                .starting_inside()
                .hits(inside(vec3(1e-3, 0.0, 0.0)), 2, exact(size) / exact(1e-3))
                .starting_inside()
                .hits(inside(Vec3::X * size), 2, ratio(1, 1))
                .starting_inside()
                .hits(
                    Ray::new(vec3(beyond, 0.0, 0.0), Vec3::NEG_X),
                    2,
                    before.clone(),
                )
                .crosses(2)
                .hits(Ray::new(Vec3::splat(-beyond), Vec3::ONE), 0, before)
                .crosses(2)
                .misses(Ray::new(vec3(beyond, 0.0, 0.0), Vec3::X))
                .hits(
                    Ray::new(vec3(1.0, 2.0, -beyond), Vec3::Z * size),
                    8,
                    (exact(beyond) - exact(size)) / exact(size),
                )
                .starting_outside();
            for target in [
                vec3(1.0, 1.0, 1.0),
                vec3(1.0, 0.0, 1.0),
                vec3(1.0, 1.0, 0.3),
                vec3(-0.1, -1.0, 0.7),
            ] {
                case = case
                    .asks(inside(target))
                    .starting_inside()
                    .asks(inside(target * size))
                    .starting_inside();
            }
            case
        })
        .collect()
}

/// 26: Vertices as small as 1e-39 among vertices of size 1: denormals are numbers like others.
pub(super) fn denormal_vertices() -> Vec<HardCase> {
    let tiny = 1e-39;
    let shape = soup(vec![
        [Vec3::ZERO, Vec3::X, Vec3::Y],
        [
            vec3(0.0, 0.0, tiny),
            vec3(tiny, 0.0, tiny),
            vec3(0.0, tiny, tiny),
        ],
        [
            vec3(2.0, 0.0, 0.0),
            vec3(3.0, 0.0, tiny),
            vec3(2.0, 1.0, -tiny),
        ],
    ]);
    let down = |x: f32, y: f32| Ray::new(vec3(x, y, 1.0), Vec3::NEG_Z);
    let case = HardCase::new(26, "denormal vertices", shape)
        // Nearer by 1e-39, which no rounded t can show.
        .hits(down(0.25 * tiny, 0.25 * tiny), 1, ratio(1, 1) - exact(tiny))
        .hits(down(0.0, tiny), 1, ratio(1, 1) - exact(tiny))
        .hits(down(tiny, tiny), 0, ratio(1, 1))
        .hits(down(0.25, 0.25), 0, ratio(1, 1))
        .misses(down(-1e-45, 0.25))
        .hits(down(2.0, 0.0), 2, ratio(1, 1))
        .hits(down(2.5, 0.0), 2, ratio(1, 1) - exact(tiny) / ratio(2, 1))
        .asks(down(2.25, 0.25))
        .asks(Ray::new(vec3(1.0, 0.25, tiny), vec3(1.0, 0.0, -1e-45)))
        .asks(Ray::new(
            vec3(0.25 * tiny, 0.25 * tiny, 0.0),
            vec3(0.0, 0.0, tiny),
        ))
        .asks(Ray::new(
            vec3(-1.0, 0.125 * tiny, tiny),
            vec3(1.0, 0.0, -tiny),
        ));
    vec![case]
}

/// 42: Small boxes 1e3 from zero, by themselves and beside a large one, whose node has a grid with steps longer than they are: where the boxes of quantised nodes
/// lose hits if they are rounded inward. Looked at from 1e7 away and, where box tests have hardly a margin, from close by, along the faces of the boxes.
pub(super) fn far_from_the_node() -> Vec<HardCase> {
    let place = |index: u8| {
        let at = |place: u8| f32::from(index >> place & 3);
        vec3(at(0), at(2), at(4)) * 0.37 + vec3(1e3, -1e3, 1e3)
    };
    let one = |index: u8| mapped(&cube(), |corner| 0.01 * corner + place(index));
    let cluster = (1..64)
        .step_by(7)
        .fold(one(0), |cluster, index| joined(&cluster, &one(index)));
    let large = mapped(&cube(), |corner| 300.0 * corner + vec3(200.0, -2e3, 300.0));
    let few = (0..64)
        .step_by(21)
        .fold(large, |all, index| joined(&all, &one(index)));
    vec![
        aimed_at_small_boxes("small boxes far from the origin of the rays", cluster),
        aimed_at_small_boxes("small boxes beside a large one", few),
    ]
}

fn aimed_at_small_boxes(name: &'static str, mesh: TriangleMesh) -> HardCase {
    let origins = [
        vec3(1e7, 1e3, -1e3),
        vec3(-1e7, -1e7, 2e6),
        vec3(1e3, -1e7, 1e3),
    ];
    let vertices = mesh.vertices().to_vec();
    let mut case = HardCase::new(42, name, mesh).closed();
    let axes = Vec3::AXES.into_iter().cycle();
    let places = origins.into_iter().cycle().zip(axes);
    for (vertex, (origin, axis)) in vertices.into_iter().zip(places) {
        let level = vec3(-1e7, vertex.y, vertex.z);
        case = case
            .asks(Ray::new(origin, vertex - origin))
            .starting_outside()
            .hits_something(Ray::new(level, Vec3::X))
            .starting_outside()
            .hits_something(Ray::new(vertex - 0.25 * axis, axis));
    }
    case
}

/// 43: A sphere scaled by 1e-6, 2 and 300 and sheared. There are no instances yet: the transformed mesh is asked.
pub(super) fn sheared() -> Vec<HardCase> {
    let matrix = DMat3::from_cols(
        DVec3::new(1e-6, 0.0, 0.0),
        DVec3::new(0.5, 2.0, 0.1),
        DVec3::new(-40.0, 7.0, 300.0),
    );
    let transforms = [
        ("sheared", DAffine3::from_mat3(matrix)),
        (
            "sheared and moved",
            DAffine3::from_mat3_translation(matrix, DVec3::new(10.0, 20.0, -30.0)),
        ),
    ];
    transforms
        .into_iter()
        .map(|(name, affine)| {
            let transform = Transform::from_affine(affine).expect("the matrix has an inverse");
            let shape = mapped(&sphere(1), |vertex| transform.point_f32(vertex));
            let outside = transform.point_f32(vec3(3.0, 5.0, -4.0));
            let center = transform.point_f32(Vec3::ZERO);
            let aimed = aimed_at_features(&shape, &[outside], &[]);
            let mut case = HardCase::new(43, name, shape).closed();
            for direction in sphere(1).vertices() {
                let direction = transform.vector(direction.as_dvec3()).as_vec3();
                case = case.asks(Ray::new(center, direction));
            }
            case.asks_all(aimed)
        })
        .collect()
}

/// 44: Directions of length 2^-100 to 2^100, 1e-10 and 1e10: `t` scales, the answer stays.
pub(super) fn directions_of_any_length() -> Vec<HardCase> {
    let mut case = HardCase::new(44, "directions of any length", cube()).closed();
    let powers = [-100i32, -60, -33, -1, 33, 60, 100].map(|exponent| 2.0f32.powi(exponent));
    for length in powers.into_iter().chain([1e-10, 1e10, 1e-30, 1e30, 1e38]) {
        let t = ratio(1, 1) / exact(length);
        let straight = Ray::new(vec3(0.5, 0.25, -1.0), Vec3::Z * length);
        let edge = Ray::new(vec3(0.5, 0.0, -1.0), Vec3::Z * length);
        let corner = Ray::new(Vec3::NEG_ONE, Vec3::splat(length));
        let beside = Ray::new(vec3(0.5, -1e-45, -1.0), Vec3::Z * length);
        case = case
            .hits(straight, 9, t.clone())
            .crosses(2)
            .hits(edge, 9, t.clone())
            .hits(corner, 0, t)
            .crosses(2)
            .misses(beside);
    }
    vec![case]
}
