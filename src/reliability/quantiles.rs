//! Quantiles of an outcome with distribution-free intervals, from order statistics alone.
//!
//! With X₍ᵣ₎ the r-th smallest of N independent samples and K ~ Binomial(N, p) the number below the
//! p-quantile x: P(X₍ᵣ₎ ≤ x) ≥ P(K ≥ r) and P(X₍ᵣ₎ ≥ x) ≥ P(K ≤ r − 1), with equality for a continuous
//! law (David and Nagaraja, *Order Statistics*, 3rd ed., §7.1; Wilks, Ann. Math. Stat. 12 (1941) 91).

use super::binomial_tails::{
    at_least, at_most, checked_confidence, checked_probability, first_where, within_risk,
};
use super::demonstration::minimum_samples;
use crate::error::{Error, Result};
use crate::numerics::interval::{Earned, Interval};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// The quantiles of a margin that a report states.
pub const REPORTED: [f64; 5] = [0.5, 0.9, 0.99, 0.9973, 0.999];

/// An outcome's samples in ascending order, and how many could not be computed.
///
/// A faulted sample could have been anything: it counts as −∞ for lower ends and as +∞ for upper ends.
#[derive(Debug, Clone, PartialEq)]
pub struct OrderedSample<'a> {
    values: Cow<'a, [f64]>,
    faults: u64,
}

/// A quantile with its interval.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Quantile {
    /// Which quantile: the probability p below it.
    pub probability: f64,
    /// The estimate among the samples that could be computed, median-unbiased whatever the law
    /// (definition 8 of Hyndman and Fan, Am. Stat. 50 (1996) 361); `None` without one.
    pub estimate: Option<f64>,
    /// Equal-tailed interval between two order statistics, or why the sample is too small for one.
    pub interval: Earned,
    /// Ranks, among all N samples and counted from 1, of the ends; `None` where N is too small.
    pub ranks: (Option<u64>, Option<u64>),
    /// The interval's attained confidence, at least the one asked for; `None` without an interval.
    pub attained: Option<f64>,
}

impl<'a> OrderedSample<'a> {
    /// Sorts the values; NaN is a sample that could not be computed.
    pub fn from_unsorted(values: &[f64]) -> OrderedSample<'static> {
        let mut finite: Vec<f64> = values.iter().copied().filter(|value| !value.is_nan()).collect();
        finite.sort_unstable_by(f64::total_cmp);
        let faults = (values.len() - finite.len()) as u64;
        OrderedSample { values: Cow::Owned(finite), faults }
    }

    /// Values that are in ascending order already, and the number of faulted samples beside them.
    ///
    /// # Errors
    /// If the values are not in ascending order, or one of them is NaN.
    pub fn from_sorted(values: &'a [f64], faults: u64) -> Result<Self> {
        let ascending = values.windows(2).all(|pair| pair[0] <= pair[1]);
        if !ascending || values.first().is_some_and(|first| first.is_nan()) {
            return Err(Error::argument(
                "the values are not in ascending order, or one is not a number",
            ));
        }
        Ok(OrderedSample { values: Cow::Borrowed(values), faults })
    }

    /// All samples, N, faulted ones included.
    pub fn samples(&self) -> u64 {
        self.values.len() as u64 + self.faults
    }

    /// Samples that could not be computed.
    pub fn faults(&self) -> u64 {
        self.faults
    }

    /// The computed values in ascending order.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The quantile below which the outcome lies with `probability`, with an interval that holds it
    /// with at least `confidence` whatever the law.
    ///
    /// # Errors
    /// If either number is not strictly between 0 and 1.
    pub fn quantile(&self, probability: f64, confidence: f64) -> Result<Quantile> {
        checked_probability(probability, "the probability of a quantile")?;
        // Equal tails: each end is a one-sided bound at (1 + C)/2.
        let each = (1.0 + checked_confidence(confidence)?) / 2.0;
        let (low, high) = (self.lower_rank(probability, each), self.upper_rank(probability, each));
        let ends =
            (low.and_then(|r| self.at_worst_low(r)), high.and_then(|r| self.at_worst_high(r)));
        let (interval, attained) = match (low, high, ends) {
            (Some(low), Some(high), (Some(lower), Some(upper))) => {
                let n = self.samples();
                let missed = at_most(low - 1, n, probability) + at_least(high, n, probability);
                let interval = Interval { lower, upper, confidence, method: "order statistics" };
                (interval.into(), Some(1.0 - missed))
            }
            _ => (Earned::none(self.too_few(probability.max(1.0 - probability), each)?), None),
        };
        let estimate = self.median_unbiased(probability);
        Ok(Quantile { probability, estimate, interval, ranks: (low, high), attained })
    }

    /// A value below which the outcome lies with at least `probability`, at `confidence`: the upper
    /// bound `[−∞, u]` of the quantile, which is Wilks' one-sided upper tolerance bound.
    ///
    /// # Errors
    /// If either number is not strictly between 0 and 1.
    pub fn upper_bound(&self, probability: f64, confidence: f64) -> Result<Earned> {
        checked_probability(probability, "the probability of a quantile")?;
        checked_confidence(confidence)?;
        let rank = self.upper_rank(probability, confidence);
        Ok(match rank.and_then(|r| self.at_worst_high(r)) {
            Some(upper) => {
                let method = "order statistics, one-sided upper bound";
                Interval { lower: f64::NEG_INFINITY, upper, confidence, method }.into()
            }
            None => Earned::none(self.too_few(probability, confidence)?),
        })
    }

    /// A value that the `probability`-quantile is at least, at `confidence`: the lower bound `[l, ∞]`
    /// of the quantile. With 1 − content for `probability` it is Wilks' one-sided lower tolerance
    /// bound: at least `content` of the outcome lies above it.
    ///
    /// # Errors
    /// If either number is not strictly between 0 and 1.
    pub fn lower_bound(&self, probability: f64, confidence: f64) -> Result<Earned> {
        checked_probability(probability, "the probability of a quantile")?;
        checked_confidence(confidence)?;
        let rank = self.lower_rank(probability, confidence);
        Ok(match rank.and_then(|r| self.at_worst_low(r)) {
            Some(lower) => {
                let method = "order statistics, one-sided lower bound";
                Interval { lower, upper: f64::INFINITY, confidence, method }.into()
            }
            None => Earned::none(self.too_few(1.0 - probability, confidence)?),
        })
    }

    /// Wilks' two-sided tolerance interval: holds at least `content` of the outcome's law at
    /// `confidence`, between the r-th smallest and the r-th largest with the largest such r.
    ///
    /// # Errors
    /// If either number is not strictly between 0 and 1.
    pub fn tolerance_interval(&self, content: f64, confidence: f64) -> Result<Earned> {
        checked_probability(content, "the content of a tolerance interval")?;
        checked_confidence(confidence)?;
        let n = self.samples();
        let fails = |r: u64| !within_risk(at_most(2 * r - 1, n, 1.0 - content), confidence);
        let order = match first_where(1, n.div_ceil(2) + 1, fails) {
            Some(first_too_many) => first_too_many - 1,
            None => 0,
        };
        let ends = (self.at_worst_low(order), self.at_worst_high((n + 1).saturating_sub(order)));
        Ok(match (order, ends) {
            (1.., (Some(lower), Some(upper))) => {
                Interval { lower, upper, confidence, method: "Wilks, two-sided" }.into()
            }
            _ => {
                let order = self.faults + 1;
                let needed = minimum_samples(content, confidence, 2 * order - 1)?;
                Earned::none(format!(
                    "{} samples with {} faults are too few: at least {needed} are needed",
                    n, self.faults
                ))
            }
        })
    }

    /// Largest rank r with P(K ≤ r − 1) within the risk, K ~ Binomial(N, p): X₍ᵣ₎ is a lower bound.
    fn lower_rank(&self, probability: f64, confidence: f64) -> Option<u64> {
        let n = self.samples();
        let fails = |r: u64| !within_risk(at_most(r - 1, n, probability), confidence);
        // At r = N + 1 the tail is 1: it always fails.
        first_where(1, n + 1, fails)?.checked_sub(1).filter(|rank| *rank > 0)
    }

    /// Smallest rank r with P(K ≥ r) within the risk: X₍ᵣ₎ is an upper bound.
    fn upper_rank(&self, probability: f64, confidence: f64) -> Option<u64> {
        let n = self.samples();
        first_where(1, n, |r| within_risk(at_least(r, n, probability), confidence))
    }

    /// The r-th smallest of all samples if every faulted one were −∞; `None` if that is one of them.
    fn at_worst_low(&self, rank: u64) -> Option<f64> {
        let place = rank.checked_sub(self.faults)?.checked_sub(1)?;
        self.values.get(usize::try_from(place).ok()?).copied()
    }

    /// The r-th smallest of all samples if every faulted one were +∞; `None` if that is one of them.
    fn at_worst_high(&self, rank: u64) -> Option<f64> {
        self.values.get(usize::try_from(rank.checked_sub(1)?).ok()?).copied()
    }

    /// Says how many samples a one-sided bound at `confidence` of a quantile with `content` on its
    /// longer side would take, this many faults among them.
    fn too_few(&self, content: f64, confidence: f64) -> Result<String> {
        let needed = minimum_samples(content, confidence, self.faults)?;
        let n = self.samples();
        Ok(match self.faults {
            0 => format!(
                "{n} samples are too few to bound this quantile: at least {needed} are needed"
            ),
            f => format!(
                "{n} samples, {f} of them faults that could lie on either side, are too few to bound this \
                 quantile: at least {needed} are needed"
            ),
        })
    }

    fn median_unbiased(&self, probability: f64) -> Option<f64> {
        let count = self.values.len() as f64;
        let place = (count + 1.0 / 3.0) * probability + 1.0 / 3.0;
        let below = place.floor().clamp(1.0, count.max(1.0));
        let share = (place - below).clamp(0.0, 1.0);
        let low = *self.values.get(below as usize - 1)?;
        let high = *self.values.get(below as usize).unwrap_or(&low);
        if low.is_finite() && high.is_finite() {
            return Some(low + share * (high - low));
        }
        // Between an infinite neighbour and another there is nothing to interpolate: the nearer one.
        Some(if share <= 0.5 { low } else { high })
    }
}
