//! The root mean squared error of a picture.

use super::picture::Picture;

/// Root of the mean squared difference of the displayed values, sRGB from 0 to 1, over all pixels and channels.
///
/// # Panics
/// If the pictures have different sizes.
pub(crate) fn rmse(picture: &Picture, reference: &Picture) -> f64 {
    assert_eq!(
        (picture.width, picture.pixels.len()),
        (reference.width, reference.pixels.len()),
        "pictures of one size"
    );
    let values = picture.pixels.as_flattened();
    let pairs = values.iter().zip(reference.pixels.as_flattened());
    // Squares of whole numbers: the sum is exact, and so the same in any order.
    let sum: u64 = pairs
        .map(|(value, reference)| u64::from(value.abs_diff(*reference)).pow(2))
        .sum();
    (sum as f64 / values.len().max(1) as f64).sqrt() / 255.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(pixels: &[[u8; 3]]) -> Picture {
        Picture {
            width: pixels.len(),
            pixels: pixels.to_vec(),
        }
    }

    #[test]
    fn equal_pictures_have_no_error_and_black_and_white_the_largest() {
        let [black, white] = [0, 255].map(|value| picture(&[[value; 3]; 4]));
        assert_eq!(rmse(&black, &black), 0.0);
        assert_eq!(rmse(&black, &white), 1.0);
    }

    #[test]
    fn the_mean_is_over_pixels_and_channels() {
        let gray = picture(&[[10; 3]; 4]);
        let mut other = gray.clone();
        other.pixels[1][0] = 13;
        other.pixels[2][2] = 6;
        // Squares of 3 and 4 among twelve values.
        let expected = (25.0f64 / 12.0).sqrt() / 255.0;
        assert_eq!(rmse(&gray, &other), expected);
        assert_eq!(rmse(&other, &gray), expected);
    }
}
