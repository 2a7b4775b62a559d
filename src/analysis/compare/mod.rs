//! What changed between two finished runs: inputs, probabilities, margins, drivers.

mod reported;
mod studies;

use super::Findings;
use crate::campaign::common_numbers::{Breaches, Event};
use crate::descent::OutcomeQuantity;
use crate::error::Result;
use crate::findings::trade::proportion;
use crate::findings::{CONFIDENCE, VerdictWord};
use crate::numerics::interval::{Earned, Estimate, Interval};
use crate::numerics::special::normal;
use crate::reliability::paired::{PairedCounts, replicated_difference};
use crate::reliability::replicates::from_replicate_counts;
use crate::reliability::unpaired;
use crate::sampling::Design;
use crate::study::{Limit, LimitKind, Study};
use reported::{drivers, margins};
use serde::Serialize;

/// One of the two runs.
#[derive(Debug)]
pub struct FinishedRun {
    /// Where it lies, as named by whoever asks.
    pub name: String,
    /// Its study.
    pub study: Study,
    /// Its findings.
    pub findings: Findings,
    /// Its margins, limit by limit, SI, in the order of the samples; NaN where faulted.
    pub margins: Vec<Vec<f64>>,
}

/// What changed between two runs. Numbers are SI.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CompareFinding {
    /// Layout of this tree.
    pub format: u32,
    /// The two runs: directory, title, verdict, samples, digest of the study.
    pub runs: [RunFinding; 2],
    /// What differs between the studies.
    pub changes: Vec<ChangeFinding>,
    /// Whether rows are compared one by one.
    pub paired: bool,
    /// Why, and what that means.
    pub pairing: String,
    /// Any limit and each limit that both runs have.
    pub probabilities: Vec<EventChange>,
    /// Means of the limited outcomes.
    pub outcomes: Vec<OutcomeChange>,
    /// Margins kept by a share of flights.
    pub margins: Vec<MarginChange>,
    /// Total Sobol' indices of "any breach", the largest first.
    pub drivers: Vec<DriverChange>,
    /// What could not be compared.
    pub notes: Vec<String>,
}

/// One of the runs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunFinding {
    /// Where it lies.
    pub name: String,
    /// Title of its study.
    pub title: String,
    /// Its verdict.
    pub verdict: VerdictWord,
    /// Its samples.
    pub samples: u64,
    /// SHA-256 of its resolved study.
    pub study_digest: String,
}

/// One difference between the studies.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChangeFinding {
    /// `design`, `law`, `limit`, `requirement`, `sampling`, `model`, `correlation`.
    pub kind: &'static str,
    /// What it is.
    pub what: String,
    /// Before; `None` where there was none.
    pub before: Option<String>,
    /// After; `None` where there is none.
    pub after: Option<String>,
}

/// The probability of one event in both runs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EventChange {
    /// `any`, or the limit's name.
    pub event: String,
    /// In words.
    pub title: String,
    /// Before.
    pub before: Estimate,
    /// After.
    pub after: Estimate,
    /// After less before.
    pub difference: Estimate,
    /// Rows of a paired comparison that breach only after, and only before.
    pub disagreeing: Option<(u64, u64)>,
}

/// The mean of one outcome in both runs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OutcomeChange {
    /// Name of the outcome.
    pub outcome: &'static str,
    /// Which it is.
    #[serde(skip)]
    pub quantity: OutcomeQuantity,
    /// Mean before.
    pub before: Option<f64>,
    /// Mean after.
    pub after: Option<f64>,
    /// After less before.
    pub difference: Estimate,
}

/// The margin that a share of flights keeps, in both runs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MarginChange {
    /// Name of the limit.
    pub limit: String,
    /// Its outcome.
    #[serde(skip)]
    pub quantity: OutcomeQuantity,
    /// The share of flights.
    pub share: f64,
    /// Margin before.
    pub before: Option<f64>,
    /// Margin after.
    pub after: Option<f64>,
}

/// One driver of "any breach" in both runs: total index with its interval.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DriverChange {
    /// Path of the input, or name of the group.
    pub factor: String,
    /// Before: value, lower and upper end.
    pub before: Option<(f64, Option<(f64, f64)>)>,
    /// After.
    pub after: Option<(f64, Option<(f64, f64)>)>,
}

/// Compares two runs.
///
/// # Errors
/// If a statistic refuses its confidence, which this program sets.
pub fn compare(before: &FinishedRun, after: &FinishedRun) -> Result<CompareFinding> {
    let pairing = Pairing::of(before, after);
    let breaches = [before, after].map(|run| {
        let rows = run.margins.first().map_or(0, Vec::len);
        Breaches::from_margins(run.margins.len(), rows, |i, k| run.margins[i][k])
    });
    let both = shared_limits(&before.study, &after.study);
    let mut probabilities = Vec::new();
    let mut events = vec![("any".to_owned(), "any limit".to_owned(), Event::Any, Event::Any)];
    for &(i, j) in &both {
        let (limit, other) = (&before.study.limits[i], &after.study.limits[j]);
        let title = format!("{} {}", limit.outcome.title(), limit_words(limit, other));
        events.push((limit.name(), title, Event::Limit(i), Event::Limit(j)));
    }
    if before.study.limits.is_empty() || after.study.limits.is_empty() {
        events.clear();
    }
    for (event, title, first, second) in events {
        probabilities.push(pairing.event(&breaches, (event, title), first, second)?);
    }
    let outcomes = both
        .iter()
        .map(|&(i, j)| {
            let values = |run: &FinishedRun, i: usize| -> Vec<f64> {
                let limit = &run.study.limits[i];
                // The margin's own inverse.
                let value = |margin: &f64| match limit.kind {
                    LimitKind::Max => limit.value - margin,
                    LimitKind::Min => limit.value + margin,
                };
                run.margins[i].iter().map(value).collect()
            };
            let quantity = before.study.limits[i].outcome;
            pairing.outcome(quantity, &values(before, i), &values(after, j))
        })
        .collect();
    let mut notes = Vec::new();
    for (run, study, other) in
        [(before, &before.study, &after.study), (after, &after.study, &before.study)]
    {
        for limit in &study.limits {
            if !other.limits.iter().any(|l| l.name() == limit.name()) {
                let name = limit.name();
                notes.push(format!("only {} has the limit `{name}`: it is not compared", run.name));
            }
        }
        let own = study.notes.iter().filter(|note| !other.notes.contains(note));
        notes.extend(own.map(|note| format!("in {}, {note}", run.name)));
    }
    Ok(CompareFinding {
        format: 1,
        runs: [run_finding(before), run_finding(after)],
        changes: studies::changes(&before.study, &after.study),
        paired: pairing.rows.is_some(),
        pairing: pairing.words,
        probabilities,
        outcomes,
        margins: margins(before, after, &both),
        drivers: drivers(before, after),
        notes,
    })
}

fn run_finding(run: &FinishedRun) -> RunFinding {
    RunFinding {
        name: run.name.clone(),
        title: run.study.title.clone(),
        verdict: run.findings.verdict.word,
        samples: run.findings.method.samples,
        study_digest: run.findings.reproduction.study_digest.clone(),
    }
}

/// Places of the limits that both studies have.
fn shared_limits(before: &Study, after: &Study) -> Vec<(usize, usize)> {
    let place = |limit: &Limit| after.limits.iter().position(|l| l.name() == limit.name());
    before.limits.iter().enumerate().filter_map(|(i, l)| Some((i, place(l)?))).collect()
}

fn limit_words(before: &Limit, after: &Limit) -> String {
    let side = match before.kind {
        LimitKind::Max => "above",
        LimitKind::Min => "below",
    };
    match before.value == after.value {
        true => format!("{side} {}", before.text),
        false => format!("{side} its limit ({}, then {})", before.text, after.text),
    }
}

/// Whether rows go together, and how.
struct Pairing {
    /// Rows compared one by one.
    rows: Option<usize>,
    /// Replicates to which rows belong in turn.
    replicates: usize,
    /// Whether unpaired samples are independent, row from row and run from run.
    independent: bool,
    words: String,
}

impl Pairing {
    fn of(before: &FinishedRun, after: &FinishedRun) -> Self {
        let plans = (before.study.sampling, after.study.sampling);
        let (a, b) = plans;
        let rows = |run: &FinishedRun| run.margins.first().map_or(0, Vec::len);
        let counts = (rows(before), rows(after));
        let none = |independent: bool, words: &str| Pairing {
            rows: None,
            replicates: 1,
            independent,
            words: words.to_owned(),
        };
        if a.stopping.is_some() || b.stopping.is_some() {
            return none(
                false,
                "Not paired, and the differences have no interval: the sampling of a run ended because of \
                 what it had seen.",
            );
        }
        let plain = (a.design == Design::MonteCarlo, b.design == Design::MonteCarlo);
        if a.seed != b.seed {
            return match plain {
                (true, true) => {
                    none(true, "Not paired: the seeds differ, so the samples are independent.")
                }
                _ => none(
                    false,
                    "Not paired, and the differences have no interval: the seeds differ, and the points of a \
                     design that is not plain Monte Carlo are not independent. Run both with one seed.",
                ),
            };
        }
        let same = a.design == b.design
            && a.replicates == b.replicates
            && before.study.inputs.len() == after.study.inputs.len()
            && (a.design != Design::LatinHypercube || counts.0 == counts.1);
        // Plain Monte Carlo samples of one seed depend on each other whatever else differs, row by row.
        if !same && plain != (true, true) {
            return none(
                false,
                "Not paired, and the differences have no interval: the runs share a seed and not the design \
                 of experiment.",
            );
        }
        let replicates = (a.replicates as usize).max(1);
        let shared = counts.0.min(counts.1) / replicates * replicates;
        let targets = |run: &FinishedRun| -> Vec<_> {
            run.study.inputs.iter().map(|input| input.target).collect()
        };
        let mut words = if targets(before) == targets(after) {
            "Paired: both runs have the same seed and inputs, so row k of both is the same point of the \
             design, and only rows in which the two disagree count (common random numbers)."
                .to_owned()
        } else {
            "Paired by row, since both runs draw from the same random numbers; their inputs differ, so a row \
             is not the same flight in both, and pairing gains less."
                .to_owned()
        };
        if counts.0 != counts.1 {
            words += &format!(" The first {shared} rows, which both have, are compared.");
        }
        Pairing { rows: Some(shared), replicates, independent: true, words }
    }

    fn event(
        &self,
        breaches: &[Breaches; 2],
        (event, title): (String, String),
        first: Event,
        second: Event,
    ) -> Result<EventChange> {
        let [a, b] = breaches;
        let share = |of: &Breaches, event: Event| match self.replicates {
            1 => proportion(&of.count(event)),
            several => {
                let counts: Vec<_> = (0..several)
                    .map(|r| of.counts(event, (r..of.rows()).step_by(several)))
                    .collect();
                Ok(from_replicate_counts(&counts, CONFIDENCE)?.probability)
            }
        };
        let (before, after) = (share(a, first)?, share(b, second)?);
        let Some(rows) = self.rows else {
            let mut difference =
                unpaired::difference(&a.count(first), &b.count(second), CONFIDENCE)?;
            if !self.independent {
                difference.standard_error = None;
                difference.interval = Earned::none("the samples are not independent");
            }
            return Ok(EventChange { event, title, before, after, difference, disagreeing: None });
        };
        let mut counts = vec![PairedCounts::default(); self.replicates];
        for k in 0..rows {
            counts[k % self.replicates].push(a.happened(first, k), b.happened(second, k));
        }
        let sum = |read: fn(&PairedCounts) -> u64| counts.iter().map(read).sum::<u64>();
        Ok(EventChange {
            event,
            title,
            before,
            after,
            difference: replicated_difference(&counts, CONFIDENCE)?,
            disagreeing: Some((sum(|c| c.gained), sum(|c| c.lost))),
        })
    }

    fn outcome(&self, quantity: OutcomeQuantity, before: &[f64], after: &[f64]) -> OutcomeChange {
        let (a, b) = (moments(before.iter().copied()), moments(after.iter().copied()));
        let difference = match self.rows {
            Some(rows) if self.replicates == 1 => {
                let pairs = before.iter().zip(after).take(rows).map(|(a, b)| b - a);
                let (mean, variance, n) = moments(pairs);
                normal_estimate(mean, variance / n, "normal, common random numbers")
            }
            None if self.independent => {
                let error = a.1 / a.2 + b.1 / b.2;
                normal_estimate(b.0 - a.0, error, "normal, independent samples")
            }
            _ => {
                let value = Some(b.0 - a.0).filter(|d| d.is_finite());
                let why = "the points of the design are not independent";
                Estimate { value, standard_error: None, interval: Earned::none(why) }
            }
        };
        let known = |moments: (f64, f64, f64)| Some(moments.0).filter(|mean| mean.is_finite());
        OutcomeChange {
            outcome: quantity.name(),
            quantity,
            before: known(a),
            after: known(b),
            difference,
        }
    }
}

/// Mean, sample variance and number of the values that are numbers.
fn moments(values: impl Iterator<Item = f64>) -> (f64, f64, f64) {
    let (mut n, mut mean, mut squares) = (0.0, 0.0, 0.0);
    for value in values.filter(|value| !value.is_nan()) {
        n += 1.0;
        let before = value - mean;
        mean += before / n;
        squares += before * (value - mean);
    }
    if n < 2.0 { (f64::NAN, f64::NAN, n) } else { (mean, squares / (n - 1.0), n) }
}

fn normal_estimate(value: f64, squared_error: f64, method: &'static str) -> Estimate {
    let error = squared_error.sqrt();
    if !(value.is_finite() && error.is_finite()) {
        return Estimate::none("fewer than two samples could be computed");
    }
    let half = normal::quantile_upper((1.0 - CONFIDENCE) / 2.0) * error;
    let (lower, upper) = (value - half, value + half);
    let interval = Interval { lower, upper, confidence: CONFIDENCE, method };
    Estimate { value: Some(value), standard_error: Some(error), interval: interval.into() }
}
