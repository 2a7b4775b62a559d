//! Adaptive Monte Carlo: when to stop sampling, decided while looking, at the stated confidence.
//!
//! Every look shows confidence sequences of all limits and of their union, simultaneously (Bonferroni),
//! so neither early looks nor the choice of what to look at spoil the confidence.

use super::breach_counts::BreachCounts;
use super::confidence_sequence::confidence_sequence;
use super::crude::from_counts;
use super::estimate::Estimate;
use super::event::Event;
use super::probability::Proportion;
use crate::error::{Error, Result};
use crate::numerics::columns::Columns;
use serde::{Deserialize, Serialize};

/// What ends the sampling, besides the budget.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Until {
    /// The union's interval reaches no farther from its estimate than this share of it.
    RelativeError(f64),
    /// The union's interval lies on one side of this probability: the requirement is decided.
    Decided {
        /// Largest probability of a breach that the requirement allows.
        allowed: f64,
    },
}

/// Why the sampling ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stop {
    /// The relative error was reached.
    Precise,
    /// The probability is shown to be at most what is allowed.
    Met,
    /// The probability is shown to be more than what is allowed.
    Missed,
    /// The budget was used up with neither.
    Budget,
}

/// Sampling under way. Feed it whole batches of the size that [`next_batch`](Self::next_batch) says: the
/// looks are then at sample sizes that depend on nothing but their number.
#[derive(Debug, Clone)]
pub struct AdaptiveMonteCarlo {
    until: Until,
    confidence: f64,
    budget: u64,
    counts: BreachCounts,
}

/// Samples before the first look.
const FIRST_LOOK: u64 = 4096;

impl AdaptiveMonteCarlo {
    /// Nothing sampled yet.
    ///
    /// # Errors
    /// If the target, the confidence or the budget is out of range, or there are too many limits.
    pub fn new(limits: usize, until: Until, confidence: f64, budget: u64) -> Result<Self> {
        let sound = match until {
            Until::RelativeError(error) => error > 0.0 && error.is_finite(),
            Until::Decided { allowed } => 0.0 < allowed && allowed < 1.0,
        };
        let sound = sound && 0.0 < confidence && confidence < 1.0;
        if !sound || budget == 0 || limits == 0 {
            return Err(Error::argument(
                "adaptive sampling needs limits, a budget, a positive target and a confidence below 1",
            ));
        }
        Ok(AdaptiveMonteCarlo { until, confidence, budget, counts: BreachCounts::new(limits)? })
    }

    /// Samples so far, faulted ones included.
    pub fn samples(&self) -> u64 {
        self.counts.samples()
    }

    /// How many samples to draw before the next look: a tenth more than there are, within the budget;
    /// 0 when the sampling is over.
    pub fn next_batch(&self) -> Result<u64> {
        if self.stop()?.is_some() {
            return Ok(0);
        }
        let samples = self.counts.samples();
        Ok((samples / 10).max(FIRST_LOOK).min(self.budget - samples))
    }

    /// Counts a batch of margins (one row a sample, one column a limit).
    ///
    /// # Errors
    /// If the number of limits differs.
    pub fn record(&mut self, margins: &Columns) -> Result<()> {
        let columns: Vec<&[f64]> = (0..margins.columns()).map(|i| margins.column(i)).collect();
        self.counts.push_margins(&columns)
    }

    /// Whether the sampling is over, and why.
    ///
    /// # Errors
    /// None that [`new`](Self::new) has not excluded.
    pub fn stop(&self) -> Result<Option<Stop>> {
        let earned = confidence_sequence(self.counts.any(), self.each_confidence())?;
        if let Some(interval) = earned.interval() {
            let (least, most) = self.counts.any().fault_bounds().unwrap_or((0.0, 1.0));
            match self.until {
                Until::RelativeError(error) => {
                    let reach = (least - interval.lower).max(interval.upper - most);
                    // Faults are part of what is not known.
                    let reach = reach.max(interval.upper - least);
                    if least > 0.0 && reach <= error * least {
                        return Ok(Some(Stop::Precise));
                    }
                }
                Until::Decided { allowed } if interval.upper <= allowed => {
                    return Ok(Some(Stop::Met));
                }
                Until::Decided { allowed } if interval.lower > allowed => {
                    return Ok(Some(Stop::Missed));
                }
                Until::Decided { .. } => {}
            }
        }
        Ok((self.counts.samples() >= self.budget).then_some(Stop::Budget))
    }

    /// Confidence of each of the simultaneous sequences: one a limit and one for the union (a single
    /// limit is its own union).
    pub fn each_confidence(&self) -> f64 {
        let limits = self.counts.constraints() as f64;
        let sequences = if limits > 1.0 { limits + 1.0 } else { 1.0 };
        1.0 - (1.0 - self.confidence) / sequences
    }

    /// The estimates so far with their simultaneous intervals: each limit, then the union.
    ///
    /// # Errors
    /// None that [`new`](Self::new) has not excluded.
    pub fn estimates(&self) -> Result<Vec<Estimate>> {
        let each = (0..self.counts.constraints())
            .filter_map(|i| self.counts.constraint(i).map(|counts| (Event::Limit(i), counts)));
        each.chain([(Event::Any, self.counts.any())])
            .map(|(event, counts)| self.estimate(event, counts))
            .collect()
    }

    fn estimate(&self, event: Event, counts: Proportion) -> Result<Estimate> {
        let mut estimate = from_counts(event, counts, self.confidence)?;
        estimate.interval = confidence_sequence(counts, self.each_confidence())?;
        estimate.diagnostics.push(format!(
            "holds at every look, for all limits and their union together, with confidence {}",
            self.confidence
        ));
        Ok(estimate)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One limit that every `period`-th sample breaches.
    fn run(until: Until, period: u64, budget: u64) -> (AdaptiveMonteCarlo, Stop) {
        let mut adaptive = AdaptiveMonteCarlo::new(1, until, 0.9, budget).unwrap();
        let mut first = 0;
        loop {
            let count = adaptive.next_batch().unwrap();
            if count == 0 {
                let stop = adaptive.stop().unwrap().unwrap();
                return (adaptive, stop);
            }
            let mut margins = Columns::new(count as usize, 1);
            for row in 0..count {
                let breach = (first + row) % period == period - 1;
                margins.set(row as usize, 0, if breach { -1.0 } else { 1.0 });
            }
            adaptive.record(&margins).unwrap();
            first += count;
        }
    }

    #[test]
    fn property_sampling_ends_for_the_reason_it_names() {
        let (adaptive, stop) = run(Until::RelativeError(0.05), 100, 10_000_000);
        assert_eq!(stop, Stop::Precise);
        // A fixed size would need 1.645²·0.99/(0.01·0.05²) = 1.07e5; looking at any time costs more.
        assert!(adaptive.samples() > 107_000 && adaptive.samples() < 1_000_000);
        assert_eq!(run(Until::Decided { allowed: 0.02 }, 100, 1_000_000).1, Stop::Met);
        assert_eq!(run(Until::Decided { allowed: 0.005 }, 100, 1_000_000).1, Stop::Missed);
        let (adaptive, stop) = run(Until::Decided { allowed: 0.01 }, 100, 50_001);
        assert_eq!((adaptive.samples(), stop), (50_001, Stop::Budget));
    }

    #[test]
    fn property_every_limit_and_the_union_are_reported() {
        let mut adaptive =
            AdaptiveMonteCarlo::new(2, Until::RelativeError(0.1), 0.9, 10_000).unwrap();
        adaptive.record(&Columns::from_rows(&[[1.0, -1.0], [f64::NAN, 1.0], [1.0, 1.0]])).unwrap();
        let estimates = adaptive.estimates().unwrap();
        let events: Vec<Event> = estimates.iter().map(|estimate| estimate.event).collect();
        assert_eq!(events, [Event::Limit(0), Event::Limit(1), Event::Any]);
        assert_eq!(estimates[2].faults, 1);
        assert!((adaptive.each_confidence() - (1.0 - 0.1 / 3.0)).abs() < 1e-15);
        assert!(AdaptiveMonteCarlo::new(1, Until::RelativeError(0.0), 0.9, 10).is_err());
    }
}
