//! Every other measure of what drives an outcome or a breach: from samples already run, from a screening and
//! from derivatives; and whether they agree on the ranking.

mod given;
mod index;
pub mod local;
pub mod ranking;

use super::drivers::DriversFinding;
use super::named::{FactorName, Output};
use super::shapley::ShapleyFinding;
use crate::campaign::Found;
use crate::campaign::given_sample::GivenSample;
use crate::campaign::screening::{ScreeningOutcomes, Slopes};
use crate::error::Result;
use crate::study::Study;
use local::LocalFinding;
use ranking::RankingFinding;
use serde::{Deserialize, Serialize};

pub use index::IndexColumn;

/// The measures of a study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MeasuresFinding {
    /// Why there are none.
    pub none: Option<String>,
    /// Samples of the run that were read again: its first.
    pub samples: usize,
    /// Every input, then every group of several as one: the order of every list of an index.
    pub factors: Vec<MeasuredFactor>,
    /// The limited outcomes (all of them without a limit), then the breach of each limit and of any.
    pub outputs: Vec<MeasuredOutput>,
    /// Whether the measures agree.
    pub ranking: Option<RankingFinding>,
    /// Derivatives of the outcomes.
    pub local: LocalFinding,
}

/// What is measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MeasuredFactor {
    /// Path of the input, or name of the group.
    pub name: FactorName,
    /// How many inputs it is.
    pub inputs: usize,
    /// Whether it belongs to a group that is measured as one.
    pub grouped: bool,
}

/// The measures of one output.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MeasuredOutput {
    /// The output.
    pub name: Output,
    /// The output in words.
    pub title: String,
    /// Whether it is a breach.
    pub breach: bool,
    /// Its indices.
    pub indices: Vec<IndexColumn>,
}

/// The measures of a study, or why there are none.
pub(crate) fn measures(
    study: &Study,
    given: &Found<GivenSample>,
    screening: &Found<ScreeningOutcomes>,
    slopes: &Slopes,
    drivers: &DriversFinding,
    shapley: &ShapleyFinding,
) -> Result<MeasuresFinding> {
    let local = local::local(study, slopes);
    let sample = match given {
        Ok(sample) => sample,
        Err(why) => {
            return Ok(MeasuresFinding {
                none: Some(why.to_string()),
                samples: 0,
                factors: Vec::new(),
                outputs: Vec::new(),
                ranking: None,
                local,
            });
        }
    };
    let grouped = |columns: &[usize]| {
        sample.factors.iter().any(|other| {
            other.columns.len() > columns.len()
                && columns.iter().all(|column| other.columns.contains(column))
        })
    };
    let factors: Vec<MeasuredFactor> = sample
        .factors
        .iter()
        .map(|factor| MeasuredFactor {
            name: FactorName::of(study, factor),
            inputs: factor.columns.len(),
            grouped: grouped(&factor.columns),
        })
        .collect();
    let mut outputs = given::outputs(study, sample)?;
    for output in &mut outputs {
        let Output::Outcome(quantity) = output.name else { continue };
        output.indices.push(index::screened(sample, screening, quantity)?);
        output.indices.push(local::scaled(study, sample, slopes, quantity));
    }
    let ranking = ranking::ranking(study, sample, &factors, &outputs, drivers, shapley);
    Ok(MeasuresFinding {
        none: None,
        samples: sample.outcomes.rows(),
        factors,
        outputs,
        ranking,
        local,
    })
}
