//! The report as one HTML file that asks the network for nothing: style, script and figures are inside, and
//! its content security policy forbids the rest. Laid out by the templates in `reports/templates/`.

use super::figures::{Figure, ReportFigures};
use super::view::{View, view};
use crate::analysis::Findings;
use crate::error::{Error, Result};
use crate::findings::VerdictWord;
use minijinja::{Environment, Value};
use serde::Serialize;

const TEMPLATE: &str = include_str!("../../reports/templates/report.html");
pub(super) const STYLE: &str = include_str!("../../reports/templates/report.css");
pub(super) const SCRIPT: &str = include_str!("../../reports/templates/report.js");

/// What the template is filled in from: the view, and what only HTML needs.
#[derive(Serialize)]
struct Page {
    #[serde(flatten)]
    view: View,
    verdict_class: &'static str,
    figures: Sections,
    no_interaction: Option<String>,
    style: &'static str,
    script: &'static str,
}

/// The figures of a report by section, for a template.
#[derive(Serialize)]
pub(super) struct Sections {
    probabilities: Vec<Shown>,
    margins: Vec<Shown>,
    drivers: Vec<Shown>,
    trade: Vec<Shown>,
    known: Vec<Shown>,
    epistemic: Vec<Shown>,
    descents: Vec<Shown>,
}

#[derive(Serialize)]
struct Shown {
    file: String,
    title: String,
    caption: String,
    alternative: String,
    svg: String,
}

impl Sections {
    pub(super) fn new(figures: &ReportFigures) -> Self {
        let shown = |figures: &[Figure]| {
            let one = |figure: &Figure| Shown {
                file: figure.file_name(),
                title: figure.title.clone(),
                caption: figure.caption.clone(),
                alternative: figure.alternative.clone(),
                svg: figure.svg.clone(),
            };
            figures.iter().map(one).collect()
        };
        Sections {
            probabilities: shown(&figures.probabilities),
            margins: shown(&figures.margins),
            drivers: shown(&figures.drivers),
            trade: shown(&figures.trade),
            known: shown(&figures.known),
            epistemic: shown(&figures.epistemic),
            descents: shown(&figures.descents),
        }
    }
}

/// The report as HTML.
///
/// # Errors
/// If the template is at fault: a mistake of this program's, which its tests would have shown.
pub fn html(findings: &Findings, figures: &ReportFigures) -> Result<String> {
    let broken = |reason: minijinja::Error| {
        Error::argument(format!("the report template cannot be filled in: {reason:#}"))
    };
    let page = Page {
        view: view(findings),
        verdict_class: match findings.verdict.word {
            VerdictWord::Met => "met",
            VerdictWord::NotMet => "not-met",
            VerdictWord::Undecided => "undecided",
            VerdictWord::NoRequirement => "none",
        },
        figures: Sections::new(figures),
        no_interaction: findings.figures.interaction.as_ref().err().cloned(),
        style: STYLE,
        script: SCRIPT,
    };
    let mut environment = Environment::new();
    environment.add_filter("prose", |text: String| Value::from_safe_string(prose(&text)));
    environment.add_template("report.html", TEMPLATE).map_err(broken)?;
    environment
        .get_template("report.html")
        .and_then(|template| template.render(minijinja::value::Serde(page)))
        .map_err(broken)
}

/// Text with its special characters escaped and what stands between backticks as code.
pub(super) fn prose(text: &str) -> String {
    let escaped =
        text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;");
    let mut html = String::with_capacity(escaped.len());
    let mut parts = escaped.split('`').peekable();
    let mut inside = false;
    while let Some(part) = parts.next() {
        html.push_str(part);
        if parts.peek().is_some() {
            html.push_str(if inside { "</code>" } else { "<code>" });
            inside = !inside;
        }
    }
    if inside {
        html.push_str("</code>");
    }
    // A number does not part from its sign at a line's end.
    html.replace(" %", "\u{a0}%")
}

#[cfg(test)]
mod tests {
    use super::prose;

    #[test]
    fn analytic_a_number_keeps_its_percent_sign() {
        assert_eq!(prose("P = 4 % of"), "P = 4\u{a0}% of");
    }

    #[test]
    fn analytic_backticks_become_code_and_markup_does_not_pass() {
        assert_eq!(prose("by `a.b` <b>"), "by <code>a.b</code> &lt;b&gt;");
        assert_eq!(prose("odd ` one"), "odd <code> one</code>");
        assert_eq!(prose("plain"), "plain");
    }
}
