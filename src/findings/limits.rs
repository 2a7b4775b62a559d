//! The limits that a descent is judged by, and where each comes from.

use crate::numerics::words::{self, Word};
use crate::study::{Limit, Study};
use serde::{Deserialize, Serialize};

/// One limit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LimitFinding {
    /// Name of the limit.
    pub limit: String,
    /// Name of the outcome.
    #[serde(deserialize_with = "words::one")]
    pub outcome: Word,
    /// `max` or `min`.
    #[serde(deserialize_with = "words::one")]
    pub side: Word,
    /// The limit, SI.
    pub value: f64,
    /// The limit as written.
    pub text: String,
    /// Where it comes from; `None` if the study does not state that.
    pub source: Option<String>,
    /// Whether the study does not state the limit itself.
    pub implied: bool,
}

/// The limits of a study.
pub(crate) fn limits(study: &Study) -> Vec<LimitFinding> {
    let finding = |limit: &Limit| LimitFinding {
        limit: limit.name(),
        outcome: limit.outcome.name(),
        side: limit.kind.name(),
        value: limit.value,
        text: limit.text.clone(),
        source: limit.source.clone(),
        implied: limit.implied,
    };
    study.limits.iter().map(finding).collect()
}
