//! The values after the header of a PLY file, one after another, from text and from bytes.

use std::str::SplitAsciiWhitespace;

use super::header::Scalar;
use crate::load::text::{number, quoted};

/// Gives the values of elements in the order of the header.
pub(super) trait Values {
    /// Goes to the next element.
    fn start_element(&mut self) -> Result<(), String>;
    /// A value as f32, rounded once; it may be infinite or NaN.
    fn real(&mut self, scalar: Scalar) -> Result<f32, String>;
    /// A value that must be whole.
    fn integer(&mut self, scalar: Scalar) -> Result<i64, String>;
    /// Leaves values out.
    fn skip(&mut self, scalar: Scalar, count: usize) -> Result<(), String>;
    /// Checks that the element has no more values.
    fn finish_element(&mut self) -> Result<(), String>;
    /// Where the current element is, apart from its number.
    fn place(&self) -> String;
    /// The least size of a value, in bytes of the file.
    fn smallest(&self, scalar: Scalar) -> usize;
    /// No more than so many bytes are left of the file.
    fn available(&self) -> usize;
}

/// Values as text, one element per line. Empty lines are passed over.
pub(super) struct TextValues<'a> {
    lines: std::str::Lines<'a>,
    line_number: usize,
    tokens: SplitAsciiWhitespace<'a>,
    size: usize,
}

impl<'a> TextValues<'a> {
    /// Values after a header of so many lines.
    pub(super) fn new(text: &'a str, header_lines: usize) -> Self {
        Self {
            lines: text.lines(),
            line_number: header_lines,
            tokens: "".split_ascii_whitespace(),
            size: text.len(),
        }
    }

    fn token(&mut self) -> Result<&'a str, String> {
        self.tokens
            .next()
            .ok_or_else(|| "the line has too few values".to_owned())
    }

    /// The number of the next line that holds a value, if there is one.
    pub(super) fn next_line(mut self) -> Option<usize> {
        self.start_element().ok().map(|()| self.line_number)
    }
}

impl Values for TextValues<'_> {
    fn start_element(&mut self) -> Result<(), String> {
        for line in self.lines.by_ref() {
            self.line_number += 1;
            self.tokens = line.split_ascii_whitespace();
            if self.tokens.clone().next().is_some() {
                return Ok(());
            }
        }
        Err("the file ends before this element".to_owned())
    }

    fn real(&mut self, scalar: Scalar) -> Result<f32, String> {
        if scalar.is_integer() {
            self.integer(scalar).map(rounded)
        } else {
            number(self.token()?)
        }
    }

    fn integer(&mut self, scalar: Scalar) -> Result<i64, String> {
        let token = self.token()?;
        let value = if scalar.is_integer() {
            token.parse().ok().filter(|value| fits(*value, scalar))
        } else {
            token.parse().ok().and_then(whole)
        };
        value.ok_or_else(|| format!("{} is not an integer of the declared type", quoted(token)))
    }

    fn skip(&mut self, _: Scalar, count: usize) -> Result<(), String> {
        for _ in 0..count {
            self.token()?;
        }
        Ok(())
    }

    fn finish_element(&mut self) -> Result<(), String> {
        match self.tokens.next() {
            None => Ok(()),
            Some(token) => Err(format!(
                "the line has more values than the header says, from {}",
                quoted(token)
            )),
        }
    }

    fn place(&self) -> String {
        format!("line {}, ", self.line_number)
    }

    fn smallest(&self, _: Scalar) -> usize {
        // A digit and a separator.
        2
    }

    fn available(&self) -> usize {
        // The last separator may be missing.
        self.size + 1
    }
}

/// Values as bytes without gaps.
pub(super) struct BinaryValues<'a> {
    bytes: &'a [u8],
    big_endian: bool,
}

impl<'a> BinaryValues<'a> {
    pub(super) const fn new(bytes: &'a [u8], big_endian: bool) -> Self {
        Self { bytes, big_endian }
    }

    /// The number of bytes that were not read.
    pub(super) const fn rest(&self) -> usize {
        self.bytes.len()
    }

    #[inline]
    fn take<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let (value, rest) = self
            .bytes
            .split_first_chunk::<N>()
            .ok_or_else(end_of_file)?;
        self.bytes = rest;
        let mut value = *value;
        if self.big_endian {
            value.reverse();
        }
        Ok(value)
    }
}

fn end_of_file() -> String {
    "the file ends inside this element".to_owned()
}

impl Values for BinaryValues<'_> {
    fn start_element(&mut self) -> Result<(), String> {
        Ok(())
    }

    #[inline]
    fn real(&mut self, scalar: Scalar) -> Result<f32, String> {
        Ok(match scalar {
            Scalar::F32 => f32::from_le_bytes(self.take()?),
            #[expect(clippy::cast_possible_truncation, reason = "the one rounding to f32")]
            Scalar::F64 => f64::from_le_bytes(self.take()?) as f32,
            _ => rounded(self.integer(scalar)?),
        })
    }

    #[inline]
    fn integer(&mut self, scalar: Scalar) -> Result<i64, String> {
        Ok(match scalar {
            Scalar::I8 => i8::from_le_bytes(self.take()?).into(),
            Scalar::U8 => u8::from_le_bytes(self.take()?).into(),
            Scalar::I16 => i16::from_le_bytes(self.take()?).into(),
            Scalar::U16 => u16::from_le_bytes(self.take()?).into(),
            Scalar::I32 => i32::from_le_bytes(self.take()?).into(),
            Scalar::U32 => u32::from_le_bytes(self.take()?).into(),
            Scalar::F32 | Scalar::F64 => {
                let value = if scalar == Scalar::F32 {
                    f32::from_le_bytes(self.take()?).into()
                } else {
                    f64::from_le_bytes(self.take()?)
                };
                whole(value).ok_or_else(|| format!("{value} is not an integer"))?
            }
        })
    }

    #[inline]
    fn skip(&mut self, scalar: Scalar, count: usize) -> Result<(), String> {
        let rest = count
            .checked_mul(scalar.size())
            .and_then(|size| self.bytes.get(size..));
        self.bytes = rest.ok_or_else(end_of_file)?;
        Ok(())
    }

    fn finish_element(&mut self) -> Result<(), String> {
        Ok(())
    }

    fn place(&self) -> String {
        String::new()
    }

    fn smallest(&self, scalar: Scalar) -> usize {
        scalar.size()
    }

    fn available(&self) -> usize {
        self.bytes.len()
    }
}

#[expect(clippy::cast_precision_loss, reason = "the one rounding to f32")]
const fn rounded(value: i64) -> f32 {
    value as f32
}

#[expect(clippy::cast_possible_truncation, reason = "whole and in range")]
fn whole(value: f64) -> Option<i64> {
    (value.fract() == 0.0 && value.abs() <= f64::from(u32::MAX)).then_some(value as i64)
}

fn fits(value: i64, scalar: Scalar) -> bool {
    match scalar {
        Scalar::I8 => i8::try_from(value).is_ok(),
        Scalar::U8 => u8::try_from(value).is_ok(),
        Scalar::I16 => i16::try_from(value).is_ok(),
        Scalar::U16 => u16::try_from(value).is_ok(),
        Scalar::I32 => i32::try_from(value).is_ok(),
        Scalar::U32 => u32::try_from(value).is_ok(),
        Scalar::F32 | Scalar::F64 => true,
    }
}
