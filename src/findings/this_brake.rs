//! Two statements where a study has epistemic inputs: what is shown of the average over brakes, and how probable it is that
//! the one brake that is built meets the requirement.
//!
//! A count of breaches among descents that each have a brake of their own is about the average over brakes that will not be
//! built. Of this brake P(any breach) is one number that is not known; nested descents give its law.

use super::demonstration::{Decision, VerdictFinding, VerdictWord};
use super::epistemic::{EpistemicEvent, EpistemicFinding};
use super::percent::percent;
use crate::numerics::interval::{Earned, Estimate};
use crate::study::{Nature, RequirementOf, Study};

/// Whether some input is a constant of the brake that is not known.
pub(super) fn has_epistemic_inputs(study: &Study) -> bool {
    study.inputs.iter().any(|input| input.nature == Nature::Unknown || input.readings.is_some())
}

/// "56.7 % (54.1 … 59.3 %, 95 % interval)".
pub(super) fn with_interval(estimate: &Estimate) -> Option<String> {
    let value = percent(estimate.value?);
    Some(match estimate.interval.interval() {
        Some(i) => format!(
            "{value} ({} … {}, {} interval)",
            percent(i.lower),
            percent(i.upper),
            percent(i.confidence)
        ),
        None => value,
    })
}

/// The verdict on the average, made the two statements of a study with epistemic inputs; the requirement says which of them
/// decides.
pub(crate) fn two_statements(
    study: &Study,
    average: VerdictFinding,
    epistemic: &EpistemicFinding,
) -> VerdictFinding {
    let Some(stated) = study.requirement.filter(|_| has_epistemic_inputs(study)) else {
        return average;
    };
    let any = epistemic.events.iter().find(|event| event.event == "any");
    let belief = any.and_then(|event| event.requirement_met.as_ref());
    let why_not = match (&epistemic.none, belief) {
        (Some(why), _) => Some(why.clone()),
        (None, None) => Some("no set of values could be evaluated".to_owned()),
        (None, Some((_, belief))) if belief.value.is_none() => {
            Some(belief.interval.why_none().unwrap_or("unknown").to_owned())
        }
        _ => None,
    };
    let of_average = format!("Average over all possible brakes. {}", average.statement);
    let (word, of_brake) = match (&why_not, any, belief) {
        (None, Some(event), Some((allowed, belief))) => {
            of_this_brake(stated.confidence, *allowed, event, belief)
        }
        (why, _, _) => {
            let why = why.as_deref().unwrap_or("unknown");
            let statement = format!(
                "This brake: the probability that it meets the requirement by itself was not computed: {why}."
            );
            (VerdictWord::Undecided, statement)
        }
    };
    match stated.of {
        RequirementOf::Average => {
            VerdictFinding { statement: of_average, other: Some(of_brake), ..average }
        }
        RequirementOf::Brake => VerdictFinding {
            word,
            statement: of_brake,
            other: Some(of_average),
            of: RequirementOf::Brake.name(),
            decision: belief.map(|(allowed, belief)| Decision::Brake {
                allowed: *allowed,
                probability: belief.clone(),
                required: stated.confidence,
            }),
            failures_allowed: Vec::new(),
            ..average
        },
    }
}

/// Whether it is probable enough, over the epistemic inputs, that this brake keeps the requirement, as a sentence.
fn of_this_brake(
    required: f64,
    allowed: f64,
    event: &EpistemicEvent,
    belief: &Estimate,
) -> (VerdictWord, String) {
    let word = match &belief.interval {
        Earned::Interval(i) if i.lower >= required => VerdictWord::Met,
        Earned::Interval(i) if i.upper < required => VerdictWord::NotMet,
        _ => VerdictWord::Undecided,
    };
    let held = match word {
        VerdictWord::Met => "at least as probable as required",
        VerdictWord::NotMet => "less probable than required",
        _ => "not shown to be, nor not to be, as probable as required",
    };
    let value = with_interval(belief).unwrap_or_else(|| "unknown".to_owned());
    let at = |share: f64| {
        let found = event.quantiles.iter().find(|(at, _)| *at == share);
        found.and_then(|(_, estimate)| estimate.value).map(percent)
    };
    let range = match (at(0.05), at(0.5), at(0.95)) {
        (Some(low), Some(median), Some(high)) => format!(
            " Its P(any breach) has the 90 % credible interval {low} … {high}, median {median}."
        ),
        _ => String::new(),
    };
    let statement = format!(
        "This brake: that its own probability of any breach is at most {} has the probability {value} over the epistemic \
         inputs: {held} ({}).{range}",
        percent(allowed),
        percent(required)
    );
    (word, statement)
}
