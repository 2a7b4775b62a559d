//! The report as Markdown, laid out by the template in `reports/templates/report.md`.

use super::figures::ReportFigures;
use super::html::Sections;
use super::view::{View, view};
use crate::error::{Error, Result};
use crate::findings::Findings;
use minijinja::Environment;
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
    environment.add_template("report.md", TEMPLATE).map_err(broken)?;
    let text = environment
        .get_template("report.md")
        .and_then(|template| template.render(minijinja::value::Serde(page)))
        .map_err(broken)?;
    Ok(tidy(&text))
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
