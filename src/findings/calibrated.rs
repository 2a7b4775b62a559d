//! What a calibration changed: P before and after, which parameters moved, and why P did.

use super::EpistemicFinding;
use super::epistemic::epistemic;
use super::probabilities::title_of;
use super::trade::Paired;
use crate::campaign::calibrated::{CalibratedOutcomes, Swapped};
use crate::campaign::common_numbers::Event;
use crate::error::Result;
use crate::numerics::interval::Estimate;
use crate::study::Study;
use serde::{Deserialize, Serialize};

/// What a calibration changed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CalibratedFinding {
    /// What the calibrated card says that it was made from.
    pub calibrated_from: String,
    /// The cards of the prior.
    pub prior_cards: Vec<String>,
    /// Samples of either.
    pub samples: u64,
    /// Each limit, then any limit.
    pub events: Vec<CalibratedEvent>,
    /// The inputs whose laws changed, the one that moved P(any breach) most first.
    pub moved: Vec<MovedInput>,
}

/// The probability of an event before and after.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CalibratedEvent {
    /// The event in words.
    pub title: String,
    /// Under the prior cards.
    pub prior: Estimate,
    /// Under all cards.
    pub posterior: Estimate,
    /// Probabilities between which 90 % of the belief lies, before and after.
    pub prior_band: Option<(f64, f64)>,
    /// See `prior_band`.
    pub posterior_band: Option<(f64, f64)>,
}

/// One input before and after.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MovedInput {
    /// Its path.
    pub path: String,
    /// Mean and standard deviation before, SI.
    pub prior: (f64, f64),
    /// Mean and standard deviation after, SI.
    pub posterior: (f64, f64),
    /// How far the mean moved, in standard deviations of the prior.
    pub shift: f64,
    /// The standard deviation after over that before.
    pub spread: f64,
    /// P(any breach) as it is less that with this input's prior law: what this one input's calibration did.
    pub effect: Estimate,
}

/// What a calibration changed; nothing for a study without a calibrated card.
pub(crate) fn calibrated(
    study: &Study,
    outcomes: Option<&CalibratedOutcomes>,
    after: &EpistemicFinding,
) -> Result<Option<CalibratedFinding>> {
    let (Some(prior), Some(outcomes)) = (study.prior.as_deref(), outcomes) else {
        return Ok(None);
    };
    let before = epistemic(prior, &outcomes.epistemic)?;
    let paired = Paired { replicates: outcomes.replicates };
    let events = (0..study.limits.len()).map(Event::Limit).chain([Event::Any]);
    let events = events
        .enumerate()
        .map(|(e, event)| {
            let band = |finding: &EpistemicFinding| {
                let quantiles = &finding.events.get(e)?.quantiles;
                Some((quantiles.first()?.1.value?, quantiles.last()?.1.value?))
            };
            Ok(CalibratedEvent {
                title: match event {
                    Event::Any => "any limit".to_owned(),
                    Event::Limit(i) => title_of(&study.limits[i]),
                },
                prior: paired.probability(&outcomes.prior, event)?,
                posterior: paired.probability(&outcomes.posterior, event)?,
                prior_band: band(&before),
                posterior_band: band(after),
            })
        })
        .collect::<Result<_>>()?;
    let mut moved = outcomes
        .swapped
        .iter()
        .map(|swapped| moved(study, prior, outcomes, swapped))
        .collect::<Result<Vec<_>>>()?;
    let size = |input: &MovedInput| input.effect.value.map_or(0.0, f64::abs);
    moved.sort_by(|a, b| size(b).total_cmp(&size(a)));
    Ok(Some(CalibratedFinding {
        calibrated_from: study.calibrated_from.clone().unwrap_or_default(),
        prior_cards: prior.card_texts.iter().map(|(name, _)| name.clone()).collect(),
        samples: outcomes.prior.rows() as u64,
        events,
        moved,
    }))
}

fn moved(
    study: &Study,
    prior: &Study,
    outcomes: &CalibratedOutcomes,
    swapped: &Swapped,
) -> Result<MovedInput> {
    let before = prior.inputs[swapped.prior].marginal.moments();
    let after = study.inputs[swapped.input].marginal.moments();
    let paired = Paired { replicates: outcomes.replicates };
    Ok(MovedInput {
        path: study.inputs[swapped.input].target.path(),
        prior: before,
        posterior: after,
        shift: (after.0 - before.0) / before.1,
        spread: after.1 / before.1,
        effect: paired.difference(&swapped.breaches, &outcomes.base, Event::Any)?,
    })
}
