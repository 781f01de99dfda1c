use glam::{DVec3, Vec3};
use tahko_geometry::{BruteForce, Precision, Transform};

use std::f32::consts::PI;

use super::*;
use crate::scene::{Camera, FieldOfView, Light, Material, MeshPart, Projection, SceneBuilder};

/// A large horizontal square at a height.
fn square(height: f32, size: f32) -> MeshPart {
    let corner = |x: f32, z: f32| Vec3::new(x * size, height, z * size);
    MeshPart {
        name: "square".to_owned(),
        positions: vec![
            corner(-1.0, 1.0),
            corner(1.0, 1.0),
            corner(1.0, -1.0),
            corner(-1.0, -1.0),
        ],
        indices: vec![[0, 1, 2], [0, 2, 3]],
        ..MeshPart::default()
    }
}

/// A camera high above, looking down at the origin.
fn from_above() -> Camera {
    let projection = Projection::Perspective(FieldOfView {
        degrees: 20.0,
        spans_shorter_side: false,
    });
    Camera::look_at(DVec3::Y * 8.0, DVec3::ZERO, DVec3::NEG_Z, projection).unwrap()
}

fn scene(parts: Vec<(MeshPart, Material)>, lights: &[Light]) -> Scene {
    let mut builder = SceneBuilder::new();
    builder.set_camera(from_above());
    builder.set_ambient(Vec3::ZERO);
    builder.set_background(Vec3::new(0.0, 0.0, 0.5));
    for (part, material) in parts {
        let material = builder.add_material(material);
        builder
            .add_part(part, material, &Transform::IDENTITY)
            .unwrap();
    }
    for light in lights {
        builder.add_light(*light);
    }
    builder.finish().unwrap()
}

fn white() -> Material {
    Material {
        color: Vec3::ONE,
        ..Material::default()
    }
}

/// The colour in the middle of the picture.
fn center(scene: &Scene, integrator: Integrator) -> Vec3 {
    let options = RenderOptions {
        width: 5,
        height: 5,
        integrator,
        ..RenderOptions::default()
    };
    let query = BruteForce::new(scene.mesh(), Precision::default());
    let (film, _) = render(scene, &query, &options, &RenderControl::default()).unwrap();
    film.pixels()[12]
}

fn assert_close(actual: Vec3, expected: Vec3) {
    assert!(
        (actual - expected).abs().max_element() < 1e-5,
        "{actual} is not {expected}"
    );
}

const WHITTED: Integrator = Integrator::Whitted {
    max_depth: DEFAULT_DEPTH,
};

#[test]
fn light_follows_the_cosine_and_the_square_of_the_distance() {
    let light = |position| {
        [Light::Point {
            position,
            intensity: Vec3::splat(4.0 * PI),
        }]
    };
    let floor = || vec![(square(0.0, 5.0), white())];
    let above = center(&scene(floor(), &light(DVec3::Y * 2.0)), Integrator::Direct);
    assert_close(above, Vec3::ONE);
    let aslant = center(
        &scene(floor(), &light(DVec3::new(2.0, 2.0, 0.0))),
        Integrator::Direct,
    );
    assert_close(aslant, Vec3::splat(0.5 * 0.5f32.sqrt()));
    let below = center(&scene(floor(), &light(DVec3::NEG_Y)), Integrator::Direct);
    assert_close(below, Vec3::ZERO);
}

#[test]
fn a_surface_between_light_and_floor_casts_a_shadow_and_one_behind_the_light_does_not() {
    let floor_and = |height, size| {
        let red = Material {
            color: Vec3::X,
            ..white()
        };
        // Beside the line of sight, so that the camera sees the floor.
        let mut lid = square(height, size);
        lid.positions
            .iter_mut()
            .for_each(|position| position.x += 2.0 * height / 4.0);
        vec![(square(0.0, 5.0), white()), (lid, red)]
    };
    let light = [Light::Point {
        position: DVec3::new(2.0, 4.0, 0.0),
        intensity: Vec3::splat(100.0),
    }];
    assert_eq!(
        center(&scene(floor_and(2.0, 0.5), &light), Integrator::Direct),
        Vec3::ZERO
    );
    assert!(
        center(&scene(floor_and(6.0, 0.5), &light), Integrator::Direct).x > 0.5,
        "not in between"
    );
}

#[test]
fn what_lies_close_above_a_large_floor_casts_a_shadow() {
    // Rays that were lifted by a part of the floor's extent would start above it.
    let height = 1e-3;
    let mut speck = square(height, 0.25 * height);
    speck
        .positions
        .iter_mut()
        .for_each(|position| position.x += 2.0 * height / 4.0);
    let light = [Light::Point {
        position: DVec3::new(2.0, 4.0, 0.0),
        intensity: Vec3::splat(100.0),
    }];
    let floor = || (square(0.0, 1e5), white());
    let lit = center(&scene(vec![floor()], &light), Integrator::Direct);
    let shaded = center(
        &scene(vec![floor(), (speck, white())], &light),
        Integrator::Direct,
    );
    assert!(lit.x > 0.5, "{lit}");
    assert_eq!(shaded, Vec3::ZERO);
}

#[test]
fn a_mirror_shows_the_background_and_glass_shows_what_is_behind() {
    let mirror = Material {
        mirror: 1.0,
        ..white()
    };
    let light = [Light::Directional {
        direction: DVec3::NEG_Y,
        irradiance: Vec3::splat(PI),
    }];
    let mirror = scene(vec![(square(1.0, 1.0), mirror)], &light);
    assert_close(center(&mirror, WHITTED), Vec3::new(0.0, 0.0, 0.5));
    assert_close(center(&mirror, Integrator::Direct), Vec3::ONE);

    let glass = Material {
        transmission: 1.0,
        ior: 1.5,
        ..white()
    };
    let glowing = Material {
        emission: Vec3::X,
        color: Vec3::ZERO,
        ..white()
    };
    let glass = scene(
        vec![(square(1.0, 1.0), glass), (square(0.0, 1.0), glowing)],
        &light,
    );
    assert_close(center(&glass, WHITTED), Vec3::new(0.96, 0.0, 0.04 * 0.5));
}

#[test]
fn parallel_mirrors_end_at_the_depth_limit() {
    let mirror = || Material {
        mirror: 1.0,
        color: Vec3::ZERO,
        ..white()
    };
    let light = [Light::Directional {
        direction: DVec3::NEG_Y,
        irradiance: Vec3::ONE,
    }];
    let scene = scene(
        vec![(square(0.0, 50.0), mirror()), (square(9.0, 50.0), mirror())],
        &light,
    );
    assert_eq!(center(&scene, WHITTED), Vec3::ZERO);
}

#[test]
fn pictures_are_the_same_for_every_number_of_threads() {
    let light = [Light::Point {
        position: DVec3::new(1.0, 3.0, 0.0),
        intensity: Vec3::splat(9.0),
    }];
    let mirror = Material {
        mirror: 0.5,
        ..white()
    };
    let scene = scene(
        vec![(square(0.0, 5.0), white()), (square(1.0, 0.7), mirror)],
        &light,
    );
    let query = BruteForce::new(scene.mesh(), Precision::default());
    let options = RenderOptions {
        width: 70,
        height: 37,
        samples: 3,
        integrator: WHITTED,
        count: true,
        ..RenderOptions::default()
    };
    let pictures = [1, 2, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| render(&scene, &query, &options, &RenderControl::default()).unwrap())
    });
    assert!(
        pictures.windows(2).all(|pair| pair[0] == pair[1]),
        "threads must not matter"
    );
    let (_, statistics) = &pictures[0];
    assert_eq!(statistics.camera_rays, 70 * 37 * 3);
    assert!(
        statistics.counts.triangle_tests > statistics.rays(),
        "brute force tests all"
    );
    let other = RenderOptions { seed: 1, ..options };
    let (film, _) = render(&scene, &query, &other, &RenderControl::default()).unwrap();
    assert_ne!(film, pictures[0].0, "the seed moves the samples");
}

#[test]
fn sizes_out_of_range_and_cancelling_are_errors() {
    let scene = scene(Vec::new(), &[]);
    let query = BruteForce::new(scene.mesh(), Precision::default());
    let control = RenderControl::default();
    let run = |width, height, samples| {
        let options = RenderOptions {
            width,
            height,
            samples,
            ..RenderOptions::default()
        };
        render(&scene, &query, &options, &control).map(|(film, _)| film.pixels()[0])
    };
    assert_eq!(run(4, 4, 1), Ok(Vec3::new(0.0, 0.0, 0.5)));
    assert_eq!(
        run(0, 4, 1),
        Err(RenderError::Size {
            width: 0,
            height: 4
        })
    );
    assert_eq!(
        run(4, u32::MAX, 1),
        Err(RenderError::Size {
            width: 4,
            height: u32::MAX
        })
    );
    assert_eq!(run(4, 4, 0), Err(RenderError::NoSamples));
    control.cancel();
    assert_eq!(run(4, 4, 1), Err(RenderError::Cancelled));
}
