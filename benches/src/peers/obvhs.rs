//! obvhs: a binary BVH and a compressed eight-wide one, both in Rust.

use std::time::Duration;

use anyhow::Result;
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::cwbvh::node::CwBvhNode;
use obvhs::ray::{Ray as ObvhsRay, RayHit};
use obvhs::rt_triangle::RtTriangle;
use obvhs::triangle::Triangle;
use tahko_tracer::geometry::{Hit, Ray, TriangleMesh};

use super::{RUST_SIMD, refuse_empty, single};
use crate::contender::{Built, Contender, Recipe};
use crate::report;

type Parameters = fn() -> BvhBuildParams;

/// The presets, with the names that the library gives them.
const PRESETS: [(&str, Parameters); 2] = [
    ("medium", BvhBuildParams::medium_build),
    ("very_slow", BvhBuildParams::very_slow_build),
];

pub(super) fn recipes() -> Vec<Box<dyn Recipe>> {
    let mut recipes: Vec<Box<dyn Recipe>> = Vec::new();
    for layout in [Layout::Binary, Layout::Compressed] {
        for (preset, parameters) in PRESETS {
            recipes.push(Box::new(Obvhs {
                layout,
                preset,
                parameters,
            }));
        }
    }
    recipes
}

#[derive(Clone, Copy)]
enum Layout {
    Binary,
    Compressed,
}

struct Obvhs {
    layout: Layout,
    preset: &'static str,
    parameters: Parameters,
}

impl Recipe for Obvhs {
    fn names(&self) -> Vec<report::Contender> {
        let structure = match self.layout {
            Layout::Binary => "bvh2",
            Layout::Compressed => "cwbvh",
        };
        vec![single("obvhs", structure, self.preset, RUST_SIMD)]
    }

    fn build(&self, mesh: &TriangleMesh, _threads: usize) -> Result<Built> {
        refuse_empty(mesh)?;
        let triangles: Vec<Triangle> = mesh
            .triangles()
            .map(|triangle| {
                let [v0, v1, v2] = triangle.vertices().map(Into::into);
                Triangle { v0, v1, v2 }
            })
            .collect();
        let parameters = (self.parameters)();
        let unused = &mut Duration::default();
        let (contender, bytes) = match self.layout {
            Layout::Binary => {
                let tree = build_bvh2_from_tris(&triangles, parameters, unused);
                let bytes = size_of::<Bvh2Node>() * tree.nodes.len();
                in_leaf_order(tree, &triangles, bytes)
            }
            Layout::Compressed => {
                let tree = build_cwbvh_from_tris(&triangles, parameters, unused);
                let bytes = size_of::<CwBvhNode>() * tree.nodes.len();
                in_leaf_order(tree, &triangles, bytes)
            }
        };
        Ok(Built {
            contenders: vec![contender],
            bytes: Some(bytes),
            tree: None,
        })
    }
}

/// Copies the triangles into the order of the leaves, as the examples of the library advise, and adds their memory.
fn in_leaf_order(
    tree: impl Tree + 'static,
    triangles: &[Triangle],
    node_bytes: usize,
) -> (Box<dyn Contender>, usize) {
    let indices = tree.primitive_indices();
    let triangles: Box<[RtTriangle]> = indices
        .iter()
        .map(|index| RtTriangle::from(&triangles[*index as usize]))
        .collect();
    let bytes = node_bytes + size_of_val(indices) + size_of_val(&*triangles);
    (Box::new(Traced { tree, triangles }), bytes)
}

/// The two layouts have functions of the same names.
trait Tree: Send + Sync {
    fn primitive_indices(&self) -> &[u32];
    fn closest(&self, ray: ObvhsRay, hit: &mut RayHit, triangles: &[RtTriangle]) -> bool;
    fn misses(&self, ray: ObvhsRay, triangles: &[RtTriangle]) -> bool;
}

impl Tree for Bvh2 {
    fn primitive_indices(&self) -> &[u32] {
        &self.primitive_indices
    }

    #[inline]
    fn closest(&self, ray: ObvhsRay, hit: &mut RayHit, triangles: &[RtTriangle]) -> bool {
        self.ray_traverse(ray, hit, |ray, index| triangles[index].intersect(ray))
    }

    #[inline]
    fn misses(&self, ray: ObvhsRay, triangles: &[RtTriangle]) -> bool {
        self.ray_traverse_miss(ray, |ray, index| triangles[index].intersect(ray))
    }
}

impl Tree for CwBvh {
    fn primitive_indices(&self) -> &[u32] {
        &self.primitive_indices
    }

    #[inline]
    fn closest(&self, ray: ObvhsRay, hit: &mut RayHit, triangles: &[RtTriangle]) -> bool {
        self.ray_traverse(ray, hit, |ray, index| triangles[index].intersect(ray))
    }

    #[inline]
    fn misses(&self, ray: ObvhsRay, triangles: &[RtTriangle]) -> bool {
        self.ray_traverse_miss(ray, |ray, index| triangles[index].intersect(ray))
    }
}

struct Traced<T> {
    tree: T,
    triangles: Box<[RtTriangle]>,
}

impl<T: Tree> Contender for Traced<T> {
    fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        for (ray, hit) in rays.iter().zip(hits) {
            let ray = converted(ray);
            let mut found = RayHit::none();
            *hit = self
                .tree
                .closest(ray, &mut found, &self.triangles)
                .then(|| {
                    let index = found.primitive_id as usize;
                    let weights = self.triangles[index].compute_barycentric(&ray);
                    Hit {
                        t: found.t,
                        u: weights.x,
                        v: weights.y,
                        primitive: self.tree.primitive_indices()[index],
                    }
                });
        }
    }

    fn any_hits(&self, rays: &[Ray], found: &mut [bool]) {
        for (ray, found) in rays.iter().zip(found) {
            *found = !self.tree.misses(converted(ray), &self.triangles);
        }
    }
}

fn converted(ray: &Ray) -> ObvhsRay {
    ObvhsRay::new(
        ray.origin.into(),
        ray.direction.into(),
        ray.t_min,
        ray.t_max,
    )
}
