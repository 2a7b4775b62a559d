//! The vector integrator: many descents at once, one in each lane.

mod clock;
mod constants;
mod dispatch;
mod dynamic;
#[cfg(test)]
mod equations_test;
mod kernel;
mod model;
mod observables;
mod quasi_steady;
pub mod rosenbrock;
mod settings;
mod thermal;

pub use dispatch::InstructionSet;
pub use settings::{Counts, Settings, default_tolerance};

use super::model::Model;
use super::outcome::{Fault, Outcome};
use crate::physics::Coefficients;

/// Integrates a batch of descents with the machine's best instruction set: `results[k]` is what becomes of
/// `batch[k]`, and does not depend on anything else in the batch. Surplus entries of either are ignored.
pub fn descend(
    model: Model,
    settings: &Settings,
    batch: &[Coefficients<f64>],
    results: &mut [Result<Outcome, Fault>],
) -> Counts {
    descend_with(InstructionSet::best(), model, settings, batch, results)
}

/// [`descend`] with an instruction set of the caller's choice; the bits are the same with every one.
pub fn descend_with(
    set: InstructionSet,
    model: Model,
    settings: &Settings,
    batch: &[Coefficients<f64>],
    results: &mut [Result<Outcome, Fault>],
) -> Counts {
    let count = batch.len().min(results.len());
    let (batch, results) = (&batch[..count], &mut results[..count]);
    deep(|| dispatch::dispatch(set, model, settings, batch, results))
}

/// Runs the kernel. Without optimisation its one inlined function keeps thousands of intermediate vectors
/// on the stack, more than a test's thread has, so it gets a deeper one then.
#[cfg(debug_assertions)]
fn deep(kernel: impl FnOnce() -> Counts + Send) -> Counts {
    const STACK_BYTES: usize = 64 << 20;
    std::thread::scope(|scope| {
        let thread =
            std::thread::Builder::new().stack_size(STACK_BYTES).spawn_scoped(scope, kernel);
        match thread.map(std::thread::ScopedJoinHandle::join) {
            Ok(Ok(counts)) => counts,
            Ok(Err(panic)) => std::panic::resume_unwind(panic),
            Err(error) => panic!("no thread for the kernel: {error}"),
        }
    })
}

#[cfg(not(debug_assertions))]
#[inline]
fn deep(kernel: impl FnOnce() -> Counts) -> Counts {
    kernel()
}

/// The instruction set that [`descend`] uses here.
pub fn instruction_set() -> &'static str {
    InstructionSet::best().name()
}
