//! Exact tails of the binomial law, which everything that counts breaches is made of.
//!
//! Each tail is computed by itself and not as one minus the other.

use crate::error::{Error, Result};
use crate::numerics::special::binomial;

/// Relative slack with which two probabilities are held to be equal, so that a tie is decided by the
/// numbers that were written ("0.75") and not by the rounding of `1 − 0.75` or of a tail.
const TIE: f64 = 1e-12;

/// P(K ≤ `count`) for K breaches among `samples` independent samples of breach probability
/// `probability`.
pub fn at_most(count: u64, samples: u64, probability: f64) -> f64 {
    binomial::cdf(count, samples, probability)
}

/// P(K ≥ `count`) for K breaches among `samples` independent samples of breach probability
/// `probability`.
pub fn at_least(count: u64, samples: u64, probability: f64) -> f64 {
    match count.checked_sub(1) {
        Some(below) => binomial::survival(below, samples, probability),
        None => 1.0,
    }
}

/// Whether a tail probability is at most the risk `1 − confidence`.
pub(crate) fn within_risk(tail: f64, confidence: f64) -> bool {
    tail <= (1.0 - confidence) * (1.0 + TIE)
}

/// The smallest integer in `from ..= to` for which `holds`, which must stay true once it is; `None` if
/// it does not hold at `to`.
pub(crate) fn first_where(from: u64, to: u64, holds: impl Fn(u64) -> bool) -> Option<u64> {
    let (mut low, mut high) = (from, to);
    if low > high || !holds(high) {
        return None;
    }
    while low < high {
        let middle = low + (high - low) / 2;
        if holds(middle) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    Some(low)
}

/// `confidence`, if it is a probability strictly between 0 and 1.
pub(crate) fn checked_confidence(confidence: f64) -> Result<f64> {
    if confidence > 0.0 && confidence < 1.0 {
        Ok(confidence)
    } else {
        Err(Error::argument(format!(
            "a confidence lies strictly between 0 and 1, not {confidence}"
        )))
    }
}

/// `probability`, if it lies strictly between 0 and 1; `what` names it in the message.
pub(crate) fn checked_probability(probability: f64, what: &str) -> Result<f64> {
    if probability > 0.0 && probability < 1.0 {
        Ok(probability)
    } else {
        Err(Error::argument(format!("{what} lies strictly between 0 and 1, not {probability}")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_tails_of_a_fair_coin() {
        // Ten tosses: P(K ≤ 3) = (1 + 10 + 45 + 120)/1024, P(K ≥ 8) = (45 + 10 + 1)/1024.
        assert!((at_most(3, 10, 0.5) - 176.0 / 1024.0).abs() < 1e-14);
        assert!((at_least(8, 10, 0.5) - 56.0 / 1024.0).abs() < 1e-14);
        assert_eq!(
            (at_most(10, 10, 0.5), at_least(0, 10, 0.5), at_least(11, 10, 0.5)),
            (1.0, 1.0, 0.0)
        );
    }

    #[test]
    fn property_the_first_integer_is_found() {
        assert_eq!(first_where(3, 90, |n| n * n >= 50), Some(8));
        assert_eq!(first_where(3, 7, |n| n * n >= 50), None);
        assert_eq!(first_where(9, 9, |_| true), Some(9));
    }
}
