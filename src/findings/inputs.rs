//! What is uncertain, from the card.

use crate::study::Study;
use serde::Serialize;

/// One uncertain parameter; the gaps of one statement are one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InputFinding {
    /// Dotted path.
    pub path: String,
    /// Letter in the equations.
    pub symbol: &'static str,
    /// What it is.
    pub description: &'static str,
    /// How many independent inputs follow the law.
    pub inputs: usize,
    /// The law as written.
    pub law: String,
    /// Mean, SI.
    pub mean: f64,
    /// Standard deviation, SI.
    pub standard_deviation: f64,
    /// When its value becomes known.
    pub known: &'static str,
    /// Whether it varies from flight to flight or is fixed and not known.
    pub nature: &'static str,
    /// Where the law comes from.
    pub source: String,
}

/// The uncertain parameters of a study.
pub(super) fn inputs(study: &Study) -> Vec<InputFinding> {
    study
        .resolved()
        .into_iter()
        .filter_map(|row| {
            let law = row.uncertain?;
            Some(InputFinding {
                path: row.path,
                symbol: row.symbol,
                description: row.description,
                inputs: law.inputs,
                law: law.law,
                mean: law.mean,
                standard_deviation: law.sd,
                known: law.known.name(),
                nature: law.nature.name(),
                source: law.source,
            })
        })
        .collect()
}
