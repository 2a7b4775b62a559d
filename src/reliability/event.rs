//! Events of a system of limits: one limit, any of them, two at once, all at once.

use super::limit_state::LimitState;
use crate::error::{Error, Result};
use crate::numerics::columns::Columns;
use serde::{Deserialize, Serialize};

/// A set of outcomes whose probability is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Event {
    /// This limit is breached.
    Limit(usize),
    /// At least one limit is breached (series system).
    Any,
    /// These two limits are breached together.
    Both(usize, usize),
    /// Every limit is breached (parallel system).
    All,
}

impl Event {
    /// The limits that decide the event.
    ///
    /// # Errors
    /// If the event names a limit that a system of `limits` limits does not have.
    pub fn members(self, limits: usize) -> Result<Vec<usize>> {
        let members: Vec<usize> = match self {
            Event::Limit(i) => vec![i],
            Event::Both(i, j) => vec![i, j],
            Event::Any | Event::All => (0..limits).collect(),
        };
        match members.iter().find(|&&i| i >= limits) {
            Some(i) => Err(Error::argument(format!("limit {i} of a system of {limits} limits"))),
            None if members.is_empty() => Err(Error::argument("a system without limits")),
            None => Ok(members),
        }
    }

    /// Whether one breach among the members suffices.
    pub fn is_union(self) -> bool {
        matches!(self, Event::Any)
    }

    /// The event's margin from its members' margins: the least of a union, the greatest of an
    /// intersection. NaN only where the margins that are known do not decide the event.
    pub fn margin(self, members: impl Iterator<Item = f64>) -> f64 {
        let union = self.is_union();
        let (mut extreme, mut unknown) = (f64::NAN, false);
        for margin in members {
            unknown |= margin.is_nan();
            extreme = if union { extreme.min(margin) } else { extreme.max(margin) };
        }
        // A breach decides a union, a margin that holds decides an intersection.
        let decided = if union { extreme < 0.0 } else { extreme >= 0.0 };
        if unknown && !decided { f64::NAN } else { extreme }
    }
}

/// How a point that could not be evaluated is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FaultReading {
    /// NaN, for a caller that treats it.
    Kept,
    /// As far from a breach as can be: margin +∞.
    Safe,
    /// As deep in breach as can be: margin −∞.
    Breach,
}

/// A limit state seen through one event: margins of the event, evaluations and faults counted.
pub struct Evaluator<'a> {
    state: &'a dyn LimitState,
    members: Vec<usize>,
    event: Event,
    reading: FaultReading,
    scales: Vec<f64>,
    margins: Columns,
    /// Points evaluated so far.
    pub evaluations: u64,
    /// Points whose event could not be decided.
    pub faults: u64,
}

/// Points handed to a limit state at a time: a whole number of vector groups, small enough for caches.
pub const BATCH: usize = 4096;

impl<'a> Evaluator<'a> {
    /// An evaluator of `event`. Events of several limits are scaled by the margins at the origin
    /// (one evaluation), since seconds and kelvin cannot be compared.
    ///
    /// # Errors
    /// If the event does not fit the limits, the dimension is zero, or the limit state fails.
    pub fn new(state: &'a dyn LimitState, event: Event, reading: FaultReading) -> Result<Self> {
        let members = event.members(state.limits())?;
        if state.dimension() == 0 {
            return Err(Error::argument("a limit state without coordinates"));
        }
        let scales = vec![1.0; members.len()];
        let mut evaluator = Evaluator {
            state,
            members,
            event,
            reading,
            scales,
            margins: Columns::default(),
            evaluations: 0,
            faults: 0,
        };
        if evaluator.members.len() > 1 {
            let origin = Columns::new(1, state.dimension());
            evaluator.margins(&origin)?;
            for (scale, &limit) in evaluator.scales.iter_mut().zip(&evaluator.members) {
                let size = evaluator.margins.get(0, limit).abs();
                if size.is_finite() && size > 0.0 {
                    *scale = size.recip();
                }
            }
        }
        Ok(evaluator)
    }

    /// The limit state behind.
    pub fn state(&self) -> &'a dyn LimitState {
        self.state
    }

    /// The event.
    pub fn event(&self) -> Event {
        self.event
    }

    /// Number of standard-normal coordinates.
    pub fn dimension(&self) -> usize {
        self.state.dimension()
    }

    /// Raw margins of all limits at the points of `z`, as the limit state gave them.
    ///
    /// # Errors
    /// Those of the limit state.
    pub fn margins(&mut self, z: &Columns) -> Result<&Columns> {
        self.margins.reset(z.rows(), self.state.limits());
        if z.rows() > 0 {
            self.state.margins(z, &mut self.margins)?;
        }
        self.evaluations += z.rows() as u64;
        Ok(&self.margins)
    }

    /// The raw margins of the last batch.
    pub fn last_margins(&self) -> &Columns {
        &self.margins
    }

    /// Margins of the event at the points of `z`, into `values`, faults counted and read as told.
    ///
    /// # Errors
    /// Those of the limit state.
    pub fn evaluate(&mut self, z: &Columns, values: &mut Vec<f64>) -> Result<()> {
        self.margins(z)?;
        values.clear();
        for k in 0..z.rows() {
            let scaled = self.members.iter().zip(&self.scales);
            let margin = self.event.margin(scaled.map(|(&i, s)| self.margins.get(k, i) * s));
            values.push(if margin.is_nan() {
                self.faults += 1;
                match self.reading {
                    FaultReading::Kept => f64::NAN,
                    FaultReading::Safe => f64::INFINITY,
                    FaultReading::Breach => f64::NEG_INFINITY,
                }
            } else {
                margin
            });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn property_a_fault_is_undecided_only_when_the_others_do_not_decide() {
        let margin = |event: Event, margins: [f64; 2]| event.margin(margins.into_iter());
        assert_eq!(margin(Event::Any, [f64::NAN, -1.0]), -1.0);
        assert!(margin(Event::Any, [f64::NAN, 1.0]).is_nan());
        assert_eq!(margin(Event::All, [f64::NAN, 1.0]), 1.0);
        assert!(margin(Event::All, [f64::NAN, -1.0]).is_nan());
        assert!(margin(Event::Limit(0), [f64::NAN, f64::NAN]).is_nan());
        assert_eq!(margin(Event::Any, [2.0, 3.0]), 2.0);
        assert_eq!(margin(Event::Both(0, 1), [2.0, 3.0]), 3.0);
    }

    #[test]
    fn property_an_event_of_a_missing_limit_is_an_error() {
        assert!(Event::Limit(2).members(2).is_err());
        assert!(Event::Both(0, 5).members(2).is_err());
        assert!(Event::Any.members(0).is_err());
        assert_eq!(Event::Any.members(3), Ok(vec![0, 1, 2]));
    }
}
