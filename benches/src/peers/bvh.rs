//! bvh: a binary BVH in Rust that gives candidates and leaves the triangle test to its user.

use std::cell::Cell;
use std::sync::Arc;

use anyhow::Result;
use bvh::aabb::{Aabb, Bounded, IntersectsAabb};
use bvh::bounding_hierarchy::{BHShape, BoundingHierarchy};
use bvh::bvh::{Bvh, BvhNode};
use bvh::ray::Ray as BvhRay;
use nalgebra::{Point3, Vector3};
use tahko_tracer::geometry::glam::Vec3;
use tahko_tracer::geometry::{Hit, Ray, TriangleMesh};

use super::moller_trumbore::meet;
use super::{RUST_SIMD, refuse_empty, single};
use crate::contender::{Built, Contender, Recipe};
use crate::report;

/// Entries of the stack of the library's depth-first iterator, which panics when it is full.
const STACK: usize = 32;

pub(super) fn recipes() -> Vec<Box<dyn Recipe>> {
    vec![Box::new(SvenstaroBvh)]
}

struct SvenstaroBvh;

impl Recipe for SvenstaroBvh {
    fn names(&self) -> Vec<report::Contender> {
        ["bvh-nearest", "bvh-depth-first"]
            .map(|structure| single("bvh", structure, "default", RUST_SIMD))
            .into()
    }

    fn build(&self, mesh: &TriangleMesh, _threads: usize) -> Result<Built> {
        refuse_empty(mesh)?;
        let mut shapes: Vec<Shape> = (0..)
            .zip(mesh.triangles())
            .map(|(primitive, triangle)| Shape {
                vertices: triangle.vertices(),
                primitive,
                node: 0,
            })
            .collect();
        let tree = Bvh::build_par(&mut shapes);
        let fits = stack_entries(&tree.nodes) <= STACK;
        if !fits {
            eprintln!(
                "note: the tree of bvh is too deep for its depth-first iterator, which is left out here"
            );
        }
        let bytes = size_of_val(&*tree.nodes) + size_of_val(&*shapes);
        let built = Arc::new(Tree { tree, shapes });
        Ok(Built {
            contenders: vec![
                Box::new(Nearest(Arc::clone(&built))),
                Box::new(DepthFirst { built, fits }),
            ],
            bytes: Some(bytes),
            tree: None,
        })
    }
}

/// A triangle as the library wants it. The vertices are kept as they are, since its boxes are made from them.
struct Shape {
    vertices: [Vec3; 3],
    primitive: u32,
    node: usize,
}

impl Bounded<f32, 3> for Shape {
    fn aabb(&self) -> Aabb<f32, 3> {
        let [a, b, c] = self.vertices;
        let (min, max) = (a.min(b).min(c), a.max(b).max(c));
        Aabb::with_bounds(Point3::from(min.to_array()), Point3::from(max.to_array()))
    }
}

impl BHShape<f32, 3> for Shape {
    fn set_bh_node_index(&mut self, index: usize) {
        self.node = index;
    }

    fn bh_node_index(&self) -> usize {
        self.node
    }
}

impl Shape {
    /// The hit with `t` in the ray's interval and below a limit.
    fn hit(&self, ray: &Ray, t_max: f32) -> Option<Hit> {
        let meeting = meet(ray.origin, ray.direction, self.vertices)?;
        let counts = ray.t_min <= meeting.t && meeting.t <= t_max;
        counts.then_some(Hit {
            t: meeting.t,
            u: meeting.u,
            v: meeting.v,
            primitive: self.primitive,
        })
    }
}

struct Tree {
    tree: Bvh<f32, 3>,
    shapes: Vec<Shape>,
}

/// Entries that the depth-first iterator needs: it keeps a node while it is to the left of it, and no longer.
fn stack_entries(nodes: &[BvhNode<f32, 3>]) -> usize {
    let mut most = 0;
    let mut pending = vec![(0, 1)];
    while let Some((node, entries)) = pending.pop() {
        most = most.max(entries);
        if let BvhNode::Node {
            child_l_index,
            child_r_index,
            ..
        } = nodes[node]
        {
            pending.push((child_l_index, entries + 1));
            pending.push((child_r_index, entries));
        }
    }
    most
}

/// The direction stays as it is, so that `t` counts in its lengths. The constructor of the library would normalise it.
fn converted(ray: &Ray) -> BvhRay<f32, 3> {
    BvhRay {
        origin: Point3::from(ray.origin.to_array()),
        direction: Vector3::from(ray.direction.to_array()),
        inv_direction: Vector3::from(ray.direction.recip().to_array()),
    }
}

/// Candidates in the order in which the ray enters their boxes, up to the first box behind the best hit.
struct Nearest(Arc<Tree>);

impl Nearest {
    fn closest(&self, ray: &Ray, stop_at_first: bool) -> Option<Hit> {
        let converted = converted(ray);
        let Tree { tree, shapes } = &*self.0;
        let (mut best, mut t_max) = (None, ray.t_max);
        for shape in tree.nearest_traverse_iterator(&converted, shapes) {
            let slice = converted.intersection_slice_for_aabb(&shape.aabb());
            if slice.is_some_and(|(entry, _)| entry > t_max) {
                break;
            }
            if let Some(hit) = shape.hit(ray, t_max) {
                (best, t_max) = (Some(hit), hit.t);
                if stop_at_first {
                    break;
                }
            }
        }
        best
    }
}

impl Contender for Nearest {
    fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.closest(ray, false);
        }
    }

    fn any_hits(&self, rays: &[Ray], found: &mut [bool]) {
        for (ray, found) in rays.iter().zip(found) {
            *found = self.closest(ray, true).is_some();
        }
    }
}

/// Candidates depth first, with a query that shrinks to the best hit.
struct DepthFirst {
    built: Arc<Tree>,
    /// Whether the iterator's stack is large enough for the tree.
    fits: bool,
}

struct Shrinking<'a> {
    ray: &'a BvhRay<f32, 3>,
    t_max: Cell<f32>,
}

impl IntersectsAabb<f32, 3> for Shrinking<'_> {
    fn intersects_aabb(&self, aabb: &Aabb<f32, 3>) -> bool {
        let slice = self.ray.intersection_slice_for_aabb(aabb);
        slice.is_some_and(|(entry, _)| entry <= self.t_max.get())
    }
}

impl DepthFirst {
    fn closest(&self, ray: &Ray, stop_at_first: bool) -> Option<Hit> {
        if !self.fits {
            return Nearest(Arc::clone(&self.built)).closest(ray, stop_at_first);
        }
        let converted = converted(ray);
        let query = Shrinking {
            ray: &converted,
            t_max: Cell::new(ray.t_max),
        };
        let Tree { tree, shapes } = &*self.built;
        let mut best = None;
        for shape in tree.traverse_iterator(&query, shapes) {
            if let Some(hit) = shape.hit(ray, query.t_max.get()) {
                best = Some(hit);
                query.t_max.set(hit.t);
                if stop_at_first {
                    break;
                }
            }
        }
        best
    }
}

impl Contender for DepthFirst {
    fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.closest(ray, false);
        }
    }

    fn any_hits(&self, rays: &[Ray], found: &mut [bool]) {
        for (ray, found) in rays.iter().zip(found) {
            *found = self.closest(ray, true).is_some();
        }
    }

    fn answers(&self, _class: report::RayClass) -> bool {
        self.fits
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tree of so many inner nodes, each with a leaf on one side.
    fn chain(length: usize, deep_is_left: bool) -> Vec<BvhNode<f32, 3>> {
        let mut nodes = Vec::new();
        for i in 0..length {
            let (leaf, deep) = (2 * i + 1, 2 * i + 2);
            let (child_l_index, child_r_index) = if deep_is_left {
                (deep, leaf)
            } else {
                (leaf, deep)
            };
            nodes.push(BvhNode::Node {
                parent_index: 0,
                child_l_index,
                child_l_aabb: Aabb::infinite(),
                child_r_index,
                child_r_aabb: Aabb::infinite(),
            });
            nodes.push(LEAF);
        }
        nodes.push(LEAF);
        nodes
    }

    const LEAF: BvhNode<f32, 3> = BvhNode::Leaf {
        parent_index: 0,
        shape_index: 0,
    };

    #[test]
    fn only_nodes_with_their_left_side_under_way_need_an_entry() {
        assert_eq!(stack_entries(&[LEAF]), 1);
        assert_eq!(stack_entries(&chain(40, true)), 41);
        assert_eq!(stack_entries(&chain(40, false)), 2);
    }

    #[test]
    fn the_stack_of_the_iterator_is_as_large_as_it_is_taken_to_be() {
        let mut shapes = [Shape {
            vertices: [Vec3::X, Vec3::Y, Vec3::Z],
            primitive: 0,
            node: 0,
        }];
        let ray = Ray::new(Vec3::ZERO, Vec3::ONE);
        let mut tree = Bvh::build(&mut shapes);
        tree.nodes = chain(STACK - 1, true);
        assert_eq!(stack_entries(&tree.nodes), STACK);
        let built = Arc::new(Tree {
            tree,
            shapes: shapes.into(),
        });
        for fits in [true, false] {
            let built = Arc::clone(&built);
            let hit = DepthFirst { built, fits }.closest(&ray, false);
            assert_eq!(hit.map(|hit| hit.t), Some(1.0 / 3.0));
        }
    }
}
