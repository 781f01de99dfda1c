//! The difference between two pictures.

use std::fmt::{self, Display};

use anyhow::Context;
use image::{ImageFormat, Rgba, RgbaImage};

/// A channel of 8 bits may differ by this much: pictures are the same on one machine, but the mathematical functions
/// of platforms differ in the last bit, which can carry a value over a rounding step.
///
/// Measured on six scenes of nine tessellated spheres (mirrors, glass, diffuse) over a wavy floor, by moving every
/// coordinate of every vertex at random by -1, 0 or 1 ulp, three times each: 1 to 7 of the 19200 pixels
/// differed, all but 2 of them by 1.
pub(super) const CHANNEL_TOLERANCE: u8 = 1;

/// So many pixels may differ by more, because a ray passes on the other side of an edge: twice the largest
/// number of the measurement at [`CHANNEL_TOLERANCE`].
pub(super) const OUTLIERS: usize = 4;

/// So many pixels of the fast precision may differ by more than [`CHANNEL_TOLERANCE`] from the golden image: one row.
/// In the same scenes none did; but where the diagonal of a quad falls on a line of pixels, as in scenes
/// that are aligned with the camera, a whole line of rays meets an edge.
pub(super) const FAST_OUTLIERS: usize = 160;

/// How two pictures differ.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Difference {
    /// Their sizes, which leave nothing to compare.
    Size {
        expected: (u32, u32),
        actual: (u32, u32),
    },
    Pixels {
        /// The largest difference of a channel.
        largest: u8,
        /// How many pixels differ at all.
        differing: usize,
        /// How many differ by more than [`CHANNEL_TOLERANCE`].
        outliers: usize,
    },
}

impl Difference {
    pub(super) fn between(expected: &RgbaImage, actual: &RgbaImage) -> Self {
        if expected.dimensions() != actual.dimensions() {
            return Self::Size {
                expected: expected.dimensions(),
                actual: actual.dimensions(),
            };
        }
        let pairs = expected.pixels().zip(actual.pixels());
        let (mut largest, mut differing, mut outliers) = (0, 0, 0);
        for (expected, actual) in pairs {
            let difference = pixel_difference(*expected, *actual);
            largest = largest.max(difference);
            differing += usize::from(difference > 0);
            outliers += usize::from(difference > CHANNEL_TOLERANCE);
        }
        Self::Pixels {
            largest,
            differing,
            outliers,
        }
    }

    /// Whether no more pixels than these differ by more than [`CHANNEL_TOLERANCE`].
    pub(super) fn is_within(&self, allowed_outliers: usize) -> bool {
        matches!(self, Self::Pixels { outliers, .. } if *outliers <= allowed_outliers)
    }
}

impl Display for Difference {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Size { expected, actual } => write!(
                formatter,
                "{} x {} pixels instead of {} x {}",
                actual.0, actual.1, expected.0, expected.1
            ),
            Self::Pixels { differing: 0, .. } => formatter.write_str("no pixel differs"),
            Self::Pixels {
                largest,
                differing,
                outliers,
            } => write!(
                formatter,
                "{differing} pixels differ, {outliers} by more than {CHANNEL_TOLERANCE}, at most by {largest}"
            ),
        }
    }
}

/// Reads a PNG file.
pub(super) fn decode(png: &[u8]) -> anyhow::Result<RgbaImage> {
    let image = image::load_from_memory_with_format(png, ImageFormat::Png);
    Ok(image.context("not a PNG picture")?.to_rgba8())
}

/// The expected picture, dark and grey, with pixels that differ in yellow, and in red where they are outliers.
/// Pixels that only one of the pictures has are red.
pub(super) fn difference_image(expected: &RgbaImage, actual: &RgbaImage) -> RgbaImage {
    let width = expected.width().max(actual.width());
    let height = expected.height().max(actual.height());
    RgbaImage::from_fn(width, height, |x, y| {
        let expected = expected.get_pixel_checked(x, y);
        let Some((expected, actual)) = expected.zip(actual.get_pixel_checked(x, y)) else {
            return Rgba([255, 0, 0, 255]);
        };
        match pixel_difference(*expected, *actual) {
            0 => {
                let [red, green, blue, _] = expected.0;
                let dark = red.max(green).max(blue) / 4;
                Rgba([dark, dark, dark, 255])
            }
            difference if difference <= CHANNEL_TOLERANCE => Rgba([255, 255, 0, 255]),
            _ => Rgba([255, 0, 0, 255]),
        }
    })
}

fn pixel_difference(a: Rgba<u8>, b: Rgba<u8>) -> u8 {
    let channels = a.0.iter().zip(&b.0);
    channels.map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grey picture with some pixels of the first row brighter by the given amounts.
    fn picture(brighter: &[u8]) -> RgbaImage {
        RgbaImage::from_fn(8, 4, |x, y| {
            let amount = brighter.get(x as usize).filter(|_| y == 0);
            Rgba([100, 100 + amount.unwrap_or(&0), 100, 255])
        })
    }

    #[test]
    fn equal_pictures_do_not_differ() {
        let difference = Difference::between(&picture(&[]), &picture(&[]));
        assert!(difference.is_within(0), "{difference}");
        assert_eq!(difference.to_string(), "no pixel differs");
    }

    #[test]
    fn small_differences_are_tolerated_and_counted() {
        let actual = picture(&[CHANNEL_TOLERANCE; 8]);
        let difference = Difference::between(&picture(&[]), &actual);
        assert!(difference.is_within(0), "{difference}");
        assert_eq!(
            difference.to_string(),
            "8 pixels differ, 0 by more than 1, at most by 1"
        );
    }

    #[test]
    fn outliers_are_tolerated_up_to_a_number() {
        let difference = Difference::between(&picture(&[]), &picture(&[1, 2, 90]));
        assert!(difference.is_within(2), "{difference}");
        assert!(!difference.is_within(1), "{difference}");
    }

    #[test]
    fn a_difference_of_the_alpha_channel_counts() {
        let mut transparent = picture(&[]);
        transparent.put_pixel(0, 0, Rgba([100, 100, 100, 0]));
        let difference = Difference::between(&picture(&[]), &transparent);
        assert!(!difference.is_within(0), "{difference}");
    }

    #[test]
    fn pictures_of_different_sizes_are_never_within_tolerance() {
        let narrow = RgbaImage::new(7, 4);
        let difference = Difference::between(&picture(&[]), &narrow);
        assert!(!difference.is_within(usize::MAX), "{difference}");
        assert_eq!(
            difference_image(&picture(&[]), &narrow).dimensions(),
            (8, 4)
        );
    }

    #[test]
    fn the_difference_image_marks_what_differs() {
        let marks = difference_image(&picture(&[]), &picture(&[0, 1, 50]));
        let row: Vec<[u8; 4]> = (0..3).map(|x| marks.get_pixel(x, 0).0).collect();
        let expected = [[25, 25, 25, 255], [255, 255, 0, 255], [255, 0, 0, 255]];
        assert_eq!(row, expected);
    }

    #[test]
    fn what_is_not_a_picture_is_refused() {
        assert!(decode(b"no picture").is_err(), "text is no PNG");
    }
}
