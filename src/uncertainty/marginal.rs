//! One uncertain quantity: a law with stated truncation.

use super::moments::expectation;
use super::transform::{
    NormalTransform, Scale, tail_of_uniform, truncated_normal_of, uniform_column,
    uniform_column_from_normal,
};
use super::truncation::{Truncation, interval_probability, ordered};
use super::{Empirical, Law};
use crate::error::Result;
use crate::numerics::elementary::ln;
use crate::numerics::special::normal;

/// A law and the interval to which it is truncated, if any.
#[derive(Debug, Clone, PartialEq)]
pub struct Marginal {
    law: Law,
    lower: Option<f64>,
    upper: Option<f64>,
    cut: Option<Truncation>,
    /// What truncation leaves of a law of listed values, which has atoms, and the probability that it had.
    kept: Option<(Empirical, f64)>,
}

impl Marginal {
    /// `law`, truncated to the values between `lower` and `upper` where they are stated.
    ///
    /// # Errors
    /// If the limits are reversed, not numbers, or leave no probability between them.
    pub fn new(law: Law, lower: Option<f64>, upper: Option<f64>) -> Result<Self> {
        let mut marginal = Marginal { lower, upper, ..Marginal::untruncated(law) };
        if lower.is_none() && upper.is_none() {
            return Ok(marginal);
        }
        match &marginal.law {
            Law::Empirical(empirical) => {
                let (from, to) = ordered(lower, upper)?;
                marginal.kept = Some(empirical.restricted(from, to)?);
            }
            law => marginal.cut = Some(Truncation::new(law, lower, upper)?),
        }
        Ok(marginal)
    }

    /// `law` as it is.
    pub fn untruncated(law: Law) -> Self {
        Marginal { law, lower: None, upper: None, cut: None, kept: None }
    }

    /// The law before truncation.
    pub fn law(&self) -> &Law {
        &self.law
    }

    /// The lower truncation limit.
    pub fn lower(&self) -> Option<f64> {
        self.lower
    }

    /// The upper truncation limit.
    pub fn upper(&self) -> Option<f64> {
        self.upper
    }

    /// The probability that the law had between the limits; 1 without truncation.
    pub fn mass(&self) -> f64 {
        match &self.kept {
            Some((_, mass)) => *mass,
            None => self.cut.map_or(1.0, |cut| cut.mass),
        }
    }

    /// The law of listed values, truncated, if it is one.
    fn listed(&self) -> Option<&Empirical> {
        match (&self.kept, &self.law) {
            (Some((kept, _)), _) => Some(kept),
            (None, Law::Empirical(whole)) => Some(whole),
            _ => None,
        }
    }

    /// Whether the quantile function jumps: then an outcome has no slope in the input's coordinate.
    pub fn has_jumps(&self) -> bool {
        self.listed().is_some_and(Empirical::has_jumps)
    }

    /// The listed law, for integrals over its steps.
    pub(super) fn stepped(&self) -> Option<&Empirical> {
        self.listed()
    }

    /// The smallest interval that holds every value, ends possibly infinite.
    pub fn support(&self) -> (f64, f64) {
        if let Some(listed) = self.listed() {
            return listed.support();
        }
        let (least, greatest) = self.law.support();
        (
            self.lower.map_or(least, |x| x.max(least)),
            self.upper.map_or(greatest, |x| x.min(greatest)),
        )
    }

    /// The law as a function of a standard normal value, where it is one.
    fn normal_transform(&self) -> Option<NormalTransform> {
        match self.law {
            Law::Normal { mean, sd } => {
                Some(NormalTransform { scale: Scale::Linear, offset: mean, factor: sd })
            }
            Law::Lognormal { log_mean, log_sd } => Some(NormalTransform {
                scale: Scale::Exponential,
                offset: log_mean,
                factor: log_sd,
            }),
            _ => None,
        }
    }

    /// The value whose `lower` or upper tail is `tail` ≤ ½.
    fn quantile_of_tail(&self, tail: f64, lower: bool) -> f64 {
        if let Some(listed) = self.listed() {
            return listed.quantile_of_tail(tail, lower);
        }
        if let Law::Uniform { .. } = self.law {
            // A truncated uniform law is a narrower one.
            let (from, to) = self.support();
            return super::transform::uniform_of(from, to, tail, lower);
        }
        let Some(cut) = &self.cut else { return self.law.quantile_of_tail(tail, lower) };
        let x = match self.normal_transform() {
            Some(transform) => transform.value(truncated_normal_of(cut, tail, lower)),
            None => {
                let (below, above) = cut.tails_of(tail, lower);
                if below <= above {
                    self.law.quantile_of_tail(below, true)
                } else {
                    self.law.quantile_of_tail(above, false)
                }
            }
        };
        cut.clamp(x)
    }

    /// The value whose lower tail is `p` of [0, 1].
    pub fn quantile_lower(&self, p: f64) -> f64 {
        if p > 0.5 { self.quantile_of_tail(1.0 - p, false) } else { self.quantile_of_tail(p, true) }
    }

    /// The value whose upper tail is `q` of [0, 1].
    pub fn quantile_upper(&self, q: f64) -> f64 {
        if q > 0.5 { self.quantile_of_tail(1.0 - q, true) } else { self.quantile_of_tail(q, false) }
    }

    /// The value at the uniform `u`: [`Marginal::quantile_lower`], of which [`Marginal::quantile_column`] is the column.
    pub fn from_uniform(&self, u: f64) -> f64 {
        self.quantile_lower(u)
    }

    /// The value with the tails of the standard normal `z`; mean + sd z for an untruncated normal law.
    pub fn from_standard_normal(&self, z: f64) -> f64 {
        match (self.normal_transform(), &self.cut) {
            (Some(transform), None) => transform.value(z),
            _ => self.quantile_of_tail(normal::cdf(-z.abs()), z <= 0.0),
        }
    }

    /// The standard normal value with the tails of `x`; infinite at and beyond the ends of the support.
    pub fn to_standard_normal(&self, x: f64) -> f64 {
        match (&self.law, &self.cut) {
            (&Law::Normal { mean, sd }, None) => (x - mean) / sd,
            (&Law::Lognormal { log_mean, log_sd }, None) if x > 0.0 => (ln(x) - log_mean) / log_sd,
            _ => {
                // The middle of an atom's share of the axis stands for it.
                let (below, above) = match self.listed() {
                    Some(listed) => listed.middle_tails(x),
                    None => self.tails(x),
                };
                if below <= above { normal::quantile(below) } else { normal::quantile_upper(above) }
            }
        }
    }

    /// [`Marginal::from_uniform`] of every `u`, with the same bits.
    pub fn quantile_column(&self, u: &[f64], out: &mut [f64]) {
        if let Law::Uniform { .. } = self.law {
            let (from, to) = self.support();
            uniform_column(u, out, from, to);
        } else if let Some(transform) = self.normal_transform() {
            transform.column_from_uniform(u, out, self.cut.as_ref());
        } else {
            for (out, &u) in out.iter_mut().zip(u) {
                let (tail, lower) = tail_of_uniform(u);
                *out = self.quantile_of_tail(tail, lower);
            }
        }
    }

    /// [`Marginal::from_standard_normal`] of every `z`, with the same bits.
    pub fn from_standard_normal_column(&self, z: &[f64], out: &mut [f64]) {
        if let Law::Uniform { .. } = self.law {
            let (from, to) = self.support();
            uniform_column_from_normal(z, out, from, to);
        } else if let Some(transform) = self.normal_transform() {
            transform.column_from_normal(z, out, self.cut.as_ref());
        } else {
            for (out, &z) in out.iter_mut().zip(z) {
                *out = self.from_standard_normal(z);
            }
        }
    }

    /// Lower and upper tail at `x`, each to its own precision.
    fn tails(&self, x: f64) -> (f64, f64) {
        if let (Some(listed), false) = (self.listed(), x.is_nan()) {
            return listed.tails(x);
        }
        let Some(cut) = &self.cut else { return self.law.tails(x) };
        if x.is_nan() {
            (x, x)
        } else if x <= cut.lower {
            (0.0, 1.0)
        } else if x >= cut.upper {
            (1.0, 0.0)
        } else {
            let below = interval_probability(&self.law, cut.lower, x) / cut.mass;
            let above = interval_probability(&self.law, x, cut.upper) / cut.mass;
            (below.min(1.0), above.min(1.0))
        }
    }

    /// Distribution function: the lower tail at `x`.
    pub fn cdf(&self, x: f64) -> f64 {
        self.tails(x).0
    }

    /// Survival function: the upper tail at `x`, accurate where the distribution function rounds to one.
    pub fn survival(&self, x: f64) -> f64 {
        self.tails(x).1
    }

    /// ln of the density at `x`; −∞ outside the support.
    pub fn ln_density(&self, x: f64) -> f64 {
        if let Some(listed) = self.listed() {
            let (from, to) = listed.support();
            return if (from..=to).contains(&x) { listed.ln_density(x) } else { f64::NEG_INFINITY };
        }
        let Some(cut) = &self.cut else { return self.law.ln_density(x) };
        if x < cut.lower || x > cut.upper {
            f64::NEG_INFINITY
        } else {
            self.law.ln_density(x) - ln(cut.mass)
        }
    }

    /// Median.
    pub fn median(&self) -> f64 {
        self.quantile_of_tail(0.5, true)
    }

    /// Mean, of the truncated law to about 1e-12 of its spread.
    pub fn mean(&self) -> f64 {
        self.moments().0
    }

    /// Standard deviation, of the truncated law to about 1e-12 relative.
    pub fn sd(&self) -> f64 {
        self.moments().1
    }

    /// Mean and standard deviation; for a truncated law one integration gives both.
    pub fn moments(&self) -> (f64, f64) {
        if let Some(listed) = self.listed() {
            return listed.moments();
        }
        let Some(cut) = &self.cut else { return (self.law.mean(), self.law.sd()) };
        if !self.law.has_moments(cut.lower, cut.upper) {
            return (self.law.mean(), self.law.sd());
        }
        match &self.law {
            Law::Uniform { .. } => {
                let (from, to) = self.support();
                (0.5 * from + 0.5 * to, (to - from) / 12.0_f64.sqrt())
            }
            law => {
                let kink = match *law {
                    Law::Triangular { mode, .. } => Some(self.cdf(mode)),
                    _ => None,
                };
                // About the median, so that a narrow law far from zero keeps its digits.
                let median = self.median();
                let shift = expectation(self, kink, |x| x - median);
                let mean = median + shift;
                let variance = expectation(self, kink, |x| (x - mean) * (x - mean));
                (mean, variance.sqrt())
            }
        }
    }
}
