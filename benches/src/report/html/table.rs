//! Tables with a caption and a header that stays in sight.

use maud::{Markup, html};

/// A column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Column {
    name: &'static str,
    /// What it means, shown on pointing at it.
    title: &'static str,
    is_number: bool,
}

impl Column {
    pub(super) const fn text(name: &'static str, title: &'static str) -> Self {
        Self {
            name,
            title,
            is_number: false,
        }
    }

    pub(super) const fn number(name: &'static str, title: &'static str) -> Self {
        Self {
            name,
            title,
            is_number: true,
        }
    }
}

/// A row.
#[derive(Clone, Debug)]
pub(super) struct Row {
    pub(super) cells: Vec<Cell>,
    /// It is the one to look at.
    pub(super) is_best: bool,
}

/// A cell.
#[derive(Clone, Debug)]
pub(super) struct Cell {
    content: Markup,
    /// Length of a bar behind the number, from 0 to 1.
    bar: Option<f64>,
    tone: &'static str,
}

impl Cell {
    pub(super) const fn new(content: Markup) -> Self {
        Self {
            content,
            bar: None,
            tone: "",
        }
    }

    pub(super) fn text(text: &str) -> Self {
        Self::new(html! { (text) })
    }

    /// With a bar behind it.
    pub(super) fn with_bar(self, part: f64) -> Self {
        let bar = part.is_finite().then_some(part.clamp(0.0, 1.0));
        Self { bar, ..self }
    }

    /// Green for no error, red for errors, grey for what is not known.
    pub(super) fn with_tone(self, tone: &'static str) -> Self {
        Self { tone, ..self }
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::text(&text)
    }
}

/// The table, in a box that scrolls sideways where the page is narrow.
pub(super) fn table(caption: &str, columns: &[Column], rows: &[Row]) -> Markup {
    html! {
        div.scroll tabindex="0" role="region" aria-label=(caption) {
            table {
                caption { (caption) }
                thead {
                    tr {
                        @for column in columns {
                            th scope="col" class=[column.is_number.then_some("n")] title=(column.title) { (column.name) }
                        }
                    }
                }
                tbody {
                    @for row in rows {
                        tr class=[row.is_best.then_some("best")] {
                            @for (index, (column, cell)) in columns.iter().zip(&row.cells).enumerate() {
                                (self::cell(column, cell, index == 0))
                            }
                        }
                    }
                }
            }
        }
    }
}

fn cell(column: &Column, cell: &Cell, is_first: bool) -> Markup {
    let number = if column.is_number { "n " } else { "" };
    let class = format!("{number}{}", cell.tone);
    let class = (!class.trim().is_empty()).then(|| class.trim().to_owned());
    let bar = cell.bar.map(|part| format!("--part:{:.1}%", part * 100.0));
    html! {
        @if is_first {
            th scope="row" class=[class] { (cell.content) }
        } @else {
            td class=[class] style=[bar] { (cell.content) }
        }
    }
}

/// Something that is closed until it is asked for.
pub(super) fn folded(summary: &Markup, is_open: bool, content: &Markup) -> Markup {
    html! {
        details open=[is_open.then_some("open")] {
            summary { (summary) }
            (content)
        }
    }
}
