//! A probability from replicated designs: Latin hypercube and randomised quasi-Monte Carlo.
//!
//! The points of one such design depend on each other, so counting them as independent would be a lie;
//! only independent replicates tell the error (Owen, *Monte Carlo theory, methods and examples*, ch.
//! 10 and 17). The interval is Student's t over the replicates' shares.

use super::binomial_tails::checked_confidence;
use super::probability::Proportion;
use crate::error::{Error, Result};
use crate::numerics::elementary::{exp_m1, ln};
use crate::numerics::interval::{Earned, Estimate, Interval};
use crate::numerics::special::student;
use serde::Serialize;

const METHOD: &str = "Student t over replicates";
const METHOD_CLIPPED: &str = "Student t over replicates, clipped to [0, 1]";
const METHOD_FEW: &str = "fewer than ten breaches: the wider of Student t over replicates and the exact binomial interval";
const METHOD_FEW_CLEAN: &str = "fewer than ten samples without a breach: the wider of Student t over replicates and the exact binomial interval";
const METHOD_FAULTS: &str = "Student t over replicates, faults counted both ways";

/// Breaches, or samples without one, below which replicates show too little of their own scatter: measured on counts of a Poisson law with
/// mean 3 to 8, Student's interval for 90 % holds 82 to 90 %.
const FEW_BREACHES: u64 = 10;

/// A probability estimated from independent replicates of one design.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Replicated {
    /// Number of replicates, R.
    pub replicates: usize,
    /// Mean of the shares, its standard error s/√R, and the t interval with R − 1 degrees of freedom.
    pub probability: Estimate,
}

/// The probability from the share of breaches in each replicate.
///
/// There is no interval, and the result says why, with fewer than two replicates, or when all agree
/// exactly: a spread of zero is a lack of evidence and not certainty.
///
/// # Errors
/// If a share is not in [0, 1] or the confidence not strictly between 0 and 1.
pub fn from_replicates(shares: &[f64], confidence: f64) -> Result<Replicated> {
    checked_confidence(confidence)?;
    if let Some(share) = shares.iter().find(|share| !(0.0..=1.0).contains(*share)) {
        return Err(Error::argument(format!(
            "a share of breaches lies between 0 and 1, not {share}"
        )));
    }
    let replicates = shares.len();
    if replicates == 0 {
        return Ok(Replicated { replicates, probability: Estimate::none("no replicate was run") });
    }
    let mean = mean_of(shares);
    if replicates == 1 {
        let why = "a single replicate does not show its own error; at least two are needed";
        let interval = Earned::none(why);
        return Ok(Replicated {
            replicates,
            probability: Estimate { value: Some(mean), standard_error: None, interval },
        });
    }
    if shares.iter().all(|share| *share == shares[0]) {
        let interval = Earned::none(agreement(shares[0], replicates, confidence));
        return Ok(Replicated {
            replicates,
            probability: Estimate { value: Some(shares[0]), standard_error: None, interval },
        });
    }
    let error = standard_error_of(shares, mean);
    let half = student::quantile_upper((replicates - 1) as f64, (1.0 - confidence) / 2.0) * error;
    let (lower, upper) = ((mean - half).max(0.0), (mean + half).min(1.0));
    let clipped = mean - half < 0.0 || mean + half > 1.0;
    let method = if clipped { METHOD_CLIPPED } else { METHOD };
    let interval = Interval { lower, upper, confidence, method }.into();
    Ok(Replicated {
        replicates,
        probability: Estimate { value: Some(mean), standard_error: Some(error), interval },
    })
}

/// The probability from the counts of each replicate, with what faults could have done: the interval
/// reaches from the lower end for the shares m/N to the upper end for the shares (m + f)/N.
///
/// # Errors
/// If a replicate has no sample, or the confidence is not strictly between 0 and 1.
pub fn from_replicate_counts(counts: &[Proportion], confidence: f64) -> Result<Replicated> {
    let bounds: Option<Vec<(f64, f64)>> = counts.iter().map(Proportion::fault_bounds).collect();
    let bounds = bounds.ok_or_else(|| Error::argument("a replicate has no sample"))?;
    let least: Vec<f64> = bounds.iter().map(|b| b.0).collect();
    let low = from_replicates(&least, confidence)?;
    if counts.iter().all(|count| count.faults == 0) {
        return widened_if_few(low, counts, confidence);
    }
    let most: Vec<f64> = bounds.iter().map(|b| b.1).collect();
    let high = from_replicates(&most, confidence)?;
    let computed: Option<Vec<f64>> = counts.iter().map(Proportion::estimate).collect();
    let value = computed.as_deref().map(mean_of);
    let standard_error = match (low.probability.standard_error, high.probability.standard_error) {
        (Some(a), Some(b)) => Some(a.max(b)),
        _ => None,
    };
    let interval = match (low.probability.interval, high.probability.interval) {
        (Earned::Interval(a), Earned::Interval(b)) => {
            Interval { lower: a.lower, upper: b.upper, confidence, method: METHOD_FAULTS }.into()
        }
        (Earned::None(why), _) | (_, Earned::None(why)) => Earned::None(why),
    };
    let both = Replicated {
        replicates: counts.len(),
        probability: Estimate { value, standard_error, interval },
    };
    widened_if_few(both, counts, confidence)
}

/// With [`FEW_BREACHES`], or as few samples without one, the interval takes in the exact one for as many independent samples. Neither design scatters
/// more than those by more than a small factor: a Latin hypercube by n/(n − 1) at most in variance, scrambled nets by e
/// (Owen, *Ann. Statist.* 25, 1997; *J. Complexity* 14, 1998).
fn widened_if_few(
    mut found: Replicated,
    counts: &[Proportion],
    confidence: f64,
) -> Result<Replicated> {
    let sum = |of: fn(&Proportion) -> u64| counts.iter().map(of).sum::<u64>();
    let together = Proportion::new(sum(|c| c.breaches), sum(|c| c.faults), sum(|c| c.samples))?;
    let few = match (together.breaches < FEW_BREACHES, together.clean() < FEW_BREACHES) {
        (true, _) => Some(METHOD_FEW),
        (false, true) => Some(METHOD_FEW_CLEAN),
        (false, false) => None,
    };
    if let (Earned::Interval(interval), Some(method)) = (&mut found.probability.interval, few)
        && let Earned::Interval(exact) = together.interval(confidence)?
    {
        interval.lower = interval.lower.min(exact.lower);
        interval.upper = interval.upper.max(exact.upper);
        interval.method = method;
    }
    Ok(found)
}

/// Why replicates that agree exactly earn no interval, and what they do show: a point picked from each
/// is an independent sample, so without a breach (1 − P)^R bounds the chance of having seen none.
fn agreement(share: f64, replicates: usize, confidence: f64) -> String {
    if share == 0.0 {
        let bound = -exp_m1(ln(1.0 - confidence) / replicates as f64);
        format!(
            "no replicate saw a breach, so their spread shows nothing; at confidence {confidence} they bound the \
             probability by {bound:.2} only: use plain Monte Carlo, whose samples are counted one by one"
        )
    } else if share == 1.0 {
        "every sample of every replicate breached, so their spread shows nothing: use plain Monte Carlo".into()
    } else {
        format!(
            "all {replicates} replicates gave the same share, so their spread shows nothing: use more replicates \
             or plain Monte Carlo"
        )
    }
}

fn mean_of(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Standard error of the mean of at least two values.
fn standard_error_of(values: &[f64], mean: f64) -> f64 {
    let squares: f64 = values.iter().map(|value| (value - mean) * (value - mean)).sum();
    let count = values.len() as f64;
    (squares / (count - 1.0) / count).sqrt()
}
