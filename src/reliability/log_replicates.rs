//! The interval of a probability from independent replicates of an estimator.

use crate::numerics::elementary::{exp, ln};
use crate::numerics::interval::{Earned, Interval};
use crate::numerics::special::student;

const METHOD: &str = "lognormal replicates, Cox with Student t";

/// Mean, standard error and interval of independent unbiased estimates of one probability.
///
/// Estimates of rare probabilities are products of noisy factors, so near to lognormal: with mean m and
/// variance s² of the n logarithms, the interval of the mean is
/// `exp(m + s²/2 ± t √(s²/n + s⁴/(2(n − 1))))`, t of n − 1 degrees of freedom. A replicate of zero
/// withdraws it: the logarithm has no say then.
///
/// Source: Cox's method (Land, Technometrics 14 (1972) 145; Olsson, J. Stat. Educ. 13 (2005), with
/// Student's t in place of the normal quantile).
pub fn interval_of_replicates(replicates: &[f64], confidence: f64) -> (f64, f64, Earned) {
    let n = replicates.len() as f64;
    let (mean, variance) = moments(replicates);
    let standard_error = (variance / n).sqrt();
    let empty = replicates.iter().filter(|&&p| p <= 0.0).count();
    let interval = if replicates.len() < 3 {
        Earned::none("fewer than three replicates")
    } else if empty > 0 {
        Earned::none(format!("{empty} of {n} replicates found no breach"))
    } else {
        let logarithms: Vec<f64> = replicates.iter().map(|&p| ln(p)).collect();
        let (m, s2) = moments(&logarithms);
        let t = student::quantile_upper(n - 1.0, (1.0 - confidence) / 2.0);
        let half = t * (s2 / n + s2 * s2 / (2.0 * (n - 1.0))).sqrt();
        let centre = m + 0.5 * s2;
        Interval {
            lower: exp(centre - half),
            upper: exp(centre + half).min(1.0),
            confidence,
            method: METHOD,
        }
        .into()
    };
    (mean, standard_error, interval)
}

/// Mean and unbiased variance.
fn moments(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|x| (x - mean) * (x - mean)).sum();
    (mean, squares / (n - 1.0).max(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn property_an_empty_replicate_withdraws_the_interval() {
        let (mean, _, interval) = interval_of_replicates(&[1e-4, 2e-4, 0.0], 0.95);
        assert!((mean - 1e-4).abs() < 1e-18);
        assert!(interval.why_none().is_some());
        assert!(interval_of_replicates(&[1e-4, 2e-4], 0.95).2.why_none().is_some());
    }

    #[test]
    fn analytic_interval_of_three_replicates() {
        // Logarithms −1, 0, 1: m = 0, s² = 1, t(2, 97.5 %) = 4.302652729749464 (tables).
        let replicates = [exp(-3.0), exp(-2.0), exp(-1.0)];
        let (_, _, interval) = interval_of_replicates(&replicates, 0.95);
        let half = 4.302_652_729_749_464 * (1.0_f64 / 3.0 + 0.25).sqrt();
        let interval = *interval.interval().unwrap();
        assert!((interval.lower / exp(-1.5 - half) - 1.0).abs() < 1e-12);
        assert_eq!(interval.upper, 1.0);
    }
}
