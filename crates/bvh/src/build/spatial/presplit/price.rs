//! How many pieces of which triangles pay.
//!
//! **What boxes cost.** The areas of all references' boxes as parts of the root's have a sum `E`: the boxes that a random line through the root is expected to meet, and so the least number of
//! triangles that it tests in any tree over these references. A ray costs about `E + R` tests, where `R` stands for what it takes beside.
//!
//! **What pieces save.** The box of a triangle has half the area `A`, and the projections of the triangle along the axes have areas of which the sum is `a`: the boxes of its pieces cannot get
//! below that. A sliver is cut across its length, and its boxes get thinner until they are as long as wide: their sum goes down to some `2 a`. A triangle with a right angle in a
//! plane across an axis has `A = 2 a`, as has one between three axes, and pieces of such do not help. So of `s` pieces the areas are taken to have the sum `L + P / s`, with `L = min(A, 2 a)` and
//! the *potential* `P = A - L`. On slivers that is within 1 % of what comes out; pieces of triangles 10 times as long as wide are a sixth smaller.
//!
//! **How many there are.** The sum over all triangles with a given number of pieces in all is least where another piece saves the same everywhere: `P / s^2` is a common *price*, and
//! `s` is the root of `P / price`, rounded down. Potentials are counted in a histogram of steps of 7 to 12.5 %, which tells what each price would give.
//!
//! **Which price.** Pieces cost memory, time to build, and cache misses: twice the references have to save a sixth of a ray's cost, for `(E + R) N^(1/4)` is made the least, `N` being the number of
//! references, within what is allowed. And if it falls by less than a third nothing is cut at all: there spatial splits, which see what they do, are as good.

use tahko_geometry::{TriangleMesh, glam::Vec3};

use crate::build::reference::{Bounds, Reference};
use crate::parallel::reduce;

/// What a ray costs beside the tests of the triangles whose boxes it meets, in such tests; measured as 100 to 200 ns against 3 to 5.
const REST: f64 = 30.0;

/// By what factor the cost has to fall. Measured: at 1.2 to 1.3 (gear wheels, slivers of a twentieth of the scene) fewer tests and no more speed, from 1.8 on up to tenfold speed.
const LEAST_GAIN: f64 = 1.5;

/// Potentials below this part of the root's area count as none, and prices do not go below it.
const LEAST: f64 = 1.0 / (1u64 << OCTAVES) as f64;
const OCTAVES: usize = 40;

/// Bits of a potential's fraction that tell its step in the histogram.
const FRACTION_BITS: u32 = 3;
const SHIFT: u32 = f64::MANTISSA_DIGITS - 1 - FRACTION_BITS;
const FIRST_STEP: u64 = LEAST.to_bits() >> SHIFT;
/// Up to the potential of a box as large as the root.
const STEPS: usize = (OCTAVES << FRACTION_BITS) + 1;

/// From one price to the next: the fourth root of a half, by which numbers of pieces grow by a twelfth.
const CHEAPER: f64 = 0.840_896_415_253_714_5;

/// What a piece has to save, and with it how many pieces of each triangle there are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Price {
    price: f64,
    root_area: f64,
}

impl Price {
    /// The best price for references to all triangles of a mesh which gives at most `most` pieces; `None` if pieces do not pay.
    pub(super) fn find(references: &[Reference], mesh: &TriangleMesh, most: usize) -> Option<Self> {
        if most <= references.len() {
            return None;
        }
        let (bounds, area) = reduce(references, &bounds_and_area, &|a, b| {
            (a.0.union(b.0), a.1 + b.1)
        });
        let root_area = bounds.half_area();
        let met = area / root_area;
        // Most meshes end here, before their triangles are looked at; and those whose root has no area.
        let may_pay = met + REST >= LEAST_GAIN * REST;
        if !may_pay {
            return None;
        }
        let measure = |chunk: &[Reference]| Histogram::new(chunk, mesh, root_area);
        let histogram = reduce(references, &measure, &|a, b| a.merge(&b));
        let price = histogram.best_price(references.len(), met, most)?;
        Some(Self { price, root_area })
    }

    /// In how many pieces a reference that was not cut is to be cut, at least 1.
    pub(super) fn pieces(&self, reference: &Reference, mesh: &TriangleMesh) -> usize {
        let potential = potential(reference, mesh) / self.root_area;
        step(potential).map_or(1, |step| pieces(step, self.price))
    }
}

/// The box of some references, and the sum of the half areas of theirs.
fn bounds_and_area(references: &[Reference]) -> (Bounds, f64) {
    let start = (Bounds::EMPTY, 0.0);
    references.iter().fold(start, |(bounds, area), reference| {
        let whole = reference.bounds();
        (bounds.union(whole), area + whole.half_area())
    })
}

/// By how much the areas of a triangle's boxes may shrink, if it is cut in ever more pieces.
fn potential(reference: &Reference, mesh: &TriangleMesh) -> f64 {
    let [a, b, c] = mesh
        .triangle(reference.number() as usize)
        .vertices()
        .map(Vec3::as_dvec3);
    // Twice the areas of the projections.
    let least = (b - a).cross(c - a).abs().element_sum();
    (reference.bounds().half_area() - least).max(0.0)
}

/// The place of a potential, as a part of the root's area, in the histogram; `None` if it counts as none.
fn step(potential: f64) -> Option<usize> {
    let step = (potential.to_bits() >> SHIFT).checked_sub(FIRST_STEP)?;
    #[expect(clippy::cast_possible_truncation, reason = "at most the last step")]
    Some(step.min(STEPS as u64 - 1) as usize)
}

/// The least potential of a step.
const fn least_of(step: usize) -> f64 {
    f64::from_bits((step as u64 + FIRST_STEP) << SHIFT)
}

/// In how many pieces triangles of a step are cut.
fn pieces(step: usize, price: f64) -> usize {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a price is at least 2^-40, so that there are at most 2^20"
    )]
    let pieces = (least_of(step) / price).sqrt() as usize;
    pieces.max(1)
}

/// How many triangles have which potential.
struct Histogram {
    counts: [usize; STEPS],
    /// Their potentials.
    sums: [f64; STEPS],
}

impl Histogram {
    fn new(references: &[Reference], mesh: &TriangleMesh, root_area: f64) -> Self {
        let mut histogram = Self {
            counts: [0; STEPS],
            sums: [0.0; STEPS],
        };
        for reference in references {
            let potential = potential(reference, mesh) / root_area;
            if let Some(step) = step(potential) {
                histogram.counts[step] += 1;
                histogram.sums[step] += potential;
            }
        }
        histogram
    }

    fn merge(mut self, other: &Self) -> Self {
        for step in 0..STEPS {
            self.counts[step] += other.counts[step];
            self.sums[step] += other.sums[step];
        }
        self
    }

    /// The pieces beyond one per triangle that a price gives, and how many boxes a line meets the less.
    fn at(&self, price: f64) -> (usize, f64) {
        let (mut more, mut saved) = (0, 0.0);
        for step in 0..STEPS {
            let pieces = pieces(step, price);
            more += (pieces - 1) * self.counts[step];
            saved += self.sums[step] * (1.0 - 1.0 / pieces as f64);
        }
        (more, saved)
    }

    /// The price at which rays cost least, of `count` triangles of whose boxes a line meets `met`.
    fn best_price(&self, count: usize, met: f64, most: usize) -> Option<f64> {
        let (mut best_price, mut least_cost) = (None, (met + REST) / LEAST_GAIN);
        let mut price = 0.25;
        while price > LEAST {
            let (more, saved) = self.at(price);
            if count + more > most {
                break;
            }
            let references = 1.0 + more as f64 / count as f64;
            let cost = (met - saved + REST) * references.sqrt().sqrt();
            if cost < least_cost {
                (best_price, least_cost) = (Some(price), cost);
            }
            price *= CHEAPER;
        }
        best_price
    }
}

#[cfg(test)]
mod tests {
    use tahko_geometry::test_support::soup;

    use super::*;
    use crate::parallel::collect;

    fn price(mesh: &TriangleMesh, most: usize) -> Option<(Price, Vec<usize>)> {
        let references = collect(mesh.len(), |number| Reference::new(mesh, number));
        let price = Price::find(&references, mesh, most)?;
        let pieces = references.iter().map(|r| price.pieces(r, mesh));
        Some((price, pieces.collect()))
    }

    /// Triangles from a corner of the unit cube to the opposite one, of a part of that length and some width.
    fn slivers(count: u16, length: f32, width: f32) -> Vec<[Vec3; 3]> {
        let at = |number: u16| Vec3::X * 1e-4 * f32::from(number);
        (0..count)
            .map(|number| {
                let start = at(number);
                let end = start + Vec3::splat(length);
                [start, end, end - Vec3::Y * width]
            })
            .collect()
    }

    #[test]
    fn slivers_take_the_whole_budget_and_other_triangles_nothing() {
        let mesh = soup(slivers(1000, 1.0, 1e-3));
        for budget in [2, 4, 8, 16] {
            let (_, pieces) = price(&mesh, budget * 1000).expect("it pays");
            assert_eq!(pieces, vec![budget; 1000], "{budget}");
        }
        assert!(price(&mesh, 1999).is_none(), "not even two pieces each");
        let full = soup(slivers(1000, 1.0, 1.0));
        assert!(price(&full, 16_000).is_none());
        // Boxes of 1000 slivers of a tenth of the scene: a line meets ten.
        let mut short = slivers(1000, 0.1, 1e-4);
        short.extend(slivers(1, 1.0, 1e-3));
        assert!(price(&soup(short), 16_000).is_none());
    }

    #[test]
    fn pieces_go_where_they_save_most_and_no_more_than_pay() {
        let mut triangles = slivers(300, 1.0, 1e-3);
        triangles.extend(slivers(300, 0.25, 1e-3));
        triangles.extend(slivers(40_000, 1e-3, 1e-3));
        let mesh = soup(triangles);
        let (price, pieces) = price(&mesh, 16 * mesh.len()).expect("it pays");
        let (long, short) = (pieces[0], pieces[300]);
        // As long by four, and in four times as many pieces, up to rounding down and the steps.
        assert!((3 * short..6 * short).contains(&long), "{long}, {short}");
        assert!(pieces[600..].iter().all(|pieces| *pieces == 1));
        let total: usize = pieces.iter().sum();
        assert!(total < 2 * mesh.len(), "{total} {price:?}");
    }

    #[test]
    fn a_mesh_without_an_area_or_with_one_that_is_out_of_range_is_left_alone() {
        for size in [0.0, 1e-45, 3e38] {
            let line = [Vec3::ZERO, Vec3::X * size, Vec3::X * size];
            assert!(price(&soup(vec![line; 100]), 1000).is_none(), "{size}");
        }
    }

    #[test]
    fn steps_cover_all_potentials() {
        assert_eq!(step(1.0), Some(STEPS - 1));
        assert_eq!(step(1.01), Some(STEPS - 1), "rounding");
        assert_eq!(step(LEAST), Some(0));
        assert_eq!(step(LEAST * 0.99), None);
        assert_eq!(step(0.0), None);
        for index in 0..STEPS {
            assert_eq!(step(least_of(index)), Some(index));
            let ratio = least_of(index + 1) / least_of(index);
            assert!((1.0..=1.125).contains(&ratio), "{ratio}");
        }
    }
}
