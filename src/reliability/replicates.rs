//! A probability from replicated designs: Latin hypercube and randomised quasi-Monte Carlo.
//!
//! The points of one such design depend on each other, so counting them as independent would be a lie;
//! only independent replicates tell the error (Owen, *Monte Carlo theory, methods and examples*, ch.
//! 10 and 17). The replicates' scatter says how many independent samples the design is worth, and the interval is the
//! exact one of that many: Korn and Graubard, *Survey Methodology* 24 (1998), 193–201, with their allowance for the
//! degrees of freedom. Student's interval, which is the same to first order, knows nothing of the skewness of counts:
//! at 16 breaches its upper bound for 90 % fails in 13 % of runs, at 64 in 12 %.

use super::binomial_tails::checked_confidence;
use super::probability::Proportion;
use crate::error::{Error, Result};
use crate::numerics::elementary::{exp_m1, ln};
use crate::numerics::interval::{Earned, Estimate, Interval};
use crate::numerics::special::{beta, normal, student};
use serde::{Deserialize, Serialize};

const METHOD: &str = "Korn and Graubard over replicates";
const METHOD_FEW: &str =
    "Korn and Graubard over replicates, at least as wide as for independent samples";
const METHOD_FAULTS: &str = "Korn and Graubard over replicates, faults counted both ways";

/// Breaches, or samples without one, below which a design counts as no better than independent samples: what little it
/// gains there is not told apart from luck, and counts that each replicate all but fixes are not binomial.
const FEW_BREACHES: f64 = 100.0;

/// The most independent samples that a design counts as; beyond them the interval is narrower than any decision.
const MOST_EFFECTIVE: f64 = 1e12;

/// A probability estimated from independent replicates of one design.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Replicated {
    /// Number of replicates, R.
    pub replicates: usize,
    /// Mean of the shares, its standard error s/√R, and the interval of as many independent samples as
    /// that is worth.
    pub probability: Estimate,
}

/// The probability from the counts of each replicate, with what faults could have done: the interval
/// reaches from the lower end for the shares m/N to the upper end for the shares (m + f)/N.
///
/// There is no interval, and the result says why, with fewer than two replicates, or when all agree
/// exactly: a spread of zero is a lack of evidence and not certainty.
///
/// # Errors
/// If a replicate has no sample, or the confidence is not strictly between 0 and 1.
pub fn from_replicate_counts(counts: &[Proportion], confidence: f64) -> Result<Replicated> {
    checked_confidence(confidence)?;
    let bounds: Option<Vec<(f64, f64)>> = counts.iter().map(Proportion::fault_bounds).collect();
    let bounds = bounds.ok_or_else(|| Error::argument("a replicate has no sample"))?;
    let samples = counts.iter().map(|count| count.samples).sum::<u64>() as f64;
    let least: Vec<f64> = bounds.iter().map(|b| b.0).collect();
    let low = from_shares(&least, samples, confidence);
    if counts.iter().all(|count| count.faults == 0) {
        return Ok(low);
    }
    let most: Vec<f64> = bounds.iter().map(|b| b.1).collect();
    let high = from_shares(&most, samples, confidence);
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
    let probability = Estimate { value, standard_error, interval };
    Ok(Replicated { replicates: counts.len(), probability })
}

/// The probability from the share of breaches in each replicate, of `samples` points in all.
fn from_shares(shares: &[f64], samples: f64, confidence: f64) -> Replicated {
    let replicates = shares.len();
    let without = |value, interval| Replicated {
        replicates,
        probability: Estimate { value, standard_error: None, interval },
    };
    let [first, others @ ..] = shares else {
        return without(None, Earned::none("no replicate was run"));
    };
    if others.is_empty() {
        let why = "a single replicate does not show its own error; at least two are needed";
        return without(Some(*first), Earned::none(why));
    }
    if others.iter().all(|share| share == first) {
        return without(Some(*first), Earned::none(agreement(*first, replicates, confidence)));
    }
    let mean = mean_of(shares);
    let error = standard_error_of(shares, mean);
    let risk = (1.0 - confidence) / 2.0;
    let freedom = (replicates - 1) as f64;
    let reach = error * student::quantile_upper(freedom, risk) / normal::quantile_upper(risk);
    let few = samples * mean.min(1.0 - mean) < FEW_BREACHES;
    let (most, method) = if few { (samples, METHOD_FEW) } else { (MOST_EFFECTIVE, METHOD) };
    // As many independent samples as have a standard error of `reach`.
    let effective = (mean * (1.0 - mean) / (reach * reach)).min(most);
    let (breaches, clean) = (mean * effective, (1.0 - mean) * effective);
    let lower = beta::quantile_lower(breaches, clean + 1.0, risk);
    let upper = beta::quantile_upper(breaches + 1.0, clean, risk);
    let interval = Interval { lower, upper, confidence, method }.into();
    Replicated {
        replicates,
        probability: Estimate { value: Some(mean), standard_error: Some(error), interval },
    }
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
