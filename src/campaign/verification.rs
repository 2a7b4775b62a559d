//! How far the fast integrator can be trusted, measured: samples near a limit, and the first samples of
//! the run, are computed again by the plain one.

use super::{Ensemble, Record, in_parallel, sampler};
use crate::descent::reference::{self, REFERENCE_TOLERANCE};
use crate::descent::{Outcome, OutcomeQuantity};
use crate::error::Result;
use crate::numerics::columns::Columns;
use crate::physics::Coefficients;
use crate::study::Study;

/// A margin within this share of its limit is near it.
pub const NEAR: f64 = 1e-4;
/// Samples near one limit that are computed again, at most: the nearest.
const MOST_NEAR: usize = 200;
/// Samples from the start of the run whose error is measured.
const MEASURED: u64 = 256;

/// What computing samples again has shown.
#[derive(Debug, Clone, PartialEq)]
pub struct Verification {
    /// One entry a limit.
    pub limits: Vec<NearLimit>,
    /// Samples whose error was measured.
    pub measured: usize,
    /// Worst relative error of each outcome over those samples, in the order of
    /// [`OutcomeQuantity::ALL`].
    pub worst: Vec<(OutcomeQuantity, f64)>,
}

/// The samples near one limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NearLimit {
    /// Samples with a margin within [`NEAR`] of the limit.
    pub near: usize,
    /// Those of them that were computed again.
    pub recomputed: usize,
    /// Breaches that are none by the plain integrator.
    pub breach_to_clean: u64,
    /// Clean samples that are breaches by the plain integrator.
    pub clean_to_breach: u64,
}

/// Computes samples of a finished run again.
///
/// # Errors
/// What [`sampler`] refuses.
pub fn verify(study: &Study, record: &Record) -> Result<Verification> {
    let sampler = sampler(study)?;
    let ensemble = Ensemble::new(study);
    let draw = |index: u64| -> Result<Vec<f64>> {
        let mut point = Columns::new(1, ensemble.dimension());
        sampler.fill(index, &mut point)?;
        let mut inputs = Columns::new(1, ensemble.dimension());
        study.joint.from_uniform(&point, &mut inputs);
        Ok(inputs.row(0))
    };
    let again = |index: u64| -> Result<Option<Outcome>> {
        let coefficients = Coefficients::new(&ensemble.design_of(&draw(index)?));
        Ok(reference::descend(&coefficients, study.model, REFERENCE_TOLERANCE).ok())
    };
    let mut limits = Vec::with_capacity(study.limits.len());
    for (i, limit) in study.limits.iter().enumerate() {
        let margins = record.margins(i);
        let band = NEAR * limit.value.abs();
        let mut near: Vec<u64> = (0..margins.len() as u64)
            // A descent that was stopped undeployed is no nearer to a limit just below than one that never moved.
            .filter(|&k| !limit.is_of_no_deployment(margins[k as usize]))
            .filter(|&k| margins[k as usize].abs() <= band)
            .collect();
        let all = near.len();
        near.sort_by(|&a, &b| {
            margins[a as usize].abs().total_cmp(&margins[b as usize].abs()).then(a.cmp(&b))
        });
        near.truncate(MOST_NEAR);
        let flips = in_parallel(&near, |&k| -> Result<(bool, bool)> {
            let Some(outcome) = again(k)? else { return Ok((false, false)) };
            let (was, is) = (margins[k as usize] < 0.0, limit.margin(&outcome) < 0.0);
            Ok((was && !is, !was && is))
        });
        let mut found =
            NearLimit { near: all, recomputed: near.len(), breach_to_clean: 0, clean_to_breach: 0 };
        for flip in flips {
            let (to_clean, to_breach) = flip?;
            found.breach_to_clean += u64::from(to_clean);
            found.clean_to_breach += u64::from(to_breach);
        }
        limits.push(found);
    }
    let first: Vec<u64> = (0..record.counts().samples().min(MEASURED)).collect();
    let mut inputs = Columns::new(first.len(), ensemble.dimension());
    for &k in &first {
        for (j, value) in draw(k)?.into_iter().enumerate() {
            inputs.set(k as usize, j, value);
        }
    }
    let fast = ensemble.at_inputs(&inputs, &super::Progress::default());
    let errors = in_parallel(&first, |&k| -> Result<Option<Vec<f64>>> {
        let (Ok(fast), Some(plain)) = (fast.result(k as usize), again(k)?) else { return Ok(None) };
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
    Ok(Verification { limits, measured, worst })
}
