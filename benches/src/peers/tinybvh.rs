//! tinybvh, C++, through the binding tinybvh-rs: its eight-wide BVH for processors.
#![expect(
    unsafe_code,
    reason = "the binding leaves out which types threads may share"
)]

use anyhow::{Result, anyhow};
use tahko_tracer::geometry::{Hit, Ray, TriangleMesh};
use tinybvh_rs::{INFINITE, Intersection, Intersector, Ray as TinyRay, bvh, bvh8_cpu, mbvh};

use super::{refuse_empty, single};
use crate::contender::{Built, Contender, Recipe};
use crate::report;

/// Triangles that a leaf of the eight-wide layout holds.
const LEAF: u32 = 4;

pub(super) fn recipes(has_spatial_splits: bool) -> Vec<Box<dyn Recipe>> {
    let preset = if has_spatial_splits {
        Preset::SpatialSplits
    } else {
        Preset::Plain
    };
    vec![Box::new(TinyBvh(preset))]
}

#[derive(Clone, Copy)]
enum Preset {
    Plain,
    SpatialSplits,
}

struct TinyBvh(Preset);

impl Recipe for TinyBvh {
    fn names(&self) -> Vec<report::Contender> {
        let preset = match self.0 {
            Preset::Plain => "plain",
            Preset::SpatialSplits => "hq",
        };
        vec![single("tinybvh", "bvh8_cpu", preset, "native")]
    }

    fn build(&self, mesh: &TriangleMesh, _threads: usize) -> Result<Built> {
        refuse_empty(mesh)?;
        let positions: Vec<[f32; 4]> = mesh
            .triangles()
            .flat_map(|triangle| triangle.vertices())
            .map(|vertex| vertex.extend(0.0).to_array())
            .collect();
        let positions = positions.as_slice().into();
        let mut binary = match self.0 {
            Preset::Plain => bvh::BVH::new(positions),
            Preset::SpatialSplits => bvh::BVH::new_hq(positions),
        }
        .map_err(refused)?;
        binary.split_leaves(LEAF);
        let intermediate = mbvh::BVH::new(&binary);
        let wide = bvh8_cpu::BVH::new(&intermediate).map_err(refused)?;
        Ok(Built {
            contenders: vec![Box::new(Traced(wide))],
            bytes: None,
            tree: None,
        })
    }
}

/// The errors of the binding do not implement [`std::error::Error`].
fn refused(error: tinybvh_rs::Error) -> anyhow::Error {
    anyhow!("tinybvh refuses the mesh: {error}")
}

struct Traced(bvh8_cpu::BVH);

// SAFETY: the C++ object owns its nodes and triangles on the heap and refers to no thread: it can be used and freed on another.
unsafe impl Send for Traced {}
// SAFETY: the only function called through a shared reference is `BVH8_CPU::Intersect`, which is `const` in C++: it reads nodes and triangles
// and writes only to its own stack and to the ray that it is given.
unsafe impl Sync for Traced {}

/// A ray with all of the memory that it has in C++: 128 bytes, on a boundary of 64.
///
/// The binding declares the first half, up to the hit; what follows is for users. Its own constructor copies all of it into the half
/// that it declares, and is not used for that reason.
#[repr(C, align(64))]
struct WholeRay {
    ray: TinyRay,
    user_data: [u64; 8],
}

const _: () = assert!(size_of::<WholeRay>() == 128, "as in tiny_bvh.h");

impl Traced {
    /// The library starts at `t = 0` and has no other least `t`: the origin is moved there.
    #[inline]
    fn closest(&self, ray: &Ray) -> Option<Intersection> {
        let origin = if ray.t_min == 0.0 {
            ray.origin
        } else {
            ray.at(ray.t_min)
        };
        let reciprocal = ray.direction.to_array().map(reciprocal);
        let [x, y, z] = reciprocal.map(f32::abs);
        let mut whole = WholeRay {
            ray: TinyRay {
                origin: origin.to_array(),
                dir: ray.direction.to_array(),
                r_d: reciprocal,
                hit: Intersection {
                    t: (ray.t_max - ray.t_min).min(FARTHEST * x.min(y).min(z)),
                    u: 0.0,
                    v: 0.0,
                    prim: u32::MAX,
                },
                ..TinyRay::default()
            },
            user_data: [0; 8],
        };
        self.0.intersect(&mut whole.ray);
        let hit = whole.ray.hit;
        (hit.prim != u32::MAX).then_some(Intersection {
            t: hit.t + ray.t_min,
            ..hit
        })
    }
}

/// Rays end before a coordinate gets as large as this. The library gives the empty places of a node a box at 1e30 in all coordinates: a
/// diagonal ray that reaches it makes the library read wild memory.
const FARTHEST: f32 = 1e29;

/// As the library takes it, so that directions along an axis give no NaN.
fn reciprocal(x: f32) -> f32 {
    if x.abs() > 1e-12 {
        1.0 / x
    } else if x >= 0.0 {
        INFINITE
    } else {
        -INFINITE
    }
}

impl Contender for Traced {
    fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.closest(ray).map(|hit| Hit {
                t: hit.t,
                u: hit.u,
                v: hit.v,
                primitive: hit.prim,
            });
        }
    }

    fn any_hits(&self, rays: &[Ray], found: &mut [bool]) {
        for (ray, found) in rays.iter().zip(found) {
            *found = self.closest(ray).is_some();
        }
    }
}
