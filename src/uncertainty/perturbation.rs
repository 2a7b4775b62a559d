//! Laws moved and stretched, and how the density answers.

use super::law::Law;
use super::marginal::Marginal;
use crate::error::{Error, Result};
use crate::numerics::elementary::{exp, ln, ln_1p, pow};
use crate::numerics::special::normal;

/// Relative step of the central differences: the cube root of the rounding unit balances the errors.
const STEP: f64 = 6e-6;

impl Law {
    /// The value that `x` becomes when the law's spread is multiplied by `factor`.
    fn stretched(&self, factor: f64, x: f64) -> f64 {
        match *self {
            Law::Lognormal { log_mean, .. } if x > 0.0 => {
                // exp(λ + factor (ln x − λ)): about the median, on the scale of the logarithm.
                exp(log_mean * (1.0 - factor)) * pow(x, factor)
            }
            Law::Lognormal { .. } => x,
            Law::Student { location, logarithmic: true, .. } if x > 0.0 => {
                exp(location * (1.0 - factor)) * pow(x, factor)
            }
            Law::Student { logarithmic: true, .. } => x,
            Law::Student { location, .. } => location + factor * (x - location),
            Law::Uniform { lower, upper } => {
                let centre = 0.5 * lower + 0.5 * upper;
                centre + factor * (x - centre)
            }
            _ => {
                let centre = self.mean();
                centre + factor * (x - centre)
            }
        }
    }

    /// The law with its spread multiplied by `factor` > 0 about its mean, which stays where it is.
    ///
    /// Every value x becomes mean + factor (x − mean), so the family stays the same: a normal law's sd, a
    /// uniform law's width, a Gumbel law's scale are multiplied, and a bound or location moves with the
    /// values. Of a lognormal law the standard deviation of the logarithm is multiplied and the median kept.
    ///
    /// # Errors
    /// If `factor` is not finite and above zero, or a parameter leaves its range by it.
    pub fn with_spread(&self, factor: f64) -> Result<Law> {
        if !(factor > 0.0 && factor.is_finite()) {
            return Err(Error::argument(format!("a spread factor is above zero, not {factor}")));
        }
        let map = |x: f64| self.stretched(factor, x);
        match *self {
            Law::Normal { mean, sd } => Law::normal(mean, sd * factor),
            Law::Lognormal { log_mean, log_sd } => {
                Ok(Law::Lognormal { log_mean, log_sd: log_sd * factor })
            }
            Law::Uniform { lower, upper } => Law::uniform(map(lower), map(upper)),
            Law::Triangular { lower, mode, upper } => {
                let (lower, upper) = (map(lower), map(upper));
                Law::triangular(lower, map(mode).clamp(lower, upper), upper)
            }
            Law::Beta { alpha, beta, lower, upper } => {
                Law::beta(alpha, beta, map(lower), map(upper))
            }
            Law::Weibull { shape, scale, location } => {
                Law::weibull(shape, scale * factor, map(location))
            }
            Law::Gumbel { location, scale, minimum } => {
                Law::gumbel(location, scale * factor)?;
                Ok(Law::Gumbel { location: map(location), scale: scale * factor, minimum })
            }
            Law::Gamma { shape, scale, location } => {
                Law::gamma(shape, scale * factor, map(location))
            }
            Law::Exponential { mean, location } => Law::exponential(mean * factor, map(location)),
            Law::Student { location, scale, degrees, logarithmic } => {
                Ok(Law::Student { location, scale: scale * factor, degrees, logarithmic })
            }
            Law::Empirical(ref empirical) => Ok(Law::Empirical(empirical.mapped(map)?)),
        }
    }

    /// The value that `x` becomes when the law's mean moves by `delta`.
    fn shifted(&self, delta: f64, x: f64) -> f64 {
        match self {
            Law::Lognormal { .. } => x * (1.0 + delta / self.mean()),
            Law::Student { logarithmic: true, .. } => x * (1.0 + delta / self.anchor()),
            _ => x + delta,
        }
    }

    /// The law with its mean moved by `delta`: every value moves by as much.
    ///
    /// A lognormal law keeps the standard deviation of its logarithm and stays positive: its values are
    /// multiplied instead.
    ///
    /// # Errors
    /// If a lognormal law's mean would not be positive, or a parameter would not be finite.
    pub fn with_shifted_mean(&self, delta: f64) -> Result<Law> {
        let map = |x: f64| self.shifted(delta, x);
        match *self {
            Law::Normal { mean, sd } => Law::normal(map(mean), sd),
            Law::Lognormal { log_mean, log_sd } => {
                let growth = delta / self.mean();
                if !(growth > -1.0 && growth.is_finite()) {
                    return Err(Error::argument(format!(
                        "moving the mean of a lognormal law by {delta} leaves it no positive mean"
                    )));
                }
                Ok(Law::Lognormal { log_mean: log_mean + ln_1p(growth), log_sd })
            }
            Law::Uniform { lower, upper } => Law::uniform(map(lower), map(upper)),
            Law::Triangular { lower, mode, upper } => {
                Law::triangular(map(lower), map(mode), map(upper))
            }
            Law::Beta { alpha, beta, lower, upper } => {
                Law::beta(alpha, beta, map(lower), map(upper))
            }
            Law::Weibull { shape, scale, location } => Law::weibull(shape, scale, map(location)),
            Law::Gumbel { location, scale, minimum } => {
                Law::gumbel(map(location), scale)?;
                Ok(Law::Gumbel { location: map(location), scale, minimum })
            }
            Law::Gamma { shape, scale, location } => Law::gamma(shape, scale, map(location)),
            Law::Exponential { mean, location } => Law::exponential(mean, map(location)),
            Law::Student { location, scale, degrees, logarithmic } => {
                let growth = delta / self.anchor();
                if !delta.is_finite() || logarithmic && growth <= -1.0 {
                    return Err(Error::argument(format!("a law cannot move by {delta}")));
                }
                let location = if logarithmic { location + ln_1p(growth) } else { map(location) };
                Ok(Law::Student { location, scale, degrees, logarithmic })
            }
            Law::Empirical(ref empirical) => Ok(Law::Empirical(empirical.mapped(map)?)),
        }
    }

    /// The spread parameter of the scores: the standard deviation, of a lognormal law the logarithm's.
    pub fn spread(&self) -> f64 {
        match *self {
            Law::Lognormal { log_sd, .. } => log_sd,
            Law::Student { scale, .. } => scale,
            _ => self.sd(),
        }
    }
}

impl Marginal {
    /// The marginal with its law's spread multiplied by `factor`, truncation limits moving with the
    /// values: limits at ± 3 sd stay at ± 3 sd. See [`Law::with_spread`].
    ///
    /// # Errors
    /// As [`Law::with_spread`] and [`Marginal::new`].
    pub fn with_spread(&self, factor: f64) -> Result<Marginal> {
        let map = |x: f64| self.law().stretched(factor, x);
        Marginal::new(self.law().with_spread(factor)?, self.lower().map(map), self.upper().map(map))
    }

    /// The marginal with its law's mean moved by `delta`, truncation limits moving with the values.
    ///
    /// # Errors
    /// As [`Law::with_shifted_mean`] and [`Marginal::new`].
    pub fn with_shifted_mean(&self, delta: f64) -> Result<Marginal> {
        let map = |x: f64| self.law().shifted(delta, x);
        Marginal::new(
            self.law().with_shifted_mean(delta)?,
            self.lower().map(map),
            self.upper().map(map),
        )
    }

    /// ∂ ln density(`x`)/∂ mean, the mean being the law's before truncation.
    ///
    /// Truncation limits stay where they are, so that for a normal or lognormal law, truncated or not, the
    /// expectation is zero and E[1(breach) score] is the derivative of a breach probability. A law with a
    /// finite end of its own moves that end with its mean; its score is the interior's alone, and says
    /// nothing of the probability that the moving end uncovers. NaN where a law cannot be moved.
    pub fn score_mean(&self, x: f64) -> f64 {
        match *self.law() {
            Law::Normal { mean, sd } => {
                let z = (x - mean) / sd;
                (z - self.truncation_scores().0) / sd
            }
            Law::Lognormal { log_mean, log_sd } => {
                let z = (ln(x) - log_mean) / log_sd;
                (z - self.truncation_scores().0) / (log_sd * self.law().mean())
            }
            _ => {
                let step = STEP * self.law().sd();
                self.central_difference(x, step, |law, h| law.with_shifted_mean(h))
            }
        }
    }

    /// ∂ ln density(`x`)/∂ [`Law::spread`] of the law before truncation, the centre of [`Law::with_spread`]
    /// held. What [`Marginal::score_mean`] says of limits and ends holds here.
    pub fn score_spread(&self, x: f64) -> f64 {
        match *self.law() {
            Law::Normal { mean, sd } => {
                let z = (x - mean) / sd;
                ((z * z - 1.0) - self.truncation_scores().1) / sd
            }
            Law::Lognormal { log_mean, log_sd } => {
                let z = (ln(x) - log_mean) / log_sd;
                ((z * z - 1.0) - self.truncation_scores().1) / log_sd
            }
            _ => {
                let spread = self.law().spread();
                let step = STEP * spread;
                self.central_difference(x, step, |law, h| law.with_spread(1.0 + h / spread))
            }
        }
    }

    /// E[Z] and E[Z² − 1] of the truncated standard normal variable: what truncation takes off the scores.
    fn truncation_scores(&self) -> (f64, f64) {
        if self.lower().is_none() && self.upper().is_none() {
            return (0.0, 0.0);
        }
        let standardised = |x: f64| match *self.law() {
            Law::Normal { mean, sd } => (x - mean) / sd,
            Law::Lognormal { log_mean, log_sd } if x > 0.0 => (ln(x) - log_mean) / log_sd,
            _ => f64::NEG_INFINITY,
        };
        let from = self.lower().map_or(f64::NEG_INFINITY, standardised);
        let to = self.upper().map_or(f64::INFINITY, standardised);
        // −φ' integrates to −φ, and φ'' = (z² − 1) φ to φ' = −z φ; both vanish at infinity.
        let first = |z: f64| if z.is_finite() { normal::density(z) } else { 0.0 };
        let second = |z: f64| if z.is_finite() { z * normal::density(z) } else { 0.0 };
        let mass = self.mass();
        ((first(from) - first(to)) / mass, (second(from) - second(to)) / mass)
    }

    /// The central difference of ln density at `x` under a change of the law, limits held.
    fn central_difference(
        &self,
        x: f64,
        step: f64,
        changed: impl Fn(&Law, f64) -> Result<Law>,
    ) -> f64 {
        let at = |h: f64| {
            changed(self.law(), h)
                .and_then(|law| Marginal::new(law, self.lower(), self.upper()))
                .map_or(f64::NAN, |marginal| marginal.ln_density(x))
        };
        (at(step) - at(-step)) / (2.0 * step)
    }
}
