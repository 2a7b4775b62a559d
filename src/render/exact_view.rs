//! The values taken as exact, in a reader's words.

use super::figures_of_speech::count;
use crate::findings::ExactFinding;
use crate::units::number;
use serde::Serialize;

/// The table, ready to be laid out.
#[derive(Debug, Serialize)]
pub(super) struct Exact {
    pub none: Option<String>,
    pub alert: Option<String>,
    pub about: String,
    pub rows: Vec<ExactRow>,
    /// The values that do nothing or cannot be moved.
    pub others: String,
}

#[derive(Debug, Serialize)]
pub(super) struct ExactRow {
    pub path: String,
    pub description: &'static str,
    pub value: String,
    pub source: String,
    pub step: String,
    pub change: String,
}

pub(super) fn exact(finding: &ExactFinding) -> Exact {
    let points = |value: f64| match value {
        v if v > 0.0 => format!("+{}", number(100.0 * v, 2)),
        v => number(100.0 * v, 2).replace('-', "−"),
    };
    let (moving, others): (Vec<_>, Vec<_>) =
        finding.values.iter().partition(|v| v.change.value.is_some_and(|change| change != 0.0));
    let rows = moving.iter().map(|value| ExactRow {
        path: value.path.clone(),
        description: value.description,
        value: value.text.clone(),
        source: value.source.clone(),
        step: value.step.clone(),
        change: match (value.change.value, value.change.standard_error) {
            (Some(change), Some(error)) => {
                format!("{} ± {}", points(change), number(100.0 * error, 1))
            }
            (Some(change), None) => points(change),
            (None, _) => "–".to_owned(),
        },
    });
    let names: Vec<String> =
        others.iter().map(|v| format!("`{}` = {} ({})", v.path, v.text, v.source)).collect();
    let strongest = finding.strongest.as_ref().and_then(|(name, change)| {
        Some(format!(
            " The mean of `{name}`, moved alike, does most of the card's inputs: {}.",
            points(change.value?)
        ))
    });
    Exact {
        none: finding.none.clone(),
        alert: finding.alert.clone(),
        about: format!(
            "Values without a law, and what a small step of each does to P(any breach), in percentage points ± a standard \
             error, by common random numbers on {} samples.{}",
            count(finding.samples as u64),
            strongest.unwrap_or_default()
        ),
        rows: rows.collect(),
        others: match names.is_empty() {
            true => String::new(),
            false => {
                format!("Without effect here, or zero, or a whole number: {}.", names.join(", "))
            }
        },
    }
}
