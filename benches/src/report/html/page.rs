//! The page around the sections: style, title, machine, contents.

use std::time::{Duration, UNIX_EPOCH};

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::context::Context;
use super::format::{count, seconds};
use super::sections::{self, Section};

const STYLE: &str = include_str!("style.css");
const TITLE: &str = "tahko: speed against error";

pub(super) fn page(context: &Context<'_>) -> Markup {
    let sections = sections::all(context);
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { (TITLE) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                main {
                    h1 { (TITLE) }
                    (sections::summary::paragraph(context))
                    @if context.report.settings.quick { (warning()) }
                    (machine(context))
                    (contents(&sections))
                    @for (number, section) in (1u32..).zip(&sections) {
                        section id=(section.id) {
                            h2 { (number) ". " (section.title) }
                            (section.body)
                        }
                    }
                }
            }
        }
    }
}

fn warning() -> Markup {
    html! {
        p.warning role="note" {
            strong { "A quick run. " }
            "Few rays and few rounds: the figures show that everything works, and mean little."
        }
    }
}

fn machine(context: &Context<'_>) -> Markup {
    let report = context.report;
    let (machine, settings) = (&report.machine, &report.settings);
    let facts = [
        ("Processor", machine.processor.clone()),
        ("Threads", count(machine.threads)),
        ("System", machine.system.clone()),
        ("Compiler", machine.compiler.clone()),
        ("Version", machine.version.clone()),
        ("Began", date(report.started)),
        ("Took", duration(report.seconds)),
        ("Rays of each class", count(settings.rays)),
        ("Rounds", count(settings.rounds)),
    ];
    html! {
        dl.facts {
            @for (name, value) in &facts {
                div { dt { (name) } dd { (value) } }
            }
            div.wide { dt { "Command" } dd { code { (report.command) } } }
        }
    }
}

/// The time in UTC; the bare number where it is beyond all calendars.
fn date(seconds: u64) -> String {
    use std::fmt::Write as _;
    let mut text = String::new();
    let written = UNIX_EPOCH
        .checked_add(Duration::from_secs(seconds))
        .map(|time| write!(text, "{}", humantime::format_rfc3339_seconds(time)));
    match written {
        Some(Ok(())) => text.replace('T', " ").replace('Z', " UTC"),
        _ => format!("{seconds} s since 1970"),
    }
}

/// Hours, minutes and seconds where it is long.
fn duration(time: f64) -> String {
    match Duration::try_from_secs_f64(time.round()) {
        Ok(long) if time >= 100.0 => humantime::format_duration(long).to_string(),
        _ => seconds(time),
    }
}

fn contents(sections: &[Section]) -> Markup {
    html! {
        nav aria-label="Contents" {
            ol {
                @for section in sections {
                    li { a href={ "#" (section.id) } { (section.title) } }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_utc() {
        assert_eq!(date(951_782_400), "2000-02-29 00:00:00 UTC");
        assert_eq!(date(u64::MAX), format!("{} s since 1970", u64::MAX));
    }
}
