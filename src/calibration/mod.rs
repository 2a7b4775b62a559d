//! From data to a posterior: what measurements teach of uncertain parameters, and what they do not.
//!
//! Knows nothing of brakes. A calibration sees a [`LogLikelihood`] over parameters in standard-normal space, where
//! the prior is the law N(0, I), in batches, as a reliability method sees its limit state.
//! - [`noise`]: how readings scatter about a model that is not quite right;
//! - [`best_fit()`]: the most probable parameters;
//! - [`tempering`] and [`posterior`]: the posterior and the evidence by sequential Monte Carlo, in replicates that check
//!   each other;
//! - [`consistency`]: whether data agree, with each other and with the prior;
//! - [`screening`]: what is suspicious about readings before they are used;
//! - [`narrowing`]: what a further measurement would teach.

pub mod best_fit;
mod cloud;
pub mod consistency;
mod likelihood;
pub mod narrowing;
pub mod noise;
pub mod posterior;
pub mod screening;
pub mod tempering;

pub use best_fit::{BestFit, best_fit};
pub use likelihood::{LeastSquares, LogLikelihood, Whitened};
pub use posterior::{Diagnosis, Posterior, sample};
pub use tempering::{Plan, Replicate};
