//! What varies and what is not known: P(breach) as something to be uncertain about.

use super::{CONFIDENCE, probabilities::title_of};
use crate::campaign::common_numbers::Event;
use crate::campaign::epistemic::EpistemicOutcomes;
use crate::campaign::{Found, in_parallel};
use crate::error::Result;
use crate::numerics::interval::Estimate;
use crate::numerics::words::{self, Word};
use crate::reliability::nested::{NestedEvent, band, central, shares};
use crate::study::{LimitKind, Study};
use serde::{Deserialize, Serialize};

/// Shares of belief of the quantiles shown.
pub const SHARES: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];
/// Shares of belief of the curve of P.
const CURVE: usize = 99;
/// Thresholds of a p-box.
const THRESHOLDS: usize = 61;
/// Share of outcomes left out at either end of a p-box.
const TAIL: f64 = 0.002;

/// What varies and what is not known.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EpistemicFinding {
    /// Why there is nothing to say.
    pub none: Option<String>,
    /// What is not known, by factor.
    pub unknown: Vec<String>,
    /// What varies, by factor.
    pub varying: Vec<String>,
    /// Sets of values of what is not known, and descents with each.
    pub sets: usize,
    /// See `sets`.
    pub inner: u64,
    /// Whether P of a set is integrated along lines; if not, breaches are counted.
    pub integrated: bool,
    /// Descents spent, those for the shares included.
    pub descents: u64,
    /// Descents of the sets that could not be computed.
    pub faults: u64,
    /// Each limit, then any limit.
    pub events: Vec<EpistemicEvent>,
    /// The outcomes that are limited.
    pub boxes: Vec<ProbabilityBox>,
}

/// What is believed of the probability of one event.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EpistemicEvent {
    /// The event: a limit's name, or `any`.
    pub event: String,
    /// The event in words.
    pub title: String,
    /// Mean of P(event | what is not known): P(event).
    pub mean: Estimate,
    /// Its standard deviation.
    pub standard_deviation: Estimate,
    /// Its quantiles: (share of belief, probability).
    pub quantiles: Vec<(f64, Estimate)>,
    /// Of any breach: what the requirement allows, and the belief that P is at most that.
    pub requirement_met: Option<(f64, Estimate)>,
    /// Standard deviation of what the inner sampling does to one set, which is taken out.
    pub noise: f64,
    /// Its quantile function at evenly spaced shares, for a figure.
    pub curve: Vec<(f64, f64)>,
    /// Why there are no shares.
    pub no_shares: Option<String>,
    /// What each unknown carries of the variance, the most first.
    pub shares: Vec<UnknownShare>,
}

/// What one unknown carries of the variance of P(event | what is not known).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct UnknownShare {
    /// The factor.
    pub factor: String,
    /// How many inputs it is.
    pub inputs: usize,
    /// Knowing it alone settles this share.
    pub first: Estimate,
    /// Knowing everything else leaves this share.
    pub total: Estimate,
}

/// The distribution functions that an outcome may have: a p-box.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ProbabilityBox {
    /// The outcome.
    #[serde(deserialize_with = "words::one")]
    pub outcome: Word,
    /// Its limit, SI, and as written.
    pub limit: f64,
    /// See `limit`.
    pub limit_text: String,
    /// Thresholds, SI, ascending.
    pub thresholds: Vec<f64>,
    /// P(outcome below the threshold).
    pub mean: Vec<f64>,
    /// Shares of belief, each with that quantile of P(outcome below the threshold | what is not known).
    pub bands: Vec<(f64, Vec<f64>)>,
}

/// What varies and what is not known, or why there is nothing to say.
pub(crate) fn epistemic(
    study: &Study,
    outcomes: &Found<EpistemicOutcomes>,
) -> Result<EpistemicFinding> {
    let outcomes = match outcomes {
        Ok(outcomes) => outcomes,
        Err(why) => return Ok(nothing(why.to_string())),
    };
    let events: Vec<Event> =
        (0..study.limits.len()).map(Event::Limit).chain([Event::Any]).collect();
    let events: Vec<EpistemicEvent> =
        in_parallel(&events, |event| self::event(study, outcomes, *event))
            .into_iter()
            .collect::<Result<_>>()?;
    let limits = study.stated_limits();
    let share_points = outcomes.shares.as_ref().map_or(0, |sample| sample.points());
    Ok(EpistemicFinding {
        none: None,
        unknown: outcomes.factors.iter().map(|factor| factor.name.clone()).collect(),
        varying: outcomes.varying.clone(),
        sets: outcomes.sample.sets(),
        inner: outcomes.inner,
        integrated: outcomes.sample.integrates(),
        descents: (outcomes.sample.points() + share_points) as u64,
        faults: outcomes.sample.faults(),
        events,
        boxes: in_parallel(&limits, |&i| probability_box(study, outcomes, i))
            .into_iter()
            .flatten()
            .collect(),
    })
}

fn nothing(why: String) -> EpistemicFinding {
    EpistemicFinding {
        none: Some(why),
        unknown: Vec::new(),
        varying: Vec::new(),
        sets: 0,
        inner: 0,
        integrated: false,
        descents: 0,
        faults: 0,
        events: Vec::new(),
        boxes: Vec::new(),
    }
}

fn nested(event: Event) -> NestedEvent {
    match event {
        Event::Any => NestedEvent::Any,
        Event::Limit(limit) => NestedEvent::Below { limit, margin: 0.0 },
    }
}

fn event(study: &Study, outcomes: &EpistemicOutcomes, event: Event) -> Result<EpistemicEvent> {
    let halves = outcomes.sample.halves(nested(event));
    let allowed = study.requirement.filter(|_| event == Event::Any).map(|r| 1.0 - r.reliability);
    let at: Vec<f64> = allowed.into_iter().collect();
    let found = band(&halves, &SHARES, &at, CONFIDENCE)?;
    let even: Vec<f64> = (1..=CURVE).map(|k| k as f64 / (CURVE + 1) as f64).collect();
    let curve = central(&halves, &even).map_or(Vec::new(), |(_, quantiles)| quantiles);
    let (name, title) = match event {
        Event::Any => ("any".to_owned(), "any limit".to_owned()),
        Event::Limit(i) => (study.limits[i].name(), title_of(&study.limits[i])),
    };
    let (no_shares, shares) = match &outcomes.shares {
        Err(why) => (Some(why.clone()), Vec::new()),
        Ok(sample) => {
            let found = shares(sample, nested(event), CONFIDENCE)?;
            let mut listed: Vec<UnknownShare> = outcomes
                .factors
                .iter()
                .zip(found.first.into_iter().zip(found.total))
                .map(|(factor, (first, total))| UnknownShare {
                    factor: factor.name.clone(),
                    inputs: factor.columns.len(),
                    first,
                    total,
                })
                .collect();
            let size = |share: &UnknownShare| share.total.value.unwrap_or(0.0);
            listed.sort_by(|a, b| size(b).total_cmp(&size(a)));
            (None, listed)
        }
    };
    Ok(EpistemicEvent {
        event: name,
        title,
        mean: found.mean,
        standard_deviation: found.standard_deviation,
        quantiles: found.quantiles,
        requirement_met: found.beliefs.into_iter().next(),
        noise: found.noise,
        curve: even.into_iter().zip(curve).collect(),
        no_shares,
        shares,
    })
}

/// The p-box of a limited outcome; none if fewer than two outcomes could be computed.
fn probability_box(
    study: &Study,
    outcomes: &EpistemicOutcomes,
    i: usize,
) -> Option<ProbabilityBox> {
    let limit = &study.limits[i];
    // The margin is the outcome's distance to the limit.
    let outcome_of = |margin: f64| match limit.kind {
        LimitKind::Max => limit.value - margin,
        LimitKind::Min => limit.value + margin,
    };
    let margins = outcomes.sample.margins().column(i);
    let weights = outcomes.sample.weights();
    let mut values: Vec<(f64, f64)> = margins
        .iter()
        .zip(weights.iter().cycle())
        .map(|(m, weight)| (outcome_of(*m), *weight))
        .filter(|(x, _)| x.is_finite())
        .collect();
    if values.len() < 2 {
        return None;
    }
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let all: f64 = values.iter().map(|(_, weight)| weight).sum();
    let at = |share: f64| {
        let mut below = 0.0;
        let reaches = |(_, weight): &&(f64, f64)| {
            below += weight;
            below >= share * all
        };
        values.iter().find(reaches).or(values.last()).map_or(f64::NAN, |(x, _)| *x)
    };
    let (from, to) = (at(TAIL).min(limit.value), at(1.0 - TAIL).max(limit.value));
    let room = 0.02 * (to - from);
    let (from, to) = (from - room, to + room);
    let thresholds: Vec<f64> =
        (0..THRESHOLDS).map(|k| from + (to - from) * k as f64 / (THRESHOLDS - 1) as f64).collect();
    let shares = [SHARES[0], SHARES[2], SHARES[4]];
    let mut mean = Vec::with_capacity(THRESHOLDS);
    let mut bands: Vec<(f64, Vec<f64>)> = shares.map(|share| (share, Vec::new())).to_vec();
    for &threshold in &thresholds {
        let halves = match limit.kind {
            LimitKind::Max => {
                // The outcome is below where the margin is not.
                let margin = limit.value - threshold;
                outcomes.sample.halves(NestedEvent::Below { limit: i, margin }).complement()
            }
            LimitKind::Min => {
                let margin = threshold - limit.value;
                outcomes.sample.halves(NestedEvent::Below { limit: i, margin })
            }
        };
        let (average, quantiles) = central(&halves, &shares)?;
        mean.push(average);
        for ((_, curve), quantile) in bands.iter_mut().zip(quantiles) {
            // A distribution function does not fall.
            let before = curve.last().copied().unwrap_or(0.0);
            curve.push(quantile.max(before));
        }
    }
    Some(ProbabilityBox {
        outcome: limit.outcome.name(),
        limit: limit.value,
        limit_text: limit.text.clone(),
        thresholds,
        mean,
        bands,
    })
}
