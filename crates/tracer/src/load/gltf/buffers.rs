//! The raw data of a file: buffers, and the views that cut them up.

use std::path::Path;

use gltf::json::Value;

use super::fault::{Fault, element_name, integer, items, reference, require};
use super::uri;

/// A run of bytes of a buffer.
#[derive(Clone, Copy, Debug)]
pub(super) struct View<'a> {
    pub(super) bytes: &'a [u8],
    /// Where the run begins in its buffer; elements are aligned relative to the buffer.
    pub(super) offset: usize,
    /// The distance between the starts of elements, where it is given.
    pub(super) stride: Option<usize>,
    pub(super) target: Option<u64>,
}

/// Reads all buffers of a file. `binary` is the BIN chunk of a GLB file.
///
/// # Errors
/// If a buffer has no data, less than it should have, or its file cannot be read.
pub(super) fn load(
    json: &Value,
    binary: Option<&[u8]>,
    folder: &Path,
) -> Result<Vec<Vec<u8>>, Fault> {
    let load_one = |(index, buffer): (usize, &Value)| {
        let place = element_name("buffer", index, buffer);
        let length = integer(buffer, "byteLength").unwrap_or(0);
        let mut bytes = match buffer.get("uri").and_then(Value::as_str) {
            Some(uri) => fetch(uri, folder, length, &place)?,
            None if index == 0 => chunk_data(binary, length, &place)?.to_vec(),
            None => return Err(Fault::invalid(place, "it has no URI")),
        };
        require(bytes.len() as u64 >= length, &place, || {
            format!("only {} of its {length} bytes are there", bytes.len())
        })?;
        // More bytes than given are padding, which nothing may refer to.
        bytes.truncate(usize::try_from(length).unwrap_or(usize::MAX));
        Ok(bytes)
    };
    items(json, "buffers")
        .iter()
        .enumerate()
        .map(load_one)
        .collect()
}

/// The BIN chunk, which may be longer than the buffer only by its padding.
fn chunk_data<'a>(binary: Option<&'a [u8]>, length: u64, place: &str) -> Result<&'a [u8], Fault> {
    let bytes =
        binary.ok_or_else(|| Fault::invalid(place, "it has no URI and there is no BIN chunk"))?;
    let padding = usize::try_from(length).ok();
    let padding = padding
        .and_then(|length| bytes.get(length..))
        .unwrap_or_default();
    let is_padding = padding.len() < 4 || padding.iter().all(|byte| *byte == 0);
    require(is_padding, place, || {
        format!(
            "its length is {length}, but the BIN chunk holds {} bytes of data",
            bytes.len()
        )
    })?;
    Ok(bytes)
}

const MEDIA_TYPES: [&str; 2] = ["application/octet-stream", "application/gltf-buffer"];

fn fetch(uri: &str, folder: &Path, length: u64, place: &str) -> Result<Vec<u8>, Fault> {
    let resource = uri::fetch(uri, folder, length, place)?;
    if let Some(media_type) = resource.media_type {
        require(MEDIA_TYPES.contains(&media_type.as_str()), place, || {
            format!(
                "its data URI has the media type '{media_type}', but it must be one of {}",
                MEDIA_TYPES.join(", ")
            )
        })?;
    }
    Ok(resource.bytes)
}

/// The views of a file, which lie within their buffers.
///
/// # Errors
/// If a view reaches over the end of its buffer, or its stride is wrong.
pub(super) fn views<'a>(json: &Value, buffers: &'a [Vec<u8>]) -> Result<Vec<View<'a>>, Fault> {
    let check_one = |(index, view): (usize, &Value)| {
        let place = element_name("buffer view", index, view);
        let buffer = reference(view, "buffer").and_then(|index| buffers.get(index));
        let buffer = buffer.map_or(&[][..], Vec::as_slice);
        let offset = integer(view, "byteOffset").unwrap_or(0);
        let length = integer(view, "byteLength").unwrap_or(0);
        let bytes = part(buffer, offset, length).ok_or_else(|| {
            let reason = format!(
                "{length} bytes from {offset} reach over the end of its buffer of {} bytes",
                buffer.len()
            );
            Fault::invalid(&place, reason)
        })?;
        let stride = reference(view, "byteStride");
        if let Some(stride) = stride {
            require(stride.is_multiple_of(4), &place, || {
                format!("a stride of {stride} is not a multiple of 4")
            })?;
            require(stride <= bytes.len(), &place, || {
                format!("a stride of {stride} is more than its {length} bytes")
            })?;
        }
        Ok(View {
            bytes,
            offset: usize::try_from(offset).unwrap_or(usize::MAX),
            stride,
            target: integer(view, "target"),
        })
    };
    items(json, "bufferViews")
        .iter()
        .enumerate()
        .map(check_one)
        .collect()
}

/// The bytes from `offset` on; `None` if they are not all there.
pub(super) fn part(bytes: &[u8], offset: u64, length: u64) -> Option<&[u8]> {
    let start = usize::try_from(offset).ok()?;
    let length = usize::try_from(length).ok()?;
    bytes.get(start..start.checked_add(length)?)
}
