//! When the sampling of a study is over: at its number of samples, or at a look where its rule holds.
//!
//! Looks happen at numbers of samples that are a pure function of the plan, and what is seen there is a
//! function of the samples: neither threads nor batches nor an interruption change where sampling ends.

use crate::error::Result;
use crate::numerics::columns::Columns;
use crate::outcomes::OutcomeTable;
use crate::reliability::adaptive::{AdaptiveMonteCarlo, Stop};
use crate::study::{Limit, Study};
use std::ops::Range;

/// The samples that a study has taken so far, and how many it wants before it decides again.
#[derive(Debug, Clone)]
pub struct Looks {
    limits: Vec<Limit>,
    taken: u64,
    next: u64,
    adaptive: Option<AdaptiveMonteCarlo>,
}

impl Looks {
    /// Before the first sample of a study.
    ///
    /// # Errors
    /// If the study's stopping rule is out of range, or it has too many limits.
    pub fn new(study: &Study) -> Result<Self> {
        let plan = &study.sampling;
        let adaptive = plan.stopping.map(|stopping| {
            let limits = study.limits.len();
            AdaptiveMonteCarlo::new(limits, stopping.until, stopping.confidence, plan.samples)
        });
        let adaptive = adaptive.transpose()?;
        let next = match &adaptive {
            Some(adaptive) => adaptive.next_batch()?,
            None => plan.samples,
        };
        Ok(Looks { limits: study.limits.clone(), taken: 0, next, adaptive })
    }

    /// A fixed range of samples, whatever they show.
    pub fn fixed(range: Range<u64>) -> Self {
        Looks { limits: Vec::new(), taken: range.start, next: range.end, adaptive: None }
    }

    /// Index after the last sample taken.
    pub fn taken(&self) -> u64 {
        self.taken
    }

    /// Index after the last sample before the next look.
    pub fn next(&self) -> u64 {
        self.next
    }

    /// Whether no further sample is wanted.
    pub fn over(&self) -> bool {
        self.taken >= self.next
    }

    /// Why the sampling is over; `None` while it is not, and where the number of samples was fixed.
    ///
    /// # Errors
    /// None that [`Self::new`] has not excluded.
    pub fn stop(&self) -> Result<Option<Stop>> {
        match &self.adaptive {
            Some(adaptive) if self.over() => adaptive.stop(),
            _ => Ok(None),
        }
    }

    /// Takes in the next samples, in their order, and says how many of them the study takes: fewer than
    /// there are if a look among them ends the sampling.
    ///
    /// # Errors
    /// None that [`Self::new`] has not excluded.
    pub fn take(&mut self, table: &OutcomeTable) -> Result<usize> {
        let mut used = 0;
        while used < table.rows() && !self.over() {
            let wanted = usize::try_from(self.next - self.taken).unwrap_or(usize::MAX);
            let rows = used..used + wanted.min(table.rows() - used);
            used = rows.end;
            self.taken += rows.len() as u64;
            if let Some(adaptive) = &mut self.adaptive {
                adaptive.record(&margins(&self.limits, table, rows))?;
                if self.taken == self.next {
                    self.next += adaptive.next_batch()?;
                }
            }
        }
        Ok(used)
    }
}

/// Margins of some rows, SI: one column a limit, NaN where faulted.
fn margins(limits: &[Limit], table: &OutcomeTable, rows: Range<usize>) -> Columns {
    let mut margins = Columns::new(rows.len(), limits.len());
    for (i, limit) in limits.iter().enumerate() {
        let values = &table.outcome(limit.outcome)[rows.clone()];
        for (margin, &value) in margins.column_mut(i).iter_mut().zip(values) {
            *margin = limit.margin_of(value);
        }
    }
    margins
}

/// Gathers consecutive tables, none of which crosses a row group's end, into whole row groups.
#[derive(Debug, Default)]
pub struct RowGroups {
    pending: Vec<OutcomeTable>,
}

impl RowGroups {
    /// Takes the next table, and gives back a row group's if it is complete with it.
    pub fn push(&mut self, table: OutcomeTable) -> Option<Vec<OutcomeTable>> {
        let end = table.first + table.rows() as u64;
        self.pending.push(table);
        end.is_multiple_of(super::ROW_GROUP).then(|| self.rest())
    }

    /// What is left, the last row group's; none where the last table completed one.
    pub fn rest(&mut self) -> Vec<OutcomeTable> {
        std::mem::take(&mut self.pending)
    }
}
