//! The law of a set of observations.

use crate::error::{Error, Result};
use crate::numerics::elementary::ln;

/// A continuous law through observed values: its quantile function is piecewise linear between them.
///
/// Value i of n in ascending order lies at the probability (i − 1)/(n − 1) (type 7 of Hyndman and Fan,
/// 1996), so that the least and greatest observations bound it and the density between two neighbours
/// is constant. With weights w, it lies at (m(i) − m(1))/(m(n) − m(1)), where m(i) is the weight below i
/// plus half its own, which is the same for equal weights. Equal values are pooled into one with their
/// joint weight: the law has no atoms.
#[derive(Debug, Clone, PartialEq)]
pub struct Empirical {
    values: Vec<f64>,
    /// Lower tail at every value, from 0 to 1.
    below: Vec<f64>,
    /// Upper tail at every value, from 1 to 0, summed from above so that it keeps its digits.
    above: Vec<f64>,
}

impl Empirical {
    /// The law of `values`, equally weighted or with `weights`.
    ///
    /// # Errors
    /// If a value is not finite, a weight is negative or not finite, their numbers differ, or fewer
    /// than two different values have weight.
    pub fn new(values: Vec<f64>, weights: Option<Vec<f64>>) -> Result<Self> {
        let weights = match weights {
            Some(weights) if weights.len() != values.len() => {
                return Err(Error::argument(format!(
                    "an empirical law needs one weight a value, not {} for {} values",
                    weights.len(),
                    values.len()
                )));
            }
            Some(weights) => weights,
            None => vec![1.0; values.len()],
        };
        if let Some(k) = values.iter().position(|value| !value.is_finite()) {
            let value = values.get(k).copied().unwrap_or(f64::NAN);
            return Err(Error::argument(format!(
                "an empirical law needs finite values, and value {} is {value}",
                k + 1
            )));
        }
        if let Some(k) = weights.iter().position(|&weight| !(weight >= 0.0 && weight.is_finite())) {
            let weight = weights.get(k).copied().unwrap_or(f64::NAN);
            return Err(Error::argument(format!(
                "an empirical law needs weights of zero or more, and weight {} is {weight}",
                k + 1
            )));
        }
        let mut pairs: Vec<(f64, f64)> =
            values.into_iter().zip(weights).filter(|&(_, weight)| weight > 0.0).collect();
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut pooled: Vec<(f64, f64)> = Vec::with_capacity(pairs.len());
        for (value, weight) in pairs {
            match pooled.last_mut() {
                Some(last) if last.0 == value => last.1 += weight,
                _ => pooled.push((value, weight)),
            }
        }
        if pooled.len() < 2 {
            return Err(Error::argument(
                "an empirical law needs at least two different values; state a constant as a constant",
            ));
        }
        // Steps between neighbours' mid-weights, summed from either end.
        let steps: Vec<f64> = pooled.windows(2).map(|pair| 0.5 * (pair[0].1 + pair[1].1)).collect();
        let total: f64 = steps.iter().sum();
        if !(total.is_finite() && total > 0.0) {
            return Err(Error::argument("an empirical law needs weights with a finite sum"));
        }
        let mut below = vec![0.0; pooled.len()];
        let mut above = vec![0.0; pooled.len()];
        let mut sum = 0.0;
        for (k, step) in steps.iter().enumerate() {
            sum += step;
            below[k + 1] = (sum / total).min(1.0);
        }
        sum = 0.0;
        for (k, step) in steps.iter().enumerate().rev() {
            sum += step;
            above[k] = (sum / total).min(1.0);
        }
        let last = pooled.len() - 1;
        below[last] = 1.0;
        above[0] = 1.0;
        Ok(Empirical { values: pooled.into_iter().map(|(value, _)| value).collect(), below, above })
    }

    /// The different values in ascending order.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The lower tail at every value.
    pub fn probabilities(&self) -> &[f64] {
        &self.below
    }

    /// Least and greatest value.
    pub fn support(&self) -> (f64, f64) {
        (self.values[0], self.values[self.values.len() - 1])
    }

    /// The value whose `lower` or upper tail is `tail`.
    pub(super) fn quantile_of_tail(&self, tail: f64, lower: bool) -> f64 {
        if tail.is_nan() {
            return tail;
        }
        let last = self.values.len() - 1;
        // The segment k..k + 1 that holds the tail, and the tails at its ends.
        let k = if lower {
            self.below.partition_point(|&p| p <= tail).clamp(1, last) - 1
        } else {
            self.above.partition_point(|&q| q > tail).clamp(1, last) - 1
        };
        let tails = if lower { &self.below } else { &self.above };
        let (from, to) = (self.values[k], self.values[k + 1]);
        let mass = tails[k + 1] - tails[k];
        let share = if mass == 0.0 { 0.5 } else { (tail - tails[k]) / mass };
        // From the nearer end, so that both ends are hit exactly.
        let x = if share <= 0.5 {
            from + (to - from) * share
        } else {
            to - (to - from) * (1.0 - share)
        };
        x.clamp(from, to)
    }

    /// The segment k..k + 1 that holds `x` of the support, and x's share of its length.
    fn segment(&self, x: f64) -> (usize, f64) {
        let last = self.values.len() - 1;
        let k = self.values.partition_point(|&value| value <= x).clamp(1, last) - 1;
        (k, (x - self.values[k]) / (self.values[k + 1] - self.values[k]))
    }

    /// Lower and upper tail at `x` of the support.
    pub(super) fn tails(&self, x: f64) -> (f64, f64) {
        let (k, share) = self.segment(x);
        let between = |tails: &[f64]| tails[k] * (1.0 - share) + tails[k + 1] * share;
        (between(&self.below), between(&self.above))
    }

    /// ln of the piecewise constant density at `x` of the support; at a value, of the segment above it.
    pub(super) fn ln_density(&self, x: f64) -> f64 {
        let (k, _) = self.segment(x);
        ln(self.mass(k) / (self.values[k + 1] - self.values[k]))
    }

    /// Probability of segment `k`.
    fn mass(&self, k: usize) -> f64 {
        // The difference of the smaller tails loses less.
        if self.below[k] < 0.5 {
            self.below[k + 1] - self.below[k]
        } else {
            self.above[k] - self.above[k + 1]
        }
    }

    /// Mean and standard deviation of the law restricted to [lower, upper].
    pub(super) fn moments(&self, lower: f64, upper: f64) -> (f64, f64) {
        // Pieces of constant density: (probability, midpoint, width).
        let mut pieces = Vec::with_capacity(self.values.len());
        for k in 0..self.values.len() - 1 {
            let (from, to) = (self.values[k].max(lower), self.values[k + 1].min(upper));
            if from < to {
                let share = (to - from) / (self.values[k + 1] - self.values[k]);
                pieces.push((self.mass(k) * share, 0.5 * (from + to), to - from));
            }
        }
        let total: f64 = pieces.iter().map(|piece| piece.0).sum();
        let mean = pieces.iter().map(|&(p, middle, _)| p * middle).sum::<f64>() / total;
        let variance = pieces
            .iter()
            .map(|&(p, middle, width)| {
                p * ((middle - mean) * (middle - mean) + width * width / 12.0)
            })
            .sum::<f64>()
            / total;
        (mean, variance.sqrt())
    }

    /// The same law with every value sent through an increasing `map`; values that fall together are pooled.
    ///
    /// # Errors
    /// If all values fall together or one is no longer finite.
    pub(super) fn mapped(&self, map: impl Fn(f64) -> f64) -> Result<Self> {
        let mut mapped = Empirical { values: Vec::new(), below: Vec::new(), above: Vec::new() };
        let last = self.values.len() - 1;
        for (k, &x) in self.values.iter().enumerate() {
            let value = map(x);
            match mapped.values.last() {
                // The greatest value ends the law, whichever others it has fallen together with.
                Some(&before) if before >= value && k == last => {
                    mapped.values.pop();
                    mapped.below.pop();
                    mapped.above.pop();
                }
                Some(&before) if before >= value => continue,
                _ => {}
            }
            mapped.values.push(value);
            mapped.below.push(self.below[k]);
            mapped.above.push(self.above[k]);
        }
        let increasing = mapped.values.windows(2).all(|pair| pair[0] < pair[1]);
        if mapped.values.len() > 1 && increasing && mapped.values.iter().all(|x| x.is_finite()) {
            Ok(mapped)
        } else {
            Err(Error::argument("the observations of an empirical law would no longer be distinct"))
        }
    }
}
