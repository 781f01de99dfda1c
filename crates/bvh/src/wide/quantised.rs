//! Nodes whose boxes are rounded outward to a grid of 8 bits: three eighths of the memory.
//!
//! Source: Ylitie, Karras, Laine, "Efficient incoherent ray traversal on GPUs through compressed wide BVHs", 2017, section 3.2. There the planes are not decoded before
//! the test: the grid is folded into the ray. Here they are, so that the test is the one that is proven, and a box is what it was checked to be.
//!
//! **Equal bits.** A plane is `steps * step + origin`. The step is a power of two and the product exact, so that there is one rounding, fused or not: a plane is the same
//! number at every level of instructions, and where it is encoded.
//!
//! **Rounded outward.** The origin is the smallest coordinate of all children. The encoder tries steps, and counts of steps, until the plane *as decoded* is not inside of
//! what it stands for. Its first guesses only save time.
//!
//! **Extremes.** Where the children lie in one plane the step still grows until 255 of them lead away from it, so that the boxes of unused lanes are inside out. The
//! smallest step is `2^-126`: around what is smaller there are larger boxes. 255 steps of `2^120` are the longest way that is exact. Where children are farther apart boxes
//! go from the first coordinate of all to infinity, which 255 steps of `2^122` are, fused or not. In scenes of such a size [`FusedRay`](tahko_geometry::FusedRay) culls nothing.

use tahko_geometry::simd::{LANES, Simd};

use super::node::Node;
use super::plane_order::PlaneOrder;
use super::{Child, WideNode};

/// The boxes of up to eight children in steps of a grid, and where they are: 96 bytes, always in two cache lines.
///
/// Unused lanes have a box that is inside out and stand for the leaf without triangles, as in [`WideNode`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(32))]
pub(crate) struct QuantisedNode {
    /// By axis: where the grid begins.
    origins: [f32; 3],
    /// By axis: the exponents of the steps, as f32 has them. The fourth is not used.
    exponents: [u8; 4],
    /// By axis: the smallest coordinates, then the largest, in steps from the origin.
    planes: [[[u8; LANES]; 2]; 3],
    children: [Child; LANES],
}

const _: () = assert!(
    size_of::<QuantisedNode>() == 96,
    "three quarters of two cache lines"
);

/// The planes of an axis that boxes can have.
#[derive(Clone, Copy, Debug)]
struct Grid {
    origin: f32,
    exponent: u8,
}

impl Node for QuantisedNode {
    const PREFETCHED: usize = 128;

    #[inline(always)]
    fn lanes(&self) -> &[Child; LANES] {
        &self.children
    }

    #[inline(always)]
    fn planes<S: Simd>(&self, simd: S, axis: usize, order: &PlaneOrder) -> [S::F32s; 2] {
        let grid = self.grid(axis);
        let (origin, step) = (simd.splat(grid.origin), simd.splat(grid.step()));
        // Rounded once or twice, as levels have it: the product is exact.
        let place = |steps: &[u8; LANES]| simd.mul_add(simd.load_u8(steps), step, origin);
        let [first, last] = order.of_axis(&self.planes, axis);
        [place(first), place(last)]
    }

    /// Boxes end at the largest number where the planes are at infinity.
    #[inline(always)]
    fn child_plane(&self, axis: usize, side: u32, lane: usize) -> f32 {
        let side = (side & 1) as usize;
        let plane = self.grid(axis).plane(self.planes[axis][side][lane]);
        // Where unused lanes begin may stay at infinity.
        plane.min([f32::INFINITY, f32::MAX][side])
    }

    #[inline]
    fn decoded(&self) -> WideNode {
        let mut bounds = WideNode::EMPTY.bounds;
        for (axis, [smallest, largest]) in bounds.iter_mut().enumerate() {
            for lane in 0..LANES {
                smallest.0[lane] = self.child_plane(axis, 0, lane);
                largest.0[lane] = self.child_plane(axis, 1, lane);
            }
        }
        WideNode {
            bounds,
            children: self.children,
        }
    }
}

impl QuantisedNode {
    /// A node whose boxes contain those of another one, and are hardly larger. Cost: some hundred nanoseconds.
    pub(super) fn new(node: &WideNode) -> Self {
        let mut quantised = Self {
            origins: [0.0; 3],
            exponents: [0; 4],
            planes: [[[u8::MAX; LANES], [0; LANES]]; 3],
            children: node.children,
        };
        // Unused lanes have boxes that are inside out, so that they change neither end.
        for (axis, [smallest, largest]) in node.bounds.iter().enumerate() {
            let first = smallest.0.into_iter().fold(f32::MAX, f32::min);
            let last = largest.0.into_iter().fold(f32::MIN, f32::max);
            let grid = Grid::around(first, last);
            quantised.origins[axis] = grid.origin;
            quantised.exponents[axis] = grid.exponent;
            let [below, above] = &mut quantised.planes[axis];
            for lane in (0..LANES).filter(|lane| node.children[*lane] != Child::NOTHING) {
                below[lane] = grid.below(smallest.0[lane]);
                above[lane] = grid.above(largest.0[lane]);
            }
        }
        quantised
    }

    #[inline(always)]
    fn grid(&self, axis: usize) -> Grid {
        Grid {
            origin: self.origins[axis],
            exponent: self.exponents[axis],
        }
    }
}

impl Grid {
    /// The exponent of the largest step of which 255 are a number, `2^120`.
    const LARGEST: u8 = 247;
    /// The exponent of the step where more is needed, `2^122`: none of them, or 255, which are infinite wherever they begin.
    const BEYOND: u8 = 249;

    /// The finest grid that begins at a coordinate and reaches another one, and leads away from the first.
    fn around(first: f32, last: f32) -> Self {
        let grid = |exponent| Self {
            origin: first,
            exponent,
        };
        let reaches = |grid: &Self| {
            let end = grid.plane(u8::MAX);
            end >= last && end > first
        };
        // Shorter ways do not lead away from the first coordinate.
        let way =
            (f64::from(last) - f64::from(first)).max(f64::from(first).abs() * 2.0f64.powi(-25));
        let exponents = Self::at_most(way / 255.0)..=Self::LARGEST;
        let mut grids = exponents.map(grid);
        grids.find(reaches).unwrap_or(grid(Self::BEYOND))
    }

    /// The exponent of the largest step that is not above a number, or of one of the ends of the range.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_possible_wrap,
        clippy::cast_sign_loss,
        reason = "a sign and eleven bits, then within the range"
    )]
    fn at_most(step: f64) -> u8 {
        let exponent = (step.to_bits() >> 52) as i64 - 1023 + 127;
        exponent.clamp(1, i64::from(Self::LARGEST)) as u8
    }

    #[inline(always)]
    fn step(self) -> f32 {
        f32::from_bits(u32::from(self.exponent) << 23)
    }

    /// The coordinate some steps from the origin, as all levels decode it.
    #[inline(always)]
    fn plane(self, steps: u8) -> f32 {
        f32::from(steps) * self.step() + self.origin
    }

    /// The largest number of steps that are a number.
    fn most_steps(self) -> u8 {
        if self.exponent <= Self::LARGEST {
            u8::MAX
        } else {
            0
        }
    }

    /// The most steps whose plane is not above a coordinate of a box in the grid.
    fn below(self, place: f32) -> u8 {
        let mut steps = self.guess(place);
        // The origin itself is not above it.
        while steps > 0 && self.plane(steps) > place {
            steps -= 1;
        }
        while steps < self.most_steps() && self.plane(steps + 1) <= place {
            steps += 1;
        }
        steps
    }

    /// The fewest steps whose plane is not below a coordinate of a box in the grid.
    fn above(self, place: f32) -> u8 {
        let mut steps = self.guess(place);
        while self.plane(steps) < place {
            if steps == self.most_steps() {
                return u8::MAX;
            }
            steps += 1;
        }
        while steps > 0 && self.plane(steps - 1) >= place {
            steps -= 1;
        }
        steps
    }

    /// About as many steps as there are to a coordinate.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "what is out of range becomes one of its ends, and NaN zero"
    )]
    fn guess(self, place: f32) -> u8 {
        let way = f64::from(place) - f64::from(self.origin);
        ((way / f64::from(self.step())) as u8).min(self.most_steps())
    }
}

#[cfg(test)]
mod tests;
