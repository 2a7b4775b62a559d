//! Importance sampling around design points: a mixture of unit Gaussians, one a design point, and a
//! defensive share of the nominal density that bounds every weight.
//!
//! Where the origin breaches, a design point is the nearest point that does *not*: the samples around it show how often
//! there is no breach, and where that is the exception the probability of a breach is what is left.
//!
//! Unfit for limits that curve around the origin in many dimensions (benchmark RP63, a shell of 100): breaches
//! are found off every design point, their effective number is small, and the interval is withdrawn.
//!
//! Source: Hesterberg, Technometrics 37 (1995) 185, for defensive mixtures; Melchers, Structural
//! Safety 6 (1989) 3, for sampling at design points.

use super::design_point::{DesignPoints, SearchOptions, design_points};
use super::draws::{open_uniform, standard_normal};
use super::estimate::{Estimate, Method};
use super::event::{BATCH, Evaluator, Event, FaultReading};
use super::form::no_design_point;
use super::limit_state::LimitState;
use super::vectors::dot;
use super::weighted::{WeightChecks, WeightedBreaches};
use crate::error::{Error, Result};
use crate::numerics::columns::Columns;
use crate::numerics::elementary::exp;
use crate::numerics::interval::{Earned, Interval};
use crate::numerics::special::normal;
use crate::streams::{Purpose, keyed};

/// How importance sampling is done.
#[derive(Debug, Clone, PartialEq)]
pub struct ImportanceOptions {
    /// Points drawn from the mixture.
    pub samples: u64,
    /// Share of them drawn from the nominal density; no weight exceeds its inverse.
    pub defensive_share: f64,
    /// Confidence of the interval.
    pub confidence: f64,
    /// The self-checks.
    pub checks: WeightChecks,
    /// The search of the design points.
    pub search: SearchOptions,
    /// Seed of the points.
    pub seed: u64,
}

impl ImportanceOptions {
    /// The usual choices, with the seed of every stream.
    pub fn seeded(seed: u64) -> Self {
        ImportanceOptions {
            samples: 20_000,
            defensive_share: 0.1,
            confidence: 0.95,
            checks: WeightChecks::default(),
            search: SearchOptions::seeded(seed),
            seed,
        }
    }
}

/// Unit Gaussians at centres, and the nominal density with the share that is left.
struct Mixture {
    centres: Vec<Vec<f64>>,
    shares: Vec<f64>,
    defensive: f64,
}

/// Shares of the effort that design points get: by their first-order probabilities Φ(−β), none below a
/// tenth of an equal share.
pub(super) fn shares(found: &DesignPoints) -> Vec<f64> {
    let first: Vec<f64> =
        found.points.iter().map(|point| normal::survival(point.reliability_index)).collect();
    let total = first.iter().sum::<f64>().max(1e-300);
    let least = 0.1 / first.len() as f64;
    let raised: Vec<f64> = first.iter().map(|p| (p / total).max(least)).collect();
    let total: f64 = raised.iter().sum();
    raised.iter().map(|share| share / total).collect()
}

impl Mixture {
    fn new(found: &DesignPoints, defensive: f64) -> Mixture {
        let centres: Vec<Vec<f64>> = found.points.iter().map(|p| p.point.clone()).collect();
        let shares = shares(found).iter().map(|share| (1.0 - defensive) * share).collect();
        Mixture { centres, shares, defensive }
    }

    fn draw(&self, stream: &mut crate::streams::Stream, dimension: usize) -> Vec<f64> {
        let mut left = open_uniform(stream) - self.defensive;
        let mut point: Vec<f64> = (0..dimension).map(|_| standard_normal(stream)).collect();
        if left > 0.0 {
            let last = self.shares.len() - 1;
            let mut which = 0;
            while which < last && left > self.shares[which] {
                left -= self.shares[which];
                which += 1;
            }
            point.iter_mut().zip(&self.centres[which]).for_each(|(x, c)| *x += c);
        }
        point
    }

    /// Nominal density over the mixture's.
    fn weight(&self, point: &[f64]) -> f64 {
        let mut inverse = self.defensive;
        for (centre, share) in self.centres.iter().zip(&self.shares) {
            inverse += share * exp(dot(centre, point) - 0.5 * dot(centre, centre));
        }
        inverse.recip()
    }
}

/// Importance sampling of an event, with the design points that it searched first.
///
/// Point k is a pure function of (seed, k). Faults are counted as weighted breaches in
/// `probability_with_faults` and in the upper end of the interval.
///
/// # Errors
/// If an option is out of range, the event does not fit, or the limit state fails.
pub fn importance_sampling(
    state: &dyn LimitState,
    event: Event,
    options: &ImportanceOptions,
) -> Result<(Estimate, DesignPoints)> {
    let found = design_points(state, event, &options.search)?;
    let estimate = sample_around(state, event, &found, options)?;
    Ok((estimate, found))
}

/// Importance sampling around design points that are known already; their search is counted.
///
/// # Errors
/// As [`importance_sampling`].
pub fn sample_around(
    state: &dyn LimitState,
    event: Event,
    found: &DesignPoints,
    options: &ImportanceOptions,
) -> Result<Estimate> {
    let share = options.defensive_share;
    if !(0.0 < share && share < 1.0) || options.samples < 2 {
        return Err(Error::argument(
            "importance sampling needs two samples and a defensive share between 0 and 1",
        ));
    }
    let method = Method::ImportanceSampling;
    if found.points.is_empty() {
        let mut estimate = Estimate::without_number(method, event, no_design_point(found));
        estimate.evaluations = found.evaluations;
        estimate.faults = found.faults;
        return Ok(estimate);
    }
    let mixture = Mixture::new(found, share);
    let mut evaluator = Evaluator::new(state, event, FaultReading::Kept)?;
    // Breaches for certain, and with every fault counted too; likewise points without a breach.
    let (mut breach, mut possible) = (WeightedBreaches::default(), WeightedBreaches::default());
    let (mut clean, mut possibly_clean) = (breach.clone(), breach.clone());
    let mut stream = keyed(options.seed, Purpose::ImportanceSampling);
    let mut values = Vec::new();
    let mut first = 0;
    while first < options.samples {
        let count = (options.samples - first).min(BATCH as u64);
        let points: Vec<Vec<f64>> = (first..first + count)
            .map(|k| {
                stream.set_stream(k);
                stream.set_word_pos(0);
                mixture.draw(&mut stream, state.dimension())
            })
            .collect();
        evaluator.evaluate(&Columns::from_rows(&points), &mut values)?;
        for (point, &margin) in points.iter().zip(&values) {
            if margin >= 0.0 && !found.origin_breaches {
                continue;
            }
            let weight = mixture.weight(point);
            if margin.is_nan() {
                possible.weights.push(weight);
                possibly_clean.weights.push(weight);
            } else if margin < 0.0 {
                breach.weights.push(weight);
                possible.weights.push(weight);
            } else {
                clean.weights.push(weight);
                possibly_clean.weights.push(weight);
            }
        }
        first += count;
    }
    [&mut breach, &mut possible, &mut clean, &mut possibly_clean]
        .into_iter()
        .for_each(|of| of.samples = options.samples);
    let (evaluations, faults) = (evaluator.evaluations, evaluator.faults);
    let of = |certain: &WeightedBreaches, possible: &WeightedBreaches| {
        combined(method, event, certain, possible, options.confidence, &options.checks)
    };
    // In many dimensions the origin can breach and hardly anything else: then breaches are the exception all the same.
    let mut estimate = match found.origin_breaches && breach.total() > clean.total() {
        true => of_the_complement(of(&clean, &possibly_clean)),
        false => of(&breach, &possible),
    };
    estimate.evaluations = evaluations + found.evaluations;
    estimate.faults = faults + found.faults;
    estimate.diagnostics.extend(found.diagnostics());
    Ok(estimate)
}

/// The estimate of an event from that of its complement, in which faults are read the other way round.
fn of_the_complement(estimate: Estimate) -> Estimate {
    let rest = |p: Option<f64>| p.map(|p| 1.0 - p);
    let interval = match estimate.interval {
        Earned::Interval(of) => {
            Interval { lower: 1.0 - of.upper, upper: 1.0 - of.lower, ..of }.into()
        }
        Earned::None(why) => Earned::none(format!("of the points without a breach: {why}")),
    };
    let mut diagnostics = vec!["the medians breach: points without a breach were sampled".into()];
    diagnostics.extend(
        estimate.diagnostics.iter().map(|line| line.replace("breaches", "points without a breach")),
    );
    Estimate {
        probability: rest(estimate.probability_with_faults),
        probability_with_faults: rest(estimate.probability),
        interval,
        diagnostics,
        ..estimate
    }
}

/// The estimate from weighted breaches without faults and with them. A weighted mean above 1 is 1: the interval ends
/// there too.
pub(super) fn combined(
    method: Method,
    event: Event,
    safe: &WeightedBreaches,
    breach: &WeightedBreaches,
    confidence: f64,
    checks: &WeightChecks,
) -> Estimate {
    let low = safe.summary(confidence, checks);
    let high = breach.summary(confidence, checks);
    let interval = match (low.interval, high.interval) {
        (Earned::Interval(low), Earned::Interval(high)) => {
            Interval { upper: high.upper, ..low }.into()
        }
        (Earned::None(why), _) | (_, Earned::None(why)) => Earned::None(why),
    };
    let tail = low.tail_index.map_or("unknown".to_owned(), |k| format!("{k:.2}"));
    Estimate {
        method,
        event,
        probability: Some(low.probability.min(1.0)),
        probability_with_faults: Some(high.probability.min(1.0)),
        standard_error: Some(low.standard_error),
        interval,
        evaluations: 0,
        faults: 0,
        diagnostics: vec![format!(
            "{} weighted breaches of {} samples, effective number {:.0}, largest share {:.2} %, tail index {tail}",
            safe.weights.len(),
            safe.samples,
            low.effective_breaches,
            100.0 * low.largest_share
        )],
        replicates: Vec::new(),
    }
}
