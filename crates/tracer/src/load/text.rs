//! What the readers of text formats share: decoding, lines, numbers, and how tokens are quoted in messages.

use std::borrow::Cow;

/// The text of a file: UTF-8 with or without a byte order mark, or UTF-16 with one.
///
/// Bytes that are not UTF-8 become replacement characters: older exporters write names in local encodings, and
/// the statements that matter are ASCII.
pub(crate) fn decode(bytes: &[u8]) -> Cow<'_, str> {
    match bytes {
        [0xFF, 0xFE, rest @ ..] => Cow::Owned(decode_utf16(rest, u16::from_le_bytes)),
        [0xFE, 0xFF, rest @ ..] => Cow::Owned(decode_utf16(rest, u16::from_be_bytes)),
        [0xEF, 0xBB, 0xBF, rest @ ..] => String::from_utf8_lossy(rest),
        _ => String::from_utf8_lossy(bytes),
    }
}

fn decode_utf16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> String {
    let (pairs, _) = bytes.as_chunks::<2>();
    char::decode_utf16(pairs.iter().map(|pair| unit(*pair)))
        .map(|character| character.unwrap_or(char::REPLACEMENT_CHARACTER))
        .collect()
}

/// The lines with their numbers, from 1. Lines end with `\n`, `\r\n` or, where there is no `\n` at all, `\r`.
pub(crate) fn numbered_lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let separator = if !text.contains('\n') && text.contains('\r') {
        '\r'
    } else {
        '\n'
    };
    (1..).zip(text.split(separator))
}

/// A number as f32, rounded once.
///
/// # Errors
/// A message, if it is not a number.
pub(crate) fn number(token: &str) -> Result<f32, String> {
    token
        .parse()
        .map_err(|_| format!("{} is not a number", quoted(token)))
}

/// A finite number as f32, rounded once.
///
/// # Errors
/// A message, if it is not a number, not finite, or above the largest f32.
pub(crate) fn finite_number(token: &str) -> Result<f32, String> {
    let value = number(token)?;
    if value.is_finite() {
        Ok(value)
    } else {
        Err(format!("{} is not a finite f32", quoted(token)))
    }
}

/// A token for a message: without control characters, and not too long.
pub(crate) fn quoted(token: &str) -> String {
    const LIMIT: usize = 40;
    let mut shown: String = token
        .chars()
        .take(LIMIT)
        .flat_map(char::escape_debug)
        .collect();
    if token.chars().nth(LIMIT).is_some() {
        shown.push_str("...");
    }
    format!("'{shown}'")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn byte_order_marks_choose_the_encoding() {
        for (bytes, expected) in [
            (b"v 1".as_slice(), "v 1"),
            (b"\xEF\xBB\xBFv 1", "v 1"),
            (b"\xFF\xFEv\0 \x001\0", "v 1"),
            (b"\xFE\xFF\0v\0 \x001", "v 1"),
            (b"\xFE\xFF\0v\0", "v"),
            (b"\xE4v", "\u{FFFD}v"),
            (b"", ""),
        ] {
            assert_eq!(decode(bytes), expected, "{bytes:?}");
        }
    }

    #[test]
    fn lines_are_numbered_for_every_kind_of_line_end() {
        for text in ["a\nb", "a\r\nb", "a\rb"] {
            let lines: Vec<_> = numbered_lines(text)
                .map(|(number, line)| (number, line.trim()))
                .collect();
            assert_eq!(lines, [(1, "a"), (2, "b")], "{text:?}");
        }
    }

    #[test]
    fn numbers_are_rounded_once_and_must_be_finite() {
        // Half way between two f32 but for a digit that f64 cannot hold: rounding twice would go to even.
        assert_eq!(
            finite_number("1.00000017881393432617187501"),
            Ok(1.0 + 2.0 * f32::EPSILON)
        );
        assert_eq!(finite_number(".8e-001"), Ok(0.08));
        for token in ["nan", "inf", "1e39", "1,5", "", "0x10"] {
            assert!(finite_number(token).is_err(), "{token}");
        }
    }

    #[test]
    fn messages_hold_no_control_characters() {
        assert_eq!(quoted("a\0b"), "'a\\0b'");
        assert_eq!(quoted(&"x".repeat(99)).len(), 45);
    }
}
