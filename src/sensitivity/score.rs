//! Derivatives of a breach probability with respect to the parameters of the inputs' laws, from samples
//! already run.
//!
//! With F the breach, x the inputs and f their density: dP/dθ = E[1_F(x)·∂ln f(x; θ)/∂θ], the score
//! function or likelihood-ratio method (Rubinstein and Shapiro, *Discrete Event Systems*, 1993; Wu,
//! Oper. Res. 42 (1994) 1063). The score has mean zero, which serves as a control variate.

use crate::error::{Error, Result};
use crate::numerics::interval::{Earned, Estimate, Interval};
use crate::numerics::special::normal;
use serde::{Deserialize, Serialize};

/// With fewer breaches, or fewer clean samples, than this the normal approximation is not earned.
pub(super) const FEWEST_BREACHES: u64 = 10;

/// The derivative of one breach probability with respect to one parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ProbabilityDerivative {
    /// dP/dθ, in one over the parameter's unit, with standard error and interval; the interval holds
    /// whatever the faulted samples would have been.
    pub derivative: Estimate,
    /// Samples whose outcome is not known.
    pub faults: u64,
}

/// dP/dθ from the breach indicator of each sample (1, 0, or NaN for a fault) and its score
/// ∂ln f/∂θ.
///
/// # Errors
/// If the columns differ in length, an indicator is neither 0, 1 nor NaN, a score is not finite, or
/// the confidence is not strictly between 0 and 1.
pub fn probability_derivative(
    breached: &[f64],
    score: &[f64],
    confidence: f64,
) -> Result<ProbabilityDerivative> {
    if breached.len() != score.len() || score.iter().any(|s| !s.is_finite()) {
        return Err(Error::argument("every sample needs a breach indicator and a finite score"));
    }
    if breached.iter().any(|b| !(b.is_nan() || *b == 0.0 || *b == 1.0)) {
        return Err(Error::argument("a breach indicator is 0, 1 or not a number"));
    }
    if !(confidence > 0.0 && confidence < 1.0) {
        return Err(Error::argument(format!(
            "a confidence lies strictly between 0 and 1, not {confidence}"
        )));
    }
    let samples = breached.len() as u64;
    let faults = breached.iter().filter(|b| b.is_nan()).count() as u64;
    let breaches = breached.iter().filter(|b| **b == 1.0).count() as u64;
    let clean = samples - faults - breaches;
    if samples - faults == 0 {
        return Ok(ProbabilityDerivative {
            derivative: Estimate::none("no sample has its outcome"),
            faults,
        });
    }
    let known = breached.iter().zip(score).filter(|(b, _)| !b.is_nan()).map(|(b, s)| (*b, *s));
    let computed = Controlled::mean(known);
    // Each end takes the faulted samples as what would move the derivative furthest that way.
    let worst = |breaches_if: fn(f64) -> bool| {
        let filled = breached.iter().zip(score).map(|(b, s)| {
            let if_fault = f64::from(u8::from(breaches_if(*s)));
            (if b.is_nan() { if_fault } else { *b }, *s)
        });
        Controlled::mean(filled)
    };
    let z = normal::quantile_upper((1.0 - confidence) / 2.0);
    let (interval, standard_error) = if breaches < FEWEST_BREACHES || clean < FEWEST_BREACHES {
        let why = format!(
            "{breaches} breaches and {clean} clean samples: at least {FEWEST_BREACHES} of each are needed for an \
             interval of a derivative"
        );
        (Earned::none(why), None)
    } else if computed.error == 0.0 {
        (Earned::none("the score does not vary over the samples"), None)
    } else if faults == 0 {
        let half = z * computed.error;
        let (lower, upper) = (computed.value - half, computed.value + half);
        let interval = Interval { lower, upper, confidence, method: "score function, normal" };
        (interval.into(), Some(computed.error))
    } else {
        let (low, high) = (worst(|s| s < 0.0), worst(|s| s > 0.0));
        let lower = (low.value - z * low.error).min(computed.value - z * computed.error);
        let upper = (high.value + z * high.error).max(computed.value + z * computed.error);
        let method = "score function, normal, faults counted both ways";
        (Interval { lower, upper, confidence, method }.into(), Some(computed.error))
    };
    Ok(ProbabilityDerivative {
        derivative: Estimate { value: Some(computed.value), standard_error, interval },
        faults,
    })
}

/// The mean of indicator times score, less the multiple of the mean score that makes its variance
/// least, and its standard error.
struct Controlled {
    value: f64,
    error: f64,
}

impl Controlled {
    fn mean(samples: impl Iterator<Item = (f64, f64)> + Clone) -> Self {
        let (mut count, mut product, mut score) = (0.0, 0.0, 0.0);
        for (b, s) in samples.clone() {
            count += 1.0;
            product += b * s;
            score += s;
        }
        let (product, score) = (product / count, score / count);
        let (mut variance, mut covariance, mut spread) = (0.0, 0.0, 0.0);
        for (b, s) in samples {
            let (p, d) = (b * s - product, s - score);
            variance += p * p;
            covariance += p * d;
            spread += d * d;
        }
        let slope = if spread > 0.0 { covariance / spread } else { 0.0 };
        let left = (variance - slope * covariance).max(0.0);
        // One degree of freedom for the mean and one for the slope.
        let error = (left / (count - 2.0).max(1.0) / count).sqrt();
        Controlled { value: product - slope * score, error }
    }
}
