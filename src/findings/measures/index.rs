//! One index of every factor, side by side.

use crate::campaign::Found;
use crate::campaign::given_sample::GivenSample;
use crate::campaign::screening::{ScreeningOutcomes, TRAJECTORIES};
use crate::descent::OutcomeQuantity;
use crate::error::Result;
use crate::findings::CONFIDENCE;
use crate::numerics::interval::{Earned, Estimate, Interval};
use crate::numerics::words::{self, Word};
use serde::ser::SerializeStruct;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Below this an index is not told from none.
const NEVER_NEGATIVE: &str = "the index itself is never negative: its estimate is, because ";

/// One index of one output, for every factor.
///
/// Serialised by columns, in the order of the factors: `value`, `lower`, `upper`, `p_value`, each null where there is
/// none, and `notes`, which say why, with the places of the factors that they are about.
#[derive(Debug, Clone, PartialEq)]
pub struct IndexColumn {
    /// Its name: `borgonovo_delta`.
    pub index: &'static str,
    /// How it was estimated.
    pub method: &'static str,
    /// Samples (of a screening trajectories) that were read; 0 of what is not sampled.
    pub samples: usize,
    /// Samples left out because their outcome is not known.
    pub left_out: usize,
    /// One entry a factor.
    pub estimates: Vec<Estimate>,
    /// One entry a factor, of a test of independence; empty without one.
    pub p_values: Vec<Option<f64>>,
    /// One entry a factor: what an estimate beyond its index's range means.
    pub explanations: Vec<Option<String>>,
}

impl IndexColumn {
    /// A column; `negative` says what an estimate below zero means, if the index cannot be.
    pub(super) fn new(
        index: &'static str,
        method: &'static str,
        samples: usize,
        estimates: Vec<Estimate>,
        negative: Option<&str>,
    ) -> Self {
        let explain = |estimate: &Estimate| {
            let below = estimate.value.is_some_and(|value| value < 0.0);
            negative.filter(|_| below).map(|why| format!("{NEVER_NEGATIVE}{why}"))
        };
        let explanations = estimates.iter().map(explain).collect();
        IndexColumn {
            index,
            method,
            samples,
            left_out: 0,
            estimates,
            p_values: Vec::new(),
            explanations,
        }
    }

    /// The same with p-values.
    pub(super) fn tested(mut self, p_values: Vec<Option<f64>>) -> Self {
        self.p_values = p_values;
        self
    }

    /// The same, with the number of samples left out.
    pub(super) fn leaving_out(mut self, rows: usize) -> Self {
        self.left_out = rows;
        self
    }

    /// What is to be said of one factor's estimate: why it has no interval, or what its sign means.
    pub fn note(&self, factor: usize) -> Option<&str> {
        let why = self.estimates.get(factor).and_then(|estimate| estimate.interval.why_none());
        why.or_else(|| self.explanations.get(factor)?.as_deref())
    }

    /// Whether the factor's effect is told from none: by its interval if it has one, else by the test.
    pub fn distinct(&self, factor: usize) -> Option<bool> {
        if let Some(p) = self.p_values.get(factor).copied().flatten() {
            return Some(p <= 1.0 - CONFIDENCE);
        }
        let interval = self.estimates.get(factor)?.interval.interval()?;
        Some(!interval.contains(0.0))
    }

    /// The same without intervals, which are not earned.
    pub(super) fn without_intervals(mut self, why: &str) -> Self {
        for estimate in self.estimates.iter_mut().filter(|estimate| estimate.value.is_some()) {
            estimate.standard_error = None;
            estimate.interval = Earned::none(why);
        }
        self.p_values.clear();
        self
    }

    fn notes(&self) -> Vec<Note<'_>> {
        let mut notes: Vec<Note<'_>> = Vec::new();
        for factor in 0..self.estimates.len() {
            let Some(text) = self.note(factor) else { continue };
            match notes.iter_mut().find(|note| note.note == text) {
                Some(note) => note.factors.push(factor),
                None => notes.push(Note { note: text, factors: vec![factor] }),
            }
        }
        notes
    }
}

#[derive(Serialize)]
struct Note<'a> {
    note: &'a str,
    /// Places of the factors, from 0.
    factors: Vec<usize>,
}

impl Serialize for IndexColumn {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        let intervals = || self.estimates.iter().map(|estimate| estimate.interval.interval());
        let mut tree = serializer.serialize_struct("IndexColumn", 10)?;
        tree.serialize_field("index", self.index)?;
        tree.serialize_field("method", self.method)?;
        tree.serialize_field("samples", &self.samples)?;
        if self.left_out > 0 {
            tree.serialize_field("left_out", &self.left_out)?;
        }
        let values: Vec<_> = self.estimates.iter().map(|estimate| estimate.value).collect();
        tree.serialize_field("value", &values)?;
        if let Some(interval) = intervals().flatten().next() {
            let ends = |upper: bool| -> Vec<Option<f64>> {
                intervals().map(|i| i.map(|i| if upper { i.upper } else { i.lower })).collect()
            };
            tree.serialize_field("lower", &ends(false))?;
            tree.serialize_field("upper", &ends(true))?;
            tree.serialize_field("confidence", &interval.confidence)?;
            tree.serialize_field("interval", interval.method)?;
        }
        if !self.p_values.is_empty() {
            tree.serialize_field("p_value", &self.p_values)?;
        }
        tree.serialize_field("notes", &self.notes())?;
        tree.end()
    }
}

/// What is written of a column.
#[derive(Deserialize)]
struct Written {
    #[serde(deserialize_with = "words::one")]
    index: Word,
    #[serde(deserialize_with = "words::one")]
    method: Word,
    samples: usize,
    #[serde(default)]
    left_out: usize,
    value: Vec<Option<f64>>,
    #[serde(default)]
    lower: Vec<Option<f64>>,
    #[serde(default)]
    upper: Vec<Option<f64>>,
    #[serde(default)]
    confidence: f64,
    #[serde(default, deserialize_with = "words::one")]
    interval: Word,
    #[serde(default)]
    p_value: Vec<Option<f64>>,
    notes: Vec<WrittenNote>,
}

#[derive(Deserialize)]
struct WrittenNote {
    note: String,
    factors: Vec<usize>,
}

impl<'de> Deserialize<'de> for IndexColumn {
    /// Standard errors are not written.
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        let written = Written::deserialize(deserializer)?;
        let note = |factor: usize| {
            let of = |note: &&WrittenNote| note.factors.contains(&factor);
            written.notes.iter().find(of).map(|note| note.note.clone())
        };
        let end = |ends: &[Option<f64>], factor: usize| ends.get(factor).copied().flatten();
        let (confidence, method) = (written.confidence, written.interval);
        let (mut estimates, mut explanations) = (Vec::new(), Vec::new());
        for (factor, &value) in written.value.iter().enumerate() {
            let ends = end(&written.lower, factor).zip(end(&written.upper, factor));
            let interval = match ends {
                Some((lower, upper)) => Interval { lower, upper, confidence, method }.into(),
                None => Earned::none(note(factor).unwrap_or_default()),
            };
            explanations.push(note(factor).filter(|_| ends.is_some()));
            estimates.push(Estimate { value, standard_error: None, interval });
        }
        Ok(IndexColumn {
            index: written.index,
            method: written.method,
            samples: written.samples,
            left_out: written.left_out,
            estimates,
            p_values: written.p_value,
            explanations,
        })
    }
}

/// Mean magnitude of the elementary effects of every factor.
pub(super) fn screened(
    sample: &GivenSample,
    screening: &Found<ScreeningOutcomes>,
    quantity: OutcomeQuantity,
) -> Result<IndexColumn> {
    let effects = match screening {
        Err(why) => Err(why.to_string()),
        Ok(found) => {
            let outcomes = found.outcomes.column(quantity as usize);
            Ok(found.screening.effects(outcomes, CONFIDENCE)?)
        }
    };
    let estimates =
        sample.factors.iter().map(|factor| match (&effects, factor.columns.as_slice()) {
            (Err(why), _) => Estimate::none(why.clone()),
            (Ok(effects), [one]) => effects[*one].magnitude.clone(),
            (Ok(effects), members) => {
                let sizes = members.iter().map(|&j| effects[j].magnitude.value);
                root_of_squares(
                    sizes,
                    "the root of the sum of its members' squares, which are not one statistic",
                )
            }
        });
    let method =
        "Morris screening, mean magnitude of the effect of half of a law's probability, SI";
    Ok(IndexColumn::new("morris_mu_star", method, TRAJECTORIES, estimates.collect(), None))
}

/// The size of a group from its members'.
pub(super) fn root_of_squares(sizes: impl Iterator<Item = Option<f64>>, why: &str) -> Estimate {
    let sum: Option<f64> = sizes.map(|size| size.map(|size| size * size)).sum();
    match sum {
        Some(sum) => {
            let interval = Earned::none(why);
            Estimate { value: Some(sum.sqrt()), standard_error: None, interval }
        }
        None => Estimate::none("a member has none"),
    }
}
