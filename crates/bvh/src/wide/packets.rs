//! The packets of a batch of coherent rays.

use tahko_geometry::simd::{Simd, WithSimd, bits_of};
use tahko_geometry::{HitCollector, Ray, TriangleKernel};

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
            let mut octants = [None; SIZE];
            for (place, ray) in octants.iter_mut().zip(rays) {
                *place = octant(ray);
            }
            let mut left = u64::MAX >> (SIZE - rays.len());
            while left != 0 {
                let octant = octants[left.trailing_zeros() as usize % SIZE];
                let members = left & places_of(octant, &octants);
                left &= !members;
                match octant {
                    Some(negative)
                        if members.count_ones() >= FEWEST && bvh.root != Child::NOTHING =>
                    {
                        for index in bits_of(members) {
                            packet.push(&rays[index]);
                        }
                        simd.outline(PacketSearch {
                            bvh,
                            packet: &mut packet,
                            negative: u32::from(negative),
                        });
                        for (index, mut search) in bits_of(members).zip(packet.drain()) {
                            answers[index] = search.collector.finish::<K, ()>(search.ray, &mut ());
                        }
                    }
                    _ => {
                        for index in bits_of(members) {
                            answers[index] = search_one::<S, K, H, N>(simd, bvh, &rays[index]);
                        }
                    }
                }
            }
        }
    }
}

/// The octant that a ray goes into, if it may be in a packet: bit `i` is set for a negative direction along axis `i`.
#[inline(always)]
fn octant(ray: &Ray) -> Option<u8> {
    let octant = (ray.direction.is_negative_bitmask() & 7) as u8;
    (ray.is_valid() & (ray.t_min >= 0.0)).then_some(octant)
}

/// A bit for each ray of an octant.
#[inline(always)]
fn places_of(octant: Option<u8>, octants: &[Option<u8>; SIZE]) -> u64 {
    let places = octants.iter().enumerate();
    places.fold(0, |members, (place, other)| {
        members | u64::from(*other == octant) << place
    })
}

#[cfg(test)]
mod tests {
    use tahko_geometry::glam::Vec3;
    use tahko_geometry::test_support::invalid_rays;

    use super::*;

    #[test]
    fn rays_of_an_octant_find_each_other() {
        let directions = [
            (Vec3::new(1.0, 2.0, 0.0), 0),
            (Vec3::new(-1.0, 2.0, 3.0), 1),
            (Vec3::new(1.0, -2.0, -0.0), 6),
            (Vec3::new(2.0, 1.0, 5.0), 0),
        ];
        let mut octants = [None; SIZE];
        for (place, (direction, expected)) in directions.into_iter().enumerate() {
            octants[place] = octant(&Ray::new(Vec3::ONE, direction));
            assert_eq!(octants[place], Some(expected), "{direction}");
        }
        assert_eq!(places_of(Some(0), &octants), 0b1001);
        assert_eq!(places_of(Some(6), &octants), 0b0100);
        assert_eq!(places_of(Some(5), &octants), 0);
    }

    #[test]
    fn rays_that_begin_behind_their_origin_or_are_not_valid_are_in_no_packet() {
        let good = Ray::new(Vec3::ZERO, Vec3::ONE);
        let behind = Ray {
            t_min: -1.0,
            ..good
        };
        assert_eq!(octant(&behind), None);
        assert!(
            invalid_rays(good).iter().all(|ray| octant(ray).is_none()),
            "not valid"
        );
    }
}
