//! What vector kernels say of a block of triangles.

use super::rays::RaysFilter;
use crate::simd::{Lanes, Simd};
use crate::{FusedRay, Ray, TriangleBlock};

/// A ray that is prepared for testing blocks of triangles: a filter before the tests of single triangles.
///
/// It depends on the block and the ray how much it throws out; what it lets through, and what it calls certain, is true of the
/// kernel that it belongs to. So answers do not depend on the level, on blocks, or on what else is in them.
pub trait BlockTest {
    /// What can be said of a block's triangles: `None` if the kernel accepts none of them with `t`, rounded, up to `t_max`.
    fn test<S: Simd>(&self, simd: S, block: &TriangleBlock, t_max: f32) -> Option<BlockVerdict>;

    /// The triangles that the kernel may accept with `t`, rounded, up to `t_max`. There is no branch on what is found: for callers who have other work until it is known.
    fn candidates<S: Simd>(&self, simd: S, block: &TriangleBlock, t_max: f32) -> Candidates;

    /// A bit for each lane whose triangle is one of the [candidates](Self::candidates).
    #[inline(always)]
    fn possible<S: Simd>(&self, simd: S, block: &TriangleBlock, t_max: f32) -> u32 {
        self.candidates(simd, block, t_max).possible
    }

    /// What [`test`](Self::test) says of some lanes that [are left](Self::possible).
    fn judge<S: Simd>(
        &self,
        simd: S,
        block: &TriangleBlock,
        t_max: f32,
        possible: u32,
    ) -> Option<BlockVerdict>;
}

/// A ray prepared alone for testing blocks of triangles.
pub trait BlockFilter: BlockTest + Copy {
    /// The filter of the same kernels for eight rays and one triangle.
    type Rays: RaysFilter;

    /// Prepares a valid ray for triangles inside the bounds that the fused ray was made for.
    fn new(ray: &Ray, fused: &FusedRay) -> Self;
}

/// The triangles of a block that may be hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Candidates {
    /// A bit for each lane whose triangle may be hit; the others are certainly not.
    pub possible: u32,
    /// A bit for some lanes whose triangles the line of the ray meets for certain, at whatever `t`. Lanes that are not possible may have one.
    pub met: u32,
}

impl Candidates {
    /// Candidates of which nothing more is known.
    #[inline(always)]
    pub(super) const fn undecided(possible: u32) -> Self {
        Self { possible, met: 0 }
    }
}

/// What is known of the triangles of a block that may be hit by a ray; or of the rays that may hit a triangle, a lane for each ray.
#[derive(Clone, Copy, Debug)]
pub struct BlockVerdict {
    /// A bit for each lane whose triangle may be hit: not 0. The others are certainly not.
    pub possible: u32,
    /// A bit for each of these whose triangle is certainly hit, with `t` inside the ray's interval.
    pub certain: u32,
    /// For the lanes that are certain, a number not above `t`.
    pub starts: Lanes,
    /// For the lanes that are certain, a number not below `t`.
    pub ends: Lanes,
}

impl BlockVerdict {
    /// Nothing but that some triangles may be hit; `None` if there are none.
    #[inline(always)]
    pub(super) fn undecided(possible: u32) -> Option<Self> {
        (possible != 0).then_some(Self {
            possible,
            certain: 0,
            starts: Lanes::splat(0.0),
            ends: Lanes::splat(0.0),
        })
    }
}
