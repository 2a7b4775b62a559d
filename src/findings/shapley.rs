//! Every factor's fair share of the variance, also where inputs are correlated; and where the breaches lie.

use super::CONFIDENCE;
use crate::campaign::common_numbers::Event;
use crate::campaign::in_parallel;
use crate::campaign::shapley::ShapleyOutcomes;
use crate::campaign::trade::TradeOutcomes;
use crate::descent::OutcomeQuantity;
use crate::error::Result;
use crate::numerics::interval::Estimate;
use crate::sensitivity::target::{BreachSensitivity, breach_sensitivities};
use crate::study::Study;
use serde::Serialize;

/// The Shapley effects of the limited outcomes and of a breach of any limit.
#[derive(Debug, Clone, PartialEq, Serialize)]
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
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ShapleyOutput {
    /// The output: an outcome's name, or `breach.any`.
    pub name: String,
    /// Variance of the output.
    pub variance: Option<f64>,
    /// Walks left out because an outcome along them is not known.
    pub left_out: usize,
    /// One entry a factor: its name and its share; the shares add up to one.
    pub effects: Vec<(String, Estimate)>,
}

/// Where the breaches of one event lie.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BreachFinding {
    /// The event: a limit's name, or `any`.
    pub event: String,
    /// One entry an input: its path and what it has to do with the event.
    pub inputs: Vec<(String, BreachSensitivity)>,
}

/// The Shapley effects of a study, or why there are none.
pub(super) fn shapley(
    study: &Study,
    outcomes: &std::result::Result<ShapleyOutcomes, String>,
) -> Result<ShapleyFinding> {
    let outcomes = match outcomes {
        Ok(outcomes) => outcomes,
        Err(why) => {
            let none = Some(why.clone());
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
                (quantity.name().to_owned(), column.to_vec())
            }
            None => ("breach.any".to_owned(), any_breach(study, outcomes)),
        };
        let found = outcomes.walks.effects(&values, CONFIDENCE)?;
        let names = outcomes.factors.iter().map(|factor| factor.name.clone());
        Ok(ShapleyOutput {
            name,
            variance: found.variance,
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

/// Where the breaches of every event lie, from samples of the run.
pub(super) fn breaches(
    study: &Study,
    outcomes: &std::result::Result<TradeOutcomes<'_>, String>,
) -> Result<Vec<BreachFinding>> {
    let Ok(outcomes) = outcomes else { return Ok(Vec::new()) };
    let inputs = outcomes.sample.inputs();
    let columns: Vec<usize> = (0..study.inputs.len()).collect();
    let uniforms = in_parallel(&columns, |&j| -> Vec<f64> {
        let marginal = &study.inputs[j].marginal;
        let open = |u: f64| u.clamp(f64::EPSILON, 1.0 - f64::EPSILON);
        inputs.column(j).iter().map(|&x| open(marginal.cdf(x))).collect()
    });
    let uniforms: Vec<&[f64]> = uniforms.iter().map(Vec::as_slice).collect();
    let events: Vec<(Event, String)> = (0..study.limits.len())
        .map(|i| (Event::Limit(i), study.limits[i].name()))
        .chain([(Event::Any, "any".to_owned())])
        .collect();
    let found = in_parallel(&events, |(event, name)| {
        let indicator = outcomes.base.indicator(*event);
        let found = breach_sensitivities(&uniforms, &indicator, CONFIDENCE)?;
        let paths = study.inputs.iter().map(|input| input.target.path());
        Ok(BreachFinding { event: name.clone(), inputs: paths.zip(found).collect() })
    });
    found.into_iter().collect()
}
