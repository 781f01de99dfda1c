//! Pictures as a screen shows them.

use std::io;
use std::path::Path;

use anyhow::{Context, Result};
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};
use tahko_tracer::film::Film;
use tahko_tracer::write_atomically;

/// A picture of 8-bit sRGB pixels, rows from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Picture {
    pub(crate) width: usize,
    pub(crate) pixels: Vec<[u8; 3]>,
}

impl Picture {
    /// The pixels that a PNG of the film would have.
    pub(crate) fn displayed(film: &Film, exposure: f32) -> Self {
        Self {
            width: film.width() as usize,
            pixels: film.to_srgb8(exposure).as_chunks().0.to_vec(),
        }
    }

    pub(crate) fn height(&self) -> usize {
        self.pixels.len() / self.width
    }

    /// Writes a PNG, whole or not at all.
    pub(crate) fn save(&self, path: &Path) -> Result<()> {
        let name = || path.display().to_string();
        let [width, height] = [self.width, self.height()].map(u32::try_from);
        let (width, height) = (width.with_context(name)?, height.with_context(name)?);
        write_atomically(path, |writer| {
            PngEncoder::new(writer)
                .write_image(
                    self.pixels.as_flattened(),
                    width,
                    height,
                    ExtendedColorType::Rgb8,
                )
                .map_err(io::Error::other)
        })
        .with_context(name)
    }
}
