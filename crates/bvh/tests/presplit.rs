//! Slivers that are cut in pieces before the tree is built.

use tahko_bvh::{BuildControl, BuildError, Bvh, BvhOptions, NodeFormat};
use tahko_geometry::test_support::{assert_answers_like_brute_force, rays_at_features, soup};
use tahko_geometry::{QueryCounts, Ray, RayQuery, TriangleMesh, glam::Vec3};

/// Numbers from 0 to 1, always the same ones.
fn numbers() -> impl FnMut() -> f32 {
    let mut state = 1u32;
    move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f32::from((state >> 16) as u16) / 65536.0
    }
}

/// Slivers of some length, which begin in a unit cube, near the four diagonals.
fn slivers(count: u32, length: f32) -> TriangleMesh {
    let mut random = numbers();
    let mut point = move || Vec3::new(random(), random(), random());
    let sliver = |number: u32| {
        let [start, way, side] = [point(), point() - 0.5, point()];
        let diagonal = Vec3::ONE.with_x([1.0, -1.0][number as usize % 2]);
        let diagonal = diagonal.with_y([1.0, -1.0][number as usize / 2 % 2]);
        let end = start + length * (diagonal + 0.2 * way).normalize();
        [start, end, end + 1e-3 * side]
    };
    soup((0..count).map(sliver).collect())
}

/// Rays from one side of a unit cube to another.
fn chords(count: u32) -> Vec<Ray> {
    let mut random = numbers();
    let chord = |_| {
        let [from, to] = [-0.5, 1.5].map(|x| Vec3::new(x, random(), random()));
        Ray::new(from, to - from)
    };
    (0..count).map(chord).collect()
}

fn build(mesh: &TriangleMesh, budget: f64) -> Bvh {
    let options = BvhOptions::high_quality().with_presplit_budget(budget);
    Bvh::build(mesh, &options).expect("options in range")
}

/// Triangle tests per ray.
fn tests(bvh: &Bvh, rays: &[Ray]) -> f64 {
    let mut counts = QueryCounts::default();
    for ray in rays {
        bvh.closest_hit_counted(ray, &mut counts);
    }
    counts.triangle_tests as f64 / rays.len() as f64
}

#[test]
fn rays_test_fewer_triangles_the_more_pieces_there_may_be() {
    let rays = chords(500);
    for (length, factors) in [(2.0, [1.7, 2.7, 4.0]), (0.7, [2.0, 3.0, 4.5])] {
        let mesh = slivers(4000, length);
        let whole = tests(&build(&mesh, 1.0), &rays);
        for (budget, factor) in [4.0, 8.0, 16.0].into_iter().zip(factors) {
            let pieces = tests(&build(&mesh, budget), &rays);
            assert!(
                pieces * factor < whole,
                "{length}, {budget}: {whole} to {pieces}"
            );
        }
    }
}

#[test]
fn pieces_answer_like_brute_force() {
    let mesh = slivers(800, 1.5);
    let mut rays = chords(200);
    rays.extend(rays_at_features(&mesh).into_iter().step_by(50));
    for format in NodeFormat::ALL {
        for preset in [BvhOptions::balanced(), BvhOptions::high_quality()] {
            let options = preset.with_presplit_budget(8.0).with_node_format(format);
            let bvh = Bvh::build(&mesh, &options).expect("options in range");
            assert!(bvh.statistics().references > 4 * mesh.len(), "{options:?}");
            assert_eq!(bvh.validate(), Ok(()));
            assert_eq!(bvh.bounds(), mesh.aabb());
            let precision = options.precision;
            assert_answers_like_brute_force("slivers", &bvh, &mesh, precision, &rays);
        }
    }
}

#[cfg(feature = "parallel")]
#[test]
fn pieces_do_not_depend_on_the_number_of_threads() {
    let mesh = slivers(3000, 1.5);
    let trees = [1, 2, 5].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads").install(|| build(&mesh, 8.0))
    });
    let references = trees[0].statistics().references;
    assert!(references > 20_000, "{references}");
    assert!(trees[0] == trees[1], "2 threads");
    assert!(trees[0] == trees[2], "5 threads");
}

#[test]
fn ordinary_meshes_have_the_tree_that_they_have_without_a_budget() {
    let mut random = numbers();
    let small: Vec<[Vec3; 3]> = (0..5000)
        .map(|_| {
            let corner = Vec3::new(random(), random(), random());
            [corner, corner + 0.02 * Vec3::X, corner + 0.02 * Vec3::ONE]
        })
        .collect();
    let large: Vec<[Vec3; 3]> = (0..500)
        .map(|_| std::array::from_fn(|_| Vec3::new(random(), random(), random())))
        .collect();
    let meshes = [
        ("small", soup(small)),
        ("large", soup(large)),
        ("short slivers", slivers(2000, 0.05)),
        ("few slivers", slivers(40, 2.0)),
        ("none", TriangleMesh::default()),
    ];
    let rays = chords(100);
    for (name, mesh) in meshes {
        let [without, with] = [1.0, 32.0].map(|budget| build(&mesh, budget));
        assert_eq!(without.statistics(), with.statistics(), "{name}");
        let counts = [&without, &with].map(|bvh| tests(bvh, &rays));
        assert_eq!(counts[0], counts[1], "{name}");
    }
}

#[test]
fn a_limit_of_memory_leaves_fewer_pieces() {
    let mesh = slivers(3000, 1.5);
    let options = BvhOptions::high_quality();
    let whole = options.build_memory(mesh.len());
    let mut last = 0.0;
    for (factor, least, most) in [(1, 1.0, 1.3), (4, 3.0, 5.2), (100, 6.0, 10.4)] {
        let limit = factor * whole;
        let control = BuildControl::new().with_memory_limit(limit);
        let (bvh, report) = Bvh::build_with(&mesh, &options, &control).expect("it fits");
        let references = report.references_per_triangle;
        assert!(
            (least..=most).contains(&references),
            "{factor}: {references}"
        );
        let estimate = report.estimated_memory;
        assert!(estimate <= limit, "{estimate} of {limit}");
        assert!(references > last, "{references}");
        // What fits is made use of.
        let is_used = factor == 100 || estimate > limit * 7 / 10;
        assert!(is_used, "{estimate} of {limit}");
        assert_eq!(bvh.validate(), Ok(()));
        assert_eq!(control.progress(), 1.0);
        last = references;
    }
    let control = BuildControl::new().with_memory_limit(whole - 1);
    let error = Bvh::build_with(&mesh, &options, &control).err();
    let (needed, allowed) = (whole, whole - 1);
    assert_eq!(error, Some(BuildError::MemoryLimit { needed, allowed }));
}
