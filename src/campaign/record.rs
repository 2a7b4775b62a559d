//! What a report needs to remember of the samples: counts, margins, summaries; not the samples.

use crate::descent::outcome::OUTCOME_COUNT;
use crate::descent::{Fault, OutcomeQuantity};
use crate::error::Result;
use crate::outcomes::OutcomeTable;
use crate::reliability::breach_counts::BreachCounts;
use crate::study::{Limit, Study};

/// How many faulted samples are remembered one by one.
const REMEMBERED: usize = 20;

/// How many extreme samples of each outcome are remembered.
const EXTREMES: usize = 16;

/// A sample that could not be computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FaultedSample {
    /// Its index.
    pub index: u64,
    /// Why.
    pub fault: Fault,
}

/// Mean, spread and extremes of one outcome over the samples that could be computed, SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutcomeSummary {
    /// Number of samples.
    pub samples: u64,
    /// Arithmetic mean.
    pub mean: f64,
    /// Smallest value.
    pub smallest: f64,
    /// Largest value.
    pub largest: f64,
    sum_of_squares: f64,
}

impl OutcomeSummary {
    const EMPTY: OutcomeSummary = OutcomeSummary {
        samples: 0,
        mean: 0.0,
        smallest: f64::INFINITY,
        largest: f64::NEG_INFINITY,
        sum_of_squares: 0.0,
    };

    /// Welford's update: one pass, no cancellation.
    fn add(&mut self, value: f64) {
        self.samples += 1;
        let before = value - self.mean;
        self.mean += before / self.samples as f64;
        self.sum_of_squares += before * (value - self.mean);
        self.smallest = self.smallest.min(value);
        self.largest = self.largest.max(value);
    }

    /// Sample standard deviation; `None` with fewer than two samples.
    pub fn standard_deviation(&self) -> Option<f64> {
        (self.samples > 1).then(|| (self.sum_of_squares / (self.samples - 1) as f64).sqrt())
    }
}

/// The memory of a campaign: everything its findings are made from.
#[derive(Debug, Clone)]
pub struct Record {
    limits: Vec<Limit>,
    replicates: u32,
    counts: BreachCounts,
    by_replicate: Vec<BreachCounts>,
    margins: Vec<Vec<f64>>,
    summaries: [OutcomeSummary; OUTCOME_COUNT],
    not_deployed: u64,
    fault_counts: Vec<(Fault, u64)>,
    faulted: Vec<FaultedSample>,
    /// Of each outcome the most extreme values, the most extreme first, and their samples: the largest, of the time
    /// the shortest.
    extremes: [Vec<(f64, u64)>; OUTCOME_COUNT],
}

impl Record {
    /// An empty record for a study's limits; `replicates` is that of its design.
    ///
    /// # Errors
    /// If the study has more limits than can be counted together.
    pub fn new(study: &Study, replicates: u32) -> Result<Self> {
        let counts = BreachCounts::new(study.limits.len())?;
        let kept = if replicates > 1 { replicates as usize } else { 0 };
        Ok(Record {
            limits: study.limits.clone(),
            replicates,
            by_replicate: vec![counts.clone(); kept],
            counts,
            margins: vec![Vec::new(); study.limits.len()],
            summaries: [OutcomeSummary::EMPTY; OUTCOME_COUNT],
            not_deployed: 0,
            fault_counts: Vec::new(),
            faulted: Vec::new(),
            extremes: std::array::from_fn(|_| Vec::with_capacity(EXTREMES + 1)),
        })
    }

    /// Takes in the next samples. Tables arrive in the order of the samples.
    pub fn absorb(&mut self, table: &OutcomeTable) {
        for k in 0..table.rows() {
            let (mut breached, mut unknown) = (0u32, 0u32);
            for (i, limit) in self.limits.iter().enumerate() {
                let margin = limit.margin_of(table.outcomes.get(k, limit.outcome as usize));
                breached |= u32::from(margin < 0.0) << i;
                unknown |= u32::from(margin.is_nan()) << i;
                self.margins[i].push(margin);
            }
            if let Some(fault) = table.faults[k] {
                unknown = u32::MAX;
                self.note_fault(table.first + k as u64, fault);
            } else {
                for (j, summary) in self.summaries.iter_mut().enumerate() {
                    summary.add(table.outcomes.get(k, j));
                }
                self.note_extremes(table, k);
                self.not_deployed += u64::from(!table.deployed[k]);
            }
            self.counts.push_partly(breached, unknown);
            if !self.by_replicate.is_empty() {
                let replicate = (table.first + k as u64) % u64::from(self.replicates);
                self.by_replicate[replicate as usize].push_partly(breached, unknown);
            }
        }
    }

    fn note_extremes(&mut self, table: &OutcomeTable, row: usize) {
        for (j, extremes) in self.extremes.iter_mut().enumerate() {
            let value = table.outcomes.get(row, j);
            let rank = if j == OutcomeQuantity::Time as usize { -value } else { value };
            if extremes.len() == EXTREMES && extremes.last().is_some_and(|last| rank <= last.0) {
                continue;
            }
            let place = extremes.partition_point(|other| rank <= other.0);
            extremes.insert(place, (rank, table.first + row as u64));
            extremes.truncate(EXTREMES);
        }
    }

    /// The samples with the most extreme outcomes, each once: the shortest, and those with the largest of each other
    /// outcome; the most extreme of every outcome first, then the second of every outcome, and so on.
    pub fn extreme_samples(&self) -> Vec<u64> {
        let mut samples = Vec::new();
        for place in 0..EXTREMES {
            for (_, sample) in self.extremes.iter().filter_map(|extremes| extremes.get(place)) {
                if !samples.contains(sample) {
                    samples.push(*sample);
                }
            }
        }
        samples
    }

    fn note_fault(&mut self, index: u64, fault: Fault) {
        match self.fault_counts.iter_mut().find(|(known, _)| *known == fault) {
            Some((_, count)) => *count += 1,
            None => {
                self.fault_counts.push((fault, 1));
                self.fault_counts.sort();
            }
        }
        if self.faulted.len() < REMEMBERED {
            self.faulted.push(FaultedSample { index, fault });
        }
    }

    /// Breach counts over all samples.
    pub fn counts(&self) -> &BreachCounts {
        &self.counts
    }

    /// Breach counts of each replicate; empty for plain Monte Carlo.
    pub fn by_replicate(&self) -> &[BreachCounts] {
        &self.by_replicate
    }

    /// Margins of limit `i`, SI, in the order of the samples, NaN where faulted.
    pub fn margins(&self, i: usize) -> &[f64] {
        &self.margins[i]
    }

    /// Summary of one outcome.
    pub fn summary(&self, quantity: OutcomeQuantity) -> &OutcomeSummary {
        &self.summaries[quantity as usize]
    }

    /// Samples that did not deploy.
    pub fn not_deployed(&self) -> u64 {
        self.not_deployed
    }

    /// Faults by kind, in the order of [`Fault`].
    pub fn fault_counts(&self) -> &[(Fault, u64)] {
        &self.fault_counts
    }

    /// The first faulted samples.
    pub fn faulted(&self) -> &[FaultedSample] {
        &self.faulted
    }
}
