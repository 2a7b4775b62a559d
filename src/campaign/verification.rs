//! How far the fast integrator can be trusted, measured: the first samples of the run, its most extreme ones, and those
//! near a limit are computed again by the plain one.

use super::{Ensemble, Record, in_parallel, sampler};
use crate::descent::reference::{self, REFERENCE_TOLERANCE};
use crate::descent::vector::Settings;
use crate::descent::{Outcome, OutcomeQuantity};
use crate::error::Result;
use crate::numerics::columns::Columns;
use crate::physics::Coefficients;
use crate::sampling::Sampler;
use crate::study::Study;

/// A margin within this share of its limit is near it, or within three times the worst error measured where
/// that is more.
pub const NEAR: f64 = 1e-4;
/// So many times the worst error that was seen may have been missed.
const MARGIN_ERRORS: f64 = 3.0;
/// Samples near one limit that are computed again, at most: the nearest.
const MOST_NEAR: usize = 200;
/// Samples from the start of the run whose error is measured.
const MEASURED: u64 = 256;
/// Of the detailed models, a descent of which takes the plain integrator some 25 ms: samples near one limit, from the
/// start of the run, and extreme ones.
const DETAILED: (usize, u64, usize) = (16, 24, 40);

/// What computing samples again has shown.
#[derive(Debug, Clone, PartialEq)]
pub struct Verification {
    /// One entry a limit.
    pub limits: Vec<NearLimit>,
    /// Samples whose error was measured.
    pub measured: usize,
    /// How many of them are from the start of the run; the others are its most extreme ones.
    pub first: usize,
    /// Worst relative error of each outcome over those samples, in the order of
    /// [`OutcomeQuantity::ALL`].
    pub worst: Vec<(OutcomeQuantity, f64)>,
}

/// The samples near one limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearLimit {
    /// A margin within this share of the limit is near it.
    pub share: f64,
    /// Samples with a margin that near.
    pub near: usize,
    /// Those of them that were computed again.
    pub recomputed: usize,
    /// Breaches that are none by the plain integrator.
    pub breach_to_clean: u64,
    /// Clean samples that are breaches by the plain integrator.
    pub clean_to_breach: u64,
    /// Breaches, and clean samples, that are near and were not computed again.
    pub untried: (u64, u64),
}

impl NearLimit {
    /// Breaches that may be none, and clean samples that may be breaches: what was seen, and where anything was seen
    /// all that was not tried.
    pub fn may_flip(&self) -> (u64, u64) {
        if self.breach_to_clean + self.clean_to_breach == 0 {
            return (0, 0);
        }
        (self.breach_to_clean + self.untried.0, self.clean_to_breach + self.untried.1)
    }
}

impl Verification {
    /// The outcomes whose measured error is above what the integrator promises at a study's tolerance: the error, and
    /// the promise.
    pub fn broken_promises(&self, study: &Study) -> Vec<(OutcomeQuantity, f64, f64)> {
        let settings = Settings { tolerance: study.numerics.tolerance };
        let promised = |&(quantity, error): &(OutcomeQuantity, f64)| {
            (quantity, error, settings.promise(quantity))
        };
        self.worst.iter().map(promised).filter(|(_, error, promise)| error > promise).collect()
    }
}

/// A run whose samples are computed again.
struct Again<'a> {
    study: &'a Study,
    sampler: Sampler,
    ensemble: Ensemble<'a>,
}

impl Again<'_> {
    /// The draw of a sample.
    fn draw(&self, sample: u64) -> Result<Vec<f64>> {
        let mut point = Columns::new(1, self.ensemble.dimension());
        self.sampler.fill(sample, &mut point)?;
        let mut inputs = Columns::new(1, self.ensemble.dimension());
        self.study.joint.from_uniform(&point, &mut inputs);
        Ok(inputs.row(0))
    }

    /// What the plain integrator makes of a sample, if it can.
    fn plain(&self, sample: u64) -> Result<Option<Outcome>> {
        let coefficients = Coefficients::new(&self.ensemble.design_of(&self.draw(sample)?));
        Ok(reference::descend(&coefficients, self.study.model, REFERENCE_TOLERANCE).ok())
    }

    /// Worst relative error of each outcome over samples, and over how many of them both integrators had a result.
    fn worst(&self, samples: &[u64]) -> Result<(Vec<(OutcomeQuantity, f64)>, usize)> {
        let mut inputs = Columns::new(samples.len(), self.ensemble.dimension());
        for (row, &sample) in samples.iter().enumerate() {
            for (j, value) in self.draw(sample)?.into_iter().enumerate() {
                inputs.set(row, j, value);
            }
        }
        let fast = self.ensemble.at_inputs(&inputs, &super::Progress::default());
        let rows: Vec<usize> = (0..samples.len()).collect();
        let errors = in_parallel(&rows, |&row| -> Result<Option<Vec<f64>>> {
            let Ok(fast) = fast.result(row) else { return Ok(None) };
            let Some(plain) = self.plain(samples[row])? else { return Ok(None) };
            let relative = |q: &OutcomeQuantity| (fast.get(*q) / plain.get(*q) - 1.0).abs();
            Ok(Some(OutcomeQuantity::ALL.iter().map(relative).collect()))
        });
        let mut worst = OutcomeQuantity::ALL.map(|quantity| (quantity, 0.0f64)).to_vec();
        let mut measured = 0;
        for error in errors {
            let Some(error) = error? else { continue };
            measured += 1;
            for ((_, worst), error) in worst.iter_mut().zip(error) {
                *worst = worst.max(error);
            }
        }
        Ok((worst, measured))
    }
}

/// Computes samples of a finished run again.
///
/// # Errors
/// What [`sampler`] refuses.
pub fn verify(study: &Study, record: &Record) -> Result<Verification> {
    let again = Again { study, sampler: sampler(study)?, ensemble: Ensemble::new(study) };
    let (most_near, first, extreme) =
        if study.model.is_detailed() { DETAILED } else { (MOST_NEAR, MEASURED, usize::MAX) };
    let first = record.counts().samples().min(first);
    let extremes = record.extreme_samples().into_iter().filter(|&sample| sample >= first);
    let samples: Vec<u64> = (0..first).chain(extremes.take(extreme)).collect();
    let (worst, measured) = again.worst(&samples)?;

    let mut limits = Vec::with_capacity(study.limits.len());
    for (i, limit) in study.limits.iter().enumerate() {
        let margins = record.margins(i);
        let margin = |sample: &u64| margins[*sample as usize];
        let error = worst[limit.outcome as usize].1;
        let share = NEAR.max(MARGIN_ERRORS * error);
        let band = share * limit.value.abs();
        let mut near: Vec<u64> = (0..margins.len() as u64)
            // A descent that was stopped undeployed is no nearer to a limit just below than one that never moved.
            .filter(|k| !limit.is_of_no_deployment(margin(k)))
            .filter(|k| margin(k).abs() <= band)
            .collect();
        let all = near.len();
        near.sort_by(|a, b| margin(a).abs().total_cmp(&margin(b).abs()).then(a.cmp(b)));
        let rest = near.split_off(all.min(most_near));
        let breaches = rest.iter().filter(|k| margin(k) < 0.0).count() as u64;
        let flips = in_parallel(&near, |k| -> Result<(bool, bool)> {
            let Some(outcome) = again.plain(*k)? else { return Ok((false, false)) };
            let (was, is) = (margin(k) < 0.0, limit.margin(&outcome) < 0.0);
            Ok((was && !is, !was && is))
        });
        let mut found = NearLimit {
            share,
            near: all,
            recomputed: near.len(),
            breach_to_clean: 0,
            clean_to_breach: 0,
            untried: (breaches, rest.len() as u64 - breaches),
        };
        for flip in flips {
            let (to_clean, to_breach) = flip?;
            found.breach_to_clean += u64::from(to_clean);
            found.clean_to_breach += u64::from(to_breach);
        }
        limits.push(found);
    }
    Ok(Verification { limits, measured, first: first as usize, worst })
}
