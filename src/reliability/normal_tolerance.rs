//! What few samples of a normal outcome show: tolerance factors and predictive exceedance.
//!
//! Both are exact for a normal law and wrong for another: order statistics (`quantiles`) assume
//! nothing and need more samples. Source: Krishnamoorthy and Mathew, *Statistical Tolerance Regions*
//! (2009), ch. 2; the predictive probability is Student's, Geisser, *Predictive Inference* (1993).

use super::binomial_tails::{checked_confidence, checked_probability};
use crate::error::{Error, Result};
use crate::numerics::elementary::{exp, ln};
use crate::numerics::special::quadrature::integral;
use crate::numerics::special::{gamma, normal, student};

/// One-sided normal tolerance factor k: with mean x̄ and standard deviation s of `samples` values of
/// a normal outcome, at least `content` of it lies below x̄ + k·s, at `confidence`.
///
/// k√n is the `confidence` quantile of the noncentral t law with n − 1 degrees of freedom and
/// noncentrality z√n, z the `content` quantile of the normal law; here from
/// P(T ≤ k√n) = ∫ Φ(k√n·w − z√n) f(w) dw over the density f of w = √(χ²/(n − 1)).
///
/// # Errors
/// If there are fewer than two samples, or a probability is not strictly between 0 and 1.
pub fn one_sided_tolerance_factor(samples: u64, content: f64, confidence: f64) -> Result<f64> {
    checked_probability(content, "the content of a tolerance bound")?;
    checked_confidence(confidence)?;
    if samples < 2 {
        return Err(Error::argument("a tolerance factor needs at least two samples"));
    }
    let root = (samples as f64).sqrt();
    let freedom = (samples - 1) as f64;
    let shift = normal::quantile(content) * root;
    let spread = Spread::new(freedom);
    let reached = |k: f64| spread.mean_of(|w| normal::cdf(k * root * w - shift)) >= confidence;
    // Doubling brackets the factor: the probability rises with it from 0 to 1.
    let (mut low, mut high) = (-1.0, 1.0);
    while reached(low) && low > -f64::MAX / 4.0 {
        low *= 2.0;
    }
    while !reached(high) && high < f64::MAX / 4.0 {
        high *= 2.0;
    }
    // Bisection to the last bit: the factor is wanted once in a report.
    loop {
        let middle = low + (high - low) / 2.0;
        if middle <= low || middle >= high {
            return Ok(high);
        }
        if reached(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
}

/// Probability that the next sample of a normal outcome lies more than `deviations` sample standard
/// deviations s beyond the mean x̄ of `samples` values: P(T > deviations/√(1 + 1/n)), T Student with
/// n − 1 degrees of freedom. It is larger than the plug-in 1 − Φ(deviations), which forgets that x̄
/// and s are estimates.
///
/// # Errors
/// If there are fewer than two samples, or the deviations are not a number.
pub fn predictive_exceedance(samples: u64, deviations: f64) -> Result<f64> {
    if samples < 2 || deviations.is_nan() {
        return Err(Error::argument(
            "a predictive probability needs two samples and a number of deviations",
        ));
    }
    let n = samples as f64;
    Ok(student::survival(n - 1.0, deviations / (1.0 + 1.0 / n).sqrt()))
}

/// Panels over the range of w: narrow enough for the step of Φ(k√n·w − z√n) at n = 2.
const PANELS: usize = 64;

/// The law of w = √(χ²_ν/ν), for means over it.
struct Spread {
    freedom: f64,
    ln_scale: f64,
    from: f64,
    panel: f64,
}

impl Spread {
    fn new(freedom: f64) -> Self {
        // w has mean ≈ 1 and standard deviation ≈ 1/√(2ν); beyond 12 of them the mass is below 1e-20.
        let reach = 12.0 / (2.0 * freedom).sqrt();
        let from = (1.0 - reach).max(0.0);
        let panel = (1.0 + reach - from) / PANELS as f64;
        let ln_scale = ln(2.0) + freedom / 2.0 * ln(freedom / 2.0) - gamma::ln_gamma(freedom / 2.0);
        let mut law = Spread { freedom, ln_scale, from, panel };
        // ln_gamma of a large argument has a rounding error of its size; the mass is known to be 1.
        law.ln_scale -= ln(law.mean_of(|_| 1.0));
        law
    }

    fn mean_of(&self, f: impl Fn(f64) -> f64) -> f64 {
        let weighted = |w: f64| {
            f(w) * exp(self.ln_scale + (self.freedom - 1.0) * ln(w) - self.freedom * w * w / 2.0)
        };
        let start = |panel: usize| self.from + self.panel * panel as f64;
        (0..PANELS).map(|panel| integral(start(panel), start(panel + 1), weighted)).sum()
    }
}
