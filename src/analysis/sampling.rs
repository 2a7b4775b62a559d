//! The samples of a run: taken from where some are already, computed as far as they are not, and handed on row group
//! by row group, so that no more than two of these are in memory.

use crate::campaign::{self, Looks, Progress, ROW_GROUP, Record, RowGroups};
use crate::error::Result;
use crate::outcomes::OutcomeTable;
use crate::reliability::adaptive::Stop;
use crate::study::Study;
use std::ops::Range;

/// Where samples come from before any is computed: it is asked for a range of them, and gives the first of these, or
/// nothing if it has no more.
pub type Source<'a> = dyn FnMut(Range<u64>) -> Result<Option<OutcomeTable>> + 'a;

/// Where samples go: whole row groups in their order, the last one perhaps shorter.
pub type Sink<'a> = dyn FnMut(&[OutcomeTable]) -> Result<()> + Send + 'a;

/// Samples that have been run.
#[derive(Debug)]
pub struct Sampling {
    /// What they have shown.
    pub record: Record,
    /// How many there are.
    pub samples: u64,
    /// How many of them the source had.
    pub read: u64,
    /// Why no more were wanted, if that was decided while sampling.
    pub stop: Option<Stop>,
    /// Whether the study has all that it wants: not if a stop was asked for.
    pub complete: bool,
}

impl Sampling {
    /// Runs all samples of a study and keeps none of them.
    ///
    /// # Errors
    /// What [`campaign::sampler`] refuses.
    pub fn of(study: &Study, progress: &Progress) -> Result<Self> {
        sample(study, &mut |_| Ok(None), &mut |_| Ok(()), progress)
    }
}

/// Runs the samples of a study.
///
/// # Errors
/// What [`campaign::sampler`] refuses, and whatever `source` and `sink` return.
pub fn sample(
    study: &Study,
    source: &mut Source<'_>,
    sink: &mut Sink<'_>,
    progress: &Progress,
) -> Result<Sampling> {
    let replicates = campaign::sampler(study)?.replicates();
    let mut looks = Looks::new(study)?;
    let mut rows =
        Rows { record: Record::new(study, replicates)?, sink, groups: RowGroups::default() };
    while !looks.over() && !progress.stopping() {
        let start = looks.taken();
        // No table goes beyond a row group's end, nor beyond a look.
        let end = ((start / ROW_GROUP + 1) * ROW_GROUP).min(looks.next());
        let Some(table) = source(start..end)? else { break };
        looks.take(&table)?;
        rows.push(table)?;
    }
    let read = looks.taken();
    progress.begin("descents", study.sampling.samples - read);
    let mut sink = |table: OutcomeTable| rows.push(table);
    campaign::run_until(study, &mut looks, progress, &mut sink)?;
    Ok(Sampling {
        record: rows.finish()?,
        samples: looks.taken(),
        read,
        stop: looks.stop()?,
        complete: looks.over(),
    })
}

/// What becomes of the samples, row group by row group.
struct Rows<'a, 'b> {
    record: Record,
    sink: &'a mut Sink<'b>,
    groups: RowGroups,
}

impl Rows<'_, '_> {
    fn push(&mut self, table: OutcomeTable) -> Result<()> {
        match self.groups.push(table) {
            Some(group) => self.keep(&group),
            None => Ok(()),
        }
    }

    fn keep(&mut self, group: &[OutcomeTable]) -> Result<()> {
        group.iter().for_each(|table| self.record.absorb(table));
        (self.sink)(group)
    }

    fn finish(mut self) -> Result<Record> {
        let rest = self.groups.rest();
        if !rest.is_empty() {
            self.keep(&rest)?;
        }
        Ok(self.record)
    }
}
