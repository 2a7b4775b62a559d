//! What drives an outcome: sensitivity indices from designs of their own and from samples already run.
//!
//! Every function takes columns of numbers, one outcome at a time, so that a caller can work on the
//! outcomes in parallel. A sample that could not be computed is NaN: it is left out and counted.

// From a design of their own.
mod block_sums;
pub mod bootstrap;
pub mod morris;
pub mod pick_freeze;
pub(crate) mod rare_events;
pub mod shapley;
pub mod sobol_indices;

// From samples already run.
pub mod borgonovo;
mod classes;
pub mod conditional_normal;
pub mod given_data;
pub mod hsic;
pub mod pawn;
pub mod rank_index;
pub mod regression;
pub mod reweighting;
pub mod score;
pub mod score_sums;
pub mod target;
