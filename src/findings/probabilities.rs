//! How probable each breach is, and how sure that is.

use super::CONFIDENCE;
use super::percent::percent;
use super::sequence;
use crate::campaign::Record;
use crate::error::Result;
use crate::numerics::interval::Earned;
use crate::reliability::breach_counts::BreachCounts;
use crate::reliability::probability::Proportion;
use crate::reliability::replicates::from_replicate_counts;
use crate::study::{Limit, LimitKind, Study};
use serde::{Deserialize, Serialize};

/// Fewer breaches than this are stated as an upper bound.
const FEW: u64 = 10;

/// Which event a probability is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EventKind {
    /// One limit is breached.
    Limit,
    /// At least one limit is breached.
    Any,
    /// Both limits of a pair are breached.
    Pair,
}

/// The probability of one event.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ProbabilityFinding {
    /// Kind of event.
    pub kind: EventKind,
    /// Names of the limits concerned.
    pub limits: Vec<String>,
    /// The event in words: "reel-down time above 210 s".
    pub title: String,
    /// Breaches, faults, samples.
    pub counts: Proportion,
    /// The estimate; `None` without a computed sample.
    pub probability: Option<f64>,
    /// Two-sided interval, faults counted both ways.
    pub interval: Earned,
    /// What the share of breaches could be, whatever the faulted samples would have been.
    pub fault_bounds: Option<(f64, f64)>,
    /// One-sided upper bound at the requirement's confidence, or at [`CONFIDENCE`] without one.
    pub upper_bound: Earned,
    /// What to say where breaches are few or none.
    pub statement: Option<String>,
}

/// A breach of a limit in words.
pub(super) fn title_of(limit: &Limit) -> String {
    if limit.implied {
        return format!("line not deployed after {}", limit.text);
    }
    let side = match limit.kind {
        LimitKind::Max => "above",
        LimitKind::Min => "below",
    };
    format!("{} {side} {}", limit.outcome.title(), limit.text)
}

/// The same where indices of the event are listed.
pub(super) fn breach_of(limit: &Limit) -> String {
    match limit.implied {
        true => title_of(limit),
        false => format!("breach of {}", limit.outcome.title()),
    }
}

/// Every event of a study: each limit, any of them, each pair.
pub(crate) fn probabilities(study: &Study, record: &Record) -> Result<Vec<ProbabilityFinding>> {
    let mut found = Vec::new();
    let count = study.limits.len();
    let title = |i: usize| title_of(&study.limits[i]);
    let name = |i: usize| study.limits[i].name();
    for i in 0..count {
        let event = |c: &BreachCounts| c.constraint(i);
        found.extend(finding(study, record, EventKind::Limit, vec![name(i)], title(i), event)?);
    }
    if count > 0 {
        let names = (0..count).map(name).collect();
        let any = |c: &BreachCounts| Some(c.any());
        found.extend(finding(study, record, EventKind::Any, names, "any limit".to_owned(), any)?);
    }
    for i in 0..count {
        for j in i + 1..count {
            let both = |c: &BreachCounts| c.pair(i, j);
            let names = vec![name(i), name(j)];
            let title = format!("{} and {}", title(i), title(j));
            found.extend(finding(study, record, EventKind::Pair, names, title, both)?);
        }
    }
    Ok(found)
}

fn finding(
    study: &Study,
    record: &Record,
    kind: EventKind,
    limits: Vec<String>,
    title: String,
    event: impl Fn(&BreachCounts) -> Option<Proportion>,
) -> Result<Option<ProbabilityFinding>> {
    let Some(counts) = event(record.counts()) else { return Ok(None) };
    let one_sided = study.requirement.map_or(CONFIDENCE, |requirement| requirement.confidence);
    let replicates: Vec<Proportion> = record.by_replicate().iter().filter_map(&event).collect();
    let (probability, interval, upper_bound) = if let Some(plan) = study.sampling.stopping {
        let at = |confidence: f64| match kind {
            EventKind::Pair => sequence::alone(counts, confidence),
            _ => sequence::together(study, &plan, counts, confidence),
        };
        (counts.estimate(), at(plan.confidence)?, sequence::upper_bound(at(one_sided)?))
    } else if replicates.is_empty() {
        (counts.estimate(), counts.interval(CONFIDENCE)?, counts.upper_bound(one_sided)?)
    } else if replicates.iter().any(|count| count.samples == 0) {
        let none = || Earned::none("a replicate has no sample yet");
        (counts.estimate(), none(), none())
    } else {
        let estimate = from_replicate_counts(&replicates, CONFIDENCE)?.probability;
        let upper = match 2.0 * one_sided - 1.0 {
            both if both > 0.0 => from_replicate_counts(&replicates, both)?.probability.interval,
            _ => Earned::none("a confidence of one half or less bounds nothing"),
        };
        (estimate.value.or(counts.estimate()), estimate.interval, upper)
    };
    let statement = if replicates.is_empty() {
        few_breaches(study, &counts, &upper_bound, one_sided)?
    } else {
        None
    };
    Ok(Some(ProbabilityFinding {
        kind,
        limits,
        title,
        probability,
        interval,
        fault_bounds: counts.fault_bounds(),
        upper_bound,
        statement,
        counts,
    }))
}

/// Zero or few breaches are an upper bound, and a number of clean samples that would lower it.
fn few_breaches(
    study: &Study,
    counts: &Proportion,
    bound: &Earned,
    confidence: f64,
) -> Result<Option<String>> {
    if counts.breaches >= FEW {
        return Ok(None);
    }
    let Some(upper) = bound.interval().map(|interval| interval.upper) else { return Ok(None) };
    let seen = match counts.breaches {
        0 => "no breach was seen".to_owned(),
        1 => "one breach was seen".to_owned(),
        some => format!("{some} breaches were seen"),
    };
    let sure = percent(confidence);
    let mut statement =
        format!("{seen}: the probability is at most {} with {sure} confidence", percent(upper));
    if study.sampling.stopping.is_some() {
        // A number of further samples is a promise of a fixed size.
        return Ok(Some(statement));
    }
    let target = match study.requirement {
        Some(requirement) if upper > 1.0 - requirement.reliability => 1.0 - requirement.reliability,
        _ => upper / 10.0,
    };
    let needed = counts.clean_samples_needed(target, confidence)?;
    if needed > 0 {
        let target = percent(target);
        statement += &format!("; {needed} more clean samples would demonstrate at most {target}");
    }
    Ok(Some(statement))
}
