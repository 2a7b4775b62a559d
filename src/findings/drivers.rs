//! What drives the outcomes and the breaches: Sobol' indices from the pick-freeze design.

use super::CONFIDENCE;
use super::named::{FactorName, Output};
use super::probabilities::breach_of;
use crate::campaign::{Found, PickFreezeOutcomes, in_parallel};
use crate::descent::OutcomeQuantity;
use crate::error::Result;
use crate::sensitivity::bootstrap::Resampling;
use crate::sensitivity::rare_events::FEWEST;
use crate::sensitivity::sobol_indices::{FactorIndices, PairIndices, sobol_indices};
use crate::study::Study;
use serde::{Deserialize, Serialize};

/// The drivers of every outcome and every breach.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DriversFinding {
    /// Why there are none.
    pub none: Option<String>,
    /// Rows of each block of the design.
    pub base_samples: usize,
    /// Descents spent.
    pub descents: u64,
    /// Descents that could not be computed.
    pub faults: u64,
    /// One entry an outcome, then one a breach event.
    pub outputs: Vec<DriverOutput>,
}

/// The drivers of one output.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DriverOutput {
    /// The output.
    pub name: Output,
    /// The output in words.
    pub title: String,
    /// Whether it is a breach indicator.
    pub breach: bool,
    /// Mean of the output.
    pub mean: Option<f64>,
    /// Variance of the output.
    pub variance: Option<f64>,
    /// Why the indices of a breach do not rank the factors: too few breaches, or too few descents without one.
    pub too_few: Option<String>,
    /// One entry a factor.
    pub factors: Vec<FactorFinding>,
    /// One entry a pair that was asked for.
    pub pairs: Vec<PairFinding>,
}

/// What two factors do together to one output.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PairFinding {
    /// Paths of the inputs, or names of the groups.
    pub factors: (FactorName, FactorName),
    /// How many inputs they are.
    pub inputs: usize,
    /// The indices.
    #[serde(flatten)]
    pub indices: PairIndices,
}

/// One factor's share in one output.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FactorFinding {
    /// Path of the input, or name of the group.
    pub name: FactorName,
    /// How many inputs it is.
    pub inputs: usize,
    /// Whether it belongs to a group that is listed as a factor of its own.
    pub grouped: bool,
    /// The indices.
    #[serde(flatten)]
    pub indices: FactorIndices,
}

/// The drivers of a study, or why there are none.
pub(crate) fn drivers(
    study: &Study,
    pick_freeze: &Found<PickFreezeOutcomes>,
) -> Result<DriversFinding> {
    let design = match pick_freeze {
        Ok(design) => design,
        Err(why) => {
            return Ok(DriversFinding {
                none: Some(why.to_string()),
                base_samples: 0,
                descents: 0,
                faults: 0,
                outputs: Vec::new(),
            });
        }
    };
    let rows = design.plan.base_samples();
    let replicates = study.sensitivity.bootstrap as usize;
    let resampling = Resampling::new(study.sampling.seed, rows, replicates)?;
    let outputs = in_parallel(&outputs(study), |output| {
        let blocks = output.values(study, design);
        let blocks: Vec<&[f64]> = blocks.iter().map(Vec::as_slice).collect();
        let indices = sobol_indices(&design.plan, &blocks, &resampling, CONFIDENCE)?;
        let factors = design.plan.factors().iter().zip(indices.factors);
        let grouped = |columns: &[usize]| {
            design.plan.factors().iter().any(|other| {
                other.columns.len() > columns.len()
                    && columns.iter().all(|column| other.columns.contains(column))
            })
        };
        let known = design.plan.factors();
        let pairs = indices.pairs.into_iter().map(|indices| {
            let (one, other) = (&known[indices.factors.0], &known[indices.factors.1]);
            PairFinding {
                factors: (FactorName::of(study, one), FactorName::of(study, other)),
                inputs: one.columns.len() + other.columns.len(),
                indices,
            }
        });
        let breach = !matches!(output, Asked::Outcome(_));
        Ok(DriverOutput {
            pairs: pairs.collect(),
            // Blocks A and B: the others repeat their values.
            too_few: too_few(blocks.iter().take(2).copied().flatten()).filter(|_| breach),
            name: output.name(study),
            title: output.title(study),
            breach,
            mean: indices.mean,
            variance: indices.variance,
            factors: factors
                .map(|(factor, indices)| FactorFinding {
                    name: FactorName::of(study, factor),
                    inputs: factor.columns.len(),
                    grouped: grouped(&factor.columns),
                    indices,
                })
                .collect(),
        })
    });
    Ok(DriversFinding {
        none: None,
        base_samples: rows,
        descents: design.plan.points(),
        faults: design.faults,
        outputs: outputs.into_iter().collect::<Result<_>>()?,
    })
}

/// Why these indicators of a breach (NaN: not known) are too few of one kind to tell what drives it.
pub(super) fn too_few<'v>(indicators: impl Iterator<Item = &'v f64>) -> Option<String> {
    let (mut breaches, mut clean) = (0, 0);
    for &value in indicators {
        breaches += u64::from(value == 1.0);
        clean += u64::from(value == 0.0);
    }
    (breaches.min(clean) < FEWEST).then(|| {
        format!(
            "{breaches} of {} descents breach: at least {FEWEST} that do and {FEWEST} that do not are needed \
             to say what drives a breach",
            breaches + clean
        )
    })
}

/// Something whose drivers are asked for.
#[derive(Debug, Clone, Copy)]
enum Asked {
    Outcome(OutcomeQuantity),
    Breach(usize),
    AnyBreach,
}

fn outputs(study: &Study) -> Vec<Asked> {
    let outcomes = OutcomeQuantity::ALL.into_iter().map(Asked::Outcome);
    let breaches = (0..study.limits.len()).map(Asked::Breach);
    let any = (!study.limits.is_empty()).then_some(Asked::AnyBreach);
    outcomes.chain(breaches).chain(any).collect()
}

impl Asked {
    fn name(self, study: &Study) -> Output {
        match self {
            Asked::Outcome(quantity) => Output::Outcome(quantity),
            Asked::Breach(i) => Output::breach_of(&study.limits[i]),
            Asked::AnyBreach => Output::AnyBreach,
        }
    }

    fn title(self, study: &Study) -> String {
        match self {
            Asked::Outcome(quantity) => quantity.title().to_owned(),
            Asked::Breach(i) => breach_of(&study.limits[i]),
            Asked::AnyBreach => "breach of any limit".to_owned(),
        }
    }

    fn values(self, study: &Study, design: &PickFreezeOutcomes) -> Vec<Vec<f64>> {
        let indicator = |margin: f64| match margin {
            m if m.is_nan() => f64::NAN,
            m if m < 0.0 => 1.0,
            _ => 0.0,
        };
        match self {
            Asked::Outcome(quantity) => design.map(|row| row(quantity)),
            Asked::Breach(i) => {
                let limit = &study.limits[i];
                design.map(|row| indicator(limit.margin_of(row(limit.outcome))))
            }
            Asked::AnyBreach => design.map(|row| {
                let margins = study.limits.iter().map(|limit| limit.margin_of(row(limit.outcome)));
                // A known breach decides; otherwise one unknown margin leaves the row unknown.
                margins.map(indicator).fold(0.0, |any: f64, one| match (any, one) {
                    (1.0, _) | (_, 1.0) => 1.0,
                    (any, one) => any + one,
                })
            }),
        }
    }
}
