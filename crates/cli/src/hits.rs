//! Writes hits as CSV.

use std::io::Write as _;

use tahko_tracer::geometry::Hit;

/// The columns of a file of hits.
pub(crate) const HEADER: &str = "ray,hit,t,triangle,u,v\n";

/// The lines of some hits, of which the first belongs to the ray `first`.
///
/// Numbers have the fewest digits from which the same f32 can be read.
pub(crate) fn to_csv(first: u64, hits: &[Option<Hit>]) -> Vec<u8> {
    let mut text = Vec::with_capacity(48 * hits.len());
    for (ray, hit) in (first..).zip(hits) {
        let written = match hit {
            Some(Hit { t, u, v, primitive }) => writeln!(text, "{ray},1,{t},{primitive},{u},{v}"),
            None => writeln!(text, "{ray},0,,,,"),
        };
        written.expect("writing to memory cannot fail");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_can_be_read_back_to_the_bit() {
        let hit = Hit {
            t: 0.1 + 0.2,
            u: f32::MIN_POSITIVE / 3.0,
            v: 1.0 / 3.0,
            primitive: 7,
        };
        let text = String::from_utf8(to_csv(9, &[None, Some(hit)])).unwrap();
        let (miss, line) = text.split_once('\n').unwrap();
        assert_eq!(miss, "9,0,,,,");
        let fields: Vec<&str> = line.trim_end().split(',').collect();
        assert_eq!((fields[0], fields[1], fields[3]), ("10", "1", "7"));
        let number = |column: usize| fields[column].parse::<f32>().unwrap().to_bits();
        assert_eq!(
            [2, 4, 5].map(number),
            [hit.t, hit.u, hit.v].map(f32::to_bits)
        );
    }
}
