//! Many rays at a time: coherent ones in [packets](super::packets), others in [turns](super::turns).

use std::marker::PhantomData;

use tahko_geometry::glam::Vec3;
use tahko_geometry::simd::{AvailableSimd, Simd};
use tahko_geometry::{HitCollector, Ray, TriangleKernel};

use super::access::View;
use super::node::Node;
use super::packets::Packets;
use super::traverse::search;
use super::turns::Turns;

/// The searches of many rays.
pub(super) struct Batch<'a, K: TriangleKernel, H: HitCollector, N> {
    pub(super) bvh: View<'a, N>,
    pub(super) rays: &'a [Ray],
    pub(super) answers: &'a mut [H::Answer],
    pub(super) kernel: PhantomData<K>,
}

impl<K: TriangleKernel, H: HitCollector, N: Node> Batch<'_, K, H, N> {
    /// Answers all rays, with the instructions of a level.
    pub(super) fn run(self, simd: AvailableSimd) {
        if are_coherent(self.rays, self.bvh.size) {
            simd.dispatch(Packets(self));
        } else {
            simd.dispatch(Turns(self));
        }
    }
}

/// Whether neighbours in a list of rays begin near each other and go nearly the same way, as a sample tells. The limits tell the rays of a camera from bounced
/// ones; they were not tuned further.
fn are_coherent(rays: &[Ray], size: f32) -> bool {
    const SAMPLES: usize = 64;
    let step = (rays.len() / SAMPLES).max(1);
    let pairs = rays.windows(2).step_by(step);
    let count = pairs.len();
    let similar = pairs.filter(|pair| {
        let [first, second] = [&pair[0], &pair[1]];
        let [from, to] = [first.direction, second.direction].map(Vec3::normalize_or_zero);
        let distance = (first.origin - second.origin).length();
        from.dot(to) > 0.99 && distance <= size * 0.05
    });
    2 * similar.count() > count
}

/// The search of a ray; one that is not valid hits nothing.
#[inline(always)]
pub(super) fn search_one<S: Simd, K: TriangleKernel, H: HitCollector, N: Node>(
    simd: S,
    bvh: View<'_, N>,
    ray: &Ray,
) -> H::Answer {
    let mut collector = H::new(ray);
    if ray.is_valid() {
        search::<S, K, H, (), N>(simd, bvh, ray, &mut collector, &mut ());
    }
    collector.finish::<S, K, ()>(simd, ray, &mut ())
}

#[cfg(test)]
mod tests;
