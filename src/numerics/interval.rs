//! Confidence intervals that say where they come from, and the lack of one that says why.

use super::words::{self, Word};
use serde::{Deserialize, Serialize};
use std::fmt;

/// A confidence interval `[lower, upper]` of a number, in that number's unit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    /// The lower end; a one-sided upper bound has the smallest possible value here.
    pub lower: f64,
    /// The upper end; a one-sided lower bound has the largest possible value here.
    pub upper: f64,
    /// The probability, before the samples were drawn, that the interval would hold the truth.
    pub confidence: f64,
    /// How it was made: "Clopper-Pearson", "Student t over replicates", …
    #[serde(deserialize_with = "words::one")]
    pub method: Word,
}

impl Interval {
    /// Whether `value` lies in the interval, ends included.
    pub fn contains(&self, value: f64) -> bool {
        self.lower <= value && value <= self.upper
    }

    /// Upper end minus lower end.
    pub fn width(&self) -> f64 {
        self.upper - self.lower
    }
}

/// An interval that a method has earned, or the reason why there is none.
///
/// Serialised as the interval's own fields, or as `{"none": "why"}`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Earned {
    /// No interval, and why.
    None(String),
    /// The interval.
    #[serde(untagged)]
    Interval(Interval),
}

impl Earned {
    /// No interval, for this reason.
    pub fn none(why: impl Into<String>) -> Self {
        Earned::None(why.into())
    }

    /// The interval, if there is one.
    pub fn interval(&self) -> Option<&Interval> {
        match self {
            Earned::Interval(interval) => Some(interval),
            Earned::None(_) => None,
        }
    }

    /// Why there is no interval, if there is none.
    pub fn why_none(&self) -> Option<&str> {
        match self {
            Earned::Interval(_) => None,
            Earned::None(why) => Some(why),
        }
    }
}

impl From<Interval> for Earned {
    fn from(interval: Interval) -> Self {
        Earned::Interval(interval)
    }
}

impl fmt::Display for Earned {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Earned::Interval(i) => write!(f, "[{}, {}]", i.lower, i.upper),
            Earned::None(why) => write!(f, "none: {why}"),
        }
    }
}

/// An estimated number with its standard error and interval, each only if it was earned.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// The number; `None` if it is not defined, and then `interval` says why.
    pub value: Option<f64>,
    /// Its standard error, where one is known.
    pub standard_error: Option<f64>,
    /// Its interval, or why there is none.
    pub interval: Earned,
}

impl Estimate {
    /// An undefined number, and why.
    pub fn none(why: impl Into<String>) -> Self {
        Estimate { value: None, standard_error: None, interval: Earned::none(why) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn property_an_earned_interval_and_a_missing_one_serialise_apart() {
        let interval = Interval { lower: 0.0, upper: 0.5, confidence: 0.9, method: "m" };
        let text = serde_json::to_string(&Earned::from(interval)).unwrap();
        assert_eq!(text, r#"{"lower":0.0,"upper":0.5,"confidence":0.9,"method":"m"}"#);
        let text = serde_json::to_string(&Earned::none("too few")).unwrap();
        assert_eq!(text, r#"{"none":"too few"}"#);
        assert!(interval.contains(0.5) && !interval.contains(0.6));
    }
}
