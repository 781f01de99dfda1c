//! Where the samples of a pixel lie.

use super::RenderOptions;

/// The place of a sample in its pixel, from 0 to 1 in both directions.
///
/// One sample per pixel lies in the middle. Several follow the R2 sequence, shifted by a hash of the pixel and
/// the seed: each prefix is spread evenly, and neighbouring pixels differ. Depends on nothing but its arguments.
///
/// Source: Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018.
pub(crate) fn position_in_pixel(x: u32, y: u32, sample: u32, options: &RenderOptions) -> [f64; 2] {
    if options.samples == 1 {
        return [0.5, 0.5];
    }
    /// The reciprocals of the plastic number, the root of p^3 = p + 1, and of its square.
    const STEPS: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];
    let pixel = u64::from(y) << 32 | u64::from(x);
    let first = hash(pixel ^ hash(options.seed));
    let shifts = [first, hash(first)].map(|bits| (bits >> 11) as f64 / (1u64 << 53) as f64);
    [0, 1].map(|axis| (shifts[axis] + f64::from(sample) * STEPS[axis]).fract())
}

/// The finaliser of `SplitMix64` (Steele, Lea, Flood, "Fast splittable pseudorandom number generators", 2014).
fn hash(value: u64) -> u64 {
    let value = value.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let value = (value ^ value >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let value = (value ^ value >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    value ^ value >> 31
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_spread_evenly_over_the_pixel() {
        let options = RenderOptions {
            samples: 64,
            ..RenderOptions::default()
        };
        let mut cells = [[0u32; 4]; 4];
        for sample in 0..64 {
            let [x, y] = position_in_pixel(3, 5, sample, &options);
            assert!(
                (0.0..1.0).contains(&x) && (0.0..1.0).contains(&y),
                "({x}, {y})"
            );
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "0 to 3"
            )]
            let [column, row] = [x, y].map(|v| (4.0 * v) as usize);
            cells[row][column] += 1;
        }
        assert!(
            cells
                .as_flattened()
                .iter()
                .all(|count| (2..=6).contains(count)),
            "{cells:?}"
        );
    }

    #[test]
    fn a_single_sample_is_in_the_middle_whatever_the_seed() {
        let options = RenderOptions {
            seed: 7,
            ..RenderOptions::default()
        };
        assert_eq!(position_in_pixel(3, 5, 0, &options), [0.5, 0.5]);
    }
}
