//! Images that `map_Kd` statements name.

use std::path::Path;

use image::ImageReader;

use crate::load::text::quoted;
use crate::scene::{Texture, Wrap};

/// A `map_Kd` statement.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Map {
    /// As written, except that `\` became `/`.
    pub(super) file: String,
    pub(super) clamp: bool,
    /// Options that are left out.
    pub(super) left_out: Vec<String>,
}

impl Map {
    /// Splits options from the file name, which may hold spaces.
    pub(super) fn parse(statement: &str) -> Self {
        let mut map = Self {
            file: String::new(),
            clamp: false,
            left_out: Vec::new(),
        };
        let mut rest = statement.trim();
        while let Some((option, values)) = rest.split_once(char::is_whitespace) {
            let (most, numeric) = match option {
                "-o" | "-s" | "-t" => (3, true),
                "-mm" => (2, true),
                "-bm" | "-boost" | "-texres" => (1, true),
                "-blendu" | "-blendv" | "-cc" | "-clamp" | "-imfchan" | "-type" => (1, false),
                _ => break,
            };
            rest = values.trim_start();
            let mut on = false;
            for _ in 0..most {
                let Some((value, after)) = rest.split_once(char::is_whitespace) else {
                    break;
                };
                if numeric && value.parse::<f32>().is_err() {
                    break;
                }
                on = value == "on";
                rest = after.trim_start();
            }
            match option {
                "-clamp" => map.clamp = on,
                // Bilinear filtering is what is done; the resolution is only advice.
                "-blendu" | "-blendv" | "-texres" => {}
                _ => map.left_out.push(option.to_owned()),
            }
        }
        map.file = rest.replace('\\', "/");
        map
    }

    /// Reads the image from the folder of the library.
    ///
    /// # Errors
    /// A message, if the image cannot be read.
    pub(super) fn load(&self, folder: &Path) -> Result<Texture, String> {
        let path = folder.join(&self.file);
        let failed = |reason: &dyn std::fmt::Display| {
            format!("the texture {}: {reason}", quoted(&self.file))
        };
        if !path.is_file() {
            return Err(failed(&"there is no such file"));
        }
        let image = ImageReader::open(&path)
            .and_then(ImageReader::with_guessed_format)
            .map_err(|error| failed(&error))?
            .decode()
            .map_err(|error| failed(&error))?
            .into_rgb8();
        let texels = image.pixels().map(|pixel| pixel.0).collect();
        let wrap = if self.clamp {
            Wrap::Clamp
        } else {
            Wrap::Repeat
        };
        Texture::new(image.width(), image.height(), texels)
            .map(|texture| texture.with_wrap(wrap, wrap))
            .map_err(|error| failed(&error))
    }
}
