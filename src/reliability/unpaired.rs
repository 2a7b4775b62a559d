//! The difference of two probabilities from independent samples.
//!
//! Newcombe's hybrid of two Wilson intervals: R. G. Newcombe, Statistics in Medicine 17 (1998) 873,
//! method 10.

use super::probability::Proportion;
use crate::error::Result;
use crate::numerics::interval::{Estimate, Interval};

/// P of `after` less P of `before`, with its interval; faults count against either end.
///
/// # Errors
/// If the confidence is not strictly between 0 and 1.
pub fn difference(before: &Proportion, after: &Proportion, confidence: f64) -> Result<Estimate> {
    let intervals = (before.wilson(confidence)?, after.wilson(confidence)?);
    let shares = (before.estimate(), after.estimate());
    let ((Some(p), Some(q)), (Some(of_p), Some(of_q))) =
        (shares, (intervals.0.interval(), intervals.1.interval()))
    else {
        return Ok(Estimate::none("one of the two has no computed sample"));
    };
    let root = |a: f64, b: f64| (a * a + b * b).sqrt();
    let variance = |p: f64, of: &Proportion| p * (1.0 - p) / (of.samples - of.faults) as f64;
    let interval = Interval {
        lower: q - p - root(q - of_q.lower, of_p.upper - p),
        upper: q - p + root(of_q.upper - q, p - of_p.lower),
        confidence,
        method: "Newcombe, independent samples",
    };
    Ok(Estimate {
        value: Some(q - p),
        standard_error: Some((variance(p, before) + variance(q, after)).sqrt()),
        interval: interval.into(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_newcombe_s_examples() {
        // Table II of the paper, method 10, printed to four decimals.
        for ((m, n), (k, l), (lower, upper)) in [
            ((48, 80), (56, 70), (0.0524, 0.3339)),
            ((3, 10), (9, 10), (0.1705, 0.8090)),
            ((0, 20), (10, 10), (0.6791, 1.0)),
        ] {
            let before = Proportion { breaches: m, faults: 0, samples: n };
            let after = Proportion { breaches: k, faults: 0, samples: l };
            let estimate = difference(&before, &after, 0.95).unwrap();
            let interval = estimate.interval.interval().unwrap();
            assert!((interval.lower - lower).abs() < 5.1e-5, "{interval:?}");
            assert!((interval.upper - upper).abs() < 5.1e-5, "{interval:?}");
        }
    }

    #[test]
    fn property_faults_widen_both_ends() {
        let known = Proportion { breaches: 20, faults: 0, samples: 200 };
        let partly = Proportion { faults: 5, ..known };
        let of = |a: &Proportion, b: &Proportion| {
            *difference(a, b, 0.9).unwrap().interval.interval().unwrap()
        };
        let (plain, wide) = (of(&known, &known), of(&partly, &partly));
        assert!(wide.lower < plain.lower && wide.upper > plain.upper);
    }
}
