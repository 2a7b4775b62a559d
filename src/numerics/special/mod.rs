//! Special functions of probability, accurate in both tails.
//!
//! Every distribution comes with its lower and its upper tail and the inverse of each, because a
//! probability near one has lost the digits that matter. Arguments outside a function's domain give NaN.

pub mod beta;
pub mod binomial;
pub mod chi_squared;
mod deviance;
pub mod gamma;
mod inversion;
pub(crate) mod kernels;
pub mod normal;
pub(crate) mod quadrature;
pub mod student;
