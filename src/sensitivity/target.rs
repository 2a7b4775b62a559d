//! Where the breaches lie: target sensitivity of a breach, and how its inputs differ from their laws.
//!
//! Target: the share of the breach indicator's variance that an input explains (first-order index of the
//! indicator). Conditional: the law of an input among the breaching samples against its own law, as a shift of
//! its normal score and as the largest distance between the distribution functions (Spear and Hornberger's
//! regional analysis, Water Res. 14 (1980) 43; the terms are Marrel and Chabridon's, Reliab. Eng. Syst. Saf. 214
//! (2021) 107711).

use super::given_data::{GivenData, checked};
use super::rank_index;
use crate::error::{Error, Result};
use crate::numerics::elementary::{exp, ln};
use crate::numerics::interval::{Earned, Estimate, Interval};
use crate::numerics::special::{normal, student};
use serde::Serialize;

/// Breaches that a shift needs for its interval.
const FEWEST: usize = 10;

/// What one input has to do with one breach.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BreachSensitivity {
    /// First-order index of the breach indicator.
    pub target: Estimate,
    /// Mean of the input's normal score Φ⁻¹(F(x)) among the breaches; 0 if they do not depend on it.
    pub shift: Estimate,
    /// Largest distance between its distribution function among the breaches and its own.
    pub distance: Estimate,
    /// Probability of so large a distance if the breaches did not depend on the input (Kolmogorov).
    pub p_value: Option<f64>,
}

/// The sensitivities of a breach (1, 0, NaN for a fault) to every input, given the inputs' values of their
/// own distribution functions, one column an input.
///
/// # Errors
/// If a column has another length than the breach, a value is not strictly between 0 and 1, or the
/// confidence is not.
pub fn breach_sensitivities(
    uniforms: &[&[f64]],
    breached: &[f64],
    confidence: f64,
) -> Result<Vec<BreachSensitivity>> {
    checked(confidence)?;
    let data = GivenData::new(uniforms, breached)?;
    if data.inputs().iter().flatten().any(|u| !(*u > 0.0 && *u < 1.0)) {
        return Err(Error::argument("a distribution function's value lies between 0 and 1"));
    }
    let target = rank_index::first_order(&data, confidence)?;
    let found = data.inputs().iter().zip(target).map(|(input, target)| {
        let among: Vec<f64> = input
            .iter()
            .zip(data.outcome())
            .filter(|(_, breached)| **breached == 1.0)
            .map(|(u, _)| *u)
            .collect();
        let scores: Vec<f64> = among.iter().map(|&u| normal::quantile(u)).collect();
        let AmongBreaches { shift, distance, p_value } = among_breaches(&scores, confidence);
        BreachSensitivity { target, shift, distance, p_value }
    });
    Ok(found.collect())
}

/// How an input's law among the breaching samples differs from its own.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AmongBreaches {
    /// Mean of the input's normal score Φ⁻¹(F(x)) among the breaches; 0 if they do not depend on it.
    pub shift: Estimate,
    /// Largest distance between its distribution function among the breaches and its own.
    pub distance: Estimate,
    /// Probability of so large a distance if the breaches did not depend on the input (Kolmogorov).
    pub p_value: Option<f64>,
}

/// The conditional sensitivity of a breach to an input, given the input's normal scores in the breaching
/// samples and a confidence strictly between 0 and 1.
pub fn among_breaches(scores: &[f64], confidence: f64) -> AmongBreaches {
    let uniforms = scores.iter().map(|&z| normal::cdf(z)).collect();
    let (distance, p_value) = distance(uniforms, confidence);
    AmongBreaches { shift: shift(scores, confidence), distance, p_value }
}

fn shift(scores: &[f64], confidence: f64) -> Estimate {
    if scores.is_empty() {
        return Estimate::none("no sample breached");
    }
    let count = scores.len() as f64;
    let mean = scores.iter().sum::<f64>() / count;
    let squares: f64 = scores.iter().map(|z| (z - mean) * (z - mean)).sum();
    let error = (squares / (count - 1.0) / count).sqrt();
    if scores.len() < FEWEST || error == 0.0 {
        let interval = Earned::none(format!("{count} breaches are too few for an interval"));
        return Estimate { value: Some(mean), standard_error: None, interval };
    }
    let half = student::quantile_upper(count - 1.0, (1.0 - confidence) / 2.0) * error;
    let method = "Student t over breaches";
    let interval = Interval { lower: mean - half, upper: mean + half, confidence, method };
    Estimate { value: Some(mean), standard_error: Some(error), interval: interval.into() }
}

/// Kolmogorov's distance from the uniform law, with the Dvoretzky–Kiefer–Wolfowitz band (Massart's constant)
/// as its interval.
fn distance(mut among: Vec<f64>, confidence: f64) -> (Estimate, Option<f64>) {
    if among.is_empty() {
        return (Estimate::none("no sample breached"), None);
    }
    among.sort_by(f64::total_cmp);
    let count = among.len() as f64;
    let distance = among
        .iter()
        .enumerate()
        .map(|(k, &u)| (u - k as f64 / count).max((k + 1) as f64 / count - u))
        .fold(0.0, f64::max);
    let band = (ln(2.0 / (1.0 - confidence)) / (2.0 * count)).sqrt();
    let method = "Dvoretzky-Kiefer-Wolfowitz";
    let interval = Interval {
        lower: (distance - band).max(0.0),
        upper: (distance + band).min(1.0),
        confidence,
        method,
    };
    let estimate =
        Estimate { value: Some(distance), standard_error: None, interval: interval.into() };
    (estimate, Some(kolmogorov_tail(count, distance)))
}

/// The tail of Kolmogorov's limit law with Stephens' correction for a finite sample (J. R. Stat. Soc. B
/// 32 (1970) 115).
fn kolmogorov_tail(count: f64, distance: f64) -> f64 {
    let root = count.sqrt();
    let t = (root + 0.12 + 0.11 / root) * distance;
    if t < 0.2 {
        return 1.0;
    }
    let term = |k: f64| {
        let sign = if k % 2.0 == 1.0 { 1.0 } else { -1.0 };
        2.0 * sign * exp(-2.0 * k * k * t * t)
    };
    (1..=100).map(|k| term(f64::from(k))).sum::<f64>().clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_tail_of_kolmogorovs_law() {
        // Critical values of the limit law: 1.358 at 5 %, 1.628 at 1 %.
        let count = 1e12;
        assert!((kolmogorov_tail(count, 1.3581 / 1e6) - 0.05).abs() < 1e-4);
        assert!((kolmogorov_tail(count, 1.6276 / 1e6) - 0.01).abs() < 1e-4);
        assert_eq!(kolmogorov_tail(100.0, 0.01), 1.0);
    }
}
