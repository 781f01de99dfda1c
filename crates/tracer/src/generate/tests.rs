use std::collections::HashSet;

use tahko_geometry::TriangleMesh;

use super::*;

fn mesh(part: &GeneratedPart) -> TriangleMesh {
    TriangleMesh::new(part.positions.clone(), part.indices.clone())
        .unwrap_or_else(|error| panic!("{}: {error}", part.name))
}

/// Small, default and larger sizes, each with its scene.
fn scenes(generator: Generator) -> impl Iterator<Item = (u32, GeneratedScene)> {
    let smallest = *generator.sizes().start();
    let larger = generator.size_for_triangles(40_000).unwrap();
    [
        smallest,
        smallest + 1,
        smallest + 2,
        generator.default_size(),
        larger,
    ]
    .into_iter()
    .map(move |size| (size, generate(generator, size, 42).unwrap()))
}

#[test]
fn the_triangle_count_is_the_one_foretold() {
    for generator in Generator::ALL {
        for (size, scene) in scenes(generator) {
            let foretold = generator.triangle_count(size).unwrap();
            assert_eq!(scene.triangle_count(), foretold, "{generator} {size}");
        }
    }
}

#[test]
fn parts_are_valid_meshes_without_degenerate_triangles() {
    for generator in Generator::ALL {
        for (size, scene) in scenes(generator) {
            assert!(!scene.parts.is_empty(), "{generator} {size}");
            for part in &scene.parts {
                let mesh = mesh(part);
                assert!(!mesh.is_empty(), "{generator} {size} {}", part.name);
                let flat = mesh.triangles().position(|triangle| triangle.area() == 0.0);
                assert_eq!(flat, None, "{generator} {size} {}", part.name);
            }
        }
    }
}

#[test]
fn every_vertex_is_used() {
    for generator in Generator::ALL {
        for (size, scene) in scenes(generator) {
            for part in &scene.parts {
                let used: HashSet<u32> = part.indices.iter().flatten().copied().collect();
                assert_eq!(
                    used.len(),
                    part.positions.len(),
                    "{generator} {size} {}",
                    part.name
                );
            }
        }
    }
}

#[test]
fn part_names_are_unique_and_looks_in_range() {
    for generator in Generator::ALL {
        for (size, scene) in scenes(generator) {
            let names: HashSet<&str> = scene.parts.iter().map(|part| part.name).collect();
            assert_eq!(names.len(), scene.parts.len(), "{generator} {size}");
            for part in &scene.parts {
                let unit = |value: f32| (0.0..=1.0).contains(&value);
                assert!(
                    part.color.to_array().into_iter().all(unit) && unit(part.mirror),
                    "{generator} {}",
                    part.name
                );
                assert!(part.refractive_index.is_none_or(|index| index >= 1.0));
            }
        }
    }
}

#[test]
fn normals_are_unit_vectors_on_the_front_side() {
    for generator in Generator::ALL {
        for (size, scene) in scenes(generator) {
            for part in &scene.parts {
                let Some(normals) = &part.normals else {
                    continue;
                };
                assert_eq!(normals.len(), part.positions.len());
                let longest = normals.iter().map(|n| (n.length() - 1.0).abs());
                assert!(longest.fold(0.0, f32::max) < 4.0 * f32::EPSILON);
                for (triangle, corners) in mesh(part).triangles().zip(&part.indices) {
                    let sum: Vec3 = corners.iter().map(|&i| normals[i as usize]).sum();
                    let front = triangle.scaled_normal().dot(sum.as_dvec3());
                    assert!(front > 0.0, "{generator} {size} {} {triangle:?}", part.name);
                }
            }
        }
    }
}

#[test]
fn solids_are_closed_and_face_outwards() {
    let solids = [
        (Generator::Sphereflake, vec!["spheres"]),
        (Generator::Balls, vec!["spheres"]),
        (Generator::City, vec!["concrete", "brick", "glass"]),
        (Generator::Gears, vec!["even gears", "odd gears"]),
        (Generator::Mount, vec!["spheres"]),
        (Generator::Rings, vec!["joints"]),
        (Generator::Tetra, vec!["tetrahedra"]),
        (Generator::Tree, vec!["leaves"]),
        (Generator::Lattice, vec!["spheres"]),
    ];
    for (generator, names) in solids {
        let size = generator.size_for_triangles(5000).unwrap();
        let scene = generate(generator, size, 1).unwrap();
        for name in names {
            let part = scene.parts.iter().find(|part| part.name == name).unwrap();
            assert_closed(part);
            let volume: f64 = mesh(part)
                .triangles()
                .map(|t| t.a.as_dvec3().dot(t.scaled_normal()) / 6.0)
                .sum();
            assert!(volume > 0.0, "{generator} {name}: volume {volume}");
        }
    }
}

/// Each edge is used once in each direction.
fn assert_closed(part: &GeneratedPart) {
    let mut edges = HashSet::new();
    for [a, b, c] in &part.indices {
        for edge in [[a, b], [b, c], [c, a]] {
            assert!(edges.insert(edge), "{}: {edge:?} used twice", part.name);
        }
    }
    let open = edges.iter().find(|[a, b]| !edges.contains(&[*b, *a]));
    assert_eq!(open, None, "{}: an open edge", part.name);
}

#[test]
fn the_same_arguments_give_the_same_scene_and_seeds_matter_where_they_should() {
    for generator in Generator::ALL {
        let scene = |seed| generate(generator, generator.default_size(), seed).unwrap();
        assert_eq!(scene(1), scene(1), "{generator}");
        assert_eq!(scene(1) != scene(2), generator.uses_seed(), "{generator}");
    }
}

#[test]
fn the_size_for_a_count_is_the_smallest_that_reaches_it() {
    for generator in Generator::ALL {
        let smallest = *generator.sizes().start();
        for target in [0, 1, 1000, 12_345, 1_000_000] {
            let size = generator.size_for_triangles(target).unwrap();
            assert!(generator.triangle_count(size).unwrap() >= target);
            if size > smallest {
                let below = generator.triangle_count(size - 1).unwrap();
                assert!(below < target, "{generator} {target}");
            }
        }
    }
}

#[test]
fn counts_from_a_thousand_to_a_million_can_be_had() {
    for generator in Generator::ALL {
        let smallest = generator.triangle_count(*generator.sizes().start());
        assert!(smallest.unwrap() < 2500, "{generator}");
        let largest = generator.triangle_count(*generator.sizes().end()).unwrap();
        assert!(largest >= 5_000_000, "{generator}");
        assert!(largest <= Generator::MAX_TRIANGLES, "{generator}");
    }
}

#[test]
fn the_classic_counts_come_out() {
    assert_eq!(Generator::Tetra.triangle_count(6), Ok(4096));
    // 32 patches of 10 by 10 cells: the size of a widely used mesh of the teapot, and the board.
    assert_eq!(Generator::Teapot.triangle_count(10), Ok(6320 + 128));
    let count = |generator: Generator, size, per_piece: &[(u64, u64)]| {
        let expected: u64 = per_piece.iter().map(|(pieces, each)| pieces * each).sum();
        assert_eq!(generator.triangle_count(size), Ok(expected), "{generator}");
    };
    // Numbers of spheres and cylinders as in the standard databases.
    count(Generator::Lattice, 12, &[(2197, 80), (6084, 12)]);
    count(Generator::Rings, 7, &[(8400, 80), (8400, 12), (1, 2)]);
    count(Generator::Gears, 4, &[(64, 384), (1, 2)]);
    // The sizes of the scenes for the benchmark.
    count(Generator::Hairball, 1667, &[(1667, 300)]);
    count(Generator::Hairball, 6667, &[(6667, 300)]);
    count(Generator::Cylinders, 3126, &[(3126, 32)]);
    count(Generator::Terrain, 1000, &[(1, 2_000_002)]);
}

#[test]
fn sizes_out_of_range_are_refused() {
    for generator in Generator::ALL {
        for size in [
            generator.sizes().end() + 1,
            u32::MAX,
            generator.sizes().start().wrapping_sub(1),
        ] {
            let expected = GenerateError::SizeOutOfRange { generator, size };
            assert_eq!(generator.triangle_count(size), Err(expected.clone()));
            assert_eq!(generate(generator, size, 0), Err(expected));
        }
        let error = generator.size_for_triangles(u64::MAX).unwrap_err();
        assert!(matches!(error, GenerateError::TooManyTriangles { .. }));
    }
    let error = Generator::Tetra.triangle_count(14).unwrap_err().to_string();
    assert_eq!(
        error,
        "size 14 of generator tetra is out of range: choose 1 to 13 (power of four that is the triangle count)"
    );
}

#[test]
fn names_are_the_serialised_ones() {
    for generator in Generator::ALL {
        assert_eq!(Generator::from_name(generator.name()), Some(generator));
        assert_eq!(ron::to_string(&generator).unwrap(), generator.name());
    }
    assert_eq!(Generator::from_name("Teapot"), None);
}

#[test]
fn the_teapot_faces_outwards_and_stands_upright() {
    let scene = generate(Generator::Teapot, 6, 0).unwrap();
    let teapot = &scene.parts[0];
    let normals = teapot.normals.as_ref().unwrap();
    let handle_spout_knob = [Vec3::NEG_X, Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_Z];
    for direction in handle_spout_knob {
        let farthest = (0..normals.len())
            .max_by(|&a, &b| {
                let reach = |i: usize| teapot.positions[i].dot(direction);
                reach(a).total_cmp(&reach(b))
            })
            .unwrap();
        assert!(normals[farthest].dot(direction) > 0.5, "{direction}");
    }
    let bounds = mesh(teapot).aabb();
    assert_eq!((bounds.min.y, bounds.max.y), (0.0, 3.15));
    assert!(bounds.min.x < -2.9 && bounds.max.x > 3.3);
}

#[test]
fn the_view_shows_all_but_the_outskirts_of_the_ground() {
    const GROUND: [&str; 7] = [
        "plate",
        "floor",
        "street",
        "lawn",
        "water",
        "dark squares",
        "light squares",
    ];
    let mut cut_off = Vec::new();
    for generator in Generator::ALL {
        for (size, scene) in scenes(generator) {
            let parts = scene.parts.iter();
            for part in parts.filter(|part| !GROUND.contains(&part.name)) {
                // Land below the water cannot be seen.
                let is_hidden = |point: &Vec3| part.name == "land" && point.y < -0.3;
                let points = part.positions.iter().filter(|point| !is_hidden(point));
                let outermost = points
                    .map(|&point| distance_from_center(&scene.view, point))
                    .fold(0.0, f32::max);
                if outermost >= 1.0 {
                    cut_off.push((generator, size, part.name, outermost));
                }
            }
        }
    }
    assert_eq!(cut_off, []);
}

/// Where a point is in a picture of 4 to 3: 0 in its middle, 1 on its border, infinite behind the eye.
fn distance_from_center(view: &SuggestedView, point: Vec3) -> f32 {
    let forward = (view.target - view.eye).normalize();
    let right = forward.cross(view.up).normalize();
    let up = right.cross(forward);
    let from_eye = point - view.eye;
    let half_height = (0.5 * view.vertical_fov_degrees).to_radians().tan() * from_eye.dot(forward);
    if half_height <= 0.0 {
        return f32::INFINITY;
    }
    let x = from_eye.dot(right) / (half_height * 4.0 / 3.0);
    let y = from_eye.dot(up) / half_height;
    x.abs().max(y.abs())
}

#[test]
fn lights_are_outside_all_parts() {
    for generator in Generator::ALL {
        for (size, scene) in scenes(generator) {
            assert!(!scene.lights.is_empty(), "{generator}");
            for part in &scene.parts {
                let bounds = mesh(part).aabb();
                for light in &scene.lights {
                    let inside = light.cmpge(bounds.min).all() && light.cmple(bounds.max).all();
                    assert!(!inside, "{generator} {size} {}: {light}", part.name);
                }
            }
        }
    }
}

#[test]
fn the_teapot_is_the_classic_one() {
    // Vertices of a widely used mesh with 10 by 10 cells per patch, given to six digits after the point.
    let published = [
        [0.2198, 2.86335, 0.0],
        [0.177989, 2.86335, 0.130707],
        [0.194472, 2.9232, -0.194472],
        [3.434, 2.4729, 0.0],
    ];
    let scene = generate(Generator::Teapot, 10, 0).unwrap();
    for point in published.map(Vec3::from) {
        let positions = scene.parts[0].positions.iter();
        let nearest = positions
            .map(|p| (*p - point).abs().max_element())
            .fold(f32::INFINITY, f32::min);
        assert!(nearest < 1e-6, "{point}: {nearest}");
    }
}
