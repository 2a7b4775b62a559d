//! The report as Markdown, laid out by the template in `reports/templates/report.md`.

use super::figures::ReportFigures;
use super::html::Sections;
use super::view::{View, view};
use crate::analysis::Findings;
use crate::error::{Error, Result};
use minijinja::{AutoEscape, Environment};
use serde::Serialize;

const TEMPLATE: &str = include_str!("../../reports/templates/report.md");

/// What the template is filled in from.
#[derive(Serialize)]
struct Page {
    #[serde(flatten)]
    view: View,
    figures: Sections,
}

/// The report as Markdown; its figures are files in the directory `figures` beside it.
///
/// # Errors
/// If the template is at fault: a mistake of this program's, which its tests would have shown.
pub fn markdown(findings: &Findings, figures: &ReportFigures) -> Result<String> {
    let broken = |reason: minijinja::Error| {
        Error::argument(format!("the report template cannot be filled in: {reason:#}"))
    };
    let page = Page { view: view(findings), figures: Sections::new(figures) };
    let mut environment = Environment::new();
    environment.set_auto_escape_callback(|_| AutoEscape::Custom("markdown".into()));
    environment.set_formatter(|out, _, value| match value.as_str() {
        Some(text) if !value.is_safe() => Ok(out.write_str(&inline(text))?),
        _ => Ok(write!(out, "{value}")?),
    });
    environment.add_template("report.md", TEMPLATE).map_err(broken)?;
    let text = environment
        .get_template("report.md")
        .and_then(|template| template.render(minijinja::value::Serde(page)))
        .map_err(broken)?;
    Ok(tidy(&text))
}

/// A text as it may stand within a line of Markdown, a cell of a table included: `|`, `<` and ends of lines show as
/// what they are and change nothing about them. What stands between backticks stays code; a single one is a mark.
pub(super) fn inline(text: &str) -> String {
    let parts: Vec<&str> = text.split('`').collect();
    let mut line = String::with_capacity(text.len());
    for (k, part) in parts.iter().enumerate() {
        // An odd number of backticks leaves the last one without a partner.
        let alone = k + 1 == parts.len() && parts.len().is_multiple_of(2);
        line.push_str(match (k, alone) {
            (0, _) => "",
            (_, true) => "\\`",
            _ => "`",
        });
        let code = k % 2 == 1 && !alone;
        for character in part.chars() {
            match character {
                '|' => line.push_str("\\|"),
                '\\' if !code => line.push_str("\\\\"),
                '<' if !code => line.push_str("&lt;"),
                c if c.is_control() => line.push(' '),
                c => line.push(c),
            }
        }
    }
    line
}

/// A row of a table.
pub(super) fn row(cells: &[String]) -> String {
    let cells: Vec<String> = cells.iter().map(|cell| inline(cell)).collect();
    format!("| {} |\n", cells.join(" | "))
}

/// One blank line where the template left several, and one newline at the end.
fn tidy(text: &str) -> String {
    let mut tidied = String::with_capacity(text.len());
    let mut blank = false;
    for line in text.lines().map(str::trim_end) {
        if !(line.is_empty() && blank) {
            tidied.push_str(line);
            tidied.push('\n');
        }
        blank = line.is_empty();
    }
    format!("{}\n", tidied.trim_end())
}

#[cfg(test)]
mod tests {
    use super::inline;

    #[test]
    fn property_no_text_ends_a_cell_or_becomes_markup() {
        assert_eq!(inline("a|b <b>\nc"), "a\\|b &lt;b> c");
        assert_eq!(inline("by `a<b|c` and `"), "by `a<b\\|c` and \\`");
        assert_eq!(inline("a\\|b"), "a\\\\\\|b");
        assert_eq!(inline("plain, ± 3 %"), "plain, ± 3 %");
    }
}
