//! From weighted breaches to an estimate: the self-checks of importance sampling.
//!
//! A breach found far from where the sampling density expected it carries a large weight. When a few
//! such weights make the sum, their variance is not the variance of what was not seen, and the interval
//! is withdrawn.

use super::probability::Proportion;
use crate::numerics::elementary::{cbrt, exp, ln, ln_1p};
use crate::numerics::interval::{Earned, Interval};
use crate::numerics::special::student;

/// The limits of the self-checks.
#[derive(Debug, Clone, PartialEq)]
pub struct WeightChecks {
    /// Least effective number of weighted breaches, (Σw)²/Σw².
    pub effective_breaches: f64,
    /// Largest share of the sum that one breach may carry.
    pub largest_share: f64,
    /// Largest tail index (generalised Pareto shape) of the weights.
    pub tail_index: f64,
}

impl Default for WeightChecks {
    fn default() -> Self {
        WeightChecks { effective_breaches: 100.0, largest_share: 0.05, tail_index: 0.7 }
    }
}

/// What a weight or a probability may differ from 1 by rounding.
const ROUNDING: f64 = 1e-12;

/// Weights p/q of the breaches among `samples` independent draws; the rest weigh zero.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct WeightedBreaches {
    /// Draws, breaches or not.
    pub samples: u64,
    /// The weight of each breach.
    pub weights: Vec<f64>,
}

/// What the weights say.
#[derive(Debug, Clone, PartialEq)]
pub struct WeightSummary {
    /// The estimate, Σw/N.
    pub probability: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// Effective number of breaches, (Σw)²/Σw².
    pub effective_breaches: f64,
    /// Largest single share of Σw.
    pub largest_share: f64,
    /// Shape of the generalised Pareto law of the largest weights, where there are enough.
    pub tail_index: Option<f64>,
    /// The interval, or which check withdrew it.
    pub interval: Earned,
}

impl WeightedBreaches {
    /// Sum of the weights.
    pub fn total(&self) -> f64 {
        self.weights.iter().sum()
    }

    /// Estimate, error and interval at `confidence`.
    ///
    /// The interval corrects for the skewness γ of the draws, zeros included: their studentised mean
    /// t = (p̂ − p)/s is skewed the other way, and `t + γ (t²/3 + 1/6)/√n + γ² t³/(27 n)` is symmetric to
    /// second order. It is taken to follow Student's t with as many degrees of freedom as draws of kurtosis
    /// excess κ leave to their variance, 2/(2/(n − 1) + κ/n): few draws that matter do not know their own error
    /// well.
    ///
    /// Sources: Hall, J. R. Stat. Soc. B 54 (1992) 221, after Johnson, J. Am. Stat. Assoc. 73 (1978) 536, for
    /// the skewness; O'Neill, The American Statistician 68 (2014) 282, for the degrees of freedom.
    pub fn summary(&self, confidence: f64, checks: &WeightChecks) -> WeightSummary {
        let n = self.samples as f64;
        let sum = self.total();
        let squares: f64 = self.weights.iter().map(|w| w * w).sum();
        let probability = if n > 0.0 { sum / n } else { 0.0 };
        let variance = (squares / n - probability * probability).max(0.0) / (n - 1.0).max(1.0);
        let standard_error = variance.sqrt();
        let effective_breaches = if squares > 0.0 { sum * sum / squares } else { 0.0 };
        let largest = self.weights.iter().copied().fold(0.0, f64::max);
        let largest_share = if sum > 0.0 { largest / sum } else { 0.0 };
        let tail_index = tail_index(&self.weights);
        let withdrawn = if self.weights.is_empty() {
            Some("no breach was sampled".to_owned())
        } else if effective_breaches < checks.effective_breaches {
            Some(format!(
                "effective number of breaches {effective_breaches:.0} is below {:.0}",
                checks.effective_breaches
            ))
        } else if largest_share > checks.largest_share {
            Some(format!("one sample carries {:.1} % of the estimate", 100.0 * largest_share))
        } else {
            let heavy = tail_index.filter(|&k| k > checks.tail_index).map(|k| {
                format!("the weights' tail index {k:.2} is above {:.2}", checks.tail_index)
            });
            heavy.or_else(|| self.unseen_remainder(probability, checks))
        };
        let certain = self.weights.len() as u64 == self.samples
            && self.weights.iter().all(|w| (w - 1.0).abs() <= ROUNDING);
        let interval = match withdrawn {
            Some(why) => Earned::none(why),
            // Every draw is a breach for certain: as many successes of as many trials, and no more than that.
            None if certain => {
                Proportion { breaches: self.samples, faults: 0, samples: self.samples }
                    .interval(confidence)
                    .unwrap_or_else(|why| Earned::none(why.to_string()))
            }
            None => {
                let risk = (1.0 - confidence) / 2.0;
                let (skewness, excess) = self.shape(probability);
                let freedom = 2.0 / (2.0 / (n - 1.0) + excess / n).max(2.0 / n);
                let t = student::quantile_upper(freedom.max(1.0), risk);
                let end = |t: f64| probability - standard_error * skew_corrected(t, skewness, n);
                Interval {
                    lower: end(t).max(0.0),
                    upper: end(-t).min(1.0),
                    confidence,
                    method: "weights, Student t corrected for skewness",
                }
                .into()
            }
        };
        WeightSummary {
            probability,
            standard_error,
            effective_breaches,
            largest_share,
            tail_index,
            interval,
        }
    }

    /// Why the probability of no breach is not known, where breaches are the rule and no draw weighs more than 1: what is
    /// left of each draw must pass the same check, or draws that agree because none of them met the exception would
    /// have an interval for it.
    fn unseen_remainder(&self, probability: f64, checks: &WeightChecks) -> Option<String> {
        if probability <= 0.5 || self.weights.iter().any(|&w| w > 1.0 + ROUNDING) {
            return None;
        }
        let zeros = self.samples as f64 - self.weights.len() as f64;
        let left = self.weights.iter().map(|&w| 1.0 - w).filter(|&left| left > ROUNDING);
        let (sum, squares) =
            left.fold((zeros, zeros), |(sum, squares), left| (sum + left, squares + left * left));
        let effective = if squares > 0.0 { sum * sum / squares } else { f64::INFINITY };
        (effective < checks.effective_breaches).then(|| {
            format!(
                "effective number of samples without a breach {effective:.0} is below {:.0}",
                checks.effective_breaches
            )
        })
    }

    /// Skewness and excess kurtosis of the draws around their mean, the zeros included.
    fn shape(&self, mean: f64) -> (f64, f64) {
        let n = self.samples as f64;
        let zeros = n - self.weights.len() as f64;
        let moment = |power: i32| {
            let of = |w: f64| (0..power).fold(1.0, |product, _| product * (w - mean) / mean);
            (self.weights.iter().map(|&w| of(w)).sum::<f64>() + zeros * of(0.0)) / n
        };
        let variance = moment(2);
        if variance > 0.0 {
            (moment(3) / (variance * variance.sqrt()), moment(4) / (variance * variance) - 3.0)
        } else {
            (0.0, 0.0)
        }
    }
}

/// The studentised mean of n draws whose symmetric counterpart is t: the inverse of Hall's
/// transformation, which is a cube and so monotone.
fn skew_corrected(t: f64, skewness: f64, n: f64) -> f64 {
    let bend = skewness / n.sqrt() / 3.0;
    if bend.abs() < 1e-9 {
        return t;
    }
    (cbrt(1.0 + 3.0 * bend * (t - 0.5 * bend)) - 1.0) / bend
}

/// Shape of the generalised Pareto law of the largest fifth of the weights (at most 3√n of them); none
/// for fewer than 25 weights or where the largest are all equal.
///
/// Sources: Zhang and Stephens, Technometrics 51 (2009) 316, for the estimator; Vehtari, Simpson,
/// Gelman, Yao and Gabry, "Pareto smoothed importance sampling" (2024), for its use and its weak prior.
pub fn tail_index(weights: &[f64]) -> Option<f64> {
    let mut sorted: Vec<f64> = weights.iter().copied().filter(|w| w.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len();
    let tail = (n / 5).min((3.0 * (n as f64).sqrt()) as usize);
    if tail < 5 {
        return None;
    }
    let cutoff = sorted[n - tail - 1];
    let excess: Vec<f64> = sorted[n - tail..].iter().map(|w| w - cutoff).collect();
    let (m, largest) = (tail as f64, excess[tail - 1]);
    let quartile = excess[((m / 4.0 + 0.5) as usize).max(1) - 1];
    if quartile <= 0.0 || largest <= 0.0 {
        return None;
    }
    let grid = 30 + m.sqrt() as usize;
    let mean_log = |theta: f64| excess.iter().map(|x| ln_1p(-theta * x)).sum::<f64>() / m;
    let thetas: Vec<f64> = (1..=grid)
        .map(|j| {
            let step = 1.0 - (grid as f64 / (j as f64 - 0.5)).sqrt();
            1.0 / largest + step / (3.0 * quartile)
        })
        .collect();
    let profile: Vec<f64> = thetas
        .iter()
        .map(|&theta| {
            let shape = mean_log(theta);
            m * (ln(-theta / shape) - shape - 1.0)
        })
        .collect();
    let mut theta = 0.0;
    for (&candidate, &own) in thetas.iter().zip(&profile) {
        theta += candidate / profile.iter().map(|&other| exp(other - own)).sum::<f64>();
    }
    let shape = mean_log(theta);
    shape.is_finite().then(|| (shape * m + 5.0) / (m + 10.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_tail_index_of_pareto_quantiles() {
        // Quantiles of a Pareto law of shape k are u^-k; the estimator shrinks towards ½ by 10/(m + 10).
        for shape in [0.2, 0.7, 1.0] {
            let weights: Vec<f64> =
                (1..=20_000).map(|k| exp(-shape * ln((k as f64 - 0.5) / 20_000.0))).collect();
            let found = tail_index(&weights).unwrap();
            assert!((found - shape).abs() < 0.05, "{found} for {shape}");
        }
    }

    #[test]
    fn analytic_equal_weights_are_a_binomial_share() {
        let breaches = WeightedBreaches { samples: 10_000, weights: vec![1.0; 400] };
        let summary = breaches.summary(0.95, &WeightChecks::default());
        assert_eq!(summary.probability, 0.04);
        assert!((summary.standard_error - (0.04_f64 * 0.96 / 9999.0).sqrt()).abs() < 1e-15);
        assert!((summary.effective_breaches - 400.0).abs() < 1e-9);
        assert!(summary.interval.interval().unwrap().contains(0.04));
    }

    #[test]
    fn property_a_dominating_weight_withdraws_the_interval() {
        let mut weights = vec![1.0; 1000];
        weights.push(300.0);
        let breaches = WeightedBreaches { samples: 10_000, weights };
        assert!(breaches.summary(0.95, &WeightChecks::default()).interval.interval().is_none());
        let none = WeightedBreaches { samples: 10, weights: Vec::new() };
        assert!(none.summary(0.95, &WeightChecks::default()).interval.why_none().is_some());
    }

    #[test]
    fn analytic_draws_that_agree_on_certainty_bound_it_as_so_many_trials() {
        let of = |exceptions: usize| {
            let mut weights = vec![1.0; 2000 - exceptions];
            weights.resize(2000, 0.5);
            WeightedBreaches { samples: 2000, weights }.summary(0.95, &WeightChecks::default())
        };
        // Clopper and Pearson: 0.025^(1/2000).
        let certain = *of(0).interval.interval().unwrap();
        assert!((certain.lower - exp(ln(0.025) / 2000.0)).abs() < 1e-12 && certain.upper == 1.0);
        assert!(of(3).interval.why_none().is_some_and(|why| why.contains("without a breach 3 ")));
        assert!(of(200).interval.interval().is_some());
    }
}
