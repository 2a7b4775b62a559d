//! Points become draws, draws become descents, descents become outcomes, on every core.
//!
//! This is the only place that says rayon. Sample `k` is a pure function of the study, its seed and `k`;
//! the work is cut into batches of fixed size at fixed places, and whatever is summed is summed in the
//! order of the samples, so that nothing depends on the number of threads.

pub mod analysis;
mod breaches;
pub mod calibrated;
pub mod calibration;
pub mod common_numbers;
pub mod epistemic;
mod evaluate;
pub mod exact;
pub mod given_sample;
pub mod known;
mod limit_state;
mod looks;
pub mod model_form;
mod pick_freeze;
mod rare;
mod record;
mod refutation;
pub mod scores;
pub mod screening;
pub mod shapley;
pub mod sweep;
pub mod tighten;
pub mod trade;
mod verification;

use crate::error::{Error, Result};
use crate::outcomes::OutcomeTable;
use crate::sampling::Sampler;
use crate::streams::Purpose;
use crate::study::Study;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

pub use analysis::{Absent, Analysis, Found, Run};
pub use evaluate::{Ensemble, nominal};
pub use limit_state::DescentLimitState;
pub use looks::{Looks, RowGroups};
pub use pick_freeze::{PickFreezeOutcomes, factors};
pub use rare::{FEW_BREACHES, MostLikelyBreach, RareEvent, rare_events};
pub use record::{FaultedSample, OutcomeSummary, Record};
pub use verification::{NEAR, NearLimit, Verification, verify};

/// Samples in a row group: the unit of writing, and of resuming.
pub const ROW_GROUP: u64 = 65_536;

/// How far a campaign is, and whether it should stop; shared with whoever watches.
#[derive(Debug, Default)]
pub struct Progress {
    done: AtomicU64,
    stop: AtomicBool,
    stage: Mutex<Stage>,
}

/// A part of the work that is named and has an end.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Stage {
    /// What it is.
    pub name: &'static str,
    /// Descents computed before it began.
    pub before: u64,
    /// Descents that it takes, about.
    pub descents: u64,
}

impl Progress {
    /// Descents computed so far.
    pub fn done(&self) -> u64 {
        self.done.load(Ordering::Relaxed)
    }

    /// Asks the campaign to stop at the next batch.
    pub fn request_stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// Whether a stop has been asked for.
    pub fn stopping(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Begins a part of the work that takes so many descents, about.
    pub fn begin(&self, name: &'static str, descents: u64) {
        let stage = Stage { name, before: self.done(), descents };
        *self.stage.lock().unwrap_or_else(PoisonError::into_inner) = stage;
    }

    /// The part of the work that is being done.
    pub fn stage(&self) -> Stage {
        *self.stage.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn advance(&self, descents: usize) {
        self.done.fetch_add(descents as u64, Ordering::Relaxed);
    }
}

/// The sampler of a study's main design.
///
/// # Errors
/// If nothing is uncertain, or the design cannot have that many inputs, samples or replicates.
pub fn sampler(study: &Study) -> Result<Sampler> {
    let dimension = study.joint.dimension();
    if dimension == 0 {
        return Err(Error::argument(
            "nothing is uncertain in this study: name a card with `card = \"…\"`, or use \
             `reeldown descend` for its one nominal descent",
        ));
    }
    let plan = &study.sampling;
    Sampler::new(plan.design, dimension, plan.samples, plan.replicates, plan.seed, Purpose::Design)
}

/// Computes samples `range` of the study's main design, row group by row group in order, and hands each
/// to `sink` in several tables, which may take its time while the next is computed. Returns the index after the
/// last sample computed: less than `range.end` if `progress` was asked to stop.
///
/// # Errors
/// What [`sampler`] refuses, and whatever `sink` returns.
pub fn run(
    study: &Study,
    range: Range<u64>,
    progress: &Progress,
    sink: &mut (dyn FnMut(OutcomeTable) -> Result<()> + Send),
) -> Result<u64> {
    run_until(study, &mut Looks::fixed(range), progress, sink)
}

/// Computes the samples that `looks` still wants, as [`run`] does; no table goes beyond a row group's end or
/// a look.
///
/// # Errors
/// What [`sampler`] refuses, and whatever `sink` returns.
pub fn run_until(
    study: &Study,
    looks: &mut Looks,
    progress: &Progress,
    sink: &mut (dyn FnMut(OutcomeTable) -> Result<()> + Send),
) -> Result<u64> {
    let sampler = sampler(study)?;
    let ensemble = Ensemble::new(study);
    let (sender, receiver) = std::sync::mpsc::sync_channel::<Vec<OutcomeTable>>(1);
    std::thread::scope(|scope| {
        // What one thread must do for a row group, waiting for the disk included, is done beside the next one's
        // descents.
        let writer = scope.spawn(move || {
            let mut groups = receiver.into_iter();
            groups.try_for_each(|parts| parts.into_iter().try_for_each(&mut *sink))
        });
        while !looks.over() && !progress.stopping() {
            let next = looks.taken();
            let end = ((next / ROW_GROUP + 1) * ROW_GROUP).min(looks.next());
            let parts = ensemble.samples(&sampler, next..end, progress)?;
            for part in &parts {
                looks.take(part)?;
            }
            // A receiver that is gone has failed: its error is returned below.
            if !parts.is_empty() && sender.send(parts).is_err() {
                break;
            }
        }
        drop(sender);
        match writer.join() {
            Ok(result) => result.map(|()| looks.taken()),
            Err(panic) => std::panic::resume_unwind(panic),
        }
    })
}

/// Applies a function to every item on every core and returns the results in the order of the items.
pub fn in_parallel<T: Sync, U: Send>(
    items: &[T],
    function: impl Fn(&T) -> U + Sync + Send,
) -> Vec<U> {
    use rayon::prelude::*;
    items.par_iter().map(function).collect()
}

/// Threads that a campaign uses unless told otherwise: one a core.
pub fn threads() -> usize {
    rayon::current_num_threads()
}

/// Runs `work` with this many threads instead of one a core.
///
/// # Errors
/// If the threads cannot be started.
pub fn with_threads<T: Send>(threads: Option<usize>, work: impl FnOnce() -> T + Send) -> Result<T> {
    let Some(threads) = threads else { return Ok(work()) };
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map(|pool| pool.install(work))
        .map_err(|reason| Error::argument(format!("cannot start {threads} threads: {reason}")))
}
