//! When it becomes known: how far the probability of a breach is settled at build and on the day, and
//! whether to go, given a measured value.

use super::CONFIDENCE;
use super::trade::proportion;
use crate::campaign::Found;
use crate::campaign::common_numbers::{Breaches, Event};
use crate::campaign::known::{Chart, INNER, KnownOutcomes, Map, Second, Stage};
use crate::error::Result;
use crate::numerics::interval::Estimate;
use crate::numerics::words::{self, Word};
use crate::reliability::demonstration::{Requirement, Verdict};
use crate::reliability::jackknife::delete_a_group;
use crate::reliability::nested::untold;
use crate::reliability::probability::Proportion;
use crate::study::Study;
use serde::{Deserialize, Serialize};

/// What becomes known when, and what that settles.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct KnownFinding {
    /// Why there is nothing to say.
    pub none: Option<String>,
    /// Given what is known at build; at build and on the day.
    pub stages: Vec<StageFinding>,
    /// One chart for every input measured on the day.
    pub charts: Vec<GoChart>,
    /// The first input measured on the day with the second, or with the viscosity of the lot.
    pub map: Option<GoMap>,
}

/// Whether to go, given two measured values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GoMap {
    /// Paths of the two.
    pub paths: (String, String),
    /// Whether the second is a design value, measured in the lot that is filled in.
    pub lot: bool,
    /// Its value in the study, if it is one.
    pub present: Option<f64>,
    /// Largest acceptable probability of any breach; `None` without a requirement.
    pub allowed: Option<f64>,
    /// Confidence of `go` and `no_go`, each cell by itself.
    pub confidence: Option<f64>,
    /// Samples behind each cell.
    pub samples: u64,
    /// Measured values of the first, SI.
    pub first: Vec<f64>,
    /// Measured values of the second, SI.
    pub second: Vec<f64>,
    /// P(any breach) and the answer, row by row of the first.
    pub cells: Vec<(Estimate, GoAnswer)>,
}

/// P(any breach) given what is known by some time, over everything that may turn out by then.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StageFinding {
    /// The time: `at build`, `on the day`.
    #[serde(deserialize_with = "words::one")]
    pub known: Word,
    /// Inputs known by then.
    pub inputs: usize,
    /// Sets of known values behind the numbers, and continuations of each.
    pub sets: usize,
    /// See `sets`.
    pub continuations: usize,
    /// Standard deviation of the conditional probability.
    pub standard_deviation: Estimate,
    /// Share of the breach indicator's variance that is settled by then.
    pub settled: Estimate,
    /// Conditional probability that a share of sets stays below: (share, probability); drawn together
    /// about the mean by as much as the continuations' own scatter spreads them.
    pub quantiles: Vec<(f64, f64)>,
    /// Why there are no quantiles: too few sets saw a breach, or a descent without one.
    pub untold: Option<String>,
}

/// Whether to go, given a measured value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GoChart {
    /// Path of the input.
    pub path: String,
    /// Largest acceptable probability of any breach; `None` without a requirement.
    pub allowed: Option<f64>,
    /// Confidence of `go` and `no_go`, each.
    pub confidence: Option<f64>,
    /// Samples behind each row.
    pub samples: u64,
    /// The rows, by ascending value.
    pub rows: Vec<GoRow>,
    /// Share of days on which the measured value lies between neighbouring `go` rows.
    pub go_share: Option<f64>,
}

/// One row of a go/no-go chart.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GoRow {
    /// The measured value, SI.
    pub value: f64,
    /// Share of days on which less is measured.
    pub cumulative: f64,
    /// P(any breach) given it.
    pub probability: Estimate,
    /// The probability of each limit's breach, in the order of the limits.
    pub limits: Vec<Option<f64>>,
    /// The answer.
    pub answer: GoAnswer,
}

/// Whether to go.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GoAnswer {
    /// P is demonstrated to be at most what is allowed.
    Go,
    /// It is demonstrated to be more.
    NoGo,
    /// Neither.
    Undecided,
    /// The study requires nothing.
    NoRequirement,
}

/// Shares of the quantiles shown.
const SHARES: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];

/// What becomes known when, or why there is nothing to say.
pub(crate) fn known(study: &Study, outcomes: &Found<KnownOutcomes>) -> Result<KnownFinding> {
    let outcomes = match outcomes {
        Ok(outcomes) => outcomes,
        Err(why) => {
            return Ok(KnownFinding {
                none: Some(why.to_string()),
                stages: Vec::new(),
                charts: Vec::new(),
                map: None,
            });
        }
    };
    let nothing = outcomes.stages.is_empty() && outcomes.charts.is_empty();
    let why = "the card says of no input that it becomes known before the flight is over";
    Ok(KnownFinding {
        none: nothing.then(|| why.to_owned()),
        stages: outcomes.stages.iter().map(stage).collect(),
        charts: outcomes
            .charts
            .iter()
            .map(|chart| go_chart(study, chart, outcomes.samples))
            .collect::<Result<_>>()?,
        map: outcomes.map.as_ref().map(|map| go_map(study, map)).transpose()?,
    })
}

fn go_map(study: &Study, map: &Map) -> Result<GoMap> {
    let requirement = stated(study)?;
    let path = |input: usize| study.inputs[input].target.path();
    let cell = |breaches: &Breaches| {
        let counts = breaches.count(Event::Any);
        Ok((proportion(&counts)?, answer(requirement.as_ref(), &counts)?))
    };
    Ok(GoMap {
        paths: match map.beside {
            Second::Input(other) => (path(map.input), path(other)),
            Second::Lot(target) => (path(map.input), target.path()),
        },
        lot: matches!(map.beside, Second::Lot(_)),
        present: match map.beside {
            Second::Input(_) => None,
            Second::Lot(target) => Some(study.design.at(target)),
        },
        allowed: requirement.map(|requirement| requirement.failure_limit()),
        confidence: requirement.map(|requirement| requirement.confidence),
        samples: map.samples,
        first: map.first.clone(),
        second: map.second.clone(),
        cells: map.breaches.iter().map(cell).collect::<Result<_>>()?,
    })
}

pub(super) fn stated(study: &Study) -> Result<Option<Requirement>> {
    let stated = study.requirement;
    stated.map(|stated| Requirement::new(stated.reliability, stated.confidence)).transpose()
}

pub(super) fn answer(requirement: Option<&Requirement>, counts: &Proportion) -> Result<GoAnswer> {
    let Some(requirement) = requirement else { return Ok(GoAnswer::NoRequirement) };
    Ok(match requirement.verdict(counts)?.verdict {
        Verdict::Met => GoAnswer::Go,
        Verdict::NotMet => GoAnswer::NoGo,
        Verdict::Undecided => GoAnswer::Undecided,
    })
}

/// Breaches and faults among the continuations of one set of known values.
type Counts = (u64, u64);

/// Variance between sets less what the continuations' own scatter puts into it: unbiased for the
/// variance of the conditional probability.
fn variance_of(sets: &[(u64, u64)]) -> (f64, f64) {
    let (mut count, mut sum, mut squares, mut within) = (0.0, 0.0, 0.0, 0.0);
    for &(breaches, faults) in sets {
        let n = (INNER as u64 - faults) as f64;
        if n < 2.0 {
            continue;
        }
        let p = breaches as f64 / n;
        count += 1.0;
        sum += p;
        squares += p * p;
        within += p * (1.0 - p) / (n - 1.0);
    }
    if count < 2.0 {
        return (f64::NAN, f64::NAN);
    }
    let mean = sum / count;
    let between = (squares - count * mean * mean) / (count - 1.0);
    (between - within / count, mean)
}

/// Groups of sets from which the error is read.
const GROUPS: usize = 20;

fn stage(stage: &Stage) -> StageFinding {
    let sets = &stage.breaches;
    let settled_of = |sets: &[(u64, u64)]| {
        let (variance, mean) = variance_of(sets);
        variance / (mean * (1.0 - mean))
    };
    let deviation_of = |sets: &[(u64, u64)]| variance_of(sets).0.max(0.0).sqrt();
    let mut shares: Vec<f64> = sets
        .iter()
        .filter(|(_, faults)| *faults < INNER as u64)
        .map(|&(breaches, faults)| breaches as f64 / (INNER as u64 - faults) as f64)
        .collect();
    shares.sort_by(f64::total_cmp);
    let mean = shares.iter().sum::<f64>() / shares.len() as f64;
    let squares: f64 = shares.iter().map(|p| (p - mean) * (p - mean)).sum();
    let seen = (squares / (shares.len() as f64 - 1.0)).sqrt();
    // Moments matched: the scatter of the continuations is taken out of the spread of the shares.
    let shrink = if seen > 0.0 { (deviation_of(sets) / seen).min(1.0) } else { 1.0 };
    let quantile = |share: f64| {
        let at = (share * shares.len() as f64) as usize;
        let seen = shares.get(at.min(shares.len().saturating_sub(1))).copied();
        (mean + shrink * (seen.unwrap_or(f64::NAN) - mean)).clamp(0.0, 1.0)
    };
    let (happened, failed_to) =
        (shares.iter().filter(|p| **p > 0.0).count(), shares.iter().filter(|p| **p < 1.0).count());
    let untold = untold(happened, failed_to, shares.len());
    let told = SHARES.iter().filter(|_| untold.is_none());
    StageFinding {
        known: stage.known.name(),
        inputs: stage.inputs,
        sets: sets.len(),
        continuations: INNER,
        standard_deviation: jackknife(sets, &deviation_of),
        settled: jackknife(sets, &settled_of),
        quantiles: told.map(|&share| (share, quantile(share))).collect(),
        untold,
    }
}

/// A statistic of the sets with its error by leaving out one of [`GROUPS`] groups at a time.
fn jackknife(sets: &[Counts], statistic: &dyn Fn(&[Counts]) -> f64) -> Estimate {
    let value = statistic(sets);
    if !value.is_finite() {
        return Estimate::none("no breach, or nothing else, was seen");
    }
    let parts: Vec<f64> = (0..GROUPS)
        .map(|group| {
            let kept = sets.iter().enumerate().filter(|(k, _)| k % GROUPS != group);
            statistic(&kept.map(|(_, set)| *set).collect::<Vec<_>>())
        })
        .collect();
    delete_a_group(value, &parts, CONFIDENCE, "nested Monte Carlo, delete-a-group jackknife")
}

fn go_chart(study: &Study, chart: &Chart, samples: u64) -> Result<GoChart> {
    let input = &study.inputs[chart.input];
    let requirement = stated(study)?;
    let mut rows = Vec::with_capacity(chart.settings.len());
    for (value, breaches) in &chart.settings {
        let counts = breaches.count(Event::Any);
        rows.push(GoRow {
            value: *value,
            cumulative: input.marginal.cdf(*value),
            probability: proportion(&counts)?,
            limits: (0..study.limits.len())
                .map(|i| breaches.count(Event::Limit(i)).estimate())
                .collect(),
            answer: answer(requirement.as_ref(), &counts)?,
        });
    }
    let pairs = rows.windows(2).filter(|pair| pair.iter().all(|row| row.answer == GoAnswer::Go));
    let go_share = pairs.map(|pair| pair[1].cumulative - pair[0].cumulative).sum();
    Ok(GoChart {
        path: input.target.path(),
        allowed: requirement.map(|requirement| requirement.failure_limit()),
        confidence: requirement.map(|requirement| requirement.confidence),
        samples,
        rows,
        go_share: requirement.map(|_| go_share),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_two_kinds_of_sets_have_the_variance_of_their_probabilities() {
        // Half of the sets breach always, half never: the variance is a quarter (n/(n−1) of it, unbiased).
        let sets: Vec<(u64, u64)> =
            (0..100).map(|k| (if k % 2 == 0 { 64 } else { 0 }, 0)).collect();
        let (variance, mean) = variance_of(&sets);
        assert!((variance - 0.25 * 100.0 / 99.0).abs() < 1e-12 && mean == 0.5);
        // One coin for all: the sets' scatter is the continuations' own, and nothing is settled on average.
        let sets: Vec<(u64, u64)> = [24, 28, 30, 32, 32, 34, 36, 40].map(|k| (k, 0)).to_vec();
        assert!(variance_of(&sets).0.abs() < 0.004);
    }
}
