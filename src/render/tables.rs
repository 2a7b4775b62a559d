//! Tables for a terminal: a header, the first column to the left, numbers to the right, no borders.

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
