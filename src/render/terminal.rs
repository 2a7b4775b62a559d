//! The verdict and the probabilities for a terminal.

use super::sketch::sketches;
use super::tables::table;
use super::view::{Rare, RareRow, view};
use crate::analysis::Findings;
use crate::findings::VerdictWord;

/// Whether escape sequences are wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// Text only.
    Plain,
    /// Colour and weight.
    Colour,
}

impl Style {
    fn paint(self, text: &str, code: &str) -> String {
        match self {
            Style::Plain => text.to_owned(),
            Style::Colour => format!("\x1b[{code}m{text}\x1b[0m"),
        }
    }
}

/// Drivers shown on a terminal.
const SHOWN_DRIVERS: usize = 5;

/// Widest line of running text.
const WIDTH: usize = 100;

/// The summary that ends a run.
pub fn terminal(findings: &Findings, style: Style) -> String {
    let view = view(findings);
    let colour = match findings.verdict.word {
        VerdictWord::Met => "1;32",
        VerdictWord::NotMet => "1;31",
        VerdictWord::Undecided => "1;33",
        VerdictWord::NoRequirement => "1",
    };
    let mut text = format!("{}\n\n", style.paint(&view.title, "1"));
    let heading = style.paint(view.verdict.heading.trim_end_matches('.'), colour);
    text += &format!("{heading}\n{}\n", wrapped(&view.verdict.statement));
    if let Some(other) = &view.verdict.other {
        text += &format!("{}\n", wrapped(other));
    }
    if let Some(sharpest) = &view.verdict.sharpest {
        text += &format!("{}\n", wrapped(&sharpest.replace('`', "")));
    }
    if let Some(form) = &view.model_form {
        text += &format!("{}\n", wrapped(&form.headline));
    }
    if let Some(stopping) = &view.stopping {
        text += &format!("{}\n", wrapped(stopping));
    }
    if let Some(alert) = &findings.exact.alert {
        text += &format!("{}\n", wrapped(&alert.replace('`', "")));
    }
    let interval_header = format!("{} interval", view.interval_label);
    if !view.probabilities.is_empty() {
        let interval_header = format!("{} interval", view.probability_label);
        let header = ["event", "breaches", "probability", &interval_header];
        let rows = view.probabilities.iter().filter(|row| !row.pair).map(|row| {
            [&row.title, &row.counts, &row.probability, &row.interval].map(String::clone)
        });
        text += &format!("\n{}\n", table(&header, 1..4, rows, None));
    }
    if view.rare.is_empty() {
        for statement in &view.statements {
            text += &format!("{}\n", wrapped(statement));
        }
    } else {
        text += &format!("\n{}\n", rare(&view.rare, &interval_header));
    }
    if let Some(why) = &view.drivers.none {
        text += &format!("\n{}\n", wrapped(&format!("No sensitivity indices: {why}.")));
    } else if let Some(output) = view.drivers.outputs.first().filter(|o| o.rows.is_empty()) {
        text += &format!(
            "\n{}\n",
            wrapped(&format!("Drivers of {}: {}", output.title, output.sentence))
        );
    } else if let Some(output) = view.drivers.outputs.first() {
        let header = [&format!("drivers of {}", output.title), "alone", "with interactions"];
        let rows = output
            .rows
            .iter()
            .take(SHOWN_DRIVERS)
            .map(|row| [row.name.replace('`', ""), row.first.clone(), row.total.clone()]);
        text += &format!("\n{}\n", table(&header, 1..3, rows, None));
    }
    if !view.trade.best.is_empty() {
        text.push('\n');
        for line in &view.trade.best {
            text += &format!("{}\n", wrapped(&line.replace('`', "")));
        }
    }
    if let Some(calibrated) = &view.calibrated {
        text.push('\n');
        for line in &calibrated.headlines {
            text += &format!("{}\n", wrapped(&line.replace('`', "")));
        }
    }
    if !view.epistemic.headlines.is_empty() {
        text.push('\n');
        for line in &view.epistemic.headlines {
            text += &format!("{}\n", wrapped(&line.replace('`', "")));
        }
    }
    if findings.exceptions.not_deployed + findings.exceptions.faulted > 0 {
        for line in &view.exceptions {
            text += &format!("{}\n", wrapped(line));
        }
    }
    let sketches = sketches(findings);
    if !sketches.is_empty() {
        text += &format!("\n{sketches}");
    }
    text += &format!("\n{}\n", style.paint(&super::sketch::verdict(findings), colour));
    text
}

/// The sharpest estimate of each rare breach, and every agreement check that failed.
fn rare(events: &[Rare], interval_header: &str) -> String {
    let sharpest = |event: &Rare| event.sharpest.and_then(|k| event.rows.get(k)).cloned();
    let rows: Vec<[String; 5]> = events
        .iter()
        .filter_map(|event| {
            let RareRow { method, descents, probability, interval, .. } = sharpest(event)?;
            Some([event.title.clone(), method.to_owned(), descents, probability, interval])
        })
        .collect();
    let header = ["rare breach", "sharpest method", "descents", "probability", interval_header];
    let mut parts = Vec::new();
    if !rows.is_empty() {
        parts.push(table(&header, 2..5, rows, None));
    }
    for event in events.iter().filter(|event| sharpest(event).is_none()) {
        parts.push(wrapped(&format!(
            "{}: no estimate sharper than the samples' own. {}",
            event.title, event.without_interval
        )));
    }
    let mut text = parts.join("\n");
    for event in events.iter().filter(|event| event.disagree) {
        text.push('\n');
        text += &wrapped(&format!("{}: {}", event.title, event.agreement));
    }
    text
}

pub(super) fn wrapped(text: &str) -> String {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= WIDTH => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines.join("\n")
}
