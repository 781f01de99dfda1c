//! Which planes of a box a ray meets first: by the octant that it goes into.
#![allow(
    unsafe_code,
    reason = "computing and checking six places at every node would be a fifth of its instructions"
)]

use tahko_geometry::simd::Lanes;

/// Where the planes that a ray of an octant meets first, and those that it meets last, are among the planes of boxes: by axis the smallest coordinates, then the largest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlaneOrder {
    /// By axis, in bytes from the beginning of all planes, if those across an axis take a [`Lanes`] each. Invariant: a multiple of its size, for one of six.
    places: [[u32; 2]; 3],
}

/// By octant.
static ORDERS: [PlaneOrder; 8] = [
    PlaneOrder::new(0),
    PlaneOrder::new(1),
    PlaneOrder::new(2),
    PlaneOrder::new(3),
    PlaneOrder::new(4),
    PlaneOrder::new(5),
    PlaneOrder::new(6),
    PlaneOrder::new(7),
];

impl PlaneOrder {
    /// That of rays with the given negative directions, bit `i` for axis `i`: for many nodes, and sooner there than one that is [known](Self::known).
    #[inline(always)]
    pub(crate) const fn new(negative: u32) -> Self {
        Self {
            places: [
                places(0, negative),
                places(1, negative >> 1),
                places(2, negative >> 2),
            ],
        }
    }

    /// The same in fewer instructions: for one node.
    #[inline(always)]
    pub(crate) const fn known(negative: u32) -> &'static Self {
        &ORDERS[(negative & 7) as usize]
    }

    /// Across an axis, the planes that are met first and those that are met last.
    #[inline(always)]
    pub(crate) fn of_axis<'a, T>(&self, planes: &'a [[T; 2]; 3], axis: usize) -> [&'a T; 2] {
        const {
            assert!(
                size_of::<Lanes>().is_multiple_of(size_of::<T>()),
                "places can be told in sizes of it"
            );
        }
        let [first, last] = self.places[axis];
        let all = planes.as_ptr().cast::<T>();
        let at = |place: u32| {
            let place = place as usize / (size_of::<Lanes>() / size_of::<T>());
            // SAFETY: by the invariant this is a multiple of the size of a `T`, below six times as much; and there are six, one after the other.
            unsafe { &*all.byte_add(place) }
        };
        [at(first), at(last)]
    }
}

/// The size of a [`Lanes`].
const SIZE: u32 = 32;
const _: () = assert!(
    SIZE as usize == size_of::<Lanes>(),
    "places are its multiples"
);

/// The places of an axis, for a direction that is negative if the lowest bit says so.
#[inline(always)]
const fn places(axis: u32, negative: u32) -> [u32; 2] {
    let first = negative & 1;
    let second = first ^ 1;
    [SIZE * (2 * axis + first), SIZE * (2 * axis + second)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_of_each_octant_find_the_planes_of_each_axis() {
        let small = [[0u8, 1], [10, 11], [20, 21]];
        let large = small.map(|sides| sides.map(|plane| Lanes::splat(f32::from(plane))));
        for negative in 0..8 {
            for (order, axis) in [PlaneOrder::new(negative), *PlaneOrder::known(negative)]
                .iter()
                .flat_map(|order| [0, 1, 2].map(|axis| (order, axis)))
            {
                let mut expected = small[axis];
                if negative >> axis & 1 != 0 {
                    expected.reverse();
                }
                assert_eq!(
                    order.of_axis(&small, axis),
                    expected.each_ref(),
                    "{negative}, {axis}"
                );
                let found = order.of_axis(&large, axis).map(|lanes| lanes.0[7]);
                assert_eq!(found, expected.map(f32::from), "{negative}, {axis}");
            }
        }
    }
}
