//! Text that is composed once for a terminal and as Markdown; tables for a terminal: a header, the first column to the left, numbers to the right, no borders.

use super::markdown;
use comfy_table::{CellAlignment, ContentArrangement, Table, presets};

/// A table as text. `numbers` says which columns hold numbers; `width` is where wide ones wrap.
pub fn table<R: IntoIterator<Item = String>>(
    header: &[&str],
    numbers: std::ops::Range<usize>,
    rows: impl IntoIterator<Item = R>,
    width: Option<u16>,
) -> String {
    let mut table = Table::new();
    table.load_style(presets::NOTHING).set_header(header.to_vec());
    for row in rows {
        table.add_row(row.into_iter().collect::<Vec<String>>());
    }
    if let Some(width) = width {
        table.set_content_arrangement(ContentArrangement::Dynamic).set_width(width);
    }
    for column in numbers {
        if let Some(column) = table.column_mut(column) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    let lines: Vec<String> = table.lines().map(|line| line.trim_end().to_owned()).collect();
    lines.join("\n")
}

/// What a text is written for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Medium {
    /// A terminal: lines and aligned columns.
    Terminal,
    /// Markdown: paragraphs and tables.
    Markdown,
}

impl Medium {
    /// The first line.
    pub fn title(self, text: &str) -> String {
        match self {
            Medium::Terminal => format!("{text}\n"),
            Medium::Markdown => format!("# {}\n\n", markdown::inline(text)),
        }
    }

    /// What stands above a table.
    pub fn heading(self, text: &str) -> String {
        match self {
            Medium::Terminal => format!("\n{text}\n"),
            Medium::Markdown => format!("## {}\n\n", markdown::inline(text)),
        }
    }

    /// A line of its own, if there is one.
    pub fn line(self, text: &str) -> String {
        match self {
            _ if text.is_empty() => String::new(),
            Medium::Terminal => format!("{text}\n"),
            Medium::Markdown => format!("{}\n\n", markdown::inline(text)),
        }
    }

    /// A line with a blank one before it.
    pub fn paragraph(self, text: &str) -> String {
        match self {
            Medium::Terminal => format!("\n{text}\n"),
            Medium::Markdown => self.line(text),
        }
    }

    /// A table with a blank line before it.
    pub fn table(
        self,
        header: &[&str],
        numbers: std::ops::Range<usize>,
        rows: impl IntoIterator<Item = Vec<String>>,
        width: Option<u16>,
    ) -> String {
        match self {
            Medium::Terminal => format!("\n{}\n", table(header, numbers, rows, width)),
            Medium::Markdown => {
                let cells: Vec<String> = header.iter().map(|cell| (*cell).to_owned()).collect();
                let rules: Vec<&str> = (0..header.len())
                    .map(|column| if numbers.contains(&column) { "---:" } else { "---" })
                    .collect();
                let body: String = rows.into_iter().map(|row| markdown::row(&row)).collect();
                format!("{}| {} |\n{body}\n", markdown::row(&cells), rules.join(" | "))
            }
        }
    }
}
