//! Pictures to look at: what was rendered, and where it is wrong.

use super::flip::ErrorMap;
use super::picture::Picture;

/// The colour map `magma` of matplotlib (Smith, van der Walt, 2015, CC0) at every sixteenth of its range: black, purple, orange, light yellow.
/// Equal steps of the error look equal, also without colour. Straight lines between are at most 3 of 255 off.
const MAGMA: [[u8; 3]; 17] = [
    [0, 0, 4],
    [10, 8, 34],
    [29, 17, 71],
    [54, 16, 107],
    [81, 18, 124],
    [106, 28, 129],
    [131, 38, 129],
    [156, 46, 127],
    [183, 55, 121],
    [207, 64, 112],
    [229, 80, 100],
    [244, 105, 92],
    [251, 135, 97],
    [254, 165, 113],
    [254, 194, 135],
    [253, 224, 161],
    [252, 253, 191],
];

/// The error map in colours: black where there is no error, light where it is 1.
pub(super) fn colored(map: &ErrorMap) -> Picture {
    Picture {
        width: map.width,
        pixels: map.errors.iter().map(|error| magma(*error)).collect(),
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "from 0 to 16, and from 0 to 255"
)]
fn magma(value: f64) -> [u8; 3] {
    let last = MAGMA.len() - 1;
    let place = value.clamp(0.0, 1.0) * last as f64;
    let below = (place as usize).min(last - 1);
    let part = place - below as f64;
    [0, 1, 2].map(|channel| {
        let [from, to] = [below, below + 1].map(|index| f64::from(MAGMA[index][channel]));
        (from + part * (to - from)).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_error_is_black_and_larger_errors_are_lighter() {
        assert_eq!(magma(0.0), MAGMA[0]);
        assert_eq!(magma(1.0), MAGMA[16]);
        assert_eq!(magma(0.5), MAGMA[8]);
        assert_eq!([magma(-1.0), magma(2.0)], [MAGMA[0], MAGMA[16]]);
        let luma = |[r, g, b]: [u8; 3]| {
            0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)
        };
        let lumas: Vec<f64> = (0..=100)
            .map(|error| luma(magma(f64::from(error) / 100.0)))
            .collect();
        // Within the rounding to whole numbers.
        assert!(
            lumas.windows(2).all(|pair| pair[1] > pair[0] - 0.5),
            "{lumas:?}"
        );
    }
}
