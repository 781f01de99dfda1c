//! The picture: linear radiance per pixel, written as PNG or OpenEXR.

use std::io;
use std::path::Path;

use glam::Vec3;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};
use thiserror::Error;

use crate::output::write_atomically;

/// Linear RGB radiance for each pixel, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    width: u32,
    height: u32,
    pixels: Vec<Vec3>,
}

/// Why a picture cannot be written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FilmError {
    /// The file name does not end in a known type.
    #[error("'{name}' does not end in .png or .exr")]
    UnknownType {
        /// The file name.
        name: String,
    },
    /// The file cannot be written.
    #[error("{name}: {source}")]
    Io {
        /// The file name.
        name: String,
        /// What the system says.
        source: io::Error,
    },
}

/// The file types of pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FilmFormat {
    /// 8 bits per channel, sRGB, after the exposure.
    Png,
    /// 32-bit floats, linear, without exposure.
    Exr,
}

impl FilmFormat {
    /// The type that a file name asks for.
    ///
    /// # Errors
    /// If the name does not end in `.png` or `.exr`.
    pub fn from_path(path: &Path) -> Result<Self, FilmError> {
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        match extension.to_str() {
            Some("png") => Ok(Self::Png),
            Some("exr") => Ok(Self::Exr),
            _ => Err(FilmError::UnknownType {
                name: path.display().to_string(),
            }),
        }
    }
}

impl Film {
    /// A black picture.
    #[must_use]
    pub fn new(width: u32, height: u32) -> Self {
        let pixels = vec![Vec3::ZERO; width as usize * height as usize];
        Self {
            width,
            height,
            pixels,
        }
    }

    /// Width in pixels.
    #[must_use]
    pub const fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    #[must_use]
    pub const fn height(&self) -> u32 {
        self.height
    }

    /// The pixels, rows from the top, each from the left.
    #[must_use]
    pub fn pixels(&self) -> &[Vec3] {
        &self.pixels
    }

    /// One row, from the left.
    pub(crate) fn row_mut(&mut self, y: u32) -> &mut [Vec3] {
        let width = self.width as usize;
        &mut self.pixels[y as usize * width..][..width]
    }

    /// Writes the picture in the format of the file name, whole or not at all.
    ///
    /// # Errors
    /// If the file name has another type or the file cannot be written.
    pub fn save(&self, path: &Path, exposure: f32) -> Result<(), FilmError> {
        let result = match FilmFormat::from_path(path)? {
            FilmFormat::Png => write_atomically(path, |writer| {
                PngEncoder::new(writer)
                    .write_image(
                        &self.to_srgb8(exposure),
                        self.width,
                        self.height,
                        ExtendedColorType::Rgb8,
                    )
                    .map_err(io::Error::other)
            }),
            FilmFormat::Exr => write_atomically(path, |writer| self.write_exr(writer)),
        };
        result.map_err(|source| FilmError::Io {
            name: path.display().to_string(),
            source,
        })
    }

    fn write_exr(&self, writer: impl io::Write + io::Seek) -> io::Result<()> {
        use exr::prelude::{Image, SpecificChannels, WritableImage};
        let size = (self.width as usize, self.height as usize);
        let channels = SpecificChannels::rgb(|position: exr::math::Vec2<usize>| {
            let pixel = self.pixels[position.y() * size.0 + position.x()];
            (pixel.x, pixel.y, pixel.z)
        });
        Image::from_channels(size, channels)
            .write()
            .non_parallel()
            .to_buffered(writer)
            .map_err(io::Error::other)
    }

    /// Bytes of sRGB, three per pixel.
    #[must_use]
    pub fn to_srgb8(&self, exposure: f32) -> Vec<u8> {
        self.pixels
            .iter()
            .flat_map(|pixel| (*pixel * exposure).to_array().map(linear_to_srgb8))
            .collect()
    }
}

/// The sRGB transfer function (IEC 61966-2-1), rounded to 8 bits; NaN becomes 0.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "between 0 and 255.5; the cast of NaN gives 0"
)]
fn linear_to_srgb8(value: f32) -> u8 {
    let value = value.clamp(0.0, 1.0);
    let encoded = if value <= 0.003_130_8 {
        12.92 * value
    } else {
        1.055 * value.powf(1.0 / 2.4) - 0.055
    };
    (255.0 * encoded + 0.5) as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::srgb_to_linear;

    #[test]
    fn every_srgb_value_survives_the_way_to_linear_and_back() {
        for value in 0..=255u8 {
            assert_eq!(
                linear_to_srgb8(srgb_to_linear(f32::from(value) / 255.0)),
                value
            );
        }
        assert_eq!([-1.0, 2.0, f32::NAN].map(linear_to_srgb8), [0, 255, 0]);
    }

    #[test]
    fn both_formats_can_be_read_back() {
        let mut film = Film::new(3, 2);
        film.row_mut(1)[2] = Vec3::new(4.0, 0.5, 0.0);
        let folder = tempfile::tempdir().unwrap();

        let png = folder.path().join("a.png");
        film.save(&png, 0.25).unwrap();
        let read = image::open(&png).unwrap().to_rgb8();
        assert_eq!(
            (read.dimensions(), read.get_pixel(2, 1).0),
            ((3, 2), [255, 99, 0])
        );

        let path = folder.path().join("a.EXR");
        film.save(&path, 0.25).unwrap();
        let read = exr::prelude::read_first_rgba_layer_from_file(
            &path,
            |size, _| vec![Vec3::ZERO; size.area()],
            |pixels, position, (r, g, b, _): (f32, f32, f32, f32)| {
                pixels[position.y() * 3 + position.x()] = Vec3::new(r, g, b);
            },
        );
        assert_eq!(read.unwrap().layer_data.channel_data.pixels, film.pixels());
    }

    #[test]
    fn other_file_types_are_refused() {
        let error = Film::new(1, 1)
            .save(Path::new("picture.jpg"), 1.0)
            .unwrap_err();
        assert_eq!(
            error.to_string(),
            "'picture.jpg' does not end in .png or .exr"
        );
    }
}
