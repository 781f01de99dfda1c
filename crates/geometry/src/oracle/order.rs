//! The order of triangles along a space-filling curve, so that consecutive ones are close together.

use glam::DVec3;

use crate::TriangleMesh;

/// Steps of the curve per axis.
const STEPS: f64 = (1u64 << BITS) as f64;
const BITS: u32 = 21;

/// The numbers of the triangles along Morton's curve through the middles of their boxes.
///
/// Source: Morton, "A computer oriented geodetic data base and a new technique in file sequencing", IBM 1966.
pub(super) fn along_curve(mesh: &TriangleMesh) -> Vec<u32> {
    let bounds = mesh.aabb();
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    let middles = mesh.triangles().map(|triangle| {
        let bounds = triangle.aabb();
        bounds.min.as_dvec3().midpoint(bounds.max.as_dvec3())
    });
    let places = middles.map(|middle| place_on_curve((middle - min) / (max - min)));
    let mut numbered: Vec<(u64, u32)> = places.zip(0..).collect();
    numbered.sort_unstable();
    numbered.into_iter().map(|(_, number)| number).collect()
}

/// The bits of the three coordinates, taken in turns. Coordinates are in `[0, 1]`, or NaN on an axis without extent.
fn place_on_curve(coordinates: DVec3) -> u64 {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "in [0, 2^21], and NaN gives 0"
    )]
    let steps = (coordinates * STEPS).to_array().map(|step| step as u64);
    let [x, y, z] = steps.map(|step| spread(step.min((1 << BITS) - 1)));
    x | y << 1 | z << 2
}

/// Two zeros between all bits of a number of 21 bits.
const fn spread(number: u64) -> u64 {
    let number = (number | number << 32) & 0x001f_0000_0000_ffff;
    let number = (number | number << 16) & 0x001f_0000_ff00_00ff;
    let number = (number | number << 8) & 0x100f_00f0_0f00_f00f;
    let number = (number | number << 4) & 0x10c3_0c30_c30c_30c3;
    (number | number << 2) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_take_turns() {
        let step = 1.0 / STEPS;
        assert_eq!(place_on_curve(DVec3::new(step, 0.0, f64::NAN)), 0b001);
        assert_eq!(place_on_curve(DVec3::new(0.0, 3.0 * step, step)), 0b010_110);
        assert_eq!(place_on_curve(DVec3::ONE), (1 << 63) - 1);
    }
}
