//! A breach probability from independent samples: exact intervals, and what faults could have done.
//!
//! Sources: Clopper and Pearson, Biometrika 26 (1934) 404; Wilson, J. Am. Stat. Assoc. 22 (1927) 209;
//! Brown, Cai and DasGupta, Statistical Science 16 (2001) 101, for Jeffreys' interval and its ends.

use super::binomial_tails::{checked_confidence, checked_probability};
use super::demonstration::minimum_samples;
use crate::error::{Error, Result};
use crate::numerics::elementary::{exp, exp_m1, ln};
use crate::numerics::interval::{Earned, Interval};
use crate::numerics::special::{beta, normal};
use serde::{Deserialize, Serialize};

/// Counts of an event among independent samples, some of which could not be computed.
///
/// The counts are breaches m, faults f and samples N, with m + f ≤ N. A fault is neither a breach nor
/// clean: every bound below holds whatever the faulted samples would have been.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Proportion {
    /// Samples that breached, m.
    pub breaches: u64,
    /// Samples for which it is not known, f.
    pub faults: u64,
    /// All samples, N, faulted ones included.
    pub samples: u64,
}

impl Proportion {
    /// The counts, checked.
    ///
    /// # Errors
    /// If breaches and faults together are more than the samples.
    pub fn new(breaches: u64, faults: u64, samples: u64) -> Result<Self> {
        match breaches.checked_add(faults) {
            Some(sum) if sum <= samples => Ok(Proportion { breaches, faults, samples }),
            _ => Err(Error::argument(format!(
                "{breaches} breaches and {faults} faults cannot be among {samples} samples"
            ))),
        }
    }

    /// Share of breaches among the samples that could be computed, m/(N − f); `None` if there are
    /// none. It lies within the [fault bounds](Self::fault_bounds).
    pub fn estimate(&self) -> Option<f64> {
        let computed = self.samples - self.faults;
        (computed > 0).then(|| self.breaches as f64 / computed as f64)
    }

    /// What the share of breaches could be, whatever the faulted samples would have been:
    /// `[m/N, (m + f)/N]`; `None` without a sample.
    pub fn fault_bounds(&self) -> Option<(f64, f64)> {
        let n = self.samples as f64;
        (self.samples > 0).then(|| (self.breaches as f64 / n, self.most_breaches() as f64 / n))
    }

    /// Exact two-sided interval of the probability: Clopper–Pearson, equal tails, its lower end from
    /// m and its upper end from m + f.
    ///
    /// # Errors
    /// If the confidence is not strictly between 0 and 1.
    pub fn interval(&self, confidence: f64) -> Result<Earned> {
        let risk = (1.0 - checked_confidence(confidence)?) / 2.0;
        self.earned(confidence, "Clopper-Pearson", |counts| {
            (counts.exact_lower(risk), counts.exact_upper(risk))
        })
    }

    /// Exact one-sided upper bound: `[0, u]` with u the Clopper–Pearson bound of m + f among N.
    ///
    /// # Errors
    /// If the confidence is not strictly between 0 and 1.
    pub fn upper_bound(&self, confidence: f64) -> Result<Earned> {
        let risk = 1.0 - checked_confidence(confidence)?;
        self.earned(confidence, "Clopper-Pearson, one-sided upper bound", |counts| {
            (0.0, counts.exact_upper(risk))
        })
    }

    /// Exact one-sided lower bound: `[l, 1]` with l the Clopper–Pearson bound of m among N.
    ///
    /// # Errors
    /// If the confidence is not strictly between 0 and 1.
    pub fn lower_bound(&self, confidence: f64) -> Result<Earned> {
        let risk = 1.0 - checked_confidence(confidence)?;
        self.earned(confidence, "Clopper-Pearson, one-sided lower bound", |counts| {
            (counts.exact_lower(risk), 1.0)
        })
    }

    /// Wilson's score interval: shorter than the exact one, right on average and not always.
    ///
    /// # Errors
    /// If the confidence is not strictly between 0 and 1.
    pub fn wilson(&self, confidence: f64) -> Result<Earned> {
        let risk = (1.0 - checked_confidence(confidence)?) / 2.0;
        let z = normal::quantile_upper(risk);
        self.earned(confidence, "Wilson", |counts| {
            (counts.score_end(counts.breaches, -z), counts.score_end(counts.most_breaches(), z))
        })
    }

    /// Jeffreys' interval: equal tails of the posterior Beta(m + ½, N − m + ½), its lower end 0
    /// without a breach and its upper end 1 without a clean sample.
    ///
    /// # Errors
    /// If the confidence is not strictly between 0 and 1.
    pub fn jeffreys(&self, confidence: f64) -> Result<Earned> {
        let risk = (1.0 - checked_confidence(confidence)?) / 2.0;
        let n = self.samples as f64;
        self.earned(confidence, "Jeffreys", |counts| {
            let least = counts.breaches as f64;
            let most = counts.most_breaches() as f64;
            let lower = match counts.breaches {
                0 => 0.0,
                _ => beta::quantile_lower(least + 0.5, n - least + 0.5, risk),
            };
            let upper = match counts.clean() {
                0 => 1.0,
                _ => beta::quantile_upper(most + 0.5, n - most + 0.5, risk),
            };
            (lower, upper)
        })
    }

    /// How many more samples, all of them clean, would demonstrate at `confidence` that the
    /// probability is at most `target`: 0 if these counts already do. Faults count as breaches.
    ///
    /// # Errors
    /// If the target or the confidence is not strictly between 0 and 1.
    pub fn clean_samples_needed(&self, target: f64, confidence: f64) -> Result<u64> {
        checked_probability(target, "a target probability")?;
        let needed = minimum_samples(1.0 - target, confidence, self.most_breaches())?;
        Ok(needed.saturating_sub(self.samples))
    }

    /// Breaches if every faulted sample was one, m + f.
    pub fn most_breaches(&self) -> u64 {
        self.breaches + self.faults
    }

    /// Samples that are known to be clean, N − m − f.
    pub fn clean(&self) -> u64 {
        self.samples - self.most_breaches()
    }

    /// The interval that `ends` gives, unless there is no sample to base it on.
    fn earned(
        &self,
        confidence: f64,
        method: &'static str,
        ends: impl Fn(&Self) -> (f64, f64),
    ) -> Result<Earned> {
        if self.samples == 0 {
            return Ok(Earned::none("no sample was run"));
        }
        let (lower, upper) = ends(self);
        Ok(Interval { lower, upper, confidence, method }.into())
    }

    /// The probability at which m or more breaches would have been seen with probability `risk`.
    fn exact_lower(&self, risk: f64) -> f64 {
        let (m, n) = (self.breaches as f64, self.samples as f64);
        match self.samples - self.breaches {
            _ if self.breaches == 0 => 0.0,
            0 => exp(ln(risk) / n),
            _ => beta::quantile_lower(m, n - m + 1.0, risk),
        }
    }

    /// The probability at which m + f or fewer breaches would have been seen with probability `risk`.
    fn exact_upper(&self, risk: f64) -> f64 {
        let (m, n) = (self.most_breaches() as f64, self.samples as f64);
        match self.most_breaches() {
            _ if self.clean() == 0 => 1.0,
            0 => -exp_m1(ln(risk) / n),
            _ => beta::quantile_upper(m + 1.0, n - m, risk),
        }
    }

    /// The end of the score interval for `count` breaches and normal deviate `z`.
    fn score_end(&self, count: u64, z: f64) -> f64 {
        let n = self.samples as f64;
        let share = count as f64 / n;
        // Exact where the square root cancels the centre only up to rounding.
        if (count == 0 && z < 0.0) || (count == self.samples && z > 0.0) {
            return share;
        }
        let spread = (share * (1.0 - share) / n + z * z / (4.0 * n * n)).sqrt();
        ((share + z * z / (2.0 * n) + z * spread) / (1.0 + z * z / n)).clamp(0.0, 1.0)
    }
}
