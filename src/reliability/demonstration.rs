//! Demonstrated reliability: whether counts show "reliability R at confidence C", and how many
//! samples it takes.
//!
//! The test is the exact binomial one. With P the probability of failure and 1 − R its limit:
//! *met* when the one-sided Clopper–Pearson upper bound of P at C is at most 1 − R, *not met* when the
//! lower bound at C is above it, *undecided* otherwise. Each verdict by itself is wrong with
//! probability at most 1 − C. Faults count against: as failures for "met", as clean for "not met".

use super::binomial_tails::{
    at_least, at_most, checked_confidence, checked_probability, first_where, within_risk,
};
use super::probability::Proportion;
use crate::error::{Error, Result};
use crate::numerics::interval::Earned;
use serde::{Deserialize, Serialize};

/// How many times less likely to fail than required the system is for which the producer's risk is
/// stated: the discrimination ratio of acceptance tests, for which 2 is customary.
pub const DISCRIMINATION_RATIO: f64 = 2.0;

/// More samples than this are not asked for.
const MOST_SAMPLES: u64 = 1 << 52;

/// A reliability that must be shown at a confidence.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Requirement {
    /// Least probability R that no limit is breached.
    pub reliability: f64,
    /// Confidence C at which it must be shown.
    pub confidence: f64,
}

impl Requirement {
    /// The requirement, checked.
    ///
    /// # Errors
    /// If either number is not strictly between 0 and 1.
    pub fn new(reliability: f64, confidence: f64) -> Result<Self> {
        checked_probability(reliability, "a required reliability")?;
        checked_confidence(confidence)?;
        Ok(Requirement { reliability, confidence })
    }

    /// The largest probability of failure that is allowed, 1 − R.
    pub fn failure_limit(&self) -> f64 {
        1.0 - self.reliability
    }

    /// The most failures among `samples` that still demonstrate the requirement; `None` if not even
    /// zero would.
    pub fn failures_allowed(&self, samples: u64) -> Option<u64> {
        let limit = self.failure_limit();
        let too_many =
            |failures: u64| !within_risk(at_most(failures, samples, limit), self.confidence);
        // With as many failures as samples the tail is 1, so there is always a first that is too many.
        first_where(0, samples, too_many)?.checked_sub(1)
    }

    /// The verdict that the counts support, with its risks.
    ///
    /// # Errors
    /// If the number of samples that would be needed is beyond counting.
    pub fn verdict(&self, counts: &Proportion) -> Result<Demonstration> {
        let limit = self.failure_limit();
        let samples = counts.samples;
        let upper_tail = at_most(counts.most_breaches(), samples, limit);
        let lower_tail = at_least(counts.breaches, samples, limit);
        let verdict = if samples > 0 && within_risk(upper_tail, self.confidence) {
            Verdict::Met
        } else if samples > 0 && within_risk(lower_tail, self.confidence) {
            Verdict::NotMet
        } else {
            Verdict::Undecided
        };
        let failures_allowed = self.failures_allowed(samples);
        let good = limit / DISCRIMINATION_RATIO;
        Ok(Demonstration {
            requirement: *self,
            counts: *counts,
            verdict,
            upper_bound: counts.upper_bound(self.confidence)?,
            lower_bound: counts.lower_bound(self.confidence)?,
            clean_samples_needed: counts.clean_samples_needed(limit, self.confidence)?,
            failures_allowed,
            attained_risk: upper_tail,
            consumers_risk: failures_allowed.map(|c| at_most(c, samples, limit)),
            producers_risk: failures_allowed.map_or(1.0, |c| at_least(c + 1, samples, good)),
            producers_failure_probability: good,
        })
    }
}

/// What counts say about a requirement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Demonstrated at the stated confidence.
    Met,
    /// The opposite is demonstrated at the stated confidence.
    NotMet,
    /// Neither is demonstrated.
    Undecided,
}

/// A verdict with its evidence.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Demonstration {
    /// What was to be shown.
    pub requirement: Requirement,
    /// The counts it was held against.
    pub counts: Proportion,
    /// What they show.
    pub verdict: Verdict,
    /// One-sided upper bound of the probability of failure at the requirement's confidence.
    pub upper_bound: Earned,
    /// One-sided lower bound of the probability of failure at the requirement's confidence.
    pub lower_bound: Earned,
    /// Further samples, all clean, after which the requirement would be met; 0 if it is.
    pub clean_samples_needed: u64,
    /// Most failures among this many samples that still demonstrate it; `None` if none would.
    pub failures_allowed: Option<u64>,
    /// The probability of seeing this few failures or fewer if the system were just at the limit.
    pub attained_risk: f64,
    /// Consumer's risk: the probability that a system just at the limit passes a test of this many
    /// samples; at most 1 − C. `None` if no system can pass.
    pub consumers_risk: Option<f64>,
    /// Producer's risk: the probability that a system with `producers_failure_probability` does not
    /// pass a test of this many samples.
    pub producers_risk: f64,
    /// The probability of failure for which the producer's risk is stated: the limit divided by
    /// [`DISCRIMINATION_RATIO`].
    pub producers_failure_probability: f64,
}

/// The smallest number of samples among which `failures` failures still demonstrate `reliability` at
/// `confidence`. The failures-allowed table is this function over `failures`; with
/// `failures = order − 1` it is the one-sided Wilks number and with `failures = 2·order − 1` the
/// two-sided one (Wilks, Ann. Math. Stat. 12 (1941) 91).
///
/// # Errors
/// If reliability or confidence is not strictly between 0 and 1, or the number is beyond 2^52.
pub fn minimum_samples(reliability: f64, confidence: f64, failures: u64) -> Result<u64> {
    let requirement = Requirement::new(reliability, confidence)?;
    let limit = requirement.failure_limit();
    let shown = |n: u64| within_risk(at_most(failures, n, limit), confidence);
    let mut enough = failures.saturating_add(1);
    while enough <= MOST_SAMPLES && !shown(enough) {
        enough = enough.saturating_mul(2);
    }
    let found =
        if enough <= MOST_SAMPLES { first_where(failures + 1, enough, shown) } else { None };
    found.ok_or_else(|| {
        Error::argument(format!(
            "a reliability of {reliability} at confidence {confidence} with {failures} failures takes more samples \
             than can be counted"
        ))
    })
}

/// Consumer's risk of the plan "accept with at most `allowed` failures among `samples`": the
/// probability that it accepts a system whose probability of failure is `limit`.
pub fn consumers_risk(samples: u64, allowed: u64, limit: f64) -> f64 {
    at_most(allowed, samples, limit)
}

/// Producer's risk of the same plan: the probability that it does not accept a system whose
/// probability of failure is `good`.
pub fn producers_risk(samples: u64, allowed: u64, good: f64) -> f64 {
    at_least(allowed.saturating_add(1), samples, good)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_a_tie_counts_as_demonstrated() {
        // One half to the second power is the risk exactly; 0.9³ = 0.729 likewise.
        assert_eq!(minimum_samples(0.5, 0.75, 0).unwrap(), 2);
        assert_eq!(minimum_samples(0.9, 0.271, 0).unwrap(), 3);
    }

    #[test]
    fn property_impossible_requirements_are_refused() {
        assert!(Requirement::new(1.0, 0.9).is_err());
        assert!(Requirement::new(0.99, f64::NAN).is_err());
        assert!(minimum_samples(1.0 - 1e-16, 0.9, 0).is_err());
    }
}
