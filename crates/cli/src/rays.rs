//! Reads rays from CSV.

use std::fs::{File, Metadata};
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;

use anyhow::{Result, anyhow, bail};
use tahko_tracer::geometry::{Ray, glam::Vec3};

/// The columns of a file of rays.
const COLUMNS: [&str; 8] = ["ox", "oy", "oz", "dx", "dy", "dz", "tmin", "tmax"];

/// No ray needs a longer line, so memory stays bounded whatever the file is.
const MAX_LINE_BYTES: u64 = 4096;

/// A file of rays, read piece by piece.
pub(crate) struct RayReader {
    name: String,
    input: Box<dyn BufRead + Send>,
    line: Vec<u8>,
    line_number: u64,
    bytes_read: u64,
}

impl RayReader {
    /// Opens a file, or standard input for `-`, and reads the header. Also gives the size of a file in bytes.
    pub(crate) fn open(path: &Path) -> Result<(Self, Option<u64>)> {
        if path == Path::new("-") {
            let input = Box::new(BufReader::new(io::stdin()));
            return Ok((Self::new("standard input".to_owned(), input)?, None));
        }
        let name = path.display().to_string();
        let file = File::open(path).map_err(|source| anyhow!("{name}: {source}"))?;
        let metadata = file.metadata().ok().filter(Metadata::is_file);
        let reader = Self::new(name, Box::new(BufReader::new(file)))?;
        Ok((reader, metadata.map(|metadata| metadata.len())))
    }

    fn new(name: String, input: Box<dyn BufRead + Send>) -> Result<Self> {
        let mut reader = Self {
            name,
            input,
            line: Vec::new(),
            line_number: 0,
            bytes_read: 0,
        };
        reader.next_line()?;
        let header = reader.line.trim_ascii_end();
        let header = header.strip_prefix(BYTE_ORDER_MARK).unwrap_or(header);
        let needed = COLUMNS.join(",");
        if header != needed.as_bytes() {
            bail!("{}: line 1: the header must be '{needed}'", reader.name);
        }
        Ok(reader)
    }

    /// Reads up to `count` rays; fewer only at the end. Empty lines do not count.
    ///
    /// # Errors
    /// If a line is not a [valid](Ray::is_valid) ray; the message names file, line and reason.
    pub(crate) fn read(&mut self, count: usize) -> Result<Vec<Ray>> {
        let mut rays = Vec::with_capacity(count);
        while rays.len() < count && self.next_line()? {
            let line = self.line.trim_ascii();
            if line.is_empty() {
                continue;
            }
            let ray = parse_ray(line);
            rays.push(ray.map_err(|reason| self.error(&reason))?);
        }
        Ok(rays)
    }

    /// How many bytes have been read.
    pub(crate) const fn bytes_read(&self) -> u64 {
        self.bytes_read
    }

    /// Reads a line; false at the end of the file.
    fn next_line(&mut self) -> Result<bool> {
        self.line.clear();
        let mut input = self.input.by_ref().take(MAX_LINE_BYTES);
        let read = input.read_until(b'\n', &mut self.line);
        self.line_number += 1;
        let bytes = read.map_err(|source| self.error(&source.to_string()))? as u64;
        if bytes == MAX_LINE_BYTES {
            return Err(self.error("the line is too long for a ray"));
        }
        self.bytes_read += bytes;
        Ok(bytes > 0)
    }

    fn error(&self, reason: &str) -> anyhow::Error {
        anyhow!("{}: line {}: {reason}", self.name, self.line_number)
    }
}

const BYTE_ORDER_MARK: &[u8] = "\u{feff}".as_bytes();

/// The ray in a line, or what is wrong with it.
pub(crate) fn parse_ray(line: &[u8]) -> Result<Ray, String> {
    let mut values = [0.0; COLUMNS.len()];
    let mut fields = line.split(|byte| *byte == b',');
    for (value, column) in values.iter_mut().zip(COLUMNS) {
        let field = fields
            .next()
            .ok_or_else(|| format!("there is no {column}: {} fields are needed", COLUMNS.len()))?;
        *value = parse_number(field).map_err(|reason| {
            let field = String::from_utf8_lossy(field);
            format!("{column} is {reason}: '{field}'")
        })?;
    }
    if fields.next().is_some() {
        return Err(format!("there are more than {} fields", COLUMNS.len()));
    }
    let [ox, oy, oz, dx, dy, dz, t_min, t_max] = values;
    let ray = Ray::with_interval(Vec3::new(ox, oy, oz), Vec3::new(dx, dy, dz), t_min, t_max);
    if ray.is_valid() {
        return Ok(ray);
    }
    Err(if !ray.origin.is_finite() {
        "the origin is not finite".to_owned()
    } else if !ray.direction.is_finite() {
        "the direction is not finite".to_owned()
    } else if ray.direction == Vec3::ZERO {
        "the direction is zero".to_owned()
    } else {
        format!("tmin {t_min} is above tmax {t_max}")
    })
}

/// The nearest f32 of a decimal number, or what is wrong with it.
fn parse_number(field: &[u8]) -> Result<f32, &'static str> {
    let text = str::from_utf8(field).map_err(|_| "not a number")?.trim();
    let value: f32 = text.parse().map_err(|_| "not a number")?;
    if value.is_nan() {
        return Err("NaN");
    }
    // Written as infinity, a number contains no digit.
    if value.is_infinite() && text.contains(|character: char| character.is_ascii_digit()) {
        return Err("too large for a 32-bit float");
    }
    Ok(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str = "ox,oy,oz,dx,dy,dz,tmin,tmax";

    fn read(text: &str) -> Result<Vec<Ray>, String> {
        let input = Box::new(io::Cursor::new(text.to_owned()));
        RayReader::new("rays.csv".to_owned(), input)
            .and_then(|mut reader| reader.read(100))
            .map_err(|error| error.to_string())
    }

    #[test]
    fn numbers_are_read_to_the_bit_in_every_notation() {
        let rays = read(&format!(
            "{HEADER}\r\n0.1,-0,+1e-3, 2 ,3.,.5,-1,inf\n\n16777217,1e-60,0,0,0,-2,0.5,0.5"
        ));
        let first = Ray::with_interval(
            Vec3::new(0.1, -0.0, 1e-3),
            Vec3::new(2.0, 3.0, 0.5),
            -1.0,
            f32::INFINITY,
        );
        let second = Ray::with_interval(
            Vec3::new(16_777_216.0, 0.0, 0.0),
            Vec3::new(0.0, 0.0, -2.0),
            0.5,
            0.5,
        );
        assert_eq!(rays.unwrap(), [first, second]);
        assert_eq!(read(HEADER), Ok(Vec::new()));
    }

    #[test]
    fn bad_lines_are_refused_with_line_and_reason() {
        for (line, reason) in [
            ("0,0,0,1,0,0,0", "there is no tmax: 8 fields are needed"),
            ("0,0,0,1,0,0,0,1,2", "there are more than 8 fields"),
            ("0,abc,0,1,0,0,0,1", "oy is not a number: 'abc'"),
            ("\u{feff}0,0,0,1,0,0,0,1", "ox is not a number: '\u{feff}0'"),
            ("0,0,0,1,0,0,,1", "tmin is not a number: ''"),
            ("0,0,0,1,0,0,0x10,1", "tmin is not a number: '0x10'"),
            ("nan,0,0,1,0,0,0,1", "ox is NaN: 'nan'"),
            ("0,0,0,1,0,0,0,NaN", "tmax is NaN: 'NaN'"),
            (
                "0,0,0,1e39,0,0,0,1",
                "dx is too large for a 32-bit float: '1e39'",
            ),
            ("0,0,inf,1,0,0,0,1", "the origin is not finite"),
            ("0,0,0,-inf,0,0,0,1", "the direction is not finite"),
            ("0,0,0,0,0,1e-60,0,1", "the direction is zero"),
            ("0,0,0,1,0,0,2,1", "tmin 2 is above tmax 1"),
        ] {
            for (newline, number) in [("\n", 3), ("\r\n", 3), ("\n\n", 5), ("\r\n\r\n", 5)] {
                let good = "0,0,0,1,0,0,0,1";
                let lines = [HEADER, good, line, good].join(newline);
                let error = read(&lines).unwrap_err();
                assert_eq!(error, format!("rays.csv: line {number}: {reason}"));
            }
        }
    }

    #[test]
    fn a_file_needs_the_header() {
        for text in [
            "",
            "0,0,0,1,0,0,0,1\n",
            "ox,oy,oz,dx,dy,dz,tmin\n",
            "OX,oy,oz,dx,dy,dz,tmin,tmax",
        ] {
            let error = read(text).unwrap_err();
            assert!(
                error.starts_with("rays.csv: line 1: the header must be"),
                "{error}"
            );
        }
        assert_eq!(read(&format!("\u{feff}{HEADER}\n")), Ok(Vec::new()));
    }

    #[test]
    fn a_line_without_end_does_not_fill_the_memory() {
        let endless = format!("{HEADER}\n{}", "0".repeat(5000));
        let error = read(&endless).unwrap_err();
        assert_eq!(error, "rays.csv: line 2: the line is too long for a ray");
    }
}
