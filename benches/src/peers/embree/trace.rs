//! Rays through a scene of Embree: one by one, or in packets.

use std::ptr;
use std::sync::Arc;

use tahko_tracer::geometry::{Hit, Ray};

use super::denormals::FlushDenormals;
use super::ffi::{self, Arguments, HitPacket, INVALID_ID, RayHitPacket, RayPacket, Valid};
use super::scene::Scene;
use crate::contender::Contender;
use crate::report::RayClass;

/// A call per ray.
pub(super) struct Single(pub(super) Arc<Scene>);

impl Contender for Single {
    fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        let _flush = FlushDenormals::new();
        let scene = &*self.0;
        for (ray, hit) in rays.iter().zip(hits) {
            let mut traced = ffi::RayHit {
                ray: converted(ray),
                hit: NO_HIT,
            };
            // SAFETY: the scene is committed, and the ray is on the stack and aligned. No arguments stand for the defaults.
            unsafe {
                (scene.embree.functions.intersect1)(scene.handle, &raw mut traced, ptr::null());
            }
            *hit = (traced.hit.geometry != INVALID_ID).then_some(Hit {
                t: traced.ray.t_far,
                u: traced.hit.u,
                v: traced.hit.v,
                primitive: traced.hit.primitive,
            });
        }
    }

    fn any_hits(&self, rays: &[Ray], found: &mut [bool]) {
        let _flush = FlushDenormals::new();
        let scene = &*self.0;
        for (ray, found) in rays.iter().zip(found) {
            let mut traced = converted(ray);
            // SAFETY: as in `closest_hits`.
            unsafe {
                (scene.embree.functions.occluded1)(scene.handle, &raw mut traced, ptr::null());
            }
            *found = is_occluded(traced.t_far);
        }
    }
}

const NO_HIT: ffi::Hit = ffi::Hit {
    normal: [0.0; 3],
    u: 0.0,
    v: 0.0,
    primitive: INVALID_ID,
    geometry: INVALID_ID,
    instance: INVALID_ID,
    instance_primitive: INVALID_ID,
};

fn converted(ray: &Ray) -> ffi::Ray {
    ffi::Ray {
        origin: ray.origin.to_array(),
        t_near: ray.t_min,
        direction: ray.direction.to_array(),
        time: 0.0,
        t_far: ray.t_max,
        mask: u32::MAX,
        id: 0,
        flags: 0,
    }
}

/// The library says so by setting the end of the ray to negative infinity.
fn is_occluded(t_far: f32) -> bool {
    t_far == f32::NEG_INFINITY
}

/// A call per packet of `N` rays that follow each other, with the flag for coherent rays.
pub(super) struct Packets<const N: usize>(pub(super) Arc<Scene>);

/// The functions for packets of a size.
pub(super) trait PacketSize<const N: usize> {
    fn intersect(&self, valid: &Valid<N>, packet: &mut RayHitPacket<N>);
    fn occluded(&self, valid: &Valid<N>, packet: &mut RayPacket<N>);
}

impl PacketSize<8> for Scene {
    fn intersect(&self, valid: &Valid<8>, packet: &mut RayHitPacket<8>) {
        // SAFETY: the scene is committed; mask and packet have the layout and alignment of `RTCRayHit8`.
        unsafe {
            (self.embree.functions.intersect8)(valid, self.handle, packet, &Arguments::COHERENT);
        }
    }

    fn occluded(&self, valid: &Valid<8>, packet: &mut RayPacket<8>) {
        // SAFETY: as in `intersect`, for `RTCRay8`.
        unsafe {
            (self.embree.functions.occluded8)(valid, self.handle, packet, &Arguments::COHERENT);
        }
    }
}

impl PacketSize<16> for Scene {
    fn intersect(&self, valid: &Valid<16>, packet: &mut RayHitPacket<16>) {
        // SAFETY: the scene is committed; mask and packet have the layout and alignment of `RTCRayHit16`.
        unsafe {
            (self.embree.functions.intersect16)(valid, self.handle, packet, &Arguments::COHERENT);
        }
    }

    fn occluded(&self, valid: &Valid<16>, packet: &mut RayPacket<16>) {
        // SAFETY: as in `intersect`, for `RTCRay16`.
        unsafe {
            (self.embree.functions.occluded16)(valid, self.handle, packet, &Arguments::COHERENT);
        }
    }
}

impl<const N: usize> Contender for Packets<N>
where
    Scene: PacketSize<N>,
{
    fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        let _flush = FlushDenormals::new();
        let mut packet = RayHitPacket {
            ray: no_rays(),
            hit: no_hits(),
        };
        for (rays, hits) in rays.chunks(N).zip(hits.chunks_mut(N)) {
            let valid = fill(&mut packet.ray, rays);
            packet.hit.geometry = [INVALID_ID; N];
            self.0.intersect(&valid, &mut packet);
            for (lane, hit) in hits.iter_mut().enumerate() {
                *hit = (packet.hit.geometry[lane] != INVALID_ID).then(|| Hit {
                    t: packet.ray.t_far[lane],
                    u: packet.hit.u[lane],
                    v: packet.hit.v[lane],
                    primitive: packet.hit.primitive[lane],
                });
            }
        }
    }

    fn any_hits(&self, rays: &[Ray], found: &mut [bool]) {
        let _flush = FlushDenormals::new();
        let mut packet = no_rays();
        for (rays, found) in rays.chunks(N).zip(found.chunks_mut(N)) {
            let valid = fill(&mut packet, rays);
            self.0.occluded(&valid, &mut packet);
            for (found, t_far) in found.iter_mut().zip(packet.t_far) {
                *found = is_occluded(t_far);
            }
        }
    }

    /// Rays that follow each other in the other classes have nothing in common.
    fn answers(&self, class: RayClass) -> bool {
        matches!(class, RayClass::Primary | RayClass::Shadow)
    }
}

fn no_rays<const N: usize>() -> RayPacket<N> {
    RayPacket {
        origin: [[0.0; N]; 3],
        t_near: [0.0; N],
        direction: [[0.0; N]; 3],
        time: [0.0; N],
        t_far: [0.0; N],
        mask: [u32::MAX; N],
        id: [0; N],
        flags: [0; N],
    }
}

fn no_hits<const N: usize>() -> HitPacket<N> {
    HitPacket {
        normal: [[0.0; N]; 3],
        u: [0.0; N],
        v: [0.0; N],
        primitive: [INVALID_ID; N],
        geometry: [INVALID_ID; N],
        instance: [INVALID_ID; N],
        instance_primitive: [INVALID_ID; N],
    }
}

/// Puts at most `N` rays into the lanes of a packet, and says which lanes have one.
fn fill<const N: usize>(packet: &mut RayPacket<N>, rays: &[Ray]) -> Valid<N> {
    let mut valid = Valid([0; N]);
    for (lane, ray) in rays.iter().enumerate() {
        for axis in 0..3 {
            packet.origin[axis][lane] = ray.origin[axis];
            packet.direction[axis][lane] = ray.direction[axis];
        }
        packet.t_near[lane] = ray.t_min;
        packet.t_far[lane] = ray.t_max;
        valid.0[lane] = -1;
    }
    valid
}
