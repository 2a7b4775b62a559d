//! The numbers behind the figures, SI: what is drawn is in the findings, so that nothing is computed
//! while drawing.

mod convergence;
mod distribution;
mod fan;
mod interaction;
mod paper;

use super::drivers::DriversFinding;
use crate::campaign::Record;
use crate::error::Result;
use crate::study::Study;
use serde::{Deserialize, Serialize};

pub use convergence::{Checkpoint, Convergence};
pub use distribution::{Distribution, Exceedance};
pub use fan::{Fan, FanBand};
pub use interaction::{Interaction, InteractionInput};
pub(crate) use paper::held_temperature;
pub use paper::{ConstantTemperature, PaperRuns, paper_runs};

/// The numbers behind every figure of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FigureData {
    /// How each limited outcome is distributed, one entry a limit.
    pub distributions: Vec<Distribution>,
    /// How the probability of any breach settled as samples came in; `None` without a limit.
    pub convergence: Option<Convergence>,
    /// What descents look like over the run.
    pub fan: Fan,
    /// Where in the plane of its two strongest inputs a breach happens, or why that is not shown.
    pub interaction: std::result::Result<Interaction, String>,
}

/// The figures' numbers of a finished campaign.
///
/// # Errors
/// What the study's sampler refuses.
pub(crate) fn figures(
    study: &Study,
    record: &Record,
    drivers: &DriversFinding,
) -> Result<FigureData> {
    Ok(FigureData {
        distributions: distribution::distributions(study, record)?,
        convergence: convergence::convergence(study, record)?,
        fan: fan::fan(study)?,
        interaction: interaction::interaction(study, record, drivers)?,
    })
}
