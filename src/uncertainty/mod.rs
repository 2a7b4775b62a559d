//! What is uncertain: laws, their truncated forms, and the dependence between them.
//!
//! A [`Law`] is a distribution family with its parameters, a [`Marginal`] a law with stated
//! truncation, a [`Copula`] the Gaussian dependence of several, a [`JointSample`] rows in which several
//! inputs are drawn together, a [`Joint`] all of it: it turns points of the unit cube or of standard normal space into values in SI units.

pub mod correlation;
pub mod empirical;
pub mod joint;
pub mod joint_sample;
pub mod law;
pub mod marginal;
mod moments;
pub mod nataf;
mod perturbation;
pub mod readings;
mod transform;
mod truncation;

pub use correlation::{Copula, Measure, NEAREST_TO_ONE, Refusal, Statement};
pub use empirical::Empirical;
pub use joint::Joint;
pub use joint_sample::JointSample;
pub use law::Law;
pub use marginal::Marginal;
pub use readings::Readings;
