//! Messages on stderr: one line each, without control characters.

use std::fmt::Write as _;
use std::io::{self, Write};

use anyhow::Error;
use tahko_tracer::load::LoadReport;

use crate::progress::Progress;

/// How many notes of a loader are printed.
const MAX_NOTES: usize = 20;

/// Where messages go.
#[derive(Debug)]
pub(crate) struct Terminal {
    progress: Progress,
    quiet: bool,
}

impl Terminal {
    pub(crate) fn new(quiet: bool) -> Self {
        Self {
            progress: Progress::new(quiet),
            quiet,
        }
    }

    pub(crate) const fn progress(&self) -> &Progress {
        &self.progress
    }

    /// Prints what a loader skipped, unless the user wants quiet.
    pub(crate) fn notes(&self, report: &LoadReport) {
        let notes = report.notes();
        for note in notes.iter().take(MAX_NOTES) {
            self.message("note: ", note);
        }
        if notes.len() > MAX_NOTES {
            let more = format!("and {} more", notes.len() - MAX_NOTES);
            self.message("note: ", &more);
        }
    }

    /// Prints a summary of what was done, unless the user wants quiet.
    pub(crate) fn summary(&self, text: &str) {
        self.message("", text);
    }

    /// Prints why the program failed.
    pub(crate) fn error(&self, error: &Error) {
        self.print("error: ", &error.to_string());
    }

    fn message(&self, label: &str, text: &str) {
        if !self.quiet {
            self.print(label, text);
        }
    }

    fn print(&self, label: &str, text: &str) {
        let text = printable(text);
        // If nobody listens on stderr, there is no better place to say so.
        let print = || drop(writeln!(io::stderr().lock(), "{label}{text}"));
        self.progress.suspend(print);
    }
}

/// One line without control characters: names and messages may come from a file.
pub(crate) fn printable(text: &str) -> String {
    let mut line = String::with_capacity(text.len());
    for character in text.trim_end().chars() {
        match character {
            '\n' => line.push(' '),
            _ if character.is_control() => {
                let _ = write!(line, "{}", character.escape_default());
            }
            _ => line.push(character),
        }
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_escaped_and_lines_joined() {
        assert_eq!(
            printable("name '\u{1b}[2J\u{9b}é'\nsecond line\n"),
            "name '\\u{1b}[2J\\u{9b}é' second line"
        );
    }
}
