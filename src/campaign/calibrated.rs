//! What a calibration changed: the study under the cards before the calibrated one, beside the study as it is.

use super::common_numbers::{Breaches, Change, CommonSample};
use super::epistemic::{EpistemicOutcomes, run_epistemic};
use super::{Progress, Record};
use crate::error::Result;
use crate::study::Study;

/// Samples of either study at most.
const SAMPLES: u64 = 50_000;
/// Samples behind each swap of one input's law.
const SWAP_SAMPLES: u64 = 20_000;

/// An input whose law a calibration changed.
#[derive(Debug, Clone)]
pub struct Swapped {
    /// Its place in the study.
    pub input: usize,
    /// Its place in the prior study.
    pub prior: usize,
    /// Breaches with its prior law in place of its posterior one.
    pub breaches: Breaches,
}

/// The study before and after.
#[derive(Debug)]
pub struct CalibratedOutcomes {
    /// Independently randomised replicates to which the rows belong in turn; 1 if every row is independent.
    pub replicates: usize,
    /// Breaches under the prior cards.
    pub prior: Breaches,
    /// Breaches under all cards, on as many samples of the same seed.
    pub posterior: Breaches,
    /// Nested descents under the prior cards, or why there are none.
    pub epistemic: std::result::Result<EpistemicOutcomes, String>,
    /// Breaches of the sample behind the swaps, as it is.
    pub base: Breaches,
    /// Every changed input with its prior law instead.
    pub swapped: Vec<Swapped>,
}

/// Runs a calibrated study under its prior cards. `None` if no card of it is a calibrated one after others, it has no
/// limit, or `progress` asks for a stop.
///
/// # Errors
/// What the samples refuse.
pub fn run_calibrated(
    study: &Study,
    record: &Record,
    progress: &Progress,
) -> Result<Option<CalibratedOutcomes>> {
    let Some(before) = study.prior.as_deref().filter(|_| !study.limits.is_empty()) else {
        return Ok(None);
    };
    let available = record.counts().samples();
    let sample = CommonSample::of_run(before, SAMPLES.min(available))?;
    let (prior, replicates) = (sample.base(progress)?, sample.replicates());
    let posterior = Breaches::from_margins(study.limits.len(), sample.rows(), |i, k| {
        record.margins(i).get(k).copied().unwrap_or(f64::NAN)
    });
    let epistemic = match run_epistemic(before, progress) {
        Ok(Some(found)) => Ok(found),
        Ok(None) => Err("the study asks for none (epistemic.outer = 0)".to_owned()),
        Err(reason) => Err(reason.to_string()),
    };
    let sample = CommonSample::of_run(study, SWAP_SAMPLES.min(available))?;
    let base = sample.base(progress)?;
    let mut swapped = Vec::new();
    for (input, after) in study.inputs.iter().enumerate() {
        if progress.stopping() {
            return Ok(None);
        }
        let found = before.inputs.iter().position(|old| old.target == after.target);
        let Some(prior) = found else { continue };
        if before.inputs[prior].law_canonical == after.law_canonical {
            continue;
        }
        let marginals = vec![(input, before.inputs[prior].marginal.clone())];
        let breaches = sample.changed(&Change { marginals, ..Change::default() }, progress)?;
        swapped.push(Swapped { input, prior, breaches });
    }
    Ok(Some(CalibratedOutcomes { replicates, prior, posterior, epistemic, base, swapped }))
}
