//! Takes a file apart: JSON text alone (.gltf), or JSON and binary data in chunks (.glb).

use super::fault::{Fault, require};

/// The two parts of a file.
#[derive(Debug)]
pub(super) struct Container<'a> {
    pub(super) json: &'a [u8],
    /// The BIN chunk of a GLB file.
    pub(super) binary: Option<&'a [u8]>,
    /// Bytes after the end that the header gives.
    pub(super) trailing: usize,
}

const MAGIC: &[u8] = b"glTF";
const HEADER_LENGTH: usize = 12;
const JSON_CHUNK: [u8; 4] = *b"JSON";
const BINARY_CHUNK: [u8; 4] = *b"BIN\0";

/// Takes a file apart. A file is GLB if it begins with the magic number, or is named so.
///
/// # Errors
/// If a GLB file breaks the rules for its header or its chunks.
pub(super) fn open(bytes: &[u8], named_glb: bool) -> Result<Container<'_>, Fault> {
    if !named_glb && !bytes.starts_with(MAGIC) {
        return Ok(Container {
            // Some tools write a byte order mark, which JSON does not know.
            json: bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes),
            binary: None,
            trailing: 0,
        });
    }
    let end = header(bytes)?;
    let mut chunks = Chunks {
        rest: &bytes[HEADER_LENGTH..end],
        offset: HEADER_LENGTH,
    };
    let place = "GLB chunk 0";
    let (kind, json) = chunks
        .next()?
        .ok_or_else(|| Fault::invalid(place, "the file ends after its header"))?;
    require(
        kind == JSON_CHUNK,
        place,
        || "the first chunk must hold JSON",
    )?;
    require(!json.is_empty(), place, || "the JSON chunk is empty")?;
    let mut binary = None;
    let mut number = 1;
    while let Some((kind, data)) = chunks.next()? {
        let place = format!("GLB chunk {number}");
        require(kind != JSON_CHUNK, &place, || "a second JSON chunk")?;
        if kind == BINARY_CHUNK {
            require(number == 1, &place, || "BIN must be the second chunk")?;
            binary = Some(data);
        }
        number += 1;
    }
    Ok(Container {
        json,
        binary,
        trailing: bytes.len() - end,
    })
}

/// Checks the header and returns the length of the file that it gives.
fn header(bytes: &[u8]) -> Result<usize, Fault> {
    let place = "GLB header";
    require(
        bytes.starts_with(MAGIC),
        place,
        || "the file does not begin with 'glTF'",
    )?;
    let field = |start: usize| {
        little_endian(bytes.get(start..start + 4))
            .ok_or_else(|| Fault::invalid(place, "the file ends within its header"))
    };
    let version = field(4)?;
    require(version == 2, place, || {
        format!("version {version} is not 2")
    })?;
    let length = field(8)? as usize;
    require(length >= HEADER_LENGTH, place, || {
        format!("a length of {length} bytes is too small")
    })?;
    require(length <= bytes.len(), place, || {
        format!(
            "the file is cut off: {} of {length} bytes are there",
            bytes.len()
        )
    })?;
    Ok(length)
}

/// The kind of a chunk, and its data.
type Chunk<'a> = ([u8; 4], &'a [u8]);

/// The chunks that follow the header.
struct Chunks<'a> {
    rest: &'a [u8],
    offset: usize,
}

impl<'a> Chunks<'a> {
    fn next(&mut self) -> Result<Option<Chunk<'a>>, Fault> {
        if self.rest.is_empty() {
            return Ok(None);
        }
        let place = format!("GLB chunk at byte {}", self.offset);
        let Some((header, rest)) = self.rest.split_first_chunk::<8>() else {
            return Err(Fault::invalid(place, "the file ends within a chunk header"));
        };
        let [l0, l1, l2, l3, kind @ ..] = *header;
        let length = u32::from_le_bytes([l0, l1, l2, l3]) as usize;
        require(length.is_multiple_of(4), &place, || {
            format!("a chunk length of {length} is not a multiple of 4")
        })?;
        require(length <= rest.len(), &place, || {
            format!("{length} bytes are more than the {} left", rest.len())
        })?;
        let (data, rest) = rest.split_at(length);
        self.rest = rest;
        self.offset += 8 + length;
        Ok(Some((kind, data)))
    }
}

fn little_endian(bytes: Option<&[u8]>) -> Option<u32> {
    Some(u32::from_le_bytes(bytes?.try_into().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn glb(chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
        let mut bytes = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
        for (kind, data) in chunks {
            bytes.extend(u32::try_from(data.len()).unwrap().to_le_bytes());
            bytes.extend(*kind);
            bytes.extend(*data);
        }
        let length = u32::try_from(bytes.len()).unwrap();
        bytes[8..12].copy_from_slice(&length.to_le_bytes());
        bytes
    }

    fn refusal(bytes: &[u8]) -> String {
        match open(bytes, true).unwrap_err() {
            Fault::Invalid { place, reason } => format!("{place}: {reason}"),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn chunks_are_found() {
        let bytes = glb(&[(b"JSON", b"{}  "), (b"BIN\0", b"abcd"), (b"MORE", b"")]);
        let container = open(&bytes, false).unwrap();
        assert_eq!(container.json, b"{}  ");
        assert_eq!(container.binary, Some(&b"abcd"[..]));
        let text = open(b"\xef\xbb\xbf{}", false).unwrap();
        assert_eq!((text.json, text.binary), (&b"{}"[..], None));
    }

    #[test]
    fn every_truncation_is_refused() {
        let bytes = glb(&[(b"JSON", b"{}  "), (b"BIN\0", b"abcd")]);
        for length in 0..bytes.len() {
            assert!(open(&bytes[..length], true).is_err(), "{length} bytes");
        }
    }

    #[test]
    fn broken_headers_and_chunks_are_named() {
        let mut old = glb(&[(b"JSON", b"{}  ")]);
        old[4] = 1;
        assert_eq!(refusal(&old), "GLB header: version 1 is not 2");
        assert_eq!(
            refusal(&glb(&[(b"BIN\0", b"abcd")])),
            "GLB chunk 0: the first chunk must hold JSON"
        );
        assert_eq!(
            refusal(&glb(&[(b"JSON", b"{}  "), (b"JSON", b"{}  ")])),
            "GLB chunk 1: a second JSON chunk"
        );
        let mut long = glb(&[(b"JSON", b"{}  ")]);
        long[12] = 8;
        assert_eq!(
            refusal(&long),
            "GLB chunk at byte 12: 8 bytes are more than the 4 left"
        );
    }
}
