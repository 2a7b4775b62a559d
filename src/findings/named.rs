//! What a sensitivity is of, and what it is due to: identities, each written as a text in one way.

use crate::descent::OutcomeQuantity;
use crate::sensitivity::pick_freeze::Factor;
use crate::study::{Limit, Study};
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;

/// An output of a study: what a sensitivity is of.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Output {
    /// An outcome; written `time`.
    Outcome(OutcomeQuantity),
    /// The breach of the limit of this name; written `breach.time`.
    Breach(String),
    /// The breach of any limit; written `breach.any`.
    AnyBreach,
}

impl Output {
    /// The breach of a limit.
    pub fn breach_of(limit: &Limit) -> Self {
        Output::Breach(limit.name())
    }

    /// Whether it is the outcome of one of these names.
    pub fn is_one_of(&self, outcomes: &[&str]) -> bool {
        matches!(self, Output::Outcome(quantity) if outcomes.contains(&quantity.name()))
    }
}

impl fmt::Display for Output {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Output::Outcome(quantity) => f.write_str(quantity.name()),
            Output::Breach(limit) => write!(f, "breach.{limit}"),
            Output::AnyBreach => f.write_str("breach.any"),
        }
    }
}

impl Serialize for Output {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for Output {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        match (text.strip_prefix("breach."), OutcomeQuantity::from_name(&text)) {
            (Some("any"), _) => Ok(Output::AnyBreach),
            (Some(limit), _) => Ok(Output::Breach(limit.to_owned())),
            (None, Some(quantity)) => Ok(Output::Outcome(quantity)),
            (None, None) => Err(D::Error::custom(format!("{text} is no output"))),
        }
    }
}

/// How the factor of a whole group is written.
const ALL: &str = " (all)";

/// What a factor is called where the members of its group are factors as well: those of a group are told from it by
/// what is written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FactorName {
    /// Path of the input, or name of the group.
    pub name: String,
    /// Whether it is a group beside its members; written `brake.gap (all)`.
    pub all: bool,
}

impl FactorName {
    /// The name of a factor of a study.
    pub(super) fn of(study: &Study, factor: &Factor) -> Self {
        let beside = |&j: &usize| study.joint.sample_of(j).is_none();
        let all = factor.columns.len() > 1 && factor.columns.iter().all(beside);
        FactorName { name: factor.name.clone(), all }
    }
}

impl fmt::Display for FactorName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", self.name, if self.all { ALL } else { "" })
    }
}

impl Serialize for FactorName {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for FactorName {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        Ok(match text.strip_suffix(ALL) {
            Some(name) => FactorName { name: name.to_owned(), all: true },
            None => FactorName { name: text, all: false },
        })
    }
}
