//! Numbers as text: three significant digits, thousands apart, units where they help.

/// What stands where there is no number.
pub(super) const NOTHING: &str = "–";

/// Three significant digits; whole numbers from a hundred on, powers of ten for very small ones.
pub(super) fn number(value: f64) -> String {
    let magnitude = value.abs();
    match magnitude {
        _ if !value.is_finite() => NOTHING.to_owned(),
        0.0 => "0".to_owned(),
        _ if magnitude >= 1e12 => power_of_ten(value),
        _ if magnitude >= 100.0 => group(&format!("{value:.0}")),
        _ if magnitude >= 10.0 => format!("{value:.1}"),
        _ if magnitude >= 1.0 => format!("{value:.2}"),
        _ if magnitude >= 0.1 => format!("{value:.3}"),
        _ if magnitude >= 0.01 => format!("{value:.4}"),
        _ if magnitude >= 0.001 => format!("{value:.5}"),
        _ => power_of_ten(value),
    }
}

/// The same without zeros at the end: for ticks.
pub(super) fn short(value: f64) -> String {
    let text = number(value);
    match text.split_once(" × ") {
        Some((factor, power)) if trim(factor) == "1" => power.to_owned(),
        Some((factor, power)) => format!("{} × {power}", trim(factor)),
        None => trim(&text).to_owned(),
    }
}

fn trim(text: &str) -> &str {
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        text
    }
}

/// A count, with its thousands apart.
pub(super) fn count(value: usize) -> String {
    group(&value.to_string())
}

/// A number of rays, with the prefix that fits it.
pub(super) fn rays(value: f64) -> String {
    let scaled = [
        (1e12, "\u{a0}T"),
        (1e9, "\u{a0}G"),
        (1e6, "\u{a0}M"),
        (1e3, "\u{a0}k"),
    ];
    let unit = scaled.iter().find(|(size, _)| value * 1.000_000_1 >= *size);
    match unit {
        Some((size, unit)) if value.is_finite() => format!("{}{unit}", short(value / size)),
        _ => short(value),
    }
}

/// A time in the unit that fits it.
pub(super) fn seconds(value: f64) -> String {
    with_unit(value, number)
}

/// A time on a tick.
pub(super) fn short_seconds(value: f64) -> String {
    with_unit(value, short)
}

fn with_unit(value: f64, number: fn(f64) -> String) -> String {
    if !value.is_finite() {
        return NOTHING.to_owned();
    }
    // A little below each limit, as the ticks of an axis are not exactly powers of ten.
    let (factor, unit) = match value.abs() * 1.000_000_1 {
        0.0 => (1.0, "s"),
        magnitude if magnitude < 1e-6 => (1e9, "ns"),
        magnitude if magnitude < 1e-3 => (1e6, "µs"),
        magnitude if magnitude < 1.0 => (1e3, "ms"),
        _ => (1.0, "s"),
    };
    format!("{}\u{a0}{unit}", number(value * factor))
}

/// A part of a whole, in percent.
pub(super) fn percent(part: f64) -> String {
    match part * 100.0 {
        value if !value.is_finite() => NOTHING.to_owned(),
        value if value != 0.0 && value.abs() < 10.0 => format!("{value:.1}\u{a0}%"),
        value => format!("{value:.0}\u{a0}%"),
    }
}

/// `1.2 × 10⁻⁵`.
fn power_of_ten(value: f64) -> String {
    let text = format!("{value:.2e}");
    let Some((factor, exponent)) = text.split_once('e') else {
        return text;
    };
    let exponent = exponent.chars().map(superscript);
    format!("{factor} × 10{}", exponent.collect::<String>())
}

fn superscript(character: char) -> char {
    match character {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '4' => '⁴',
        '5' => '⁵',
        '6' => '⁶',
        '7' => '⁷',
        '8' => '⁸',
        '9' => '⁹',
        _ => '⁰',
    }
}

/// Narrow spaces between the thousands of a whole number with more than four digits.
fn group(digits: &str) -> String {
    let (sign, digits) = digits
        .strip_prefix('-')
        .map_or(("", digits), |rest| ("-", rest));
    if digits.len() <= 4 {
        return format!("{sign}{digits}");
    }
    let mut text = sign.to_owned();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_significant_digits() {
        let expected = [
            (0.0, "0"),
            (1234.4, "1234"),
            (1_234_567.0, "1\u{202f}234\u{202f}567"),
            (99.04, "99.0"),
            (0.5, "0.500"),
            (0.001_234, "0.00123"),
            (0.000_012_3, "1.23 × 10⁻⁵"),
            (f64::NAN, NOTHING),
            (f64::INFINITY, NOTHING),
        ];
        for (value, text) in expected {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    fn ticks_have_no_zeros_at_the_end() {
        for (value, text) in [(0.5, "0.5"), (20.0, "20"), (100.0, "100"), (1e-6, "10⁻⁶")] {
            assert_eq!(short(value), text);
        }
        assert_eq!(short_seconds(0.01), "10\u{a0}ms");
        assert_eq!(short_seconds(0.001), "1\u{a0}ms");
    }

    #[test]
    fn times_have_the_unit_that_fits() {
        assert_eq!(seconds(0.0), "0\u{a0}s");
        assert_eq!(seconds(2.5e-5), "25.0\u{a0}µs");
        assert_eq!(seconds(90.0), "90.0\u{a0}s");
        assert_eq!(percent(0.034), "3.4\u{a0}%");
        assert_eq!(percent(1.5), "150\u{a0}%");
    }
}
