//! What a calibration changed: the study under the cards before the calibrated one, beside the study as it is.

use super::analysis::{Absent, Analysis, Found, Run, find};
use super::common_numbers::{Breaches, Change, CommonSample};
use super::epistemic::EpistemicOutcomes;
use crate::error::Result;
use crate::study::{Input, Study};

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
    pub epistemic: Found<EpistemicOutcomes>,
    /// Breaches of the sample behind the swaps, as it is.
    pub base: Breaches,
    /// Every changed input with its prior law instead.
    pub swapped: Vec<Swapped>,
}

impl Analysis<'_> for CalibratedOutcomes {
    const NAME: &'static str = "the study before its calibration";

    fn cost(study: &Study) -> Found<u64> {
        let before = before(study)?;
        Absent::unless_limited(study)?;
        let nested = EpistemicOutcomes::cost(before).unwrap_or(0);
        let swaps = SWAP_SAMPLES.min(study.sampling.samples) * swaps(study, before).len() as u64;
        Ok(2 * SAMPLES.min(study.sampling.samples) + nested + swaps)
    }

    fn compute(run: Run<'_>) -> Result<Option<Self>> {
        match before(run.study) {
            Ok(before) => run_calibrated(run, before),
            Err(_) => Ok(None),
        }
    }
}

/// The study under the cards before its calibrated one.
fn before(study: &Study) -> Found<&Study> {
    study.prior.as_deref().ok_or(Absent::NotCalibrated)
}

/// Places of the inputs whose law changed, in the study and in the one before.
fn swaps(study: &Study, before: &Study) -> Vec<(usize, usize)> {
    let place = |(input, after): (usize, &Input)| {
        let prior = before.inputs.iter().position(|old| old.target == after.target)?;
        let changed = before.inputs[prior].law_canonical != after.law_canonical;
        changed.then_some((input, prior))
    };
    study.inputs.iter().enumerate().filter_map(place).collect()
}

fn run_calibrated(run: Run<'_>, before: &Study) -> Result<Option<CalibratedOutcomes>> {
    let Run { study, record, progress } = run;
    let available = record.counts().samples();
    let sample = CommonSample::of_run(before, SAMPLES.min(available))?;
    let (prior, replicates) = (sample.base(progress)?, sample.replicates());
    let posterior = Breaches::from_margins(study.limits.len(), sample.rows(), |i, k| {
        record.margins(i).get(k).copied().unwrap_or(f64::NAN)
    });
    let Some(epistemic) = find::<EpistemicOutcomes>(Run { study: before, ..run }) else {
        return Ok(None);
    };
    let sample = CommonSample::of_run(study, SWAP_SAMPLES.min(available))?;
    let base = sample.base(progress)?;
    let mut swapped = Vec::new();
    for (input, prior) in swaps(study, before) {
        if progress.stopping() {
            return Ok(None);
        }
        let marginals = vec![(input, before.inputs[prior].marginal.clone())];
        let breaches = sample.changed(&Change { marginals, ..Change::default() }, progress)?;
        swapped.push(Swapped { input, prior, breaches });
    }
    Ok(Some(CalibratedOutcomes { replicates, prior, posterior, epistemic, base, swapped }))
}
