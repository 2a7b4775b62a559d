//! The table that a campaign fills: one row a sample, always, faulted ones included.

use crate::descent::outcome::OUTCOME_COUNT;
use crate::descent::{Fault, Outcome, OutcomeQuantity};
use crate::numerics::columns::Columns;

/// Consecutive samples with their inputs and what became of them.
#[derive(Debug, Clone, PartialEq)]
pub struct OutcomeTable {
    /// Index of the first sample.
    pub first: u64,
    /// Inputs, SI: rows = samples, columns = inputs of the study.
    pub inputs: Columns,
    /// Outcomes, SI: rows = samples, columns = [`OutcomeQuantity::ALL`]; NaN in a faulted row.
    pub outcomes: Columns,
    /// Whether the line ran out before the time limit; false in a faulted row.
    pub deployed: Vec<bool>,
    /// Why a sample could not be computed.
    pub faults: Vec<Option<Fault>>,
}

impl OutcomeTable {
    /// A table of `rows` samples from `first` on, not computed yet.
    pub fn new(first: u64, rows: usize, inputs: usize) -> Self {
        OutcomeTable {
            first,
            inputs: Columns::new(rows, inputs),
            outcomes: Columns::new(rows, OUTCOME_COUNT),
            deployed: vec![false; rows],
            faults: vec![None; rows],
        }
    }

    /// Consecutive tables as one, from sample `first` on; with their inputs, if they have this many.
    pub fn joined(first: u64, inputs: usize, parts: &[OutcomeTable]) -> Self {
        OutcomeTable {
            first,
            inputs: Columns::joined(inputs, parts.iter().map(|part| &part.inputs)),
            outcomes: Columns::joined(OUTCOME_COUNT, parts.iter().map(|part| &part.outcomes)),
            deployed: parts.iter().map(|part| &part.deployed[..]).collect::<Vec<_>>().concat(),
            faults: parts.iter().map(|part| &part.faults[..]).collect::<Vec<_>>().concat(),
        }
    }

    /// Number of samples.
    pub fn rows(&self) -> usize {
        self.deployed.len()
    }

    /// One outcome quantity of every sample, SI, NaN where faulted.
    pub fn outcome(&self, quantity: OutcomeQuantity) -> &[f64] {
        self.outcomes.column(quantity as usize)
    }

    /// Writes what became of row `k`.
    pub fn record(&mut self, k: usize, result: Result<Outcome, Fault>) {
        let values = result.map_or([f64::NAN; OUTCOME_COUNT], |outcome| outcome.values);
        for (j, value) in values.into_iter().enumerate() {
            self.outcomes.set(k, j, value);
        }
        self.deployed[k] = result.is_ok_and(|outcome| outcome.deployed);
        self.faults[k] = result.err();
    }

    /// What became of row `k`.
    pub fn result(&self, k: usize) -> Result<Outcome, Fault> {
        match self.faults[k] {
            Some(fault) => Err(fault),
            None => Ok(Outcome {
                deployed: self.deployed[k],
                values: std::array::from_fn(|j| self.outcomes.get(k, j)),
            }),
        }
    }
}
