//! Rules about files as such.

use std::path::Path;

use super::Finding;

/// Data that is larger belongs elsewhere, or comes from a generator.
const MAX_BYTES: usize = 1 << 20;

/// A longer file holds more than one idea.
const MAX_LINES: usize = 500;

/// Endings of the files that people write here. Scenes and meshes in text form are data: they may be as
/// their program wrote them.
const TEXT_ENDINGS: [&str; 6] = ["rs", "toml", "md", "ron", "sh", "yml"];

/// Whether people write a file: by its ending, or because it has none, as `.gitignore` and `LICENSE-MIT`.
pub(super) fn is_text(file: &str) -> bool {
    let ending = Path::new(file).extension();
    ending.is_none_or(|ending| TEXT_ENDINGS.iter().any(|text| ending == *text))
}

pub(super) fn size(file: &str, bytes: usize) -> Option<Finding> {
    let message = format!("{bytes} bytes; the limit is {MAX_BYTES}");
    (bytes > MAX_BYTES).then(|| Finding::new(file, 1, message))
}

pub(super) fn length(file: &str, text: &str) -> Option<Finding> {
    let lines = text.lines().count();
    let message = format!("{lines} lines; the limit is {MAX_LINES}");
    (lines > MAX_LINES).then(|| Finding::new(file, MAX_LINES + 1, message))
}

/// No space at the end of a line, line ends of Unix, and one at the end of the file.
pub(super) fn white_space(file: &str, text: &str) -> Vec<Finding> {
    let mut findings = Vec::new();
    for (number, line) in (1..).zip(text.split('\n')) {
        if line.ends_with('\r') {
            findings.push(Finding::new(
                file,
                number,
                "carriage return at the line end",
            ));
        } else if line.ends_with([' ', '\t']) {
            findings.push(Finding::new(file, number, "space at the line end"));
        }
    }
    if !text.is_empty() && !text.ends_with('\n') {
        let last = text.lines().count();
        findings.push(Finding::new(
            file,
            last,
            "no line end at the end of the file",
        ));
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_space_at_line_ends_is_found() {
        let findings = white_space("a.md", "good\ntab\t\nspace \nreturn\r\nlast");
        let lines: Vec<usize> = findings.iter().map(|finding| finding.line).collect();
        assert_eq!(lines, [2, 3, 4, 5]);
        assert_eq!(white_space("a.md", ""), []);
    }

    #[test]
    fn limits_are_inclusive() {
        assert_eq!(size("a.png", MAX_BYTES), None);
        assert!(size("a.png", MAX_BYTES + 1).is_some(), "too large");
        assert_eq!(length("a.rs", &"\n".repeat(MAX_LINES)), None);
        assert!(
            length("a.rs", &"\n".repeat(MAX_LINES + 1)).is_some(),
            "too long"
        );
    }

    #[test]
    fn data_is_not_text() {
        for file in [".ci/run", ".gitignore", "a/LICENSE-MIT", "a.rs"] {
            assert!(is_text(file), "{file}");
        }
        for file in ["a.png", "a.obj", "scenes/a.glb"] {
            assert!(!is_text(file), "{file}");
        }
    }
}
