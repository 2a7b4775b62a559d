//! How the probability of any breach settled as samples came in.

use crate::campaign::Record;
use crate::error::Result;
use crate::findings::{CONFIDENCE, sequence};
use crate::reliability::probability::Proportion;
use crate::reliability::replicates::from_replicate_counts;
use crate::study::Study;
use serde::{Deserialize, Serialize};

/// Checkpoints a decade of samples.
const PER_DECADE: i32 = 24;
/// Samples at the first checkpoint.
const FIRST: u64 = 100;

/// The running estimate of the probability of any breach.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Convergence {
    /// The largest probability that the requirement allows.
    pub allowed: Option<f64>,
    /// Confidence of the intervals.
    pub confidence: f64,
    /// Whether they hold at every number of samples at once, or each as if its number had been fixed.
    pub at_every_look: bool,
    /// How they were made.
    pub method: String,
    /// The estimate after so many samples, in their order.
    pub checkpoints: Vec<Checkpoint>,
}

/// The estimate after a number of samples.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    /// The number of samples.
    pub samples: u64,
    /// The estimate.
    pub probability: f64,
    /// Its interval.
    pub interval: Option<(f64, f64)>,
}

/// The running estimate; `None` without a limit.
pub(super) fn convergence(study: &Study, record: &Record) -> Result<Option<Convergence>> {
    let limits = study.limits.len();
    if limits == 0 {
        return Ok(None);
    }
    let replicates = record.by_replicate().len().max(1);
    let total = record.margins(0).len();
    let mut counts = vec![Proportion::new(0, 0, 0)?; replicates];
    let mut checkpoints = Vec::new();
    let mut method = String::new();
    let mut next = stops(total as u64, replicates as u64).into_iter().peekable();
    for k in 0..total {
        let margins = || (0..limits).map(|i| record.margins(i)[k]);
        let breached = margins().any(|margin| margin < 0.0);
        let count = &mut counts[k % replicates];
        count.samples += 1;
        count.breaches += u64::from(breached);
        count.faults += u64::from(!breached && margins().any(f64::is_nan));
        if next.next_if_eq(&(k as u64 + 1)).is_none() {
            continue;
        }
        let (probability, interval) = if let Some(plan) = &study.sampling.stopping {
            let interval = sequence::together(study, plan, counts[0], plan.confidence)?;
            (counts[0].estimate(), interval)
        } else if replicates == 1 {
            (counts[0].estimate(), counts[0].interval(CONFIDENCE)?)
        } else {
            let estimate = from_replicate_counts(&counts, CONFIDENCE)?.probability;
            (estimate.value, estimate.interval)
        };
        if let Some(interval) = interval.interval() {
            method = interval.method.to_owned();
        }
        checkpoints.extend(probability.map(|probability| Checkpoint {
            samples: k as u64 + 1,
            probability,
            interval: interval.interval().map(|i| (i.lower, i.upper)),
        }));
    }
    let allowed = study.requirement.map(|requirement| 1.0 - requirement.reliability);
    let stopping = &study.sampling.stopping;
    Ok(Some(Convergence {
        allowed,
        confidence: stopping.as_ref().map_or(CONFIDENCE, |plan| plan.confidence),
        at_every_look: stopping.is_some(),
        method,
        checkpoints,
    }))
}

/// Whole multiples of `replicates`, evenly spaced in the logarithm, and the total.
fn stops(total: u64, replicates: u64) -> Vec<u64> {
    let ratio = crate::numerics::elementary::pow(10.0, 1.0 / f64::from(PER_DECADE));
    let mut stops = Vec::new();
    let mut at = FIRST as f64;
    while at < total as f64 {
        let stop = (at as u64).div_ceil(replicates) * replicates;
        if stop < total && stops.last() != Some(&stop) {
            stops.push(stop);
        }
        at *= ratio;
    }
    stops.push(total);
    stops
}

#[cfg(test)]
mod tests {
    use super::stops;

    #[test]
    fn property_stops_ascend_are_whole_replicates_and_end_with_the_total() {
        for (total, replicates) in [(1, 1), (99, 1), (100, 1), (100_000, 1), (65_536, 16)] {
            let stops = stops(total, replicates);
            assert!(stops.windows(2).all(|pair| pair[0] < pair[1]));
            assert!(stops.iter().all(|stop| stop % replicates == 0));
            assert_eq!(stops.last(), Some(&total));
        }
    }
}
