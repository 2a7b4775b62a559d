//! Whether several methods' answers to one question can all be true.
//!
//! Two estimates with intervals differ by more than their errors allow when the interval of their
//! difference excludes zero. That interval is recovered from the two (MOVER): its lower end is
//! `d − √((p₁ − l₁)² + (u₂ − p₂)²)` for d = p₁ − p₂ > 0, which respects intervals that are not
//! symmetric and a crude run that saw nothing. An estimate from few replicates has its own interval at the level of the
//! check: stretched from 95 % as a normal law's, it would be too short far out, where ten replicates that happen to lie low
//! agree with each other as well (1.6 to 3.3 false alarms in a hundred at a risk of 1 %, measured).
//!
//! Source: Zou and Donner, Statistics in Medicine 27 (2008) 1693.

use super::estimate::{Estimate, Method};
use super::log_replicates::interval_of_replicates;
use crate::error::{Error, Result};
use crate::numerics::special::normal;
use serde::{Deserialize, Serialize};

/// Estimates nearer to each other than this share are the same number: sums of many terms differ by as much according to
/// the order in which they are summed.
const ROUNDING: f64 = 1e-12;

/// One pair of estimates compared.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// The two methods.
    pub methods: (Method, Method),
    /// Their estimates.
    pub probabilities: (f64, f64),
    /// Difference over the reach of the combined errors at the family's risk: above 1 they disagree.
    pub difference: f64,
    /// Whether their errors allow the difference.
    pub agree: bool,
}

/// The check of all pairs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Agreement {
    /// Whether every pair that could be compared agrees; none without a pair.
    pub agrees: Option<bool>,
    /// The pairs.
    pub comparisons: Vec<Comparison>,
    /// Methods that could not be compared, and why.
    pub left_out: Vec<(Method, String)>,
}

/// Compares the estimates pair by pair at a family risk: the probability that methods which are all
/// right are said to disagree.
///
/// # Errors
/// If the risk is not strictly between 0 and 1, or the estimates are of different events.
pub fn agreement(estimates: &[Estimate], family_risk: f64) -> Result<Agreement> {
    if !(0.0 < family_risk && family_risk < 1.0) {
        return Err(Error::argument(format!("{family_risk} is not a risk between 0 and 1")));
    }
    if estimates.windows(2).any(|pair| pair[0].event != pair[1].event) {
        return Err(Error::argument("estimates of different events cannot agree or disagree"));
    }
    let mut left_out = Vec::new();
    let mut sides = Vec::new();
    let compared = |e: &&Estimate| e.probability.is_some() && e.interval.interval().is_some();
    let count = estimates.iter().filter(compared).count();
    let pairs = count * count.saturating_sub(1) / 2;
    let risk = family_risk / pairs.max(1) as f64;
    for estimate in estimates {
        match (estimate.probability, estimate.interval.interval()) {
            (Some(p), Some(interval)) => {
                let own = interval_of_replicates(&estimate.replicates, 1.0 - risk).2;
                let interval = own.interval().unwrap_or(interval);
                let z = normal::quantile_upper((1.0 - interval.confidence) / 2.0);
                // With faults the point is a range: whatever lies in it is not a difference.
                let most = estimate.probability_with_faults.unwrap_or(p).max(p);
                let below = (p - interval.lower).max(0.0) / z;
                let above = (interval.upper - most).max(0.0) / z;
                sides.push(Side { method: estimate.method, least: p, most, below, above });
            }
            (None, _) => left_out.push((estimate.method, "no number".to_owned())),
            (_, None) => {
                let why = estimate.interval.why_none().unwrap_or("no interval");
                left_out.push((estimate.method, why.to_owned()));
            }
        }
    }
    let z = normal::quantile_upper(risk / 2.0);
    let mut comparisons = Vec::with_capacity(pairs);
    for (k, one) in sides.iter().enumerate() {
        for other in &sides[k + 1..] {
            comparisons.push(one.compared_with(other, z));
        }
    }
    let agrees = (pairs > 0).then(|| comparisons.iter().all(|comparison| comparison.agree));
    Ok(Agreement { agrees, comparisons, left_out })
}

/// An estimate with one standard error below and one above.
struct Side {
    method: Method,
    least: f64,
    most: f64,
    below: f64,
    above: f64,
}

impl Side {
    fn compared_with(&self, other: &Side, z: f64) -> Comparison {
        let (high, low) = if self.least >= other.least { (self, other) } else { (other, self) };
        let gap = high.least - low.most;
        let gap = if gap > ROUNDING * high.least { gap } else { 0.0 };
        let reach = z * (high.below * high.below + low.above * low.above).sqrt();
        let difference = match (gap > 0.0, reach > 0.0) {
            (false, _) => 0.0,
            (true, true) => gap / reach,
            (true, false) => f64::INFINITY,
        };
        Comparison {
            methods: (self.method, other.method),
            probabilities: (self.least, other.least),
            difference,
            agree: difference <= 1.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::elementary::exp;
    use crate::numerics::interval::{Earned, Interval};
    use crate::reliability::event::Event;
    use crate::streams::{Purpose, stream};
    use rand_distr::{Distribution, StandardNormal};

    fn estimate(method: Method, p: f64, ends: Option<(f64, f64)>) -> Estimate {
        let mut estimate = Estimate::without_number(method, Event::Any, "nothing");
        estimate.probability = Some(p);
        if let Some((lower, upper)) = ends {
            let interval = Interval { lower, upper, confidence: 0.95, method: "test" };
            estimate.interval = Earned::from(interval);
        }
        estimate
    }

    #[test]
    fn property_wide_errors_agree_and_narrow_ones_do_not() {
        let importance = estimate(Method::ImportanceSampling, 3.2e-5, Some((3.0e-5, 3.4e-5)));
        let subset = estimate(Method::SubsetSimulation, 2.9e-7, Some((2.0e-7, 4.0e-7)));
        let nothing = estimate(Method::CrudeMonteCarlo, 0.0, Some((0.0, 3.7e-5)));
        let form = estimate(Method::Form, 1.0, None);
        let check = |estimates: &[Estimate]| agreement(estimates, 0.01).unwrap();
        assert_eq!(check(&[importance.clone(), subset.clone()]).agrees, Some(false));
        assert_eq!(check(&[importance.clone(), nothing.clone()]).agrees, Some(true));
        let all = check(&[importance, form, subset, nothing]);
        assert_eq!((all.agrees, all.comparisons.len(), all.left_out.len()), (Some(false), 3, 1));
        assert_eq!(check(&[]).agrees, None);
    }

    #[test]
    fn analytic_methods_that_are_right_are_seldom_said_to_disagree() {
        // Ten lognormal replicates of mean 4e-6 beside the truth; the logarithm's deviation of 0.8 is that of subset
        // simulation there.
        let (risk, truth) = (0.01, 4e-6);
        let exact = estimate(Method::ImportanceSampling, truth, Some((truth, truth)));
        let alarms = (0..20_000).filter(|&k| {
            let rng = &mut stream(7, Purpose::Test, k);
            let mut replicate = || {
                let z: f64 = StandardNormal.sample(rng);
                truth * exp(0.8 * z - 0.32)
            };
            let replicates: Vec<f64> = (0..10).map(|_| replicate()).collect();
            let (mean, _, interval) = interval_of_replicates(&replicates, 0.95);
            let mut subset = Estimate::without_number(Method::SubsetSimulation, Event::Any, "");
            (subset.probability, subset.interval, subset.replicates) =
                (Some(mean), interval, replicates);
            agreement(&[subset, exact.clone()], risk).unwrap().agrees == Some(false)
        });
        // 1.22 % in 200 000 sets by numpy, Cox's method being an approximation; four standard errors of 20 000.
        let share = alarms.count() as f64 / 20_000.0;
        assert!((share - 0.0122).abs() < 4.0 * (0.0122 / 20_000.0_f64).sqrt(), "{share}");
    }

    #[test]
    fn analytic_rounding_is_no_difference() {
        // 1 − 2⁻⁵² and 1, each at the end of its interval: nothing on the side of the other.
        let one = estimate(Method::SubsetSimulation, 1.0, Some((1.0, 1.0)));
        let below = 1.0 - f64::EPSILON;
        let other = estimate(Method::DirectionalSampling, below, Some((0.9, below)));
        assert_eq!(agreement(&[one.clone(), other], 0.01).unwrap().agrees, Some(true));
        let apart = estimate(Method::DirectionalSampling, 0.999, Some((0.9, 0.999)));
        assert_eq!(agreement(&[one, apart], 0.01).unwrap().agrees, Some(false));
    }
}
