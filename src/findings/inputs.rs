//! What is uncertain, from the card.

use crate::numerics::words::{self, Word};
use crate::study::Study;
use serde::{Deserialize, Serialize};

/// One uncertain parameter; the gaps of one statement are one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct InputFinding {
    /// Dotted path.
    pub path: String,
    /// Letter in the equations.
    #[serde(deserialize_with = "words::one")]
    pub symbol: Word,
    /// What it is.
    #[serde(deserialize_with = "words::one")]
    pub description: Word,
    /// How many inputs follow the law.
    pub inputs: usize,
    /// The law as written.
    pub law: String,
    /// Mean, SI.
    pub mean: f64,
    /// Standard deviation, SI.
    pub standard_deviation: f64,
    /// When its value becomes known.
    #[serde(deserialize_with = "words::one")]
    pub known: Word,
    /// Whether it varies from flight to flight or is fixed and not known.
    #[serde(deserialize_with = "words::one")]
    pub nature: Word,
    /// Where the law comes from.
    pub source: String,
}

/// The uncertain parameters of a study.
pub(crate) fn inputs(study: &Study) -> Vec<InputFinding> {
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

/// A dependence between inputs, realised by a Gaussian copula; like ones of pairs of surfaces are one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CorrelationFinding {
    /// Dotted paths of the two inputs.
    pub between: (String, String),
    /// How many pairs of inputs have it.
    pub pairs: usize,
    /// The inputs in words.
    pub inputs: String,
    /// Which coefficient is stated: `normal`, `spearman`, `kendall`.
    #[serde(deserialize_with = "words::one")]
    pub kind: Word,
    /// The coefficient as stated.
    pub coefficient: f64,
    /// Correlation of the standard normal variables behind the two: the copula's.
    pub normal_correlation: f64,
    /// Where the coefficient comes from.
    pub source: String,
}

/// The correlations of a study's inputs.
pub(crate) fn correlations(study: &Study) -> Vec<CorrelationFinding> {
    let found = study.resolved_correlations().into_iter();
    let finding = found.map(|correlation| CorrelationFinding {
        inputs: correlation.inputs(),
        between: correlation.between,
        pairs: correlation.pairs,
        kind: correlation.measure.name(),
        coefficient: correlation.measure.value(),
        normal_correlation: correlation.measure.normal_correlation(),
        source: correlation.source,
    });
    finding.collect()
}

/// How the inputs depend on each other, after the words of a design of experiment; empty where they do not.
pub(crate) fn dependence(study: &Study) -> String {
    let pairs = study.correlations.len();
    let together: usize = study.drawn_together.iter().map(|one| one.inputs.len()).sum();
    let correlated = match pairs {
        0 => None,
        1 => Some("1 pair is correlated by a Gaussian copula".to_owned()),
        _ => Some(format!("{pairs} pairs are correlated by a Gaussian copula")),
    };
    let drawn =
        (together > 1).then(|| format!("{together} are drawn together from rows of a file"));
    let said: Vec<String> = correlated.into_iter().chain(drawn).collect();
    match said.as_slice() {
        [] => String::new(),
        said => format!("; the inputs are not independent of each other: {}", said.join(", ")),
    }
}
