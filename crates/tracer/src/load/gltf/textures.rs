//! Textures and the images in them.

use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::io::Cursor;

use gltf::json::Value;
use gltf::json::texture::{MagFilter, Sampler, WrappingMode};
use gltf::json::validation::Checked;
use image::{ImageFormat, ImageReader};

use super::Document;
use super::fault::{Fault, element_name, items, named, reference};
use super::uri;
use crate::load::Import;
use crate::scene::{Texture, TextureId, Wrap};

/// The textures that were needed so far.
#[derive(Debug, Default)]
pub(super) struct Textures {
    loaded: HashMap<usize, Option<TextureId>>,
    decoded_images: HashSet<usize>,
}

impl Textures {
    /// A texture of the file; `None` if its only image is of a kind that is not supported.
    ///
    /// # Errors
    /// If the image is missing or cannot be decoded.
    pub(super) fn load(
        &mut self,
        document: &Document<'_>,
        index: usize,
        import: &mut Import,
    ) -> Result<Option<TextureId>, Fault> {
        if let Some(texture) = self.loaded.get(&index) {
            return Ok(*texture);
        }
        let source = document.root.textures.get(index);
        let images = items(document.json, "images");
        let image = source.map_or(usize::MAX, |source| source.source.value());
        let texture = match images.get(image) {
            Some(json) => {
                let place = element_name("image", image, json);
                let sampler = source.and_then(|source| source.sampler);
                let sampler = sampler.and_then(|at| document.root.samplers.get(at.value()));
                let texture = decode(document, json, &place)?;
                self.decoded_images.insert(image);
                let texture = with_sampler(texture, sampler);
                Some(import.builder.add_texture(texture))
            }
            None => {
                let name = source.and_then(|source| source.name.as_deref());
                let name = named("texture", index, name);
                let note = format!("{name} is skipped: it has no PNG or JPEG image");
                import.report.note(note);
                None
            }
        };
        self.loaded.insert(index, texture);
        Ok(texture)
    }

    /// Checks that the images that were not decoded are there, and of a known kind.
    ///
    /// # Errors
    /// If one is not.
    pub(super) fn check_other_images(&self, document: &Document<'_>) -> Result<(), Fault> {
        for (index, json) in items(document.json, "images").iter().enumerate() {
            if self.decoded_images.contains(&index) {
                continue;
            }
            let place = element_name("image", index, json);
            let bytes = bytes(document, json, &place)?;
            if let Some(format) = format(document, &bytes, &place)? {
                ImageReader::with_format(Cursor::new(&*bytes), format)
                    .into_dimensions()
                    .map_err(|error| Fault::invalid(&place, error))?;
            }
        }
        Ok(())
    }
}

fn decode(document: &Document<'_>, json: &Value, place: &str) -> Result<Texture, Fault> {
    let bytes = bytes(document, json, place)?;
    let format = format(document, &bytes, place)?
        .ok_or_else(|| Fault::Unsupported(format!("the image format of {place}")))?;
    // Its default limits keep a small file from unpacking to more memory than there is.
    let image = ImageReader::with_format(Cursor::new(&*bytes), format)
        .decode()
        .map_err(|error| Fault::invalid(place, error))?
        .into_rgb8();
    let (width, height) = image.dimensions();
    let texels = image.pixels().map(|pixel| pixel.0).collect();
    Texture::new(width, height, texels).map_err(|error| Fault::invalid(place, error))
}

/// The encoded image.
fn bytes<'a>(document: &Document<'a>, json: &Value, place: &str) -> Result<Cow<'a, [u8]>, Fault> {
    if let Some(uri) = json.get("uri").and_then(Value::as_str) {
        let resource = uri::fetch(uri, document.folder, u64::MAX, place)?;
        return Ok(Cow::Owned(resource.bytes));
    }
    let view = reference(json, "bufferView").and_then(|index| document.views.get(index));
    let view = view.ok_or_else(|| Fault::invalid(place, "it has no data"))?;
    Ok(Cow::Borrowed(view.bytes))
}

/// What kind of image some bytes are, by their beginning; `None` for a kind that an extension of the file brings in,
/// but that is not supported.
fn format(
    document: &Document<'_>,
    bytes: &[u8],
    place: &str,
) -> Result<Option<ImageFormat>, Fault> {
    const EXTENSION_FORMATS: [(&str, &[u8]); 3] = [
        ("EXT_texture_webp", b"RIFF"),
        ("KHR_texture_basisu", b"\xabKTX 20"),
        ("MSFT_texture_dds", b"DDS "),
    ];
    if let Ok(format @ (ImageFormat::Png | ImageFormat::Jpeg)) = image::guess_format(bytes) {
        return Ok(Some(format));
    }
    let declared = items(document.json, "extensionsUsed");
    let is_known = EXTENSION_FORMATS.iter().any(|(extension, magic)| {
        bytes.starts_with(magic) && declared.contains(&Value::from(*extension))
    });
    if is_known {
        return Ok(None);
    }
    Err(Fault::invalid(place, "the data is neither PNG nor JPEG"))
}

fn with_sampler(texture: Texture, sampler: Option<&Sampler>) -> Texture {
    let Some(sampler) = sampler else {
        return texture;
    };
    let wrap = |mode: &Checked<WrappingMode>| match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
        Checked::Valid(WrappingMode::Repeat) | Checked::Invalid => Wrap::Repeat,
    };
    let nearest = matches!(sampler.mag_filter, Some(Checked::Valid(MagFilter::Nearest)));
    texture
        .with_wrap(wrap(&sampler.wrap_s), wrap(&sampler.wrap_t))
        .with_nearest_filter(nearest)
}
