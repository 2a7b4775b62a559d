//! The error of a statistic by leaving out one of a few groups of its data at a time.

use crate::numerics::interval::{Earned, Estimate, Interval};
use crate::numerics::special::student;

/// The estimate `value` of a statistic, given the statistic without each of `g` equal groups of its data.
///
/// The delete-a-group jackknife: variance `(g − 1)/g Σ (x₍ᵢ₎ − x̄)²` and Student's t with `g − 1` degrees of freedom
/// (P. Kott, *The delete-a-group jackknife*, Journal of Official Statistics 17, 2001).
pub fn delete_a_group(
    value: f64,
    without_each: &[f64],
    confidence: f64,
    method: &'static str,
) -> Estimate {
    let groups = without_each.len() as f64;
    let mean = without_each.iter().sum::<f64>() / groups;
    let squares: f64 = without_each.iter().map(|x| (x - mean) * (x - mean)).sum();
    let error = (squares * (groups - 1.0) / groups).sqrt();
    if !(error > 0.0 && error.is_finite()) {
        let interval = Earned::none("the groups of the data show no error");
        return Estimate { value: Some(value), standard_error: None, interval };
    }
    let reach = error * student::quantile_upper(groups - 1.0, 0.5 * (1.0 - confidence));
    let interval =
        Interval { lower: value - reach, upper: value + reach, confidence, method }.into();
    Estimate { value: Some(value), standard_error: Some(error), interval }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a mean the jackknife's variance is the usual one of the groups' means, exactly.
    #[test]
    fn analytic_of_a_mean_it_is_the_standard_error() {
        let data = [3.0, 1.0, 4.0, 1.0, 5.0];
        let (n, sum) = (data.len() as f64, data.iter().sum::<f64>());
        let without: Vec<f64> = data.iter().map(|x| (sum - x) / (n - 1.0)).collect();
        let estimate = delete_a_group(sum / n, &without, 0.95, "test");
        let spread: f64 = data.iter().map(|x| (x - sum / n) * (x - sum / n)).sum::<f64>();
        let wanted = (spread / (n - 1.0) / n).sqrt();
        assert!((estimate.standard_error.unwrap() - wanted).abs() < 1e-14);
        // Student's t with four degrees of freedom, 97.5 %: 2.776 (any table).
        let half = 0.5 * estimate.interval.interval().unwrap().width();
        assert!((half / wanted - 2.776).abs() < 1e-3);
        assert!(delete_a_group(1.0, &[1.0; 20], 0.95, "test").interval.interval().is_none());
    }
}
