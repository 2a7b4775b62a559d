//! Crude Monte Carlo on a limit state: slow, without assumptions, the judge of the others.

use super::draws::standard_normal;
use super::estimate::{Estimate, Method};
use super::event::{BATCH, Evaluator, Event, FaultReading};
use super::limit_state::LimitState;
use super::probability::Proportion;
use crate::error::Result;
use crate::numerics::columns::Columns;
use crate::streams::{Purpose, keyed};

/// How crude Monte Carlo is done.
#[derive(Debug, Clone, PartialEq)]
pub struct CrudeOptions {
    /// Points.
    pub samples: u64,
    /// Confidence of the interval.
    pub confidence: f64,
    /// Seed of the points.
    pub seed: u64,
}

impl CrudeOptions {
    /// The usual choices, with the seed of every stream.
    pub fn seeded(seed: u64) -> Self {
        CrudeOptions { samples: 100_000, confidence: 0.95, seed }
    }
}

/// Crude Monte Carlo of an event, with the exact binomial interval (Clopper–Pearson).
///
/// Point k is a pure function of (seed, k); the stream's purpose is the confirmation of another run.
///
/// # Errors
/// If the event does not fit, the confidence is out of range, or the limit state fails.
pub fn crude_monte_carlo(
    state: &dyn LimitState,
    event: Event,
    options: &CrudeOptions,
) -> Result<Estimate> {
    let mut evaluator = Evaluator::new(state, event, FaultReading::Kept)?;
    let mut stream = keyed(options.seed, Purpose::Confirmation);
    let (mut points, mut values) = (Columns::default(), Vec::new());
    let (mut breaches, mut first) = (0, 0);
    while first < options.samples {
        let count = (options.samples - first).min(BATCH as u64);
        points.reset(count as usize, state.dimension());
        for row in 0..count {
            stream.set_stream(first + row);
            stream.set_word_pos(0);
            for j in 0..state.dimension() {
                points.set(row as usize, j, standard_normal(&mut stream));
            }
        }
        evaluator.evaluate(&points, &mut values)?;
        breaches += values.iter().filter(|&&margin| margin < 0.0).count() as u64;
        first += count;
    }
    let counts = Proportion::new(breaches, evaluator.faults, options.samples)?;
    let mut estimate = from_counts(event, counts, options.confidence)?;
    estimate.evaluations = evaluator.evaluations;
    Ok(estimate)
}

/// The crude estimate of an event from counts, however they were sampled.
///
/// # Errors
/// If the confidence is not strictly between 0 and 1.
pub fn from_counts(event: Event, counts: Proportion, confidence: f64) -> Result<Estimate> {
    let bounds = counts.fault_bounds();
    let n = counts.samples as f64;
    Ok(Estimate {
        method: Method::CrudeMonteCarlo,
        event,
        probability: bounds.map(|(least, _)| least),
        probability_with_faults: bounds.map(|(_, most)| most),
        standard_error: bounds.map(|(least, _)| (least * (1.0 - least) / n).sqrt()),
        interval: counts.interval(confidence)?,
        evaluations: counts.samples,
        faults: counts.faults,
        diagnostics: vec![format!("{} breaches of {}", counts.breaches, counts.samples)],
        replicates: Vec::new(),
    })
}
