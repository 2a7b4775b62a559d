//! Every factor's fair share of the variance, also where inputs are correlated.

use super::CONFIDENCE;
use super::drivers::too_few;
use super::named::Output;
use crate::campaign::common_numbers::Event;
use crate::campaign::shapley::ShapleyOutcomes;
use crate::campaign::{Found, in_parallel};
use crate::descent::OutcomeQuantity;
use crate::error::Result;
use crate::numerics::interval::Estimate;
use crate::study::Study;
use serde::{Deserialize, Serialize};

/// The Shapley effects of the limited outcomes and of a breach of any limit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ShapleyFinding {
    /// Why there are none.
    pub none: Option<String>,
    /// Walks from point to point, and descents spent on them.
    pub walks: usize,
    /// See `walks`.
    pub descents: u64,
    /// One entry an output.
    pub outputs: Vec<ShapleyOutput>,
}

/// The Shapley effects of one output.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ShapleyOutput {
    /// The output: an outcome, or any breach.
    pub name: Output,
    /// Variance of the output.
    pub variance: Option<f64>,
    /// Why the effects on a breach are not to be read: too few breaches, or too few descents without one.
    pub too_few: Option<String>,
    /// Walks left out because an outcome along them is not known.
    pub left_out: usize,
    /// One entry a factor: its name and its share; the shares add up to one.
    pub effects: Vec<(String, Estimate)>,
}

/// The Shapley effects of a study, or why there are none.
pub(crate) fn shapley(study: &Study, outcomes: &Found<ShapleyOutcomes>) -> Result<ShapleyFinding> {
    let outcomes = match outcomes {
        Ok(outcomes) => outcomes,
        Err(why) => {
            let none = Some(why.to_string());
            return Ok(ShapleyFinding { none, walks: 0, descents: 0, outputs: Vec::new() });
        }
    };
    let mut wanted: Vec<Option<OutcomeQuantity>> =
        study.limits.iter().map(|limit| Some(limit.outcome)).collect();
    wanted.dedup();
    if !study.limits.is_empty() {
        wanted.push(None);
    }
    let outputs = in_parallel(&wanted, |output| {
        let (name, values) = match output {
            Some(quantity) => {
                let column = outcomes.outcomes.column(*quantity as usize);
                (Output::Outcome(*quantity), column.to_vec())
            }
            None => (Output::AnyBreach, any_breach(study, outcomes)),
        };
        let found = outcomes.walks.effects(&values, CONFIDENCE)?;
        let names = outcomes.factors.iter().map(|factor| factor.name.clone());
        Ok(ShapleyOutput {
            name,
            variance: found.variance,
            too_few: too_few(values.iter()).filter(|_| output.is_none()),
            left_out: found.left_out,
            effects: names.zip(found.effects).collect(),
        })
    });
    Ok(ShapleyFinding {
        none: None,
        walks: outcomes.walks.orders(),
        descents: outcomes.outcomes.rows() as u64,
        outputs: outputs.into_iter().collect::<Result<_>>()?,
    })
}

fn any_breach(study: &Study, outcomes: &ShapleyOutcomes) -> Vec<f64> {
    let breaches = crate::campaign::common_numbers::Breaches::from_margins(
        study.limits.len(),
        outcomes.outcomes.rows(),
        |i, k| {
            let limit = &study.limits[i];
            limit.margin_of(outcomes.outcomes.get(k, limit.outcome as usize))
        },
    );
    breaches.indicator(Event::Any)
}
