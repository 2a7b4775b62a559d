//! Derivatives of the outcomes by the gradient kernel, at the nominal design and at the means of the laws.

use super::index::{IndexColumn, root_of_squares};
use crate::campaign::given_sample::GivenSample;
use crate::campaign::screening::Slopes;
use crate::descent::OutcomeQuantity;
use crate::findings::derivatives::step_below;
use crate::numerics::interval::{Earned, Estimate};
use crate::numerics::words::{self, Word};
use crate::study::Study;
use serde::{Deserialize, Serialize};

/// Why a derivative has no interval.
const EXACT: &str = "differentiated, not sampled: as accurate as the integrator's steps";

/// Derivatives of the limited outcomes (of all without a limit).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LocalFinding {
    /// What is differentiated by: the inputs, then the design values that may move.
    pub targets: Vec<LocalTarget>,
    /// One entry an outcome.
    pub outcomes: Vec<LocalOutcome>,
}

/// What an outcome is differentiated by.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LocalTarget {
    /// Its path; of a statement for every surface the statement's, whose inputs move together.
    pub path: String,
    /// How many inputs it is.
    pub inputs: usize,
    /// A step that an engineer would speak of, SI.
    pub step: f64,
    /// The step in words: "1 °F".
    pub step_text: String,
}

/// The derivatives of one outcome, in the order of the targets, SI.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LocalOutcome {
    /// The outcome.
    #[serde(deserialize_with = "words::one")]
    pub name: Word,
    /// At the nominal design; null where that could not be computed.
    pub nominal: Vec<Option<f64>>,
    /// With every input at its law's mean.
    pub mean: Vec<Option<f64>>,
    /// Why there are no intervals, or no derivatives.
    pub note: String,
}

pub(super) fn local(study: &Study, slopes: &Slopes) -> LocalFinding {
    let inputs = study.inputs.len();
    // Members of one statement move together where they are one parameter: its surfaces.
    let mut targets: Vec<(LocalTarget, Vec<usize>)> = Vec::new();
    for (k, target) in slopes.targets.iter().enumerate() {
        let input = study.inputs.get(k).filter(|_| k < inputs);
        let of_surface =
            input.filter(|_| target.surface.is_some()).and_then(|i| i.group.as_deref());
        // The group's own name, unless other parameters are in it, too.
        let alone = |group: &&str| {
            let members = || study.inputs.iter().filter(|i| i.group.as_deref() == Some(group));
            members().all(|i| i.target.parameter == target.parameter)
        };
        let path = match of_surface {
            Some(group) => {
                Some(group).filter(alone).unwrap_or(target.parameter.info().path).to_owned()
            }
            None => target.path(),
        };
        if let Some((known, members)) = targets.iter_mut().find(|(known, _)| known.path == path) {
            known.inputs += 1;
            members.push(k);
            continue;
        }
        let quantity = target.parameter.info().quantity;
        let (step, step_text) = match input {
            Some(input) => step_below(0.5 * input.marginal.law().sd(), quantity),
            None => {
                let range = study.tighten.design.iter().find(|range| range.target == *target);
                step_below(range.map_or(0.0, |range| 0.05 * (range.upper - range.lower)), quantity)
            }
        };
        targets.push((LocalTarget { path, inputs: 1, step, step_text }, vec![k]));
    }
    let limited = |q: &OutcomeQuantity| {
        study.limits.is_empty() || study.limits.iter().any(|limit| limit.outcome == *q)
    };
    let at = |gradient: &Result<_, crate::descent::Fault>, quantity: OutcomeQuantity| {
        let of: Option<Vec<f64>> =
            gradient.as_ref().ok().map(|g: &crate::descent::gradient::Gradient| g.of(quantity));
        let sum = |members: &Vec<usize>| of.as_ref().map(|of| members.iter().map(|&k| of[k]).sum());
        targets.iter().map(|(_, members)| sum(members)).collect::<Vec<Option<f64>>>()
    };
    let note = match (&slopes.nominal, &slopes.mean) {
        (Err(fault), _) => format!("the nominal descent could not be computed: {}", fault.name()),
        (_, Err(fault)) => {
            format!("the descent at the means could not be computed: {}", fault.name())
        }
        _ => format!("no interval: {EXACT}"),
    };
    let outcomes = OutcomeQuantity::ALL.into_iter().filter(limited).map(|quantity| LocalOutcome {
        name: quantity.name(),
        nominal: at(&slopes.nominal, quantity),
        mean: at(&slopes.mean, quantity),
        note: note.clone(),
    });
    let outcomes = outcomes.collect();
    LocalFinding { targets: targets.into_iter().map(|(target, _)| target).collect(), outcomes }
}

/// The derivative at the means times the standard deviation of each factor: what a linear model would make
/// of its spread.
pub(super) fn scaled(
    study: &Study,
    sample: &GivenSample,
    slopes: &Slopes,
    quantity: OutcomeQuantity,
) -> IndexColumn {
    let at = slopes.mean.as_ref().map(|gradient| gradient.of(quantity));
    let one = |j: usize| at.as_ref().ok().map(|of| of[j] * study.inputs[j].marginal.sd());
    let estimates = sample.factors.iter().map(|factor| match factor.columns.as_slice() {
        [j] => match &at {
            Ok(_) => {
                Estimate { value: one(*j), standard_error: None, interval: Earned::none(EXACT) }
            }
            Err(fault) => Estimate::none(fault.name()),
        },
        members => root_of_squares(members.iter().map(|&j| one(j)), EXACT),
    });
    let method = "derivative at the means of the laws times the standard deviation, SI";
    IndexColumn::new("derivative_times_sd", method, 0, estimates.collect(), None)
}
