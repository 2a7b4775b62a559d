//! The vector integrator: many descents at once, one in each lane.
//!
//! Every lane has its own time, step size, error control, end and peaks, and is refilled from the queue
//! when it ends. A lane's result is a function of its own coefficients and the tolerance alone, to the bit:
//! not of its neighbours, of the batch's order or size, or of the instruction set (see
//! [`crate::numerics::lanes`]).
//!
//! # Choices, and what they were measured to do
//! Mean step attempts a descent at a worst error of 1e-6 over members of the default study, or the speed
//! of one thread with AVX-512, side by side in one run; rounded.
//! - **The start-up in one stride** (see `initial_layer.rs`): 32 attempts in the dynamic model instead of the 42 from rest,
//!   19 instead of 26 at 1e-5: 1.3 and 1.4 × as fast.
//! - **Rodas4P2 in slow variables**: 42 attempts of six stages in the dynamic model from rest, 34 in the quasi-steady.
//!   The analytic Jacobian is eliminated by hand (see `dynamic.rs`), a solve costs thirty
//!   multiply-adds. In the quasi-steady model order 4 is the limit: cost per digit does not change with the
//!   weights any more; an explicit method of order 5 or more is the next thing to try there.
//! - **The error norm** weighs states by what they do to the outcomes: a sixth fewer attempts than equal
//!   relative weights at the same error.
//! - **Growth aimed at 0.85**: 2 % of attempts rejected. A predictive controller gave a tenth more error
//!   at equal cost.
//! - **Peaks** from the dense output's derivative of the stiff variable: with the right-hand side's they
//!   were wrong by up to 18 % in runs that do not deploy, now by 2e-5 at worst.
//! - **Two registers side by side** in a group: 1.13 × in the dynamic model, 1.43 × in the quasi-steady; a
//!   stage is a chain of dependent operations, and the second group fills its waits.
//! - **One division for several reciprocals**, and a step-size rule without roots: 1.09 × and 1.10 ×.
//! - **A refilled lane idles one step** instead of having every lane's right-hand side evaluated again, and
//!   a result is read from its lane alone: 1.09 × together. Constants and starts of as many descents as there
//!   are lanes are worked out side by side (see `ready.rs`): 1.02 ×, in the quasi-steady model 1.04 ×.
//! - Tried and left: reciprocals by Newton's iteration from the machine's estimate (0.97 ×: the multiply-add
//!   ports are what is short, not the divider); time by the corrected trapezoidal rule over the steps instead
//!   of as a state (fewer operations a step, but a quarter more steps at the same error); one evaluation of
//!   the observables' rates a step instead of two (1.02 ×, but peaks of the tension six times worse; as a linear
//!   function of the stiff variable's rate 1.02 ×, in the quasi-steady model 0.98 ×); two groups stage by stage in
//!   place of two registers side by side (1.00 ×), three (1.00 ×), a loop over the stages (0.93 ×), scheduling by
//!   the compiler's other orders (0.99 to 1.03 ×).
//! - AVX2 reaches 0.7 of AVX-512, a third of whose multiply-add peak the dynamic kernel uses.

mod batch;
mod clock;
mod constants;
mod detailed;
mod dispatch;
mod dynamic;
#[cfg(test)]
mod equations_test;
mod group;
mod initial_layer;
mod leg;
mod model;
mod observables;
mod possible;
mod quasi_steady;
mod queue;
mod ready;
pub mod rosenbrock;
mod settings;
mod settle;
mod start;
pub(super) mod tangents;
mod thermal;

pub use crate::numerics::lanes::InstructionSet;
pub use batch::{Batch, Draws};
pub use settings::{Counts, Settings, TOLERANCES, default_tolerance};

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

/// [`descend`] of draws of a design's parameters.
///
/// # Panics
/// If the draws have fewer columns than targets: a mistake of the caller's.
pub fn descend_draws(
    model: Model,
    settings: &Settings,
    draws: Draws,
    results: &mut [Result<Outcome, Fault>],
) -> Counts {
    let count = results.len().min(Batch::Draws(draws).len());
    let draws = Draws { possible: &draws.possible[..count], ..draws };
    let results = &mut results[..count];
    deep(|| settle::run(InstructionSet::best(), model, settings, Batch::Draws(draws), results))
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
    let (batch, results) = (Batch::Coefficients(&batch[..count]), &mut results[..count]);
    deep(|| settle::run(set, model, settings, batch, results))
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
