//! Truncation of a law to an interval, accurate in whichever tail the interval lies.

use super::Law;
use crate::error::{Error, Result};
use crate::numerics::elementary::exp;
use crate::numerics::special::quadrature::integral;

/// The least probability that an interval may keep.
const LEAST_MASS: f64 = 1e-280;

/// An interval of a law, with the law's tails at its ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Truncation {
    /// Least value kept, −∞ where none is stated.
    pub lower: f64,
    /// Greatest value kept, ∞ where none is stated.
    pub upper: f64,
    /// Probability below the lower limit.
    below: f64,
    /// Probability above the lower limit.
    above_lower: f64,
    /// Probability above the upper limit.
    above: f64,
    /// Probability below the upper limit.
    below_upper: f64,
    /// Probability between the limits.
    pub mass: f64,
}

impl Truncation {
    /// The part of `law` between `lower` and `upper`.
    ///
    /// # Errors
    /// If the limits are reversed, not numbers, or leave no probability between them.
    pub fn new(law: &Law, lower: Option<f64>, upper: Option<f64>) -> Result<Self> {
        let (from, to) = ordered(lower, upper)?;
        let (below, above_lower) = law.tails(from);
        let (below_upper, above) = law.tails(to);
        let mass = interval_probability(law, from, to);
        if mass.is_nan() || mass < LEAST_MASS {
            return Err(Error::argument(format!(
                "the truncation to [{from}, {to}] leaves nothing of the {} law",
                law.family()
            )));
        }
        Ok(Truncation { lower: from, upper: to, below, above_lower, above, below_upper, mass })
    }

    /// The law's lower and upper tail where the `lower` or upper tail of its truncated form is `tail`.
    ///
    /// Each is a sum of positive numbers or a difference that at most halves: the smaller is accurate.
    #[inline(always)]
    pub fn tails_of(&self, tail: f64, lower: bool) -> (f64, f64) {
        let share = tail * self.mass;
        let below = if lower { self.below + share } else { self.below_upper - share };
        let above = if lower { self.above_lower - share } else { self.above + share };
        (below, above)
    }

    /// `x`, moved inside the limits if rounding has put it outside.
    #[inline(always)]
    pub fn clamp(&self, x: f64) -> f64 {
        let x = if x < self.lower { self.lower } else { x };
        if x > self.upper { self.upper } else { x }
    }
}

/// The ends of an interval, infinite where none is stated.
///
/// # Errors
/// If they are reversed or not numbers.
pub(super) fn ordered(lower: Option<f64>, upper: Option<f64>) -> Result<(f64, f64)> {
    let from = lower.unwrap_or(f64::NEG_INFINITY);
    let to = upper.unwrap_or(f64::INFINITY);
    if from.is_nan() || to.is_nan() {
        return Err(Error::argument("a truncation limit is not a number"));
    }
    if from >= to {
        return Err(Error::argument(format!(
            "the lower truncation limit {from} is not below the upper one {to}"
        )));
    }
    Ok((from, to))
}

/// The probability that `law` gives to the interval from `from` to `to`.
pub(super) fn interval_probability(law: &Law, from: f64, to: f64) -> f64 {
    if from >= to {
        return 0.0;
    }
    let (below_from, above_from) = law.tails(from);
    let (below_to, above_to) = law.tails(to);
    let (difference, largest) = if below_to <= 0.5 {
        (below_to - below_from, below_to)
    } else if above_from <= 0.5 {
        (above_from - above_to, above_from)
    } else {
        (1.0 - below_from - above_to, 1.0)
    };
    let smooth = !matches!(law, Law::Triangular { .. });
    if smooth && difference < 0.1 * largest && from.is_finite() && to.is_finite() {
        // The difference of two nearly equal tails would lose digits; over so short an interval the
        // density is a gentle curve.
        let (least, greatest) = law.support();
        let (from, to) = (from.max(least), to.min(greatest));
        if from < to {
            return integral(from, to, |x| exp(law.ln_density(x)));
        }
    }
    difference.max(0.0)
}
