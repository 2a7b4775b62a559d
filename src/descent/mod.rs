//! One life of the rig: from release to the end of the line, an outcome or a fault.

pub mod model;
pub mod outcome;
pub mod reference;

use crate::physics::Coefficients;

pub use model::Model;
pub use outcome::{Fault, Outcome, OutcomeQuantity};

/// Integrates a batch of descents: `results[k]` is what becomes of `batch[k]`.
pub fn descend_batch(
    model: Model,
    tolerance: f64,
    batch: &[Coefficients<f64>],
    results: &mut [Result<Outcome, Fault>],
) {
    for (coefficients, result) in batch.iter().zip(results) {
        *result = reference::descend(coefficients, model, tolerance);
    }
}
