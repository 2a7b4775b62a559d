//! What the values that are taken as exact do to P(any breach).

use super::trade::Paired;
use crate::campaign::Found;
use crate::campaign::common_numbers::Event;
use crate::campaign::exact::{ExactOutcomes, KELVIN, SHARE};
use crate::error::Result;
use crate::numerics::interval::Estimate;
use crate::numerics::words::{self, Word};
use crate::study::Study;
use crate::units::Quantity;
use serde::{Deserialize, Serialize};

/// The values that no law varies, by what they do.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ExactFinding {
    /// Why it is not known what they do.
    pub none: Option<String>,
    /// Samples at which they were moved.
    pub samples: usize,
    /// The values, the one that does most first.
    pub values: Vec<ExactValue>,
    /// The input of the card that does most with its mean moved alike, and what it does.
    pub strongest: Option<(String, Estimate)>,
    /// That some of the values outweigh the card, if they do.
    pub alert: Option<String>,
}

/// One value that is taken as exact.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ExactValue {
    /// Dotted path.
    pub path: String,
    /// What it is.
    #[serde(deserialize_with = "words::one")]
    pub description: Word,
    /// Value, SI.
    pub value: f64,
    /// Value as an engineer reads it.
    pub text: String,
    /// Where it comes from.
    pub source: String,
    /// By how much it was moved: "1 %".
    pub step: String,
    /// What that does to P(any breach); common random numbers.
    pub change: Estimate,
}

/// Changes of P in order of size.
fn size(change: &Estimate) -> f64 {
    change.value.map_or(-1.0, f64::abs)
}

/// The exact values of a study.
pub(crate) fn exact(study: &Study, outcomes: &Found<ExactOutcomes>) -> Result<ExactFinding> {
    let outcomes = match outcomes {
        Ok(outcomes) => outcomes,
        Err(why) => {
            return Ok(ExactFinding {
                none: Some(why.to_string()),
                samples: 0,
                values: Vec::new(),
                strongest: None,
                alert: None,
            });
        }
    };
    let paired = Paired { replicates: outcomes.replicates };
    let rows = study.resolved();
    let mut values = Vec::new();
    for moved in &outcomes.values {
        let Some(row) = rows.iter().find(|row| row.target == moved.target) else { continue };
        let (step, change) = match &moved.moved {
            None => {
                ("–".to_owned(), Estimate::none("a whole number or zero has no share to move by"))
            }
            Some((step, breaches)) => {
                let sign = if *step < 0.0 { "−" } else { "+" };
                let text = match row.quantity {
                    Quantity::Temperature => format!("{sign}{KELVIN} K"),
                    _ => format!("{sign}{} %", 100.0 * SHARE),
                };
                (text, paired.difference(&outcomes.base, breaches, Event::Any)?)
            }
        };
        values.push(ExactValue {
            path: row.path.clone(),
            description: row.description,
            value: row.value,
            text: row.text.clone(),
            source: row.source.clone(),
            step,
            change,
        });
    }
    values.sort_by(|a, b| size(&b.change).total_cmp(&size(&a.change)));
    let mut strongest: Option<(String, Estimate)> = None;
    for (name, breaches) in &outcomes.inputs {
        let change = paired.difference(&outcomes.base, breaches, Event::Any)?;
        if strongest.as_ref().is_none_or(|(_, most)| size(&change) > size(most)) {
            strongest = Some((name.clone(), change));
        }
    }
    let alert = alert(&values, strongest.as_ref());
    Ok(ExactFinding { none: None, samples: outcomes.base.rows(), values, strongest, alert })
}

/// Which values do more than the strongest input of the card, beyond the error of both.
fn alert(values: &[ExactValue], strongest: Option<&(String, Estimate)>) -> Option<String> {
    let (name, most) = strongest?;
    let error = |estimate: &Estimate| estimate.standard_error.unwrap_or(0.0);
    let outweighs = |value: &&ExactValue| {
        let (a, b) = (error(&value.change), error(most));
        let both = (a * a + b * b).sqrt();
        size(&value.change) > size(most) + 2.0 * both
    };
    let points = |estimate: &Estimate| crate::units::number(100.0 * size(estimate), 2);
    let named: Vec<String> = values
        .iter()
        .filter(outweighs)
        .map(|value| format!("`{}` ({})", value.path, points(&value.change)))
        .collect();
    (!named.is_empty()).then(|| {
        format!(
            "ALERT: taken as exact, without a stated accuracy, and of more weight than any input of the card: {}. \
             In parentheses: change of P(any breach) in percentage points for 1 % (a temperature: 1 K); the card's strongest \
             input, `{name}`, makes {}. The uncertainty of these values is in no number of this report: give them laws.",
            named.join(", "),
            points(most)
        )
    })
}
