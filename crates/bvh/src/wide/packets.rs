//! The packets of a batch of coherent rays.

use tahko_geometry::simd::{LANES, Simd, WithSimd, bits_of};
use tahko_geometry::{HitCollector, RayLanes, TriangleKernel};

use super::Child;
use super::batch::{Batch, search_one};
use super::node::Node;
use super::packet::{Packet, PacketSearch, SIZE};

/// Rays at least for a packet; fewer are searched one by one.
const FEWEST: u32 = 8;

/// The searches of a batch, whose neighbours make up packets as far as they go into the same octant.
pub(super) struct Packets<'a, K: TriangleKernel, H: HitCollector, N>(pub(super) Batch<'a, K, H, N>);

impl<K: TriangleKernel, H: HitCollector, N: Node> WithSimd for Packets<'_, K, H, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Batch {
            bvh, rays, answers, ..
        } = self.0;
        let mut packet = Packet::<K, H>::new();
        for (rays, answers) in rays.chunks(SIZE).zip(answers.chunks_mut(SIZE)) {
            packet.fill(simd, rays);
            let octants = Octants::new(simd, packet.rays());
            let all = u64::MAX >> (SIZE - rays.len());
            let mut left = all;
            while left != 0 {
                let first = left.trailing_zeros();
                let members = left & octants.places_like(first);
                left &= !members;
                if let Some(negative) = octants.of(first)
                    && members.count_ones() >= FEWEST
                    && bvh.root != Child::NOTHING
                {
                    if members != all {
                        packet.fill_with(rays, members);
                    }
                    simd.outline(PacketSearch {
                        bvh,
                        packet: &mut packet,
                        negative,
                    });
                    packet.finish(simd, |index, answer| answers[index] = answer);
                } else {
                    for index in bits_of(members) {
                        answers[index] = search_one::<S, K, H, N>(simd, bvh, &rays[index]);
                    }
                }
            }
        }
    }
}

/// The octants that rays go into, a bit for each ray.
struct Octants {
    /// Those that may be in a packet.
    members: u64,
    /// By axis: those with a negative direction.
    negative: [u64; 3],
}

impl Octants {
    #[inline(always)]
    fn new<'r, S: Simd>(simd: S, rays: impl Iterator<Item = &'r RayLanes>) -> Self {
        let mut octants = Self {
            members: 0,
            negative: [0; 3],
        };
        for (group, rays) in rays.enumerate() {
            let found = rays.octants(simd);
            octants.members |= u64::from(found.members) << (LANES * group);
            for (all, lanes) in octants.negative.iter_mut().zip(found.negative) {
                *all |= u64::from(lanes) << (LANES * group);
            }
        }
        octants
    }

    /// The octant of a ray that may be in a packet: bit `i` is set for a negative direction along axis `i`.
    #[inline(always)]
    fn of(&self, place: u32) -> Option<u32> {
        let [x, y, z] = self.negative.map(|negative| (negative >> place & 1) as u32);
        (self.members >> place & 1 != 0).then_some(x | y << 1 | z << 2)
    }

    /// The rays that may be in a packet with one; with one that may not, all that may not.
    #[inline(always)]
    fn places_like(&self, place: u32) -> u64 {
        if self.members >> place & 1 == 0 {
            return !self.members;
        }
        self.negative.iter().fold(self.members, |places, negative| {
            let is_negative = 0u64.wrapping_sub(negative >> place & 1);
            places & !(negative ^ is_negative)
        })
    }
}

#[cfg(test)]
mod tests {
    use tahko_geometry::Ray;
    use tahko_geometry::glam::Vec3;
    use tahko_geometry::simd::{SimdLevel, WithSimd};

    use super::*;

    struct OctantsOf<'a>(&'a [RayLanes]);

    impl WithSimd for OctantsOf<'_> {
        type Output = Octants;

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) -> Octants {
            Octants::new(simd, self.0.iter())
        }
    }

    #[test]
    fn rays_of_an_octant_find_each_other() {
        let directions = [
            (Vec3::new(1.0, 2.0, 0.0), Some(0)),
            (Vec3::new(-1.0, 2.0, 3.0), Some(1)),
            (Vec3::new(1.0, -2.0, -0.0), Some(6)),
            (Vec3::new(2.0, 1.0, 5.0), Some(0)),
            (Vec3::ZERO, None),
            (Vec3::splat(f32::NAN), None),
        ];
        let mut lanes = [RayLanes::splat(&Ray::new(Vec3::ONE, Vec3::NEG_ONE)); 2];
        for (place, (direction, _)) in directions.into_iter().enumerate() {
            lanes[1].set(place, &Ray::new(Vec3::ONE, direction));
        }
        for level in SimdLevel::ALL.into_iter().filter_map(SimdLevel::available) {
            let octants = level.dispatch(OctantsOf(&lanes));
            for (place, (direction, expected)) in (8..).zip(directions) {
                assert_eq!(octants.of(place), expected, "{direction}");
            }
            assert_eq!(octants.places_like(8), 0b1001 << 8);
            assert_eq!(octants.places_like(9), 0b0010 << 8);
            assert_eq!(octants.places_like(10), 0b0100 << 8);
            assert_eq!(octants.places_like(0), 0b1100_0000 << 8 | 0xff);
            assert_eq!(octants.places_like(12) & 0xffff, 0b0011_0000 << 8);
        }
    }
}
