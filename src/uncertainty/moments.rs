//! Means and standard deviations.

use super::Law;
use super::law::EULER_GAMMA;
use super::marginal::Marginal;
use crate::numerics::elementary::{exp, exp_m1};
use crate::numerics::special::gamma::ln_gamma;
use std::f64::consts::PI;

impl Law {
    /// The point that a shift of the law is counted from: its mean, of Student's law its centre.
    pub fn anchor(&self) -> f64 {
        match *self {
            Law::Student { location, logarithmic: true, .. } => exp(location),
            Law::Student { location, .. } => location,
            _ => self.mean(),
        }
    }

    /// Whether mean and standard deviation are finite between `from` and `to`.
    pub(super) fn has_moments(&self, from: f64, to: f64) -> bool {
        match *self {
            Law::Student { logarithmic: true, .. } => to.is_finite(),
            Law::Student { degrees, .. } => degrees > 2.0 || from.is_finite() && to.is_finite(),
            _ => true,
        }
    }

    /// Mean.
    pub fn mean(&self) -> f64 {
        match *self {
            Law::Normal { mean, .. } => mean,
            Law::Lognormal { log_mean, log_sd } => exp(log_mean + 0.5 * log_sd * log_sd),
            Law::Uniform { lower, upper } => 0.5 * lower + 0.5 * upper,
            Law::Triangular { lower, mode, upper } => (lower + mode + upper) / 3.0,
            Law::Beta { alpha, beta, lower, upper } => {
                lower + (upper - lower) * (alpha / (alpha + beta))
            }
            Law::Weibull { shape, scale, location } => {
                location + scale * exp(ln_gamma(1.0 + 1.0 / shape))
            }
            Law::Gumbel { location, scale, minimum } => {
                if minimum {
                    location - EULER_GAMMA * scale
                } else {
                    location + EULER_GAMMA * scale
                }
            }
            Law::Gamma { shape, scale, location } => location + shape * scale,
            Law::Exponential { mean, location } => location + mean,
            // Of the logarithm's t no moment is finite, and of Cauchy's law (one degree) none exists.
            Law::Student { logarithmic: true, .. } => f64::INFINITY,
            Law::Student { location, degrees, .. } if degrees > 1.0 => location,
            Law::Student { .. } => f64::NAN,
            Law::Empirical(ref empirical) => empirical.moments().0,
        }
    }

    /// Standard deviation.
    pub fn sd(&self) -> f64 {
        match *self {
            Law::Normal { sd, .. } => sd,
            Law::Lognormal { log_sd, .. } => self.mean() * exp_m1(log_sd * log_sd).sqrt(),
            Law::Uniform { lower, upper } => (upper - lower) / 12.0_f64.sqrt(),
            Law::Triangular { lower, mode, upper } => {
                let (left, right) = (mode - lower, upper - mode);
                ((left * left + left * right + right * right) / 18.0).sqrt()
            }
            Law::Beta { alpha, beta, lower, upper } => {
                let n = alpha + beta;
                (upper - lower) * (alpha / n * (beta / n) / (n + 1.0)).sqrt()
            }
            Law::Weibull { shape, scale, .. } => {
                let k = 1.0 / shape;
                // Γ(1 + 2k) − Γ(1 + k)², with the second factored out.
                let excess = exp_m1(ln_gamma(1.0 + 2.0 * k) - 2.0 * ln_gamma(1.0 + k));
                scale * exp(ln_gamma(1.0 + k)) * excess.sqrt()
            }
            Law::Gumbel { scale, .. } => scale * PI / 6.0_f64.sqrt(),
            Law::Gamma { shape, scale, .. } => scale * shape.sqrt(),
            Law::Exponential { mean, .. } => mean,
            Law::Student { scale, degrees, logarithmic: false, .. } if degrees > 2.0 => {
                scale * (degrees / (degrees - 2.0)).sqrt()
            }
            Law::Student { .. } => f64::INFINITY,
            Law::Empirical(ref empirical) => empirical.moments().1,
        }
    }
}

/// The mean of `value` of the marginal's variable, by integrating over its probability.
///
/// Double-exponential quadrature over each half of the unit interval, in the half's own tail, so that
/// an infinite or steep end costs nothing; a `kink` (a lower-tail probability at which the quantile
/// function is not smooth) becomes one more end.
pub(super) fn expectation(
    marginal: &Marginal,
    kink: Option<f64>,
    value: impl Fn(f64) -> f64,
) -> f64 {
    let mass = marginal.mass();
    let half = |lower: bool, kink: Option<f64>| {
        let at = |tail: f64| {
            // Of a law cut to so little of itself that the tail cannot be written as a number: a share of
            // the integral below 1e-28.
            if tail * mass < f64::MIN_POSITIVE {
                return 0.0;
            }
            value(if lower { marginal.quantile_lower(tail) } else { marginal.quantile_upper(tail) })
        };
        match kink.filter(|&kink| kink > 0.0 && kink < 0.5) {
            Some(kink) => double_exponential(0.0, kink, at) + double_exponential(kink, 0.5, at),
            None => double_exponential(0.0, 0.5, at),
        }
    };
    half(true, kink) + half(false, kink.map(|kink| 1.0 - kink))
}

/// ∫ `f` from `from` to `to` by the tanh-sinh rule of Takahasi and Mori (1974), step 1/16.
fn double_exponential(from: f64, to: f64, f: impl Fn(f64) -> f64) -> f64 {
    const STEP: f64 = 1.0 / 16.0;
    let width = to - from;
    let mut sum = 0.0;
    for k in -80..=80 {
        let t = STEP * f64::from(k);
        let (up, down) = (exp(t), exp(-t));
        // share = 1/(1 + exp(−π sinh t)), and its complement, each to its own precision.
        let growth = exp(0.5 * PI * (up - down));
        let (share, complement) = (growth / (1.0 + growth), 1.0 / (1.0 + growth));
        let weight = 0.5 * PI * (up + down) * share * complement;
        let x = if k <= 0 { from + width * share } else { to - width * complement };
        if weight > 0.0 && x > 0.0 {
            sum += weight * f(x);
        }
    }
    STEP * width * sum
}
