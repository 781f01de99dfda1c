//! Where the bytes of a buffer or an image are: in the URI itself, or in a file next to the glTF file.

use std::borrow::Cow;
use std::fs;
use std::io::Read;
use std::path::Path;

use super::fault::{Fault, require};

/// Bytes that a URI leads to, with the media type that a data URI gives.
#[derive(Debug)]
pub(super) struct Resource {
    pub(super) bytes: Vec<u8>,
    pub(super) media_type: Option<String>,
}

/// Reads what a URI leads to: a base64 data URI, or a file, relative to the folder of the glTF file. At most `limit`
/// bytes are read.
///
/// # Errors
/// If the URI is malformed, has another scheme, or the file cannot be read.
pub(super) fn fetch(uri: &str, folder: &Path, limit: u64, place: &str) -> Result<Resource, Fault> {
    if let Some(data) = strip_scheme(uri, "data") {
        return decode_data_uri(data, place);
    }
    if let Some(scheme) = scheme(uri) {
        require(!scheme.is_empty(), place, || {
            format!("the URI '{uri}' has an empty scheme")
        })?;
        return Err(Fault::Unsupported(format!(
            "the scheme '{scheme}' of the URI in {place}"
        )));
    }
    let name = percent_decode(uri)
        .ok_or_else(|| Fault::invalid(place, format!("the URI '{uri}' is malformed")))?;
    let bytes = read_file(&folder.join(&*name), limit).map_err(|source| {
        Fault::invalid(place, format!("the file '{name}' cannot be read: {source}"))
    })?;
    Ok(Resource {
        bytes,
        media_type: None,
    })
}

fn read_file(path: &Path, limit: u64) -> std::io::Result<Vec<u8>> {
    let file = fs::File::open(path)?;
    if !file.metadata()?.is_file() {
        return Err(std::io::Error::other("it is not a regular file"));
    }
    let mut bytes = Vec::new();
    file.take(limit).read_to_end(&mut bytes)?;
    Ok(bytes)
}

fn strip_scheme<'a>(uri: &'a str, name: &str) -> Option<&'a str> {
    let (scheme, rest) = uri.split_once(':')?;
    scheme.eq_ignore_ascii_case(name).then_some(rest)
}

/// What stands before a colon, unless the colon belongs to a path.
fn scheme(uri: &str) -> Option<&str> {
    let (scheme, _) = uri.split_once(':')?;
    let is_scheme = scheme
        .chars()
        .all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c));
    is_scheme.then_some(scheme)
}

/// Undoes percent encoding; `None` if a percent sign is not followed by two hexadecimal digits, or the result is not
/// UTF-8.
fn percent_decode(text: &str) -> Option<Cow<'_, str>> {
    if !text.contains('%') {
        return Some(Cow::Borrowed(text));
    }
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.bytes();
    while let Some(byte) = rest.next() {
        if byte == b'%' {
            let mut digit = || char::from(rest.next()?).to_digit(16);
            let value = digit()? * 16 + digit()?;
            bytes.push(u8::try_from(value).ok()?);
        } else {
            bytes.push(byte);
        }
    }
    Some(Cow::Owned(String::from_utf8(bytes).ok()?))
}

/// Decodes what follows `data:`.
fn decode_data_uri(data: &str, place: &str) -> Result<Resource, Fault> {
    let (header, payload) = data
        .split_once(',')
        .ok_or_else(|| Fault::invalid(place, "the data URI has no data"))?;
    let media_type = header
        .strip_suffix(";base64")
        .ok_or_else(|| Fault::Unsupported(format!("the data URI without base64 in {place}")))?;
    require(
        !media_type.split(';').skip(1).any(str::is_empty),
        place,
        || "the data URI is malformed",
    )?;
    let bytes = decode_base64(payload)
        .ok_or_else(|| Fault::invalid(place, "the data URI is not valid base64"))?;
    Ok(Resource {
        bytes,
        media_type: Some(media_type.to_owned()),
    })
}

/// Decodes base64 (RFC 4648, with the standard or the URL alphabet, padded or not).
fn decode_base64(text: &str) -> Option<Vec<u8>> {
    let digits = text.trim_end_matches('=');
    let padding = text.len() - digits.len();
    // Whole groups of four with at most two pads, or no pads at all; one digit alone is no byte.
    if digits.len() % 4 == 1 || padding > 2 || (padding > 0 && !text.len().is_multiple_of(4)) {
        return None;
    }
    let mut bytes = Vec::with_capacity(digits.len() / 4 * 3 + 2);
    for group in digits.as_bytes().chunks(4) {
        let mut bits = 0u32;
        for &digit in group {
            bits = bits << 6 | u32::from(base64_value(digit)?);
        }
        bits <<= 6 * (4 - group.len());
        let [_, decoded @ ..] = bits.to_be_bytes();
        bytes.extend(decoded.iter().take(group.len() - 1));
    }
    Some(bytes)
}

fn base64_value(digit: u8) -> Option<u8> {
    Some(match digit {
        b'A'..=b'Z' => digit - b'A',
        b'a'..=b'z' => digit - b'a' + 26,
        b'0'..=b'9' => digit - b'0' + 52,
        b'+' | b'-' => 62,
        b'/' | b'_' => 63,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_of_every_length_is_decoded() {
        let cases = [
            ("", ""),
            ("Zg==", "f"),
            ("Zm8=", "fo"),
            ("Zm9v", "foo"),
            ("Zm9vYg", "foob"),
        ];
        for (text, expected) in cases {
            assert_eq!(decode_base64(text).unwrap(), expected.as_bytes(), "{text}");
        }
        for wrong in ["A", "Zg=", "Zg===", "Z!==", "Zm9vY", "=", "Zm=v"] {
            assert_eq!(decode_base64(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn percent_signs_need_two_digits() {
        assert_eq!(percent_decode("a%20b%C3%A4").unwrap(), "a bä");
        for wrong in ["%", "%2", "%zz", "%FF"] {
            assert_eq!(percent_decode(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn schemes_are_told_from_paths() {
        assert_eq!(scheme("http://x/y.bin"), Some("http"));
        assert_eq!(scheme("dir/a b:c.bin"), None);
        let fault = fetch("http://x/y.bin", Path::new("."), 9, "buffer 0").unwrap_err();
        assert!(matches!(fault, Fault::Unsupported(_)), "{fault:?}");
    }
}
