//! A study, run: its samples, every analysis of them, and what a report says of both. This is the program's sentence;
//! the command line, a test and an example say it alike.

pub mod compare;
mod list;
mod results;
mod sampling;

use crate::campaign::{self, Progress};
use crate::error::Result;
use crate::study::Study;

pub use list::{Analyses, costs};
pub use results::{Findings, Unreadable, gather};
pub use sampling::{Sampling, Sink, Source, sample};

/// What a run takes beside its study.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Threads; one a core unless stated. They change no number.
    pub threads: Option<usize>,
    /// The command that gives the same numbers, as the report is to say it.
    pub command: Option<String>,
}

/// A study that has been run.
#[derive(Debug)]
pub struct Results {
    /// Everything that a report says.
    pub findings: Findings,
    /// What the samples have shown.
    pub sampling: Sampling,
}

/// Runs a study: its samples, every analysis, the findings. Keeps no sample. `None` if `progress` asks for a stop.
///
/// # Errors
/// If the design is impossible, nothing is uncertain, or a method refuses its options.
pub fn run(study: &Study, options: &Options, progress: &Progress) -> Result<Option<Results>> {
    study.design.validate()?;
    campaign::with_threads(options.threads, || {
        let sampling = Sampling::of(study, progress)?;
        let findings = analyse(study, &sampling, options, progress)?;
        Ok(findings.map(|findings| Results { findings, sampling }))
    })?
}

/// Analyses samples that have been run, on the threads of whoever calls. `None` if they are not complete, or `progress`
/// asks for a stop.
///
/// # Errors
/// If a method refuses its options.
pub fn analyse(
    study: &Study,
    sampling: &Sampling,
    options: &Options,
    progress: &Progress,
) -> Result<Option<Findings>> {
    if !sampling.complete {
        return Ok(None);
    }
    match Analyses::compute(study, sampling, progress) {
        Some(analyses) => gather(study, sampling, &analyses, options).map(Some),
        None => Ok(None),
    }
}
