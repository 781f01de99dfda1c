//! The header of a PLY file: which elements follow, with which properties.

use crate::load::text::quoted;

/// How the values after the header are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

/// The type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn from_name(name: &str) -> Result<Self, String> {
        Ok(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return Err(format!("{} is not a type of number", quoted(name))),
        })
    }

    /// The size in binary files, in bytes.
    pub(super) const fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    pub(super) const fn is_integer(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }
}

/// What a property holds in each element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    One(Scalar),
    List { count: Scalar, item: Scalar },
}

#[derive(Clone, Debug)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) kind: Kind,
}

/// A run of values of the same shape, such as all vertices. Several properties may have the same name.
#[derive(Clone, Debug)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u32,
    pub(super) properties: Vec<Property>,
}

#[derive(Clone, Debug)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// Where the values start.
    pub(super) size: usize,
    /// The number of lines of the header.
    pub(super) lines: usize,
}

/// What is wrong with a header, and in which line.
pub(super) struct HeaderError {
    pub(super) line: usize,
    pub(super) reason: String,
}

/// Reads a header. Lines end as the first one does; `\r\n` and `\n` may be mixed.
pub(super) fn parse(bytes: &[u8]) -> Result<Header, HeaderError> {
    let mut lines = Lines::new(bytes);
    let magic = lines.next();
    if magic.as_deref().map(str::trim_end) != Some("ply") {
        return Err(HeaderError {
            line: 1,
            reason: "a PLY file starts with the line 'ply'".to_owned(),
        });
    }
    let mut encoding = None;
    let mut elements = Vec::new();
    while let Some(line) = lines.next() {
        let at_line = |reason| HeaderError {
            line: lines.number,
            reason,
        };
        let words: Vec<_> = line.split_ascii_whitespace().collect();
        match words.as_slice() {
            [] | ["comment" | "obj_info", ..] => {}
            ["format", rest @ ..] if encoding.is_none() => {
                encoding = Some(parse_format(rest).map_err(at_line)?);
            }
            ["element", rest @ ..] => elements.push(parse_element(rest).map_err(at_line)?),
            ["property", rest @ ..] => {
                let property = parse_property(rest).map_err(at_line)?;
                let Some(Element { properties, .. }) = elements.last_mut() else {
                    return Err(at_line(
                        "a property stands before the first element".to_owned(),
                    ));
                };
                properties.push(property);
            }
            ["end_header"] => {
                let missing = || at_line("the header has no 'format' line".to_owned());
                return Ok(Header {
                    encoding: encoding.ok_or_else(missing)?,
                    elements,
                    size: lines.position,
                    lines: lines.number,
                });
            }
            _ => {
                let reason = format!("{} is not a line of a PLY header", quoted(line.trim_end()));
                return Err(at_line(reason));
            }
        }
    }
    Err(HeaderError {
        line: lines.number,
        reason: "the file ends before 'end_header'".to_owned(),
    })
}

fn parse_format(words: &[&str]) -> Result<Encoding, String> {
    match words {
        ["ascii", "1.0"] => Ok(Encoding::Text),
        ["binary_little_endian", "1.0"] => Ok(Encoding::LittleEndian),
        ["binary_big_endian", "1.0"] => Ok(Encoding::BigEndian),
        _ => Err(format!(
            "the format is {}, not ascii, binary_little_endian or binary_big_endian, version 1.0",
            quoted(&words.join(" "))
        )),
    }
}

fn parse_element(words: &[&str]) -> Result<Element, String> {
    let [name, count] = words else {
        return Err("'element' needs a name and a count".to_owned());
    };
    let count = count
        .parse()
        .map_err(|_| format!("{} is not a count below 2^32", quoted(count)))?;
    Ok(Element {
        name: (*name).to_owned(),
        count,
        properties: Vec::new(),
    })
}

fn parse_property(words: &[&str]) -> Result<Property, String> {
    let (kind, name) = match words {
        ["list", count, item, name] => {
            let [count, item] = [Scalar::from_name(count)?, Scalar::from_name(item)?];
            if !count.is_integer() {
                return Err("the length of a list must be of an integer type".to_owned());
            }
            (Kind::List { count, item }, name)
        }
        [scalar, name] => (Kind::One(Scalar::from_name(scalar)?), name),
        _ => {
            return Err(
                "'property' needs a type and a name, or 'list', two types and a name".into(),
            );
        }
    };
    Ok(Property {
        name: (*name).to_owned(),
        kind,
    })
}

struct Lines<'a> {
    bytes: &'a [u8],
    position: usize,
    /// The number of lines so far.
    number: usize,
    end: u8,
}

impl<'a> Lines<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        let first_end = bytes.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
        let only_returns =
            first_end.is_some_and(|end| bytes[end] == b'\r' && bytes.get(end + 1) != Some(&b'\n'));
        Self {
            bytes,
            position: 0,
            number: 0,
            end: if only_returns { b'\r' } else { b'\n' },
        }
    }

    /// The next line that has an end.
    fn next(&mut self) -> Option<String> {
        let rest = &self.bytes[self.position..];
        let length = rest.iter().position(|byte| *byte == self.end)?;
        self.position += length + 1;
        self.number += 1;
        Some(String::from_utf8_lossy(&rest[..length]).into_owned())
    }
}
