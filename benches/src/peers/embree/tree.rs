//! What Embree's trees are expected to cost.
//!
//! Its scenes do not show their trees. The same builders are open to programs that bring nodes of their own, though (`rtcBuildBVH`), and get here the settings that scenes of triangles
//! have by default: eight children, blocks of four triangles, and in high quality room for a fifth more references, with triangles clipped exactly.

use std::collections::BTreeSet;
use std::ffi::{c_int, c_uint, c_void};
use std::ptr;

use anyhow::{Result, ensure};
use tahko_bvh::BvhOptions;
use tahko_tracer::geometry::glam::{DVec3, Vec3};
use tahko_tracer::geometry::{Aabb, ClippedTriangle, ExpectedVisits, TriangleMesh};

use super::denormals::FlushDenormals;
use super::ffi::{self, BuildArguments, BuildPrimitive};
use super::scene::{Embree, Settings};
use crate::report::TreeRow;

/// Triangles in a block, by which scenes count what a leaf costs.
const BLOCK: c_uint = 4;
/// The most blocks in a leaf of a scene.
const MAX_BLOCKS: c_uint = 7;
/// References for each triangle for which spatial splits have room in scenes.
const REPLICATION: f64 = 1.2;

/// A node or a leaf. Leaves have no children.
#[derive(Default)]
struct Node {
    bounds: Vec<Aabb>,
    children: Vec<*mut Self>,
    triangles: usize,
}

/// Builds the tree of a mesh with at most so many threads and measures it.
pub(super) fn measure(
    embree: &Embree,
    mesh: &TriangleMesh,
    settings: Settings,
    threads: usize,
) -> Result<TreeRow> {
    let root = build(embree, mesh, settings.quality, threads)?;
    let costs = BvhOptions::default();
    let node_cost = costs.traversal_cost / costs.intersection_cost;
    let bounds = mesh.aabb();
    let mut visits = ExpectedVisits::default();
    let (mut nodes, mut references, mut depth) = (0, 0, 0);
    let mut pending = vec![(root, bounds, 1)];
    while let Some((node, box_of_node, level)) = pending.pop() {
        let probability = ExpectedVisits::probability(box_of_node.half_area(), bounds.half_area());
        nodes += 1;
        depth = depth.max(level);
        if node.children.is_empty() {
            references += node.triangles;
            visits.add_leaf(probability, node.triangles);
        } else {
            visits.add_inner_node(probability);
        }
        for (child, bounds) in node.children.iter().zip(&node.bounds) {
            // SAFETY: `create_node` or `create_leaf` made it, and a tree has each of its nodes once.
            let child = unsafe { Box::from_raw(*child) };
            pending.push((child, *bounds, level + 1));
        }
    }
    Ok(TreeRow {
        nodes,
        depth,
        references_per_triangle: references as f64 / mesh.len() as f64,
        sah_cost: visits.cost(node_cost),
        end_point_overlap: None,
        expected_inner_nodes: visits.inner_nodes,
        expected_leaves: visits.leaves,
        expected_triangle_tests: visits.triangle_tests,
    })
}

fn build(
    embree: &Embree,
    mesh: &TriangleMesh,
    quality: c_int,
    threads: usize,
) -> Result<Box<Node>> {
    let capacity = if quality == ffi::BUILD_HIGH {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "little more than a number of triangles"
        )]
        let capacity = (mesh.len() as f64 * REPLICATION) as usize;
        capacity
    } else {
        mesh.len()
    };
    let mut primitives: Vec<BuildPrimitive> = Vec::with_capacity(capacity);
    for (index, triangle) in (0..).zip(mesh.triangles()) {
        let bounds = triangle.aabb();
        primitives.push(BuildPrimitive {
            lower: bounds.min.to_array(),
            geometry: 0,
            upper: bounds.max.to_array(),
            primitive: index,
        });
    }
    let filler = primitives.first().copied();
    primitives.extend(filler.into_iter().cycle().take(capacity - mesh.len()));

    let device = embree.device(threads)?;
    let functions = &embree.functions;
    let _flush = FlushDenormals::new();
    // SAFETY: the device lives as long as the program.
    let hierarchy = unsafe { (functions.new_hierarchy)(device.handle) };
    let arguments = BuildArguments {
        byte_size: size_of::<BuildArguments>(),
        quality,
        flags: 0,
        max_branching_factor: 8,
        max_depth: 64,
        sah_block_size: BLOCK,
        min_leaf_size: BLOCK,
        max_leaf_size: BLOCK * MAX_BLOCKS,
        traversal_cost: 1.0,
        intersection_cost: 1.0,
        hierarchy,
        primitives: primitives.as_mut_ptr(),
        primitive_count: mesh.len(),
        primitive_capacity: capacity,
        create_node,
        set_node_children,
        set_node_bounds,
        create_leaf,
        split_primitive,
        progress: ptr::null(),
        user: ptr::from_ref(mesh).cast_mut().cast(),
    };
    // SAFETY: the list has room for the capacity that is given, and it and the mesh outlive the call; the functions are those below.
    let root = unsafe { (functions.build_hierarchy)(&raw const arguments) };
    // SAFETY: made above; nodes are not in its memory.
    unsafe { (functions.release_hierarchy)(hierarchy) };
    ensure!(!root.is_null(), "Embree builds no tree of its own");
    // SAFETY: `create_node` or `create_leaf` made it.
    Ok(unsafe { Box::from_raw(root.cast::<Node>()) })
}

fn leaked(node: Node) -> *mut c_void {
    Box::into_raw(Box::new(node)).cast()
}

unsafe extern "C" fn create_node(_: *mut c_void, _: c_uint, _: *mut c_void) -> *mut c_void {
    leaked(Node::default())
}

/// # Safety
/// `node` is of `create_node`, and there are so many children.
unsafe extern "C" fn set_node_children(
    node: *mut c_void,
    children: *const *mut c_void,
    count: c_uint,
    _: *mut c_void,
) {
    // SAFETY: as Embree promises; a node is given to one thread at a time.
    let (node, children) = unsafe {
        let children = std::slice::from_raw_parts(children, count as usize);
        (&mut *node.cast::<Node>(), children)
    };
    node.children = children.iter().map(|child| child.cast()).collect();
}

/// # Safety
/// `node` is of `create_node`, and there are so many boxes.
unsafe extern "C" fn set_node_bounds(
    node: *mut c_void,
    bounds: *const *const ffi::Bounds,
    count: c_uint,
    _: *mut c_void,
) {
    // SAFETY: as Embree promises; a node is given to one thread at a time.
    let (node, bounds) = unsafe {
        let bounds = std::slice::from_raw_parts(bounds, count as usize);
        (&mut *node.cast::<Node>(), bounds)
    };
    let boxes = bounds.iter().map(|bounds| {
        // SAFETY: as Embree promises.
        let ffi::Bounds { lower, upper } = unsafe { **bounds };
        Aabb::new(Vec3::from_slice(&lower), Vec3::from_slice(&upper))
    });
    node.bounds = boxes.collect();
}

/// # Safety
/// There are so many primitives.
unsafe extern "C" fn create_leaf(
    _: *mut c_void,
    primitives: *const BuildPrimitive,
    count: usize,
    _: *mut c_void,
) -> *mut c_void {
    // SAFETY: as Embree promises.
    let primitives = unsafe { std::slice::from_raw_parts(primitives, count) };
    // Parts of a triangle are one triangle to test.
    let triangles: BTreeSet<c_uint> = primitives.iter().map(|part| part.primitive).collect();
    leaked(Node {
        triangles: triangles.len(),
        ..Node::default()
    })
}

/// The boxes of a part of a triangle on both sides of a plane across an axis.
///
/// # Safety
/// `primitive` is one of those that the build was given, or a part of it, and `user` is their mesh.
unsafe extern "C" fn split_primitive(
    primitive: *const BuildPrimitive,
    axis: c_uint,
    position: f32,
    left: *mut ffi::Bounds,
    right: *mut ffi::Bounds,
    user: *mut c_void,
) {
    // SAFETY: as above.
    let (part, mesh) = unsafe { (&*primitive, &*user.cast::<TriangleMesh>()) };
    let triangle = ClippedTriangle::new(&mesh.triangle(part.primitive as usize));
    let [lower, upper] = [part.lower, part.upper].map(Vec3::from);
    let plane = |corner: Vec3| {
        let mut corner = corner.as_dvec3();
        corner[axis as usize] = f64::from(position);
        corner
    };
    let sides = [
        (lower.as_dvec3(), plane(upper)),
        (plane(lower), upper.as_dvec3()),
    ];
    for (side, (min, max)) in [left, right].into_iter().zip(sides) {
        // SAFETY: Embree gives room for both boxes.
        unsafe { *side = bounds_of(&triangle, min, max) };
    }
}

/// The box of the part of a triangle between two corners.
fn bounds_of(triangle: &ClippedTriangle, min: DVec3, max: DVec3) -> ffi::Bounds {
    let part = triangle.in_box(min, max);
    let (mut lower, mut upper) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for vertex in part.vertices() {
        lower = lower.min(vertex.position);
        upper = upper.max(vertex.position);
    }
    ffi::Bounds {
        lower: lower.as_vec3().extend(0.0).to_array(),
        upper: upper.as_vec3().extend(0.0).to_array(),
    }
}
