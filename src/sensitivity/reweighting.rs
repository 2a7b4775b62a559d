//! The probability that a breach would have under other laws, from samples of these: each sample weighs
//! the ratio of its densities.
//!
//! Trusted only where the guard says so: enough effective samples, (Σw)²/Σw² (Kong, Tech. Rep. 348, Univ.
//! of Chicago, 1992), and a mean weight that agrees with one.

use crate::error::{Error, Result};
use crate::numerics::elementary::exp;
use crate::numerics::interval::{Earned, Estimate, Interval};
use crate::numerics::special::normal;
use serde::{Deserialize, Serialize};

/// Effective samples, as a share of all, below which reweighting is not trusted.
pub const LEAST_EFFECTIVE: f64 = 0.1;
/// Standard errors by which the mean weight may miss one.
const MEAN_WEIGHT_ERRORS: f64 = 4.0;
/// Weighted breaches, as effective samples, needed for a normal interval.
const FEWEST: f64 = 20.0;

/// A probability by reweighting.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Reweighted {
    /// The probability, if it is to be trusted.
    pub probability: Estimate,
    /// Standard error of its difference to the probability under the sampled laws, from the same samples.
    pub difference_error: Option<f64>,
    /// Effective samples as a share of all.
    pub effective_share: f64,
    /// Whether the guard lets it pass.
    pub trusted: bool,
}

/// The probability of the breach (1, 0, or NaN for a fault, which is left out) under the laws whose log
/// density ratios to the sampled ones are `log_ratios`. `covered` says whether every value that the other
/// laws allow could have been drawn.
///
/// The weights' mean is one, which serves as a control variate (ratio estimator).
///
/// # Errors
/// If the columns differ in length or the confidence is not strictly between 0 and 1.
pub fn reweighted(
    breached: &[f64],
    log_ratios: &[f64],
    covered: bool,
    confidence: f64,
) -> Result<Reweighted> {
    if breached.len() != log_ratios.len() || !(confidence > 0.0 && confidence < 1.0) {
        return Err(Error::argument(
            "reweighting needs a log density ratio for every sample and a confidence between 0 and 1",
        ));
    }
    let refused = |effective_share: f64, why: String| Reweighted {
        probability: Estimate::none(why),
        difference_error: None,
        effective_share,
        trusted: false,
    };
    if !covered {
        return Ok(refused(0.0, "the laws allow values that were never drawn".into()));
    }
    let (mut n, mut weights, mut squares) = (0.0, 0.0, 0.0);
    let (mut hits, mut hit_squares) = (0.0, 0.0);
    for (&b, &log_ratio) in breached.iter().zip(log_ratios) {
        if b.is_nan() {
            continue;
        }
        let w = exp(log_ratio);
        n += 1.0;
        weights += w;
        squares += w * w;
        hits += b * w;
        hit_squares += b * w * w;
    }
    let share = if squares > 0.0 { weights * weights / squares / n } else { 0.0 };
    if !share.is_finite() || share < LEAST_EFFECTIVE {
        let share = if share.is_finite() { share } else { 0.0 };
        return Ok(refused(
            share,
            format!("the samples count as {:.1} % of their number only", 100.0 * share),
        ));
    }
    let mean = weights / n;
    let mean_error = ((squares / n - mean * mean).max(0.0) / n).sqrt();
    if (mean - 1.0).abs() > MEAN_WEIGHT_ERRORS * mean_error.max(f64::EPSILON * n.sqrt()) {
        return Ok(refused(share, format!("the mean weight is {mean:.3} and should be 1")));
    }
    let value = hits / weights;
    // Σ w² (b − p)² / (Σ w)²: the ratio estimator's variance.
    let residual = hit_squares * (1.0 - 2.0 * value) + squares * value * value;
    let error = residual.max(0.0).sqrt() / weights;
    let effective_hits = if hit_squares > 0.0 { hits * hits / hit_squares } else { 0.0 };
    let interval = if effective_hits < FEWEST {
        Earned::none(format!("{effective_hits:.0} effective breaches are too few"))
    } else {
        let half = normal::quantile_upper((1.0 - confidence) / 2.0) * error;
        let method = "reweighted, normal";
        Interval {
            lower: (value - half).max(0.0),
            upper: (value + half).min(1.0),
            confidence,
            method,
        }
        .into()
    };
    Ok(Reweighted {
        probability: Estimate { value: Some(value), standard_error: Some(error), interval },
        difference_error: Some(difference_error(breached, log_ratios, value, mean)),
        effective_share: share,
        trusted: true,
    })
}

/// Standard error of the reweighted probability less the plain one: of w (b − p')/w̄ − (b − p), linearised.
fn difference_error(breached: &[f64], log_ratios: &[f64], reweighted: f64, mean: f64) -> f64 {
    let known = || breached.iter().zip(log_ratios).filter(|(b, _)| !b.is_nan());
    let n = known().count() as f64;
    let plain = known().map(|(b, _)| b).sum::<f64>() / n;
    let squares: f64 = known()
        .map(|(b, log_ratio)| {
            let residual = exp(*log_ratio) / mean * (b - reweighted) - (b - plain);
            residual * residual
        })
        .sum();
    squares.sqrt() / n
}
