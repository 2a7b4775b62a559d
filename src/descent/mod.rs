//! One life of the rig: from release to the end of the line, an outcome or a fault.

pub mod driven;
pub mod gradient;
pub mod model;
pub mod outcome;
pub mod reference;
pub mod vector;

use crate::physics::Coefficients;

pub use model::Model;
pub use outcome::{Fault, Outcome, OutcomeQuantity};

/// Integrates a batch of descents by the vector integrator: `results[k]` is what becomes of `batch[k]`.
pub fn descend_batch(
    model: Model,
    tolerance: f64,
    batch: &[Coefficients<f64>],
    results: &mut [Result<Outcome, Fault>],
) {
    vector::descend(model, &vector::Settings { tolerance }, batch, results);
}

/// Integrates draws of a design's parameters by the vector integrator: `results[k]` is what becomes of row `k`.
pub fn descend_draws(
    model: Model,
    tolerance: f64,
    draws: vector::Draws,
    results: &mut [Result<Outcome, Fault>],
) {
    vector::descend_draws(model, &vector::Settings { tolerance }, draws, results);
}
