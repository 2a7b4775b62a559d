//! What may be said when sampling ended because of what was seen: intervals that hold at every look.

use super::percent::percent;
use crate::error::Result;
use crate::numerics::interval::{Earned, Interval};
use crate::reliability::adaptive::{AdaptiveMonteCarlo, Stop, Until};
use crate::reliability::confidence_sequence::confidence_sequence;
use crate::reliability::probability::Proportion;
use crate::study::{StoppingPlan, Study};
use serde::{Deserialize, Serialize};

/// Why the sampling ended where it did.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StoppingFinding {
    /// What it waited for.
    pub until: Until,
    /// Confidence of the intervals at every look.
    pub confidence: f64,
    /// Samples after which it would have ended in any case.
    pub budget: u64,
    /// Samples after which it ended.
    pub samples: u64,
    /// Why.
    pub reason: Stop,
    /// The same in words.
    pub statement: String,
}

/// Why the sampling ended, if that was decided while sampling.
pub(crate) fn stopping(
    study: &Study,
    samples: u64,
    reason: Option<Stop>,
) -> Option<StoppingFinding> {
    let (plan, reason) = (study.sampling.stopping?, reason?);
    let budget = study.sampling.samples;
    let statement = match (reason, plan.until) {
        (Stop::Precise, Until::RelativeError(error)) => format!(
            "Sampling stopped after {samples} of at most {budget} samples: any breach is known to \
             within {}.",
            percent(error)
        ),
        (Stop::Budget, Until::RelativeError(error)) => format!(
            "Sampling used its budget of {budget} samples before the relative error of {} was reached.",
            percent(error)
        ),
        (Stop::Budget, Until::Decided { .. }) => format!(
            "Sampling used its budget of {budget} samples before the requirement was decided."
        ),
        (reason, _) => format!(
            "Sampling stopped after {samples} of at most {budget} samples: the requirement is {}.",
            if reason == Stop::Met { "met" } else { "missed" }
        ),
    };
    Some(StoppingFinding {
        until: plan.until,
        confidence: plan.confidence,
        budget,
        samples,
        reason,
        statement,
    })
}

/// What a reader of such a run must know.
pub(super) fn caveat(plan: &StoppingPlan) -> String {
    format!(
        "The number of samples was decided while looking at them. The intervals of the probabilities are \
         confidence sequences, which hold at every look, for all limits and any of them together, with {} \
         confidence; fixed-size intervals would not, so the margins' quantiles have none.",
        percent(plan.confidence)
    )
}

/// The interval of one event at the end of such a run, at a confidence that holds for all limits and
/// any of them together.
///
/// # Errors
/// If the confidence is not strictly between 0 and 1.
pub(super) fn together(
    study: &Study,
    plan: &StoppingPlan,
    counts: Proportion,
    confidence: f64,
) -> Result<Earned> {
    let limits = study.limits.len().max(1);
    let budget = study.sampling.samples;
    let each = AdaptiveMonteCarlo::new(limits, plan.until, confidence, budget)?.each_confidence();
    let method = "beta-binomial confidence sequence, simultaneous";
    Ok(stated(confidence_sequence(counts, each)?, confidence, method))
}

/// The interval of one event alone at the end of such a run.
///
/// # Errors
/// If the confidence is not strictly between 0 and 1.
pub(super) fn alone(counts: Proportion, confidence: f64) -> Result<Earned> {
    confidence_sequence(counts, confidence)
}

/// `[0, u]` with the upper end of an interval.
pub(super) fn upper_bound(interval: Earned) -> Earned {
    match interval {
        Earned::Interval(i) => Interval { lower: 0.0, ..i }.into(),
        none => none,
    }
}

fn stated(earned: Earned, confidence: f64, method: &'static str) -> Earned {
    match earned {
        Earned::Interval(i) => Interval { confidence, method, ..i }.into(),
        none => none,
    }
}
