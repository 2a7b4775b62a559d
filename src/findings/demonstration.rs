//! The verdict: is the requirement demonstrated?

use super::percent::percent;
use super::probabilities::{EventKind, ProbabilityFinding};
use super::sequence;
use crate::campaign::Record;
use crate::error::Result;
use crate::numerics::interval::{Earned, Estimate};
use crate::numerics::words::{self, Word};
use crate::reliability::demonstration::{Demonstration, Requirement, Verdict, minimum_samples};
use crate::reliability::probability::Proportion;
use crate::reliability::replicates::from_replicate_counts;
use crate::study::{RequirementOf, StoppingPlan, Study};
use serde::{Deserialize, Serialize};

/// How many rows the failures-allowed table has: 0 to 3 failures.
const TABLE_ROWS: u64 = 4;

/// The verdict in one word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum VerdictWord {
    /// Demonstrated at the stated confidence.
    Met,
    /// The opposite is demonstrated.
    NotMet,
    /// Neither is demonstrated.
    Undecided,
    /// The study states no requirement.
    NoRequirement,
}

impl VerdictWord {
    /// The verdict in words.
    pub fn name(self) -> &'static str {
        match self {
            VerdictWord::Met => "met",
            VerdictWord::NotMet => "not met",
            VerdictWord::Undecided => "undecided",
            VerdictWord::NoRequirement => "no requirement",
        }
    }
}

/// What the verdict rests on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Decision {
    /// Exact binomial bounds on independent samples.
    Counts(Box<Demonstration>),
    /// The one-sided ends of the interval over independent replicates.
    Replicates {
        /// Lower and upper bound of the probability of any breach, each at the requirement's confidence.
        bounds: Earned,
    },
    /// The ends of a confidence sequence: the samples ended because of what was seen.
    Sequence {
        /// Lower and upper bound of the probability of any breach; at every look, and for the limits as
        /// well, both hold together at the requirement's confidence.
        bounds: Earned,
    },
    /// The probability over the epistemic inputs that this brake meets the requirement.
    Brake {
        /// Largest acceptable probability of any breach.
        allowed: f64,
        /// Probability that the brake's own is at most that; the interval is of the computation.
        probability: Estimate,
        /// How probable it must be.
        required: f64,
    },
}

/// The verdict and its evidence.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct VerdictFinding {
    /// The word.
    pub word: VerdictWord,
    /// The verdict as a sentence or two.
    pub statement: String,
    /// What the verdict is of: `average` over all possible brakes, or this `brake`.
    #[serde(deserialize_with = "words::one")]
    pub of: Word,
    /// Where there are epistemic inputs: what holds of the other of the two.
    pub other: Option<String>,
    /// Required reliability.
    pub reliability: Option<f64>,
    /// Confidence with which it must be demonstrated.
    pub confidence: Option<f64>,
    /// What the verdict rests on.
    pub decision: Option<Decision>,
    /// Clean samples and failures that would demonstrate the requirement: (failures, samples).
    pub failures_allowed: Vec<(u64, u64)>,
}

/// The verdict of a study's samples.
///
/// Without a requirement the headline says what the table says of any breach, interval included.
pub(crate) fn verdict(
    study: &Study,
    record: &Record,
    probabilities: &[ProbabilityFinding],
) -> Result<VerdictFinding> {
    let counts = record.counts().any();
    let Some(stated) = study.requirement else {
        let any = probabilities.iter().find(|p| p.kind == EventKind::Any);
        let statement = no_requirement(any);
        return Ok(VerdictFinding {
            word: VerdictWord::NoRequirement,
            statement,
            of: RequirementOf::Average.name(),
            other: None,
            reliability: None,
            confidence: None,
            decision: None,
            failures_allowed: Vec::new(),
        });
    };
    let requirement = Requirement::new(stated.reliability, stated.confidence)?;
    let stopping = study.sampling.stopping;
    let (word, decision, evidence) = if let Some(plan) = stopping {
        by_sequence(study, &plan, &requirement, &counts)?
    } else if record.by_replicate().is_empty() {
        by_counts(&requirement, &counts)?
    } else {
        by_replicates(&requirement, record)?
    };
    let allowed = percent(requirement.failure_limit());
    let demand = format!(
        "probability of any breach at most {allowed} (reliability {}) at {} confidence",
        stated.reliability,
        percent(stated.confidence)
    );
    let statement = match word {
        VerdictWord::Met => format!("Requirement met: {demand} is demonstrated. {evidence}"),
        VerdictWord::NotMet => {
            format!(
                "Requirement not met: {demand} is required, and the opposite is demonstrated. {evidence}"
            )
        }
        _ => format!("Undecided: {demand} is neither demonstrated nor refuted. {evidence}"),
    };
    // The table is of tests whose size is fixed beforehand.
    let rows = if stopping.is_some() { 0 } else { TABLE_ROWS };
    let failures_allowed = (0..rows)
        .map(|failures| {
            minimum_samples(stated.reliability, stated.confidence, failures).map(|n| (failures, n))
        })
        .collect::<Result<_>>()?;
    Ok(VerdictFinding {
        word,
        statement,
        of: RequirementOf::Average.name(),
        other: None,
        reliability: Some(stated.reliability),
        confidence: Some(stated.confidence),
        decision: Some(decision),
        failures_allowed,
    })
}

fn no_requirement(any: Option<&ProbabilityFinding>) -> String {
    let Some(any) = any else {
        return "The study states no limit: there is nothing to breach.".to_owned();
    };
    let estimate = any.probability.map_or("unknown".to_owned(), percent);
    let interval = match &any.interval {
        Earned::Interval(i) => {
            let (lower, upper) = (percent(i.lower), percent(i.upper));
            format!("{} interval {lower} to {upper}", percent(i.confidence))
        }
        Earned::None(why) => format!("no interval: {why}"),
    };
    format!(
        "The study states no requirement. Any limit is breached with probability {estimate} ({interval})."
    )
}

fn by_counts(
    requirement: &Requirement,
    counts: &Proportion,
) -> Result<(VerdictWord, Decision, String)> {
    let demonstration = requirement.verdict(counts)?;
    let word = match demonstration.verdict {
        Verdict::Met => VerdictWord::Met,
        Verdict::NotMet => VerdictWord::NotMet,
        Verdict::Undecided => VerdictWord::Undecided,
    };
    let seen = seen(counts);
    let confidence = percent(requirement.confidence);
    let end = |earned: &Earned, upper: bool| {
        earned
            .interval()
            .map_or("unknown".to_owned(), |i| percent(if upper { i.upper } else { i.lower }))
    };
    let evidence = match demonstration.verdict {
        Verdict::Met => format!(
            "{seen}: the probability is at most {} with {confidence} confidence.",
            end(&demonstration.upper_bound, true)
        ),
        Verdict::NotMet => format!(
            "{seen}: the probability is at least {} with {confidence} confidence.",
            end(&demonstration.lower_bound, false)
        ),
        Verdict::Undecided => format!(
            "{seen}; {} more clean samples would demonstrate it.",
            demonstration.clean_samples_needed
        ),
    };
    Ok((word, Decision::Counts(Box::new(demonstration)), evidence))
}

/// "12 of 1000 samples breached a limit".
fn seen(counts: &Proportion) -> String {
    format!(
        "{} of {} samples breached a limit{}",
        counts.breaches,
        counts.samples,
        match counts.faults {
            0 => String::new(),
            faults => format!(" and {faults} could not be computed"),
        }
    )
}

/// Each end of a confidence sequence bounds the probability at every look, so also at the one at which
/// sampling ended because of what was seen there.
fn by_sequence(
    study: &Study,
    plan: &StoppingPlan,
    requirement: &Requirement,
    counts: &Proportion,
) -> Result<(VerdictWord, Decision, String)> {
    let limit = requirement.failure_limit();
    let bounds = sequence::together(study, plan, *counts, requirement.confidence)?;
    let confidence = percent(requirement.confidence);
    let always = format!("with {confidence} confidence, however often it was looked at");
    let seen = seen(counts);
    let (word, evidence) = match &bounds {
        Earned::Interval(i) if i.upper <= limit => {
            let upper = percent(i.upper);
            (VerdictWord::Met, format!("{seen}: the probability is at most {upper} {always}."))
        }
        Earned::Interval(i) if i.lower > limit => {
            let lower = percent(i.lower);
            (VerdictWord::NotMet, format!("{seen}: the probability is at least {lower} {always}."))
        }
        Earned::Interval(i) => {
            let (lower, upper) = (percent(i.lower), percent(i.upper));
            let evidence =
                format!("{seen}: the probability lies between {lower} and {upper} {always}.");
            (VerdictWord::Undecided, evidence)
        }
        Earned::None(why) => (VerdictWord::Undecided, format!("No interval: {why}.")),
    };
    Ok((word, Decision::Sequence { bounds }, evidence))
}

/// Two one-sided bounds at C are the ends of a two-sided interval at 2 C − 1.
fn by_replicates(
    requirement: &Requirement,
    record: &Record,
) -> Result<(VerdictWord, Decision, String)> {
    let limit = requirement.failure_limit();
    let counts: Vec<Proportion> = record.by_replicate().iter().map(|c| c.any()).collect();
    let both = 2.0 * requirement.confidence - 1.0;
    let bounds = if both <= 0.0 {
        Earned::none("a confidence of one half or less bounds nothing")
    } else if counts.iter().any(|count| count.samples == 0) {
        Earned::none("a replicate has no sample yet")
    } else {
        from_replicate_counts(&counts, both)?.probability.interval
    };
    let confidence = percent(requirement.confidence);
    let (word, evidence) = match &bounds {
        Earned::Interval(i) if i.upper <= limit => (
            VerdictWord::Met,
            format!(
                "Over {} replicates the probability is at most {} with {confidence} confidence.",
                counts.len(),
                percent(i.upper)
            ),
        ),
        Earned::Interval(i) if i.lower > limit => (
            VerdictWord::NotMet,
            format!(
                "Over {} replicates the probability is at least {} with {confidence} confidence.",
                counts.len(),
                percent(i.lower)
            ),
        ),
        Earned::Interval(i) => (
            VerdictWord::Undecided,
            format!(
                "Over {} replicates the probability lies between {} and {}, each end at {confidence} confidence.",
                counts.len(),
                percent(i.lower),
                percent(i.upper)
            ),
        ),
        Earned::None(why) => (VerdictWord::Undecided, format!("No interval: {why}.")),
    };
    Ok((word, Decision::Replicates { bounds }, evidence))
}
