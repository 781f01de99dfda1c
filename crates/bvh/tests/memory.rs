//! The estimate of a build's memory against what is allocated. A file of its own: it counts all allocations of the process.
#![expect(unsafe_code, reason = "an allocator that counts")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use tahko_bvh::{BuildControl, Bvh, BvhOptions, NodeFormat};
use tahko_geometry::{TriangleMesh, glam::Vec3};

struct Counting;

static HELD: AtomicUsize = AtomicUsize::new(0);
static MOST: AtomicUsize = AtomicUsize::new(0);

// SAFETY: all calls go to the system's allocator unchanged; reallocation is the default one, by these two.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let held = HELD.fetch_add(layout.size(), Ordering::Relaxed) + layout.size();
        MOST.fetch_max(held, Ordering::Relaxed);
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        HELD.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller keeps the contract of `dealloc`, and `pointer` came from the system's allocator.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// The most bytes held at a time while a tree is built, beside those held before.
fn measured(mesh: &TriangleMesh, options: &BvhOptions) -> u64 {
    let before = HELD.load(Ordering::Relaxed);
    MOST.store(before, Ordering::Relaxed);
    let bvh = Bvh::build(mesh, options).expect("options in range");
    let most = MOST.load(Ordering::Relaxed);
    drop(bvh);
    (most - before) as u64
}

/// Triangles between neighbouring points of a walk in steps of a given size.
fn walk(count: u32, step: f32) -> TriangleMesh {
    let mut state = 1u32;
    let mut random = move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f32::from((state >> 16) as u16) / 65536.0 - 0.5
    };
    let mut point = Vec3::ZERO;
    let vertices = (0..count + 2).map(|_| {
        point += step * Vec3::new(random(), random(), random());
        point
    });
    let vertices = vertices.collect();
    let indices = (0..count).map(|i| [i, i + 1, i + 2]);
    TriangleMesh::new(vertices, indices.collect()).expect("finite vertices")
}

/// Slivers along a diagonal.
fn slivers(count: u16) -> TriangleMesh {
    let starts = (0..count).map(|number| 1e-4 * f32::from(number) * Vec3::X);
    let vertices = starts.flat_map(|start| [start, start + Vec3::ONE, start + 0.999 * Vec3::ONE]);
    let vertices = vertices.collect();
    let indices = (0..u32::from(count)).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
    TriangleMesh::new(vertices, indices.collect()).expect("finite vertices")
}

fn estimates_of_pieces_hold() {
    let mesh = slivers(2000);
    for (preset, budget) in [
        (BvhOptions::high_quality(), 8.0),
        (BvhOptions::high_quality(), 2.0),
        (BvhOptions::balanced(), 4.0),
    ] {
        let options = preset.with_presplit_budget(budget);
        let whole = options.build_memory(mesh.len());
        for limit in [u64::MAX, 3 * whole] {
            let before = HELD.load(Ordering::Relaxed);
            MOST.store(before, Ordering::Relaxed);
            let control = BuildControl::new().with_memory_limit(limit);
            let (bvh, report) = Bvh::build_with(&mesh, &options, &control).expect("it fits");
            let measured = (MOST.load(Ordering::Relaxed) - before) as u64;
            let estimate = report.estimated_memory;
            let pieces = report.references_per_triangle;
            assert!(pieces > 1.5, "{pieces}");
            assert!(estimate <= limit, "{estimate} of {limit}");
            assert!(
                measured <= estimate && 3 * measured >= estimate,
                "{measured} bytes, not {estimate}: {options:?}, {pieces}"
            );
            drop(bvh);
        }
    }
}

#[test]
fn the_estimate_is_not_below_what_is_allocated_and_not_far_above() {
    // The threads of the pool allocate when they start.
    let warm_up = walk(10_000, 1.0);
    for options in [BvhOptions::fast(), BvhOptions::balanced()] {
        measured(&warm_up, &options);
    }
    estimates_of_pieces_hold();
    for count in [1, 1000, 100_000, 400_000] {
        let mesh = walk(count, 1.0);
        for preset in [
            BvhOptions::fast(),
            BvhOptions::balanced(),
            BvhOptions::high_quality(),
            BvhOptions::fast().with_node_format(NodeFormat::Quantised),
        ] {
            for leaf_size in [1, 4, 8] {
                let options = preset.clone().with_max_leaf_size(leaf_size);
                let estimate = options.build_memory(mesh.len());
                let measured = measured(&mesh, &options);
                assert!(
                    measured <= estimate,
                    "{measured} bytes, not {estimate}: {options:?}, {count} triangles"
                );
                // Here nothing is worth a spatial split: the budget for them stays unused.
                let factor = if options.spatial_split_budget > 1.0 {
                    3
                } else {
                    2
                };
                assert!(
                    factor * measured >= estimate || count < 100_000,
                    "{measured} bytes, not {estimate}: {options:?}, {count} triangles"
                );
            }
        }
    }
}
