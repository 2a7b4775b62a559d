//! Which limits each row of a sample breaches.

use crate::outcomes::OutcomeTable;
use crate::reliability::paired::PairedCounts;
use crate::reliability::probability::Proportion;
use crate::study::Study;
use std::ops::Range;

/// The event whose probability is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Event {
    /// Any limit is breached.
    Any,
    /// This limit is.
    Limit(usize),
}

/// Which limits each row breaches.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Breaches {
    breached: Vec<u32>,
    unknown: Vec<u32>,
}

impl Breaches {
    /// The breaches of a table's rows.
    pub fn of(study: &Study, table: &OutcomeTable) -> Self {
        let margin = |i: usize, k: usize| {
            let limit = &study.limits[i];
            limit.margin_of(table.outcomes.get(k, limit.outcome as usize))
        };
        Self::from_margins(study.limits.len(), table.rows(), margin)
    }

    /// The breaches of rows by the margin of limit `i` in row `k`; NaN where it is not known.
    pub fn from_margins(limits: usize, rows: usize, margin: impl Fn(usize, usize) -> f64) -> Self {
        let bits = |holds: &dyn Fn(f64) -> bool| {
            let row = |k| (0..limits).fold(0, |bits, i| bits | u32::from(holds(margin(i, k))) << i);
            (0..rows).map(row).collect()
        };
        Breaches { breached: bits(&|m| m < 0.0), unknown: bits(&f64::is_nan) }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.breached.len()
    }

    /// Some of the rows, in their order.
    pub fn part(&self, rows: Range<usize>) -> Self {
        Breaches {
            breached: self.breached[rows.clone()].to_vec(),
            unknown: self.unknown[rows].to_vec(),
        }
    }

    /// Whether the event happened in row `k`; `None` where that is not known.
    pub fn happened(&self, event: Event, k: usize) -> Option<bool> {
        let mask = match event {
            Event::Any => u32::MAX,
            Event::Limit(i) => 1 << i,
        };
        match (self.breached[k] & mask != 0, self.unknown[k] & mask != 0) {
            (true, _) => Some(true),
            (false, true) => None,
            (false, false) => Some(false),
        }
    }

    /// The event in each row as a number: 1, 0, or NaN where it is not known.
    pub fn indicator(&self, event: Event) -> Vec<f64> {
        let number = |k| self.happened(event, k).map_or(f64::NAN, |yes| f64::from(u8::from(yes)));
        (0..self.rows()).map(number).collect()
    }

    /// The event counted over some rows.
    pub fn counts(&self, event: Event, rows: impl Iterator<Item = usize>) -> Proportion {
        let mut counts = Proportion { breaches: 0, faults: 0, samples: 0 };
        for k in rows {
            let happened = self.happened(event, k);
            counts.samples += 1;
            counts.breaches += u64::from(happened == Some(true));
            counts.faults += u64::from(happened.is_none());
        }
        counts
    }

    /// The event counted over all rows.
    pub fn count(&self, event: Event) -> Proportion {
        self.counts(event, 0..self.rows())
    }

    /// Share of rows with a breach, a row that is not known taken as one: what a search goes by.
    pub fn worst_share(&self) -> f64 {
        let counts = self.count(Event::Any);
        (counts.most_breaches()) as f64 / counts.samples.max(1) as f64
    }

    /// How this variant differs from `base`, row by row.
    pub fn against(
        &self,
        base: &Breaches,
        event: Event,
        rows: impl Iterator<Item = usize>,
    ) -> PairedCounts {
        let mut counts = PairedCounts::default();
        for k in rows {
            counts.push(base.happened(event, k), self.happened(event, k));
        }
        counts
    }
}
