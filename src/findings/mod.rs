//! The parts of what a report says, each computed once; `analysis` makes one tree of them. Numbers are SI; the renderer
//! chooses units.

pub mod calibrated;
pub mod calibration;
pub(crate) mod demonstration;
pub mod derivatives;
pub mod design_value;
pub(crate) mod drivers;
pub mod epistemic;
pub(crate) mod exact;
pub(crate) mod figures;
pub(crate) mod inputs;
pub mod known;
pub(crate) mod limits;
pub(crate) mod margins;
pub mod measures;
pub(crate) mod model_form;
mod named;
pub(crate) mod numerical;
pub mod paper;
mod percent;
pub(crate) mod probabilities;
mod rare;
pub mod rig;
pub(crate) mod sequence;
pub mod shapley;
mod story;
pub mod sweep;
pub mod sweep_best;
pub(crate) mod this_brake;
pub mod tighten;
pub mod trade;

use crate::campaign::Record;
use crate::descent::{Fault, Outcome, OutcomeQuantity};
use crate::numerics::words::{self, Word};
use crate::study::Study;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

pub use calibrated::{CalibratedEvent, CalibratedFinding, MovedInput};
pub use demonstration::{Decision, VerdictFinding, VerdictWord};
pub use drivers::{DriverOutput, DriversFinding, FactorFinding, PairFinding};
pub use epistemic::{EpistemicEvent, EpistemicFinding, ProbabilityBox, UnknownShare};
pub use exact::{ExactFinding, ExactValue};
pub use figures::{
    Checkpoint, ConstantTemperature, Convergence, Distribution, Exceedance, Fan, FanBand,
    FigureData, Interaction, InteractionInput, PaperRuns, paper_runs,
};
pub use inputs::{CorrelationFinding, InputFinding};
pub use known::KnownFinding;
pub use limits::LimitFinding;
pub use margins::{MarginFinding, MarginQuantile};
pub use measures::MeasuresFinding;
pub use model_form::{FormFinding, ModelFormFinding};
pub use named::{FactorName, Output};
pub use numerical::{NumericalFinding, NumericalLimit};
pub use probabilities::{EventKind, ProbabilityFinding};
pub use rare::{DesignPointFinding, DesignPointInput, RareFinding, rare_findings};
pub use sequence::StoppingFinding;
pub use shapley::{ShapleyFinding, ShapleyOutput};
pub use trade::TradeFinding;

/// Confidence of the two-sided intervals.
pub const CONFIDENCE: f64 = 0.95;

/// The spread of one outcome over the samples, SI.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OutcomeFinding {
    /// Name in study files.
    #[serde(deserialize_with = "words::one")]
    pub name: Word,
    /// Parquet column, with the unit.
    pub column: String,
    /// Samples behind the numbers.
    pub samples: u64,
    /// Mean.
    pub mean: Option<f64>,
    /// Standard deviation.
    pub standard_deviation: Option<f64>,
    /// Smallest value.
    pub smallest: Option<f64>,
    /// Largest value.
    pub largest: Option<f64>,
}

/// The nominal descent: every input at its nominal value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NominalFinding {
    /// Whether the line ran out; `None` if the descent could not be computed.
    pub deployed: Option<bool>,
    /// Outcomes by column name, SI.
    pub outcomes: BTreeMap<String, f64>,
    /// Names of the limits that it breaches.
    pub breaches: Vec<String>,
    /// Why it could not be computed.
    #[serde(deserialize_with = "words::maybe")]
    pub fault: Option<Word>,
}

/// Samples that are counted and shown apart.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ExceptionFinding {
    /// Samples that had not deployed at the time limit of a descent.
    pub not_deployed: u64,
    /// Samples that could not be computed.
    pub faulted: u64,
    /// Faults by kind.
    #[serde(deserialize_with = "words::with")]
    pub faults: Vec<(Word, u64)>,
    /// The first faulted samples: index and kind.
    #[serde(deserialize_with = "words::of")]
    pub first_faulted: Vec<(u64, Word)>,
}

/// How the numbers were obtained.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MethodFinding {
    /// The model of the motion.
    #[serde(deserialize_with = "words::one")]
    pub model: Word,
    /// The design of experiment in words.
    pub design: String,
    /// Descents in the main design.
    pub samples: u64,
    /// Independent replicates of the design.
    pub replicates: u32,
    /// Relative accuracy asked of the integrator.
    pub tolerance: f64,
    /// What a reader must know before leaning on a number.
    pub caveats: Vec<String>,
}

/// What it takes to have the same numbers again.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReproductionFinding {
    /// Version of this program.
    #[serde(deserialize_with = "words::one")]
    pub version: Word,
    /// Seed of every stream.
    pub seed: u64,
    /// SHA-256 of the resolved study.
    pub study_digest: String,
    /// Name and SHA-256 of the study file and each card.
    pub files: Vec<(String, String)>,
    /// The command.
    pub command: String,
}

/// The spread of one outcome.
pub(crate) fn outcome(record: &Record, quantity: OutcomeQuantity) -> OutcomeFinding {
    let summary = record.summary(quantity);
    let any = |value: f64| (summary.samples > 0).then_some(value);
    OutcomeFinding {
        name: quantity.name(),
        column: quantity.column(),
        samples: summary.samples,
        mean: any(summary.mean),
        standard_deviation: summary.standard_deviation(),
        smallest: any(summary.smallest),
        largest: any(summary.largest),
    }
}

/// The nominal descent.
pub(crate) fn nominal(
    study: &Study,
    nominal: &std::result::Result<Outcome, Fault>,
) -> NominalFinding {
    match nominal {
        Ok(outcome) => NominalFinding {
            deployed: Some(outcome.deployed),
            outcomes: OutcomeQuantity::ALL
                .into_iter()
                .map(|quantity| (quantity.column(), outcome.get(quantity)))
                .collect(),
            breaches: study
                .limits
                .iter()
                .filter(|limit| limit.margin(outcome) < 0.0)
                .map(|limit| limit.name())
                .collect(),
            fault: None,
        },
        Err(fault) => NominalFinding {
            deployed: None,
            outcomes: BTreeMap::new(),
            breaches: Vec::new(),
            fault: Some(fault.name()),
        },
    }
}

/// Samples that are shown apart.
pub(crate) fn exceptions(record: &Record) -> ExceptionFinding {
    ExceptionFinding {
        not_deployed: record.not_deployed(),
        faulted: record.fault_counts().iter().map(|(_, count)| count).sum(),
        faults: record.fault_counts().iter().map(|(fault, count)| (fault.name(), *count)).collect(),
        first_faulted: record.faulted().iter().map(|s| (s.index, s.fault.name())).collect(),
    }
}

/// What a reader must know before leaning on a number.
pub(crate) fn caveats(study: &Study, advice: Option<String>) -> Vec<String> {
    let mut caveats = vec![
        "The probabilities are of the model, with the laws of the card: a width that is assumed in the \
         card is assumed in every number here."
            .to_owned(),
        "The intervals hold the sampling error only, not the error of the model or of the card.".to_owned(),
    ];
    if study.sampling.design.is_replicated() {
        caveats.push(
            "The points of this design are not independent: intervals come from its replicates \
             (Korn and Graubard), and exact binomial ones of all points do not apply."
                .to_owned(),
        );
    }
    caveats.extend(study.sampling.stopping.as_ref().map(sequence::caveat));
    caveats.extend(study.notes.iter().cloned());
    caveats.extend(advice);
    caveats
}
