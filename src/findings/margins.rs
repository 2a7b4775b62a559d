//! What margin is left, in how many flights of a hundred.

use super::CONFIDENCE;
use crate::campaign::{Record, in_parallel};
use crate::error::Result;
use crate::numerics::interval::{Earned, Interval};
use crate::numerics::words::{self, Word};
use crate::reliability::quantiles::{OrderedSample, REPORTED};
use crate::study::Study;
use serde::{Deserialize, Serialize};

/// The margin of one limit, SI: negative is a breach.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MarginFinding {
    /// Name of the limit.
    pub limit: String,
    /// Name of the outcome.
    #[serde(deserialize_with = "words::one")]
    pub outcome: Word,
    /// The limit as written.
    pub limit_text: String,
    /// The limit, SI.
    pub limit_value: f64,
    /// Quantiles, from the median to the far tail.
    pub quantiles: Vec<MarginQuantile>,
}

/// The margin that a share of the flights keeps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MarginQuantile {
    /// The share of flights.
    pub share: f64,
    /// They keep at least this margin, SI; `None` if too few samples could be computed.
    pub margin: Option<f64>,
    /// Distribution-free interval of it.
    pub interval: Earned,
}

/// The margins of every limit. A share p keeps at least minus the p-quantile of the exceedance.
pub(crate) fn margins(study: &Study, record: &Record) -> Result<Vec<MarginFinding>> {
    // With a replicated design the order statistics' intervals do not apply.
    let replicated = !record.by_replicate().is_empty();
    let limits = study.stated_limits();
    in_parallel(&limits, |&i| {
        let limit = &study.limits[i];
        let exceedances: Vec<f64> = record.margins(i).iter().map(|margin| -margin).collect();
        let sample = OrderedSample::from_unsorted(&exceedances);
        let quantiles = REPORTED
            .iter()
            .map(|&share| {
                let quantile = sample.quantile(share, CONFIDENCE)?;
                let interval = match quantile.interval {
                    _ if replicated => Earned::none(
                        "order statistics need independent samples, and this design's are not",
                    ),
                    _ if study.sampling.stopping.is_some() => Earned::none(
                        "order statistics need a number of samples that was fixed beforehand",
                    ),
                    Earned::Interval(i) => {
                        Interval { lower: -i.upper, upper: -i.lower, ..i }.into()
                    }
                    none => none,
                };
                Ok(MarginQuantile { share, margin: quantile.estimate.map(|e| -e), interval })
            })
            .collect::<Result<_>>()?;
        Ok(MarginFinding {
            limit: limit.name(),
            outcome: limit.outcome.name(),
            limit_text: limit.text.clone(),
            limit_value: limit.value,
            quantiles,
        })
    })
    .into_iter()
    .collect()
}
